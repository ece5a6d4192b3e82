//! Messages of the Language Server Protocol on standard input and output. A message that cannot be read is answered with an
//! error and does not end the server.
#![expect(clippy::disallowed_methods, reason = "the command line reads standard input")]

use std::io::{self, BufRead, Write};
use std::sync::mpsc;
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, unbounded};
use lsp_server::{Connection, Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};

use super::message_frames::{read_body, write_body};

/// JSON-RPC: the text is not JSON.
const PARSE_ERROR: i32 = -32700;

/// JSON-RPC: the document is no message.
const INVALID_REQUEST: i32 = -32600;

/// The thread that writes.
pub(super) struct Writer {
    thread: JoinHandle<()>,
    done: mpsc::Receiver<()>,
}

impl Writer {
    /// Waits until the messages sent before are written, for at most a second.
    pub(super) fn finish(self) {
        // Work in the background may hold a sender longer: its messages do not count any more.
        if self.done.recv_timeout(Duration::from_secs(1)).is_ok() {
            _ = self.thread.join();
        }
    }
}

/// Returns a connection over standard input and output, and the thread that writes.
pub(super) fn stdio() -> (Connection, Writer) {
    let (in_sender, receiver) = unbounded();
    let (sender, out_receiver) = unbounded();
    let (done_sender, done) = mpsc::channel();
    std::thread::spawn(move || read_all(&mut io::stdin().lock(), &in_sender, &mut io::stdout()));
    let thread = std::thread::spawn(move || {
        write_all(&out_receiver, &mut io::stdout());
        _ = done_sender.send(());
    });
    (Connection { sender, receiver }, Writer { thread, done })
}

/// Reads messages to the end of the input.
fn read_all(input: &mut impl BufRead, messages: &Sender<Message>, errors: &mut impl Write) {
    while let Ok(Some(body)) = read_body(input) {
        let message = match body {
            Ok(body) => parse(&body),
            Err(reason) => Err((PARSE_ERROR, Value::Null, reason)),
        };
        match message {
            Ok(message) => {
                let is_exit = matches!(&message, Message::Notification(message) if message.method == "exit");
                if messages.send(message).is_err() || is_exit {
                    return;
                }
            }
            Err((code, id, message)) => {
                let error =
                    json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code, "message": message } });
                _ = write_body(errors, error.to_string().as_bytes());
            }
        }
    }
}

/// Parses a message; an error has its code, the id of the request as far as it is known, and a sentence.
fn parse(body: &[u8]) -> Result<Message, (i32, Value, String)> {
    let value: Value = serde_json::from_slice(body)
        .map_err(|error| (PARSE_ERROR, Value::Null, format!("not JSON: {error}")))?;
    let invalid = |id, message: &str| (INVALID_REQUEST, id, message.to_owned());
    let Value::Object(mut fields) = value else {
        return Err(invalid(Value::Null, "a message is one object"));
    };
    let written_id = fields.remove("id").filter(|id| !id.is_null());
    let id = written_id.clone().map(serde_json::from_value::<RequestId>).transpose();
    let id = id.map_err(|_| invalid(Value::Null, "the id is neither a string nor an integer"))?;
    let params = fields.remove("params").unwrap_or_default();
    match (fields.remove("method"), id) {
        (Some(Value::String(method)), Some(id)) => Ok(Request { id, method, params }.into()),
        (Some(Value::String(method)), None) => Ok(Notification { method, params }.into()),
        (None, Some(id)) if fields.contains_key("result") || fields.contains_key("error") => {
            let error = fields.remove("error").and_then(|error| serde_json::from_value(error).ok());
            Ok(Response { id, result: fields.remove("result"), error }.into())
        }
        _ => Err(invalid(
            written_id.unwrap_or_default(),
            "neither a request nor a notification nor a response: 'method' is missing",
        )),
    }
}

/// Writes messages until the last sender is gone.
fn write_all(messages: &Receiver<Message>, output: &mut impl Write) {
    for message in messages {
        let mut value = serde_json::to_value(&message).unwrap_or_default();
        if let Some(fields) = value.as_object_mut() {
            fields.insert("jsonrpc".to_owned(), "2.0".into());
        }
        if write_body(output, value.to_string().as_bytes()).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn framed(body: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{body}", body.len())
    }

    /// Returns the methods read from an input, and what was written.
    fn read(input: &str) -> (Vec<String>, String) {
        let (sender, receiver) = unbounded();
        let mut errors = Vec::new();
        read_all(&mut input.as_bytes(), &sender, &mut errors);
        drop(sender);
        let method = |message| match message {
            Message::Request(request) => request.method,
            Message::Notification(notification) => notification.method,
            Message::Response(_) => "response".to_owned(),
        };
        (receiver.iter().map(method).collect(), String::from_utf8(errors).unwrap())
    }

    #[test]
    fn a_message_that_cannot_be_read_is_answered_and_the_next_is_read() {
        let next = framed(r#"{"jsonrpc":"2.0","id":2,"method":"shutdown"}"#);
        let (methods, errors) = read(&(framed("{\"id\":") + &next));
        assert_eq!(methods, ["shutdown"]);
        assert!(errors.contains("-32700") && errors.contains("\"id\":null"), "{errors}");
        let (methods, errors) = read(&(framed(r#"{"id":7}"#) + &next));
        assert_eq!(methods, ["shutdown"]);
        assert!(errors.contains("-32600") && errors.contains("\"id\":7"), "{errors}");
        let (methods, errors) = read(&(framed(r#"{"id":7,"result":null}"#) + &next));
        assert_eq!((methods, errors.as_str()), (vec!["response".to_owned(), "shutdown".to_owned()], ""));
        let (methods, errors) = read(&(framed(r#"{"id":1.5,"method":"x"}"#) + &next));
        assert_eq!(methods, ["shutdown"]);
        assert!(errors.contains("-32600"), "{errors}");
        let (methods, errors) = read(&(framed("[]") + &next));
        assert_eq!(methods, ["shutdown"]);
        assert!(errors.contains("-32600"), "{errors}");
    }

    #[test]
    fn headers_may_come_in_any_case_and_order() {
        let body = r#"{"method":"exit"}"#;
        let input = format!("content-type: utf-8\r\nCONTENT-LENGTH:{}\r\n\r\n{body}", body.len());
        assert_eq!(read(&input).0, ["exit"]);
        assert_eq!(read("Content-Length: 99\r\n\r\n{}").0, [""; 0], "cut off");
    }
}
