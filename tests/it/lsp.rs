//! The language server as a process: standard input and output, exit codes, and messages out of order.
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use gcode_tests::programs;
use serde_json::{Value, json};

/// A client of the program.
struct Client {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Client {
    fn start() -> Self {
        let mut command = programs::program("gcode-sim");
        let mut child = command.arg("lsp").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (input, output) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        Self { child, input, output }
    }

    fn send_text(&mut self, body: &str) {
        write!(self.input, "Content-Length: {}\r\n\r\n{body}", body.len()).unwrap();
        self.input.flush().unwrap();
    }

    fn send(&mut self, mut message: Value) {
        message["jsonrpc"] = "2.0".into();
        self.send_text(&message.to_string());
    }

    /// Reads the next message; nothing but messages is on the output.
    fn receive(&mut self) -> Value {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        let length: usize = line.strip_prefix("Content-Length: ").unwrap().trim().parse().unwrap();
        line.clear();
        self.output.read_line(&mut line).unwrap();
        assert_eq!(line, "\r\n");
        let mut body = vec![0; length];
        self.output.read_exact(&mut body).unwrap();
        let message: Value = serde_json::from_slice(&body).unwrap();
        assert_eq!(message["jsonrpc"], "2.0");
        message
    }

    /// Returns the answer to a request.
    fn ask(&mut self, id: u32, method: &str, params: Value) -> Value {
        self.send(json!({ "id": id, "method": method, "params": params }));
        loop {
            let message = self.receive();
            if message["id"] == id && message.get("method").is_none() {
                return message;
            }
        }
    }

    fn initialize(&mut self) {
        let answer =
            self.ask(0, "initialize", json!({ "processId": null, "rootUri": null, "capabilities": {} }));
        assert_eq!(answer["result"]["serverInfo"]["name"], "gcode-sim");
        self.send(json!({ "method": "initialized", "params": {} }));
    }

