//! Cases of kind `lsp`: a session with the language server, `session.txt`, over a connection in memory.
//!
//! The folder is copied, and the server reads that copy. Lines and characters count from 0, as in the protocol. Steps:
//!
//! - `client {…}`: parts of the parameters of initialize; without it the client has no capabilities. It comes first.
//! - `folder`: the copy is the folder of the workspace; `folder by path` states it as an old client does.
//! - `open O1.nc [VERSION]`: opens a file with its text on the disk, or with the lines behind `|` that follow.
//! - `change O1.nc VERSION`: then lines `2:0-2:4 "text"` or `all "text"`, each a change. `close O1.nc`.
//! - `disk O1.nc`: writes the lines behind `|` to the disk and says so; `disk O1.nc silently` says nothing.
//! - `diagnostics O1.nc [VERSION]`: waits for them; then lines `2:0-2:4 error missing-n`, `~words` of the message behind.
//! - `-> METHOD {…}` and `<- {…}` or `<- error -32602 ~words`: a request and its answer, which `json` compares. `$O1.nc`
//!   is the URI of a file.
//! - `notify METHOD {…}`; `server METHOD ~words`: waits for a message of the server; `reply METHOD {…}`: answers its request.
//! - `never METHOD`: fails if a request METHOD has come that no step took; behind a step that waits for a later message.
//! - `eol crlf`: lines behind `|` end with CR LF from here on.
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use gcode_lsp::{SessionEnd, serve};
use gcode_sim::cli::lsp::EditorHost;
use lsp_server::{Connection, Message, Notification, Request, Response};
use serde_json::{Value, json};

use crate::{Case, copy_folder, json};

/// Longest time until an answer.
const PATIENCE: Duration = Duration::from_secs(20);

/// Runs the session; each answer must be the expected one.
pub(crate) fn run(case: &Case) {
    let folder = tempfile::tempdir().unwrap();
    copy_folder(&case.dir, folder.path());
    let text = case.text("session.txt");
    let lines: Vec<(usize, &str)> = (1..).zip(text.lines()).collect();
    let mut session = Session::new(folder.path(), &lines);
    let mut at = 0;
    while at < lines.len() {
        at += 1;
        let (number, line) = lines[at - 1];
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        // A step has the indented lines and those behind bars that follow.
        let more = lines[at..].iter().take_while(|(_, line)| line.starts_with([' ', '|'])).count();
        let body: Vec<&str> = lines[at..at + more].iter().map(|(_, line)| *line).collect();
        at += more;
        session.place = format!("{} line {number}: {line}", case.name());
        session.step(line, &body);
    }
    session.finish();
}

struct Session<'a> {
    folder: &'a Path,
    client: Connection,
    server: Option<JoinHandle<SessionEnd>>,
    received: VecDeque<Message>,
    next_id: i32,
    asked: Option<i32>,
    version: i32,
    line_end: &'static str,
    place: String,
}

impl<'a> Session<'a> {
    /// Starts the server as the first lines state.
    fn new(folder: &'a Path, lines: &[(usize, &str)]) -> Self {
        let (server, client) = Connection::memory();
        let host = Arc::new(EditorHost::default());
        let server = std::thread::spawn(move || serve(&server, host));
        let mut session = Self {
            folder,
            client,
            server: Some(server),
            received: VecDeque::new(),
            next_id: 0,
            asked: None,
            version: 1,
            line_end: "\n",
            place: "initialize".to_owned(),
        };
        let mut params = json!({ "processId": null, "rootUri": null, "capabilities": {} });
        for (_, line) in lines {
            if let Some(given) = line.strip_prefix("client ") {
                for (key, value) in session.json(given).as_object().unwrap() {
                    params[key] = value.clone();
                }
            }
            match *line {
                "folder" => params["rootUri"] = session.uri("").into(),
                "folder by path" => params["rootPath"] = folder.display().to_string().into(),
                _ => {}
            }
        }
        session.ask("initialize", params);
        assert!(session.answer().error.is_none());
        session.notify("initialized", json!({}));
        session
    }

