//! Properties of sessions with the language server and the debugger: the bodies of their fuzz targets.
//!
//! Bytes before the first 0xFF are a program, those behind it choose the steps of the session; a fixed sequence of numbers
//! chooses the steps that they lack.
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use gcode_dap::{Adapter, Host, LaunchArguments, LaunchedProgram};
use gcode_inspect::machine::Machine;
use gcode_lang::program::NoLibrary;
use gcode_lang::source::Bytes;
use gcode_lsp::serve;
use gcode_session::Request as RunRequest;
use gcode_sim::cli::lsp::EditorHost;
use lsp_server::{Connection, Message, Notification, Request};
use serde_json::{Value, json};

/// Longest time until an answer: a server that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(30);

/// Largest program of a session, bytes.
const MAX_TEXT: usize = 4096;

/// Steps of a session.
const STEPS: usize = 24;

/// Texts that edits insert.
const PIECES: [&str; 24] = [
    "",
    "\n",
    "\r\n",
    "\r",
    "%\n",
    "O2\n",
    "N10 ",
    "GOTO10\n",
    "#1",
    "#100=",
    "(",
    ")",
    "[",
    "]",
    "G65P2A1.\n",
    "M99\n",
    "WHILE[#1LT3]DO1\n",
    "END1\n",
    "X",
    "1",
    ".",
    "-",
    "(\u{d8}\u{1f600})",
    "DPRNT[",
];

/// Source of choices.
struct Choices<'a> {
    given: &'a [u8],
    state: u32,
}

impl<'a> Choices<'a> {
    /// Splits the input into a program and the choices of a session.
    fn split(input: &'a [u8]) -> (String, Self) {
        let at = input.iter().position(|byte| *byte == 0xFF);
        let (text, given) = at.map_or((input, &[][..]), |at| (&input[..at], &input[at + 1..]));
        let text = String::from_utf8_lossy(&text[..text.len().min(MAX_TEXT)]).into_owned();
        let state = text
            .bytes()
            .fold(0x811C_9DC5, |hash: u32, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
        (text, Self { given, state })
    }

    /// Returns a number below a bound.
    fn below(&mut self, bound: usize) -> usize {
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let drawn = match self.given.split_first() {
            Some((byte, rest)) => {
                self.given = rest;
                u32::from(*byte) | self.state & 0xFF00
            }
            None => self.state >> 8,
        };
        drawn as usize % bound.max(1)
    }

    fn of<'b>(&mut self, list: &[&'b str]) -> &'b str {
        list[self.below(list.len())]
    }
}

/// Client of a language server in memory, with one document.
struct Editor {
    client: Connection,
    next_id: i32,
    version: i32,
}

const URI: &str = "untitled:O1";

impl Editor {
    fn open(text: &str) -> Self {
        let (server, client) = Connection::memory();
        std::thread::spawn(move || serve(&server, Arc::new(EditorHost::default())));
        let mut editor = Self { client, next_id: 0, version: 1 };
        let capabilities = json!({ "general": { "positionEncodings": ["utf-8"] } });
        editor.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": capabilities }));
        editor.notify("initialized", json!({}));
        let document = json!({ "uri": URI, "languageId": "nc", "version": 1, "text": text });
        editor.notify("textDocument/didOpen", json!({ "textDocument": document }));
        editor
    }

    fn notify(&self, method: &str, params: Value) {
        self.client.sender.send(Notification { method: method.to_owned(), params }.into()).unwrap();
    }