    /// Returns the exit code; the output has no further byte.
    fn end(mut self) -> Option<i32> {
        let mut rest = Vec::new();
        self.output.read_to_end(&mut rest).unwrap();
        assert_eq!(String::from_utf8(rest).unwrap(), "");
        self.child.wait().unwrap().code()
    }
}

#[test]
fn shutdown_and_exit_end_the_server_with_0_exit_alone_with_1() {
    let mut client = Client::start();
    client.initialize();
    assert_eq!(client.ask(1, "shutdown", Value::Null)["result"], Value::Null);
    client.send(json!({ "method": "exit" }));
    assert_eq!(client.end(), Some(0));
    let mut client = Client::start();
    client.initialize();
    client.send(json!({ "method": "exit" }));
    assert_eq!(client.end(), Some(1));
    let mut client = Client::start();
    client.send(json!({ "method": "exit" }));
    assert_eq!(client.end(), Some(1));
    // A client that goes without a word.
    let Client { mut child, input, .. } = Client::start();
    drop(input);
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

/// An editor that dies without closing its end of the server's input. The other servers are given the id of a process that
/// goes on, and one that none has had.
#[cfg(unix)]
#[test]
fn the_server_ends_when_the_process_of_its_editor_is_gone() {
    let mut editor = Client::start();
    let started_by = |process: u32| {
        let mut client = Client::start();
        let params = json!({ "processId": process, "rootUri": null, "capabilities": {} });
        assert_eq!(client.ask(0, "initialize", params)["error"], Value::Null);
        client
    };
    let of_editor = started_by(editor.child.id());
    // Greater than the largest id of Linux and of macOS.
    let others = [started_by(std::process::id()), started_by(2_000_000_000)];
    editor.child.kill().unwrap();
    editor.child.wait().unwrap();
    let Client { mut child, input, .. } = of_editor;
    assert_eq!(child.wait().unwrap().code(), Some(1));
    drop(input);
    for mut client in others {
        assert_eq!(client.ask(1, "shutdown", Value::Null)["result"], Value::Null);
        client.send(json!({ "method": "exit" }));
        assert_eq!(client.end(), Some(0));
    }
}

/// An editor reads the comment of the macro, two characters in GBK, as two columns, and the server as four bytes.
#[test]
fn a_rename_that_edits_a_closed_file_in_another_encoding_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [main, called] = ["O0001.nc", "O9001.nc"].map(|name| folder.path().join(name));
    let text = "O0001\n#500=5.\nG65 P9001 A1.\nM30\n";
    std::fs::write(&main, text).unwrap();
    let comment = b"O9001\n(\xbf\xd7\xc9\xee) #500=#500+1.\nM99\n";
    let uri = format!("file://{}", main.display());
    let rename = |bytes: &[u8]| {
        std::fs::write(&called, bytes).unwrap();
        let mut client = Client::start();
        let root = format!("file://{}", folder.path().display());
        client.ask(0, "initialize", json!({ "processId": null, "rootUri": root, "capabilities": {} }));
        client.send(json!({ "method": "initialized", "params": {} }));
        let document = json!({ "uri": uri, "languageId": "nc", "version": 1, "text": text });
        client.send(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
        let place = json!({ "line": 1, "character": 1 });
        let params = json!({ "textDocument": { "uri": uri }, "position": place, "newName": "#510" });
        let answer = client.ask(1, "textDocument/rename", params);
        client.ask(2, "shutdown", Value::Null);
        client.send(json!({ "method": "exit" }));
        answer
    };
    let refused = rename(comment);
    assert!(refused["error"]["message"].as_str().unwrap().contains("O9001.nc is not in UTF-8"), "{refused}");
    let renamed = rename("O9001\n(孔深) #500=#500+1.\nM99\n".as_bytes());
    let edits = renamed["result"]["changes"].as_object().unwrap();
    let starts = edits.iter().find(|(uri, _)| uri.ends_with("O9001.nc")).unwrap().1.as_array().unwrap();
    assert_eq!(starts[0]["range"]["start"], json!({ "line": 1, "character": 6 }), "{renamed}");
}

#[test]
fn requests_at_the_wrong_time_are_refused_and_the_server_goes_on() {
    let mut client = Client::start();
    assert_eq!(client.ask(1, "textDocument/hover", json!({}))["error"]["code"], -32002);
    // Malformed parameters do not initialize.
    assert_eq!(client.ask(2, "initialize", json!({ "capabilities": 5 }))["error"]["code"], -32602);
    assert_eq!(client.ask(3, "shutdown", Value::Null)["error"]["code"], -32002);
    client.initialize();
    client.send_text("{\"jsonrpc\":");
    assert_eq!(client.receive()["error"]["code"], -32700);
    client.send_text("[1]");
    assert_eq!(client.receive()["error"]["code"], -32600);
    assert_eq!(client.ask(4, "shutdown", Value::Null)["result"], Value::Null);
    assert_eq!(client.ask(5, "textDocument/hover", json!({}))["error"]["code"], -32600);
    assert_eq!(client.ask(6, "shutdown", Value::Null)["error"]["code"], -32600);
    client.send(json!({ "method": "exit" }));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_cancelled_request_is_answered_once() {
    let mut client = Client::start();
    client.initialize();
    // A run of a million blocks, longer than the way of the next message.
    let text = "O1\n#1=0\nWHILE[#1LT900000]DO1\n#1=#1+1\nEND1\nM30\n";
    let document = json!({ "uri": "untitled:O1", "languageId": "nc", "version": 1, "text": text });
    client.send(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
    let arguments = json!({ "command": "gcode-sim.run", "arguments": ["untitled:O1"] });
    client.send(json!({ "id": 1, "method": "workspace/executeCommand", "params": arguments }));
    client.send(json!({ "method": "$/cancelRequest", "params": { "id": 1 } }));
    let mut answers = Vec::new();
    client.send(json!({ "id": 2, "method": "textDocument/foldingRange", "params": { "textDocument": { "uri": "untitled:O1" } } }));
    // The findings come from another thread, before the folds or behind them.
    let (mut has_findings, mut has_folds) = (false, false);
    while !has_findings || !has_folds {
        let message = client.receive();
        if message["id"] == 1 {
            answers.push(message["error"]["code"].clone());
        }
        has_findings |= message["method"] == "textDocument/publishDiagnostics";
        has_folds |= message["id"] == 2;
    }
    assert_eq!(answers, [-32800]);
    client.ask(3, "shutdown", Value::Null);
    client.send(json!({ "method": "exit" }));
    assert_eq!(client.end(), Some(0));
}

/// A program of more than 100,000 blocks is checked in pieces. As a whole, these take 130 MB and more, in pieces half of the limit.
#[cfg(target_os = "linux")]
#[test]
fn long_programs_with_unreadable_lines_and_missing_macros_are_opened_in_little_memory() {
    const LINES: usize = 110_000;
    const MAX_MEGABYTES: u64 = 110;
    let mixed: fn(usize) -> String = |line| {
        let kinds = ["G1 X2.5", "#100=3.", "M08", "G65 P100 X1. Z-2.", "(TEXT)"];
        format!("N{line} {}\n", kinds[line % kinds.len()])
    };
    let unreadable: fn(usize) -> String = |line| format!("N{line} G0 X1..5\n");
    for (name, line, findings) in [("unreadable", unreadable, 1001), ("mixed", mixed, 1)] {
        let text = format!("O1\nG21 G90 F100.\n{}M30\n", (1..=LINES).map(line).collect::<String>());
        let mut client = Client::start();
        client.initialize();
        let document = json!({ "uri": "untitled:O1", "languageId": "nc", "version": 1, "text": text });
        client.send(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
        let published = loop {
            let message = client.receive();
            if message["method"] == "textDocument/publishDiagnostics" {
                break message;
            }
        };
        assert_eq!(published["params"]["diagnostics"].as_array().unwrap().len(), findings, "{name}");
        let status = std::fs::read_to_string(format!("/proc/{}/status", client.child.id())).unwrap();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        let megabytes = peak.trim().trim_end_matches(" kB").parse::<u64>().unwrap() / 1000;
        client.ask(1, "shutdown", Value::Null);
        client.send(json!({ "method": "exit" }));
        assert_eq!(client.end(), Some(0));
        assert!(megabytes < MAX_MEGABYTES, "{name}: {megabytes} MB");
    }
}

/// Returns what the extension for VS Code contributes.
fn extension() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../editors/vscode/package.json");
    let manifest: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    manifest["contributes"].clone()
}

/// An editor colours only tokens whose type it knows: those of the protocol, and those of its manifest.
#[test]
fn the_extension_knows_each_own_token_type_of_the_server() {
    const OF_PROTOCOL: [&str; 6] = ["comment", "number", "string", "keyword", "operator", "function"];
    let mut client = Client::start();
    let capabilities = json!({ "textDocument": { "semanticTokens": { "requests": { "full": true },
        "tokenTypes": [], "tokenModifiers": [], "formats": ["relative"] } } });
    let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
    let answer = client.ask(0, "initialize", params);
    let legend = &answer["result"]["capabilities"]["semanticTokensProvider"]["legend"]["tokenTypes"];
    let legend: BTreeSet<_> = legend.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let own: BTreeSet<_> = legend.into_iter().filter(|name| !OF_PROTOCOL.contains(name)).collect();
    let contributes = extension();
    let types = contributes["semanticTokenTypes"].as_array().unwrap().iter();
    assert_eq!(types.map(|one| one["id"].as_str().unwrap()).collect::<BTreeSet<_>>(), own);
    let scopes = contributes["semanticTokenScopes"][0]["scopes"].as_object().unwrap();
    assert_eq!(scopes.keys().map(String::as_str).collect::<BTreeSet<_>>(), own);
}

#[test]
fn the_extension_has_a_schema_of_each_setting_of_the_server() {
    let contributes = extension();
    let properties = &contributes["configuration"]["properties"];
    let documented = include_str!("../../docs/editors.md").split("## Settings").nth(1).unwrap();
    let rows = documented.split("\n## ").next().unwrap().lines().filter_map(|line| line.strip_prefix("| `"));
    let keys: Vec<_> = rows.filter_map(|row| row.split('`').next()).collect();
    assert_eq!(keys, ["machine", "control", "dialect", "libraries", "reference"]);
    for key in keys {
        let kind = if key == "libraries" { "array" } else { "string" };
        assert_eq!(properties[format!("gcode-sim.{key}")]["type"], kind, "{key}");
    }
}

/// Documents opened without a wait between them: the first one's check may still be under way when the second comes.
#[test]
fn a_caller_opened_with_its_macro_in_one_go_has_the_findings_of_both_texts() {
    let folder = tempfile::tempdir().unwrap();
    let main = "%\nO0300(MAIN)\nG21 G90\nM98 P8310\nM30\n%\n";
    std::fs::write(folder.path().join("O0300.nc"), main).unwrap();
    std::fs::write(folder.path().join("O8310.nc"), "%\nO8310(STEP)\nM99\n%\n").unwrap();
    let uri = |name: &str| format!("file://{}", folder.path().join(name).display());
    let open = |name: &str, text: &str| {
        let document = json!({ "uri": uri(name), "languageId": "nc", "version": 1, "text": text });
        json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } })
    };
    let mut client = Client::start();
    client.initialize();
    client.send(open("O0300.nc", main));
    client.send(open("O8310.nc", "%\nO8311(STEP)\nM99\n%\n"));
    // A request behind each wait marks the end of what was published up to it.
    let (mut last, mut seen) = (Vec::new(), 0);
    while seen < 6 && last != ["missing-program"] {
        client.send(json!({ "id": 100 + seen, "method": "workspace/symbol", "params": { "query": "" } }));
        std::thread::sleep(std::time::Duration::from_millis(500));
        seen += 1;
        loop {
            let message = client.receive();
            if message["method"] == "textDocument/publishDiagnostics"
                && message["params"]["uri"] == uri("O0300.nc").as_str()
            {
                let found = message["params"]["diagnostics"].as_array().unwrap().iter();
                last = found.map(|one| one["code"].as_str().unwrap().to_owned()).collect();
            }
            if message["id"] == 99 + seen {
                break;
            }
        }
    }
    assert_eq!(last, ["missing-program"]);
}

#[test]
fn a_diagnostic_links_the_page_of_its_code_for_a_client_that_follows_links() {
    for is_supported in [true, false] {
        let mut client = Client::start();
        let capabilities =
            json!({ "textDocument": { "publishDiagnostics": { "codeDescriptionSupport": is_supported } } });
        let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
        client.ask(0, "initialize", params);
        client.send(json!({ "method": "initialized", "params": {} }));
        let document = json!({ "uri": "file:///nowhere/O0001.nc", "languageId": "nc", "version": 1,
            "text": "O0001\nGOTO 100\nM30\n" });
        client.send(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
        let finding = loop {
            let message = client.receive();
            if message["method"] == "textDocument/publishDiagnostics" {
                break message["params"]["diagnostics"][0].clone();
            }
        };
        assert_eq!(finding["code"], "missing-n");
        let Some(href) = finding["codeDescription"]["href"].as_str() else {
            assert!(!is_supported, "{finding}");
            continue;
        };
        assert!(is_supported, "{finding}");
        let page = std::fs::read_to_string(href.strip_prefix("file://").unwrap()).unwrap();
        assert!(page.contains("missing-n"), "{page}");
    }
}

#[test]
fn the_name_of_a_rule_that_is_turned_off_links_its_page() {
    let mut client = Client::start();
    client.initialize();
    let uri = "file:///nowhere/O0001.nc";
    let text = "O0001 (CHECK-OFF MISSING-N, NO-SUCH-RULE)\nM30 (NOT MISSING-N)\n";
    let document = json!({ "uri": uri, "languageId": "nc", "version": 1, "text": text });
    client.send(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
    let answer = client.ask(7, "textDocument/documentLink", json!({ "textDocument": { "uri": uri } }));
    let links = answer["result"].as_array().unwrap();
    assert_eq!(links.len(), 1, "{answer}");
    assert_eq!(links[0]["range"]["start"], json!({ "line": 0, "character": 17 }));
    assert_eq!(links[0]["range"]["end"], json!({ "line": 0, "character": 26 }));
    let page = std::fs::read_to_string(links[0]["target"].as_str().unwrap().strip_prefix("file://").unwrap());
    assert!(page.unwrap().contains("missing-n"));
}