    fn step(&mut self, line: &str, body: &[&str]) {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        let mut words = rest.split(' ');
        let name = words.next().unwrap();
        match word {
            "client" | "folder" => {}
            "eol" => self.line_end = if rest == "crlf" { "\r\n" } else { "\n" },
            "open" => {
                self.version = words.next().map_or(1, |word| word.parse().unwrap());
                let text = if body.is_empty() {
                    std::fs::read_to_string(self.folder.join(name)).unwrap()
                } else {
                    self.text(body)
                };
                let document = json!({ "uri": self.uri(name), "languageId": "nc", "version": self.version, "text": text });
                self.notify("textDocument/didOpen", json!({ "textDocument": document }));
            }
            "change" => {
                self.version = words.next().unwrap().parse().unwrap();
                let changes: Vec<Value> = body.iter().map(|line| change(line.trim())).collect();
                let document = json!({ "uri": self.uri(name), "version": self.version });
                self.notify(
                    "textDocument/didChange",
                    json!({ "textDocument": document, "contentChanges": changes }),
                );
            }
            "close" => {
                self.notify("textDocument/didClose", json!({ "textDocument": { "uri": self.uri(name) } }))
            }
            "disk" => {
                let path = self.folder.join(name);
                std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                std::fs::write(path, self.text(body)).unwrap();
                if words.next() != Some("silently") {
                    let change = json!({ "uri": self.uri(name), "type": 2 });
                    self.notify("workspace/didChangeWatchedFiles", json!({ "changes": [change] }));
                }
            }
            "diagnostics" => {
                let version = words.next().map_or(json!(self.version), |word| self.json(word));
                self.await_diagnostics(name, &version, body);
            }
            "->" => {
                let params = self.json_of(rest.strip_prefix(name).unwrap(), body);
                self.ask(name, params);
            }
            "<-" => {
                let answer = self.answer();
                self.compare_answer(rest, body, answer);
            }
            "notify" => {
                let params = self.json_of(rest.strip_prefix(name).unwrap(), body);
                self.notify(name, params);
            }
            "reply" => {
                let answer = self.json_of(rest.strip_prefix(name).unwrap(), body);
                let message = self.await_message(
                    |message| matches!(message, Message::Request(request) if request.method == name),
                );
                let Message::Request(request) = message else { unreachable!() };
                self.client.sender.send(Response::new_ok(request.id, answer).into()).unwrap();
            }
            "server" => {
                let words = rest.split_once('~').map_or("", |(_, words)| words).to_owned();
                self.await_message(|message| match message {
                    Message::Notification(message) if message.method == name => {
                        message.params.to_string().contains(&words)
                    }
                    Message::Request(message) if message.method == name => {
                        message.params.to_string().contains(&words)
                    }
                    _ => false,
                });
            }
            "never" => {
                let is_sent = |message: &Message| matches!(message, Message::Request(request) if request.method == name);
                assert!(!self.received.iter().any(is_sent), "{}", self.place);
            }
            _ => panic!("{}: no such step", self.place),
        }
    }

    /// Shuts the server down.
    fn finish(mut self) {
        self.place = "shutdown".to_owned();
        self.ask("shutdown", Value::Null);
        assert_eq!(self.answer().result, Some(Value::Null));
        self.notify("exit", Value::Null);
        assert_eq!(self.server.take().unwrap().join().unwrap(), SessionEnd::Shutdown);
    }

    fn uri(&self, name: &str) -> String {
        if name.contains(':') {
            return name.to_owned();
        }
        format!("file://{}", self.folder.join(name).display())
    }

    /// The lines behind the bars, each with its end.
    fn text(&self, body: &[&str]) -> String {
        body.iter().map(|line| format!("{}{}", line.strip_prefix('|').unwrap(), self.line_end)).collect()
    }

    fn json_of(&self, first: &str, body: &[&str]) -> Value {
        let all = format!("{first}{}", body.concat());
        if all.trim().is_empty() { Value::Null } else { self.json(&all) }
    }

    /// Parses JSON; `$O1.nc` in it is the URI of a file.
    fn json(&self, text: &str) -> Value {
        let mut value =
            serde_json::from_str(text).unwrap_or_else(|error| panic!("{}: {error}: {text}", self.place));
        self.insert_uris(&mut value);
        value
    }

    fn insert_uris(&self, value: &mut Value) {
        match value {
            Value::String(text) => {
                if let Some(name) = text.strip_prefix('$') {
                    *text = self.uri(name);
                }
            }
            Value::Array(items) => items.iter_mut().for_each(|item| self.insert_uris(item)),
            Value::Object(fields) => {
                let named: Vec<_> = fields.keys().filter(|key| key.starts_with('$')).cloned().collect();
                for key in named {
                    let field = fields.remove(&key).unwrap();
                    fields.insert(self.uri(&key[1..]), field);
                }
                fields.values_mut().for_each(|field| self.insert_uris(field));
            }
            _ => {}
        }
    }

    fn ask(&mut self, method: &str, params: Value) {
        let id = self.next_id;
        self.next_id += 1;
        self.asked = Some(id);
        self.client.sender.send(Request { id: id.into(), method: method.to_owned(), params }.into()).unwrap();
    }

    fn notify(&self, method: &str, params: Value) {
        self.client.sender.send(Notification { method: method.to_owned(), params }.into()).unwrap();
    }