    /// Returns the answer of a request: its result, or its error.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.next_id += 1;
        let id = self.next_id.into();
        self.client.sender.send(Request { id, method: method.to_owned(), params }.into()).unwrap();
        let id = self.next_id.into();
        let message = self.await_message(
            method,
            |message| matches!(message, Message::Response(response) if response.id == id),
        );
        let Message::Response(response) = message else { unreachable!() };
        if let Some(error) = &response.error {
            assert!(!error.message.contains("failed inside the server"), "{method}: {}", error.message);
        }
        json!({ "result": response.result, "error": response.error.map(|error| error.message) })
    }

    fn await_message(&self, what: &str, is_awaited: impl Fn(&Message) -> bool) -> Message {
        let start = Instant::now();
        loop {
            let left = PATIENCE.saturating_sub(start.elapsed());
            let message = self.client.receiver.recv_timeout(left);
            let message = message.unwrap_or_else(|_| panic!("{what} is not answered"));
            if is_awaited(&message) {
                return message;
            }
        }
    }

    /// Replaces a part of the text, and in the document.
    fn edit(&mut self, text: &mut String, choices: &mut Choices<'_>) {
        let mut start = boundary(text, choices.below(text.len() + 1));
        let mut end = boundary(text, (start + [0, 0, 1, 3, 20][choices.below(5)]).min(text.len()));
        // A position between CR and LF is none of the protocol.
        let is_between = |text: &str, at: usize| {
            text.as_bytes().get(at) == Some(&b'\n') && at > 0 && text.as_bytes()[at - 1] == b'\r'
        };
        start += usize::from(is_between(text, start));
        end = end.max(start);
        end += usize::from(is_between(text, end));
        let new = choices.of(&PIECES);
        let range = json!({ "start": position(text, start), "end": position(text, end) });
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        let changes = json!([{ "range": range, "text": new }]);
        self.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
        text.replace_range(start..end, new);
    }

    /// Asks something about a place.
    fn question(&mut self, text: &str, choices: &mut Choices<'_>) {
        const METHODS: [&str; 10] = [
            "hover",
            "completion",
            "definition",
            "references",
            "signatureHelp",
            "prepareRename",
            "rename",
            "codeAction",
            "inlayHint",
            "formatting",
        ];
        let method = choices.of(&METHODS);
        let at = position(text, boundary(text, choices.below(text.len() + 1)));
        let all = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 9999, "character": 0 } });
        let params = json!({
            "textDocument": { "uri": URI }, "position": at, "range": all, "newName": choices.of(&["#150", "N77", "#5", ""]),
            "context": { "diagnostics": [], "includeDeclaration": true }, "options": { "tabSize": 2, "insertSpaces": true },
        });
        self.ask(&format!("textDocument/{method}"), params);
    }

    /// Returns everything that the server says about the document alone.
    fn state(&mut self) -> Vec<(String, Value)> {
        let mut state = Vec::new();
        for method in ["documentSymbol", "semanticTokens/full", "foldingRange", "documentLink", "codeLens"] {
            let method = format!("textDocument/{method}");
            let answer = self.ask(&method, json!({ "textDocument": { "uri": URI } }));
            state.push((method, answer));
        }
        state
    }

    /// Returns the diagnostics of the current version.
    fn diagnostics(&self) -> Value {
        let version = json!(self.version);
        let message = self.await_message("diagnostics", |message| match message {
            Message::Notification(message) => {
                message.method == "textDocument/publishDiagnostics" && message.params["version"] == version
            }
            _ => false,
        });
        let Message::Notification(message) = message else { unreachable!() };
        message.params["diagnostics"].clone()
    }

    fn close(mut self) {
        assert_eq!(self.ask("shutdown", Value::Null)["error"], Value::Null);
        self.notify("exit", Value::Null);
    }
}

/// Returns the largest boundary of characters up to an offset.
fn boundary(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len())).rfind(|at| text.is_char_boundary(*at)).unwrap_or_default()
}

/// Returns the position of an offset: lines end with CR, LF or both.
fn position(text: &str, offset: usize) -> Value {
    let before = text[..offset].replace("\r\n", "\n").replace('\r', "\n");
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    json!({ "line": before.matches('\n').count(), "character": before.len() - start })
}

/// Random edits and requests leave the language server in the state of a fresh start on the text that they leave.
pub fn language_server(input: &[u8]) {
    let (mut text, mut choices) = Choices::split(input);
    let mut editor = Editor::open(&text);
    for _ in 0..STEPS {
        match choices.below(3) {
            0 => editor.question(&text, &mut choices),
            _ => editor.edit(&mut text, &mut choices),
        }
    }
    // The last edit is one whose diagnostics no answer above has passed over.
    editor.edit(&mut text, &mut choices);
    let edited = (editor.diagnostics(), editor.state());
    editor.close();
    let mut fresh = Editor::open(&text);
    let expected = (fresh.diagnostics(), fresh.state());
    fresh.close();
    assert_eq!(edited, expected, "edited, and opened: {text:?}");
}

/// Host of a debugger with one program.
struct OneProgram(String);

impl Host for OneProgram {
    fn launch(&mut self, arguments: &LaunchArguments) -> Result<LaunchedProgram, String> {
        let request = RunRequest::new(&arguments.program, self.0.as_bytes(), Machine::default());
        Ok(LaunchedProgram { request, library: Box::new(NoLibrary), reference: None })
    }

    fn program_text(&mut self, _: &str) -> Result<Bytes, String> {
        Ok(self.0.as_bytes().into())
    }

    fn absolute(&self, path: &str) -> String {
        format!("/nc/{path}")
    }

    fn canonical(&self) -> Rc<dyn Fn(&str) -> String> {
        Rc::new(str::to_owned)
    }
}

/// Client of a debugger.
struct Debugger {
    adapter: Adapter<OneProgram>,
    sequence: i64,
}

/// Slices of a run before it is paused.
const SLICES: usize = 40;

impl Debugger {
    /// Launches a program and stops before its first block.
    fn launch(text: &str) -> Self {
        let mut debugger = Self { adapter: Adapter::new(OneProgram(text.to_owned())), sequence: 0 };
        debugger.ask("initialize", json!({ "adapterID": "gcode-sim" }));
        debugger.ask("launch", json!({ "program": "O1.nc", "stopOnEntry": true }));
        debugger.ask("configurationDone", json!({}));
        debugger
    }

