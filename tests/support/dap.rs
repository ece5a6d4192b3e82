//! Cases of kind `dap`: a session with `gcode-sim dap`, requests and expected answers line by line in `session.txt`.
//!
//! `--> next {"threadId": 1}` sends a request with its arguments, `--! TEXT` a message as it stands. `<-- next {…}` is the next
//! message and must be the response with this body, `<-- refused next "text"` a failed one whose message contains the text,
//! `<-- event stopped {…}` an event. `json` compares the bodies; a line without one leaves it open. A line that begins with spaces continues the one before; `$DIR` is the folder of the case, `$ROOT` that
//! of the workspace.
use std::io::{Read, Write};
use std::process::{Child, ChildStdin, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::Value;

use crate::{Case, copy_folder, json, programs, workspace};

/// Time after which a missing message fails the case.
const PATIENCE: Duration = Duration::from_secs(60);

/// Client of one process.
pub struct DapClient {
    process: Child,
    stdin: Option<ChildStdin>,
    messages: Receiver<Value>,
    sent: i64,
    received: i64,
}

impl DapClient {
    /// Starts `gcode-sim dap`.
    pub fn start() -> Self {
        let mut command = programs::program("gcode-sim");
        let mut process = command
            .arg("dap")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut stdout = process.stdout.take().unwrap();
        let (sender, messages) = channel();
        std::thread::spawn(
            move || while read_message(&mut stdout).is_some_and(|read| sender.send(read).is_ok()) {},
        );
        Self { stdin: process.stdin.take(), process, messages, sent: 0, received: 0 }
    }

    /// Sends a message as it stands.
    pub fn send_text(&mut self, text: &str) {
        let stdin = self.stdin.as_mut().unwrap();
        write!(stdin, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        stdin.flush().unwrap();
    }

    /// Sends a request and returns its number.
    pub fn request(&mut self, command: &str, arguments: &Value) -> i64 {
        self.sent += 1;
        let mut request = serde_json::json!({"seq": self.sent, "type": "request", "command": command});
        if !arguments.is_null() {
            request["arguments"] = arguments.clone();
        }
        self.send_text(&request.to_string());
        self.sent
    }

    /// Waits for the next message; their numbers have no gap.
    pub fn receive(&mut self) -> Value {
        let message = self.messages.recv_timeout(PATIENCE).expect("no further message");
        self.received += 1;
        assert_eq!(message["seq"], self.received, "{message}");
        message
    }

    /// Closes standard input and returns the exit code; no message may be left.
    pub fn finish(mut self) -> Option<i32> {
        self.stdin.take();
        let status = self.process.wait().unwrap();
        let left: Vec<Value> = self.messages.iter().collect();
        assert!(left.is_empty(), "messages behind the last expected one: {left:?}");
        status.code()
    }
}

/// Reads a message with its header; `None` at the end.
fn read_message(stdout: &mut impl Read) -> Option<Value> {
    let mut header = Vec::new();
    while !header.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stdout.read_exact(&mut byte).ok()?;
        header.push(byte[0]);
    }
    let header = String::from_utf8(header).unwrap();
    let length = header.strip_prefix("Content-Length: ").unwrap().trim().parse().unwrap();
    let mut message = vec![0; length];
    stdout.read_exact(&mut message).ok()?;
    Some(serde_json::from_slice(&message).unwrap())
}

/// Plays the session and compares every message.
pub(crate) fn run(case: &Case) {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().canonicalize().unwrap();
    copy_folder(&case.dir, &folder);
    let text = case.text("session.txt").replace("$DIR", &folder.display().to_string());
    let text = text.replace("$ROOT", &workspace().display().to_string());
    let mut client = DapClient::start();
    let mut last = 0;
    for line in joined_lines(&text) {
        if let Some(raw) = line.strip_prefix("--! ") {
            client.send_text(raw);
        } else if let Some(request) = line.strip_prefix("--> ") {
            let (command, arguments) = split(request);
            last = client.request(command, &arguments.unwrap_or_default());
        } else if let Some(expected) = line.strip_prefix("<-- ") {
            expect(expected, last, &client.receive());
        } else {
            panic!("'{line}' is neither a request nor an answer");
        }
    }
    assert_eq!(client.finish(), Some(0), "the exit code");
}

/// Returns the lines without comments, each with those that continue it.
fn joined_lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')) {
        match lines.last_mut() {
            Some(last) if line.starts_with(' ') => last.push_str(line),
            _ => lines.push(line.to_owned()),
        }
    }
    lines
}

/// Splits a name from the JSON behind it, if there is any.
fn split(text: &str) -> (&str, Option<Value>) {
    let Some((name, json)) = text.split_once(' ') else { return (text, None) };
    (name, Some(serde_json::from_str(json).unwrap_or_else(|error| panic!("{json}: {error}"))))
}

fn expect(expected: &str, last: i64, message: &Value) {
    if let Some(event) = expected.strip_prefix("event ") {
        let (name, body) = split(event);
        assert_eq!((&message["type"], &message["event"]), (&"event".into(), &name.into()), "{message}");
        return check(body.as_ref(), message);
    }
    let refused = expected.strip_prefix("refused ");
    let (name, body) = split(refused.unwrap_or(expected));
    assert_eq!(message["type"], "response", "expected {expected}: {message}");
    assert_eq!(message["success"], refused.is_none(), "expected {expected}: {message}");
    if refused.is_some() {
        let text = body.as_ref().and_then(Value::as_str).unwrap_or_default();
        assert!(message["message"].as_str().unwrap().contains(text), "expected {text}: {message}");
        let error = &message["body"]["error"]["format"];
        assert_eq!(*error, message["message"], "{message}");
        return;
    }
    assert_eq!((&message["command"], &message["request_seq"]), (&name.into(), &last.into()), "{message}");
    check(body.as_ref(), message);
}

/// Compares the body of a message with what is expected of it.
fn check(expected: Option<&Value>, message: &Value) {
    if let Some(expected) = expected
        && let Err(path) = json::compare(expected, &message["body"])
    {
        panic!("expected {expected}\nat {path}: {message}");
    }
}