    /// Waits for the answer to the last request.
    fn answer(&mut self) -> Response {
        let id = self.asked.take().unwrap_or_else(|| panic!("{}: no request", self.place)).into();
        let message =
            self.await_message(|message| matches!(message, Message::Response(response) if response.id == id));
        let Message::Response(response) = message else { unreachable!() };
        response
    }

    /// Waits for a message; those before it are kept.
    fn await_message(&mut self, is_awaited: impl Fn(&Message) -> bool) -> Message {
        if let Some(at) = self.received.iter().position(&is_awaited) {
            return self.received.remove(at).unwrap();
        }
        loop {
            let message = self.client.receiver.recv_timeout(PATIENCE);
            let message =
                message.unwrap_or_else(|_| panic!("{}: nothing came, but {:?}", self.place, self.received));
            if is_awaited(&message) {
                return message;
            }
            self.received.push_back(message);
        }
    }

    fn compare_answer(&self, rest: &str, body: &[&str], answer: Response) {
        if let Some(error) = rest.strip_prefix("error ") {
            let (code, words) = error.split_once(" ~").unwrap_or((error, ""));
            let found =
                answer.error.unwrap_or_else(|| panic!("{}: no error: {:?}", self.place, answer.result));
            assert_eq!(found.code, code.parse::<i32>().unwrap(), "{}: {}", self.place, found.message);
            assert!(found.message.contains(words), "{}: {}", self.place, found.message);
            return;
        }
        let expected = self.json_of(rest, body);
        let result = answer.result.unwrap_or_else(|| panic!("{}: {:?}", self.place, answer.error));
        if let Err(path) = json::compare(&expected, &result) {
            panic!("{}\nat {path}:\n{}", self.place, serde_json::to_string_pretty(&result).unwrap());
        }
    }

    /// Waits for the diagnostics of a document; each published list of this version but the last may be another.
    fn await_diagnostics(&mut self, name: &str, version: &Value, expected: &[&str]) {
        let uri = self.uri(name);
        let mut seen = Vec::new();
        loop {
            let next = self.received.iter().position(|message| published(message, &uri, version).is_some());
            let message = match next {
                Some(at) => self.received.remove(at).unwrap(),
                None => match self.client.receiver.recv_timeout(PATIENCE) {
                    Ok(message) => message,
                    Err(_) => panic!("{}: other diagnostics: {seen:#?}", self.place),
                },
            };
            match published(&message, &uri, version) {
                Some(found) if is_expected(expected, &found) => return,
                Some(found) => seen.push(found),
                None => self.received.push_back(message),
            }
        }
    }
}

/// Returns published diagnostics as lines.
fn published(message: &Message, uri: &str, version: &Value) -> Option<Vec<String>> {
    let Message::Notification(Notification { method, params }) = message else { return None };
    let is_of =
        method == "textDocument/publishDiagnostics" && params["uri"] == *uri && params["version"] == *version;
    let severity = |diagnostic: &Value| match diagnostic["severity"].as_u64() {
        Some(1) => "error",
        Some(2) => "warning",
        Some(3) => "information",
        _ => "none",
    };
    let line = |diagnostic: &Value| {
        assert_eq!(diagnostic["source"], "gcode-sim");
        let place = |end: &str| {
            let position = &diagnostic["range"][end];
            format!("{}:{}", position["line"], position["character"])
        };
        let (code, message) = (diagnostic["code"].as_str().unwrap(), diagnostic["message"].as_str().unwrap());
        format!("{}-{} {} {code} ~{message}", place("start"), place("end"), severity(diagnostic))
    };
    is_of.then(|| params["diagnostics"].as_array().unwrap().iter().map(line).collect())
}

fn is_expected(expected: &[&str], found: &[String]) -> bool {
    let is_same = |expected: &str, found: &String| {
        let (head, words) = expected.trim().split_once(" ~").unwrap_or((expected.trim(), ""));
        let (found_head, message) = found.split_once(" ~").unwrap();
        head == found_head && message.contains(words)
    };
    expected.len() == found.len()
        && expected.iter().zip(found).all(|(expected, found)| is_same(expected, found))
}

/// Parses a change: `2:0-2:4 "text"`, `all "text"`.
fn change(line: &str) -> Value {
    let (range, text) = line.split_once(' ').unwrap();
    let text: Value = serde_json::from_str(text).unwrap();
    let position = |text: &str| {
        let (line, character) = text.split_once(':').unwrap();
        json!({ "line": line.parse::<u32>().unwrap(), "character": character.parse::<u32>().unwrap() })
    };
    match range.split_once('-') {
        Some((start, end)) => {
            json!({ "range": { "start": position(start), "end": position(end) }, "text": text })
        }
        None => json!({ "text": text }),
    }
}