    /// Sends a request, lets the run go on for a while, pauses it, and returns all messages without their numbers.
    fn ask(&mut self, command: &str, arguments: Value) -> Vec<Value> {
        self.send(command, arguments);
        for _ in 0..SLICES {
            if !self.adapter.is_running() {
                break;
            }
            self.adapter.work();
        }
        if self.adapter.is_running() {
            self.send("pause", json!({ "threadId": 1 }));
            assert!(!self.adapter.is_running(), "{command}: the run goes on after its pause");
        }
        let messages = self.adapter.take_messages();
        let mut messages: Vec<Value> =
            messages.iter().map(|text| serde_json::from_str(text).unwrap()).collect();
        let has_answer = messages.iter().any(|message| message["request_seq"] == self.sequence);
        assert!(has_answer, "{command} is not answered: {messages:?}");
        for message in &mut messages {
            message["seq"] = Value::Null;
            message["request_seq"] = Value::Null;
        }
        messages
    }

    fn send(&mut self, command: &str, arguments: Value) {
        self.sequence += 1;
        let request =
            json!({ "seq": self.sequence, "type": "request", "command": command, "arguments": arguments });
        self.adapter.receive(request.to_string().as_bytes());
    }

    fn step(&mut self, choices: &mut Choices<'_>) {
        const MOVES: [&str; 8] =
            ["next", "stepIn", "stepIn", "stepOut", "stepBack", "stepBack", "continue", "reverseContinue"];
        let line = choices.below(12);
        match choices.below(16) {
            0 => {
                let condition = choices.of(&["", "#1 GT 1", "#1", "[", "#0 EQ #0"]);
                let hits = choices.of(&["", "2", ">= 2", "% 2", "x"]);
                let one = json!({ "line": line, "condition": condition, "hitCondition": hits });
                self.ask("setBreakpoints", json!({ "source": { "path": "O1.nc" }, "breakpoints": [one] }));
            }
            1 => {
                let name = choices.of(&["O1", "O2", "O1 N10", "N10", "", "P1 2 3"]);
                self.ask("setFunctionBreakpoints", json!({ "breakpoints": [{ "name": name }] }));
            }
            2 => {
                let id = choices.of(&["#100", "#1@0", "#5041", "#x", ""]);
                let access = choices.of(&["read", "write", "readWrite", "no"]);
                self.ask(
                    "setDataBreakpoints",
                    json!({ "breakpoints": [{ "dataId": id, "accessType": access }] }),
                );
            }
            3 => {
                let expression = choices.of(&["#1*2", "SIN[30.]", "#[", "1/0", "#5041", "#1 GT", ""]);
                self.ask("evaluate", json!({ "expression": expression, "context": "watch" }));
            }
            4 => {
                self.ask("stackTrace", json!({ "threadId": 1 }));
                self.ask("scopes", json!({ "frameId": line }));
                self.ask("variables", json!({ "variablesReference": line }));
            }
            5 => {
                let filters = json!([choices.of(&["alarm", "PS", "vacant", "none"])]);
                self.ask("setExceptionBreakpoints", json!({ "filters": filters }));
            }
            6 => {
                let id = [0, 1, i64::MIN, i64::MAX][choices.below(4)];
                self.ask("gotoTargets", json!({ "source": { "path": "O1.nc" }, "line": id }));
                self.ask("goto", json!({ "threadId": 1, "targetId": id }));
            }
            _ => {
                let command = choices.of(&MOVES);
                self.ask(command, json!({ "threadId": 1 }));
            }
        }
    }

    /// Removes all breakpoints.
    fn clear(&mut self) {
        self.ask("setBreakpoints", json!({ "source": { "path": "O1.nc" }, "breakpoints": [] }));
        self.ask("setFunctionBreakpoints", json!({ "breakpoints": [] }));
        self.ask("setDataBreakpoints", json!({ "breakpoints": [] }));
        self.ask("setExceptionBreakpoints", json!({ "filters": [] }));
    }

    /// Returns what the run has at its place, and what it does from there to its end.
    fn rest(&mut self) -> Vec<Vec<Value>> {
        let mut rest = vec![self.ask("stackTrace", json!({ "threadId": 1 }))];
        for name in ["#1", "#2", "#100", "#500", "#4001", "#5041"] {
            rest.push(self.ask("evaluate", json!({ "expression": name, "context": "watch" })));
        }
        rest.push(self.ask("continue", json!({ "threadId": 1 })));
        rest
    }
}

/// Random requests leave the debugger able to start again: the restarted run is that of a fresh session.
pub fn debugger(input: &[u8]) {
    let (text, mut choices) = Choices::split(input);
    let mut debugger = Debugger::launch(&text);
    for _ in 0..STEPS {
        debugger.step(&mut choices);
    }
    debugger.clear();
    debugger.ask("restart", json!({}));
    let mut fresh = Debugger::launch(&text);
    // The client names the file here too: the debugger answers with its name for it.
    fresh.clear();
    assert_eq!(debugger.rest(), fresh.rest(), "restarted, and launched: {text:?}");
}
