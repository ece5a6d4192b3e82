//! Neovim without a window as a client of the language server, with the configuration of docs/editors.md.
use std::path::Path;
use std::process::Command;

use gcode_tests::{programs, workspace};
use serde_json::{Value, json};

/// The jump of line 4 has no target; #100 stands in lines 3, 5 and 5.
const PROGRAM: &str = "O0001\nG0 X1.5\n#100=1.\nGOTO 90\n#100=#100+1.\nM30\n";

/// Waits for the diagnostics, renames #100, and writes what came to a file.
const SESSION: &str = r##"
local ok = vim.wait(20000, function() return #vim.diagnostic.get(0) > 0 end, 50)
local found = {}
for _, one in ipairs(vim.diagnostic.get(0)) do
  table.insert(found, { line = one.lnum, code = one.code, source = one.source })
end
local at = { textDocument = vim.lsp.util.make_text_document_params(), position = { line = 2, character = 1 } }
local function ask(method, more)
  local answers = vim.lsp.buf_request_sync(0, method, vim.tbl_extend("force", at, more or {}), 20000)
  for _, answer in pairs(answers or {}) do
    if answer.result then return answer.result end
  end
end
local hover, rename = ask("textDocument/hover"), ask("textDocument/rename", { newName = "#150" })
for _, client in pairs(vim.lsp.get_active_clients()) do
  if rename then vim.lsp.util.apply_workspace_edit(rename, client.offset_encoding) end
end
local lines = vim.api.nvim_buf_get_lines(0, 0, -1, false)
local answer = { ok = ok, found = found, hover = hover, lines = lines }
vim.fn.writefile({ vim.fn.json_encode(answer) }, vim.env.ANSWER)
vim.lsp.stop_client(vim.lsp.get_active_clients())
vim.wait(5000, function() return #vim.lsp.get_active_clients() == 0 end, 20)
vim.cmd("qa!")
"##;

/// Returns the Lua code of the section on Neovim.
fn configuration() -> String {
    let page = std::fs::read_to_string(workspace().join("docs/editors.md")).unwrap();
    let section = page.split("\n## Neovim\n").nth(1).unwrap();
    let code = section.split("```lua\n").nth(1).unwrap();
    code.split("```").next().unwrap().to_owned()
}

#[test]
fn neovim_shows_a_finding_and_renames_a_variable() {
    if Command::new("nvim").arg("--version").output().is_err() {
        eprintln!("skipped: nvim is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let program = file("O0001.nc", PROGRAM);
    let init = file("init.lua", &configuration());
    let session = file("session.lua", SESSION);
    let answer = folder.path().join("answer.json");
    let server = programs::program("gcode-sim");
    let server = Path::new(server.get_program()).parent().unwrap();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(server.to_owned()).chain(std::env::split_paths(&path));
    let ended = Command::new("nvim")
        .args(["--headless", "-n", "-i", "NONE", "-u"])
        .arg(init)
        .arg(&program)
        .arg("-c")
        .arg(format!("luafile {}", session.display()))
        .env("PATH", std::env::join_paths(paths).unwrap())
        .env("HOME", folder.path())
        .env("ANSWER", &answer)
        .output()
        .unwrap();
    let told = || String::from_utf8_lossy(&ended.stderr).into_owned();
    let answer = std::fs::read_to_string(&answer).unwrap_or_else(|error| panic!("{error}: {}", told()));
    let answer: Value = serde_json::from_str(&answer).unwrap();
    let missing = json!({ "line": 3, "code": "missing-n", "source": "gcode-sim" });
    assert!(answer["found"].as_array().unwrap().contains(&missing), "{answer}");
    assert!(answer["hover"].to_string().contains("#100"), "{answer}");
    let lines = json!(["O0001", "G0 X1.5", "#150=1.", "GOTO 90", "#150=#150+1.", "M30"]);
    assert_eq!(answer["lines"], lines);
}
