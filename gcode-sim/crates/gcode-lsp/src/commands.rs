//! Commands of the lenses above a program: run, verify, prove, show, debug; renumber, and the edits of code actions.
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use gcode_control::Progress;
use gcode_ide::{FileId, ProgramKey};
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_lang::syntax::ast::ProgramPath;
use gcode_part::job::control_file;
use gcode_session::Request;
use gcode_session::files::{FileAccess, ProjectPaths};
use lsp_types::{
    CodeLens, CodeLensParams, Command, ExecuteCommandParams, MessageType, TextDocumentIdentifier, Uri,
    WorkspaceEdit,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::code_actions::NUMBERING;
use crate::document_uri;
use crate::edits::{renumber_edits, workspace_edit};
use crate::failure::Failure;
use crate::offered_edit::{self, APPLY};
use crate::program_setup::ProgramSetup;
use crate::snapshot::Snapshot;

/// Setting with the family of controls.
const DIALECT: &str = "DIALECT";

/// Claim of a proof without claims.
const NO_ALARM: &str = "no-alarm";

const RUN: &str = "gcode-sim.run";
const VERIFY: &str = "gcode-sim.verify";
const PROVE: &str = "gcode-sim.prove";
const SHOW: &str = "gcode-sim.show";
const PAGE: &str = "gcode-sim.page";
const DEBUG: &str = "gcode-sim.debug";
const RENUMBER: &str = "gcode-sim.renumber";

/// All commands, as the server announces them.
pub(crate) const ALL: [&str; 8] = [RUN, VERIFY, PROVE, SHOW, PAGE, DEBUG, RENUMBER, APPLY];

/// Argument of each command but [`APPLY`]: a program of a document.
#[derive(Debug, Serialize, Deserialize)]
struct Target {
    uri: Uri,
    /// `O1234`; the main program of the document without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    program: Option<String>,
    /// Text to run instead of the document's: the arguments of a call are tried without an edit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    text: Option<String>,
    /// Ranges of variables of a proof, `#1=0.1..9.9`; without them the program is proved as it starts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    ranges: Vec<String>,
    /// Claims of a proof; without them that no alarm is raised.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    claims: Vec<String>,
}

impl Target {
    fn new(uri: Uri, program: Option<String>) -> Self {
        Self { uri, program, text: None, ranges: Vec::new(), claims: Vec::new() }
    }
}

/// Result of a command, and what the client is told beside it.
#[derive(Debug)]
pub(crate) struct CommandResult {
    pub value: Value,
    pub message: Option<(MessageType, String)>,
    /// Page to open.
    pub shown: Option<Uri>,
    pub applied: Option<(String, WorkspaceEdit)>,
}

impl CommandResult {
    fn new(value: Value) -> Self {
        Self { value, message: None, shown: None, applied: None }
    }
}

/// Returns the lenses of a file: above each program its commands.
pub(crate) fn code_lenses(
    snapshot: &Snapshot,
    params: CodeLensParams,
) -> Result<Option<Vec<CodeLens>>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let text = snapshot.text_of(file)?;
    let mut lenses = Vec::new();
    for (key, outline) in snapshot.project.programs().filter(|(key, _)| key.file == file) {
        let range = text.range(outline.name_range.start, outline.name_range.end);
        let is_named = !outline.name_range.is_empty();
        let label = snapshot.project.label(key);
        let target = Target::new(params.text_document.uri.clone(), is_named.then_some(label));
        let commands = [("Run", RUN), ("Verify", VERIFY), ("Prove", PROVE), ("Show", SHOW), ("Debug", DEBUG)];
        for (title, command) in commands {
            let arguments = Some(vec![json!(target)]);
            let command = Command { title: title.to_owned(), command: command.to_owned(), arguments };
            lenses.push(CodeLens { range, command: Some(command), data: None });
        }
    }
    Ok(Some(lenses))
}

/// Executes a command.
pub(crate) fn execute(
    snapshot: &Snapshot,
    params: ExecuteCommandParams,
    progress: &Arc<Progress>,
) -> Result<CommandResult, Failure> {
    let name = params.command.as_str();
    if !ALL.contains(&name) {
        return Err(Failure::params(format!("unknown command {name}; there are {}", ALL.join(", "))));
    }
    if name == APPLY {
        let applied = Some(offered_edit::of_command(snapshot, &params)?);
        return Ok(CommandResult { applied, ..CommandResult::new(Value::Null) });
    }
    let target = target(&params)?;
    let file = snapshot.file(&TextDocumentIdentifier { uri: target.uri.clone() })?;
    let setup = snapshot.setup(file);
    let mut request = request(snapshot, &setup, file, &target)?;
    request.progress = Some(Arc::clone(progress));
    match name {
        RUN => run(snapshot, &setup, &request),
        VERIFY => verify(snapshot, &setup, &request),
        PROVE => prove(snapshot, &setup, &request, &target),
        SHOW => show(snapshot, &setup, &request),
        PAGE => page(snapshot, &setup, &request),
        DEBUG => Ok(CommandResult::new(launch(snapshot, &setup, &target))),
        _ => renumber(snapshot, file, &target, progress),
    }
}

/// Reads the argument: a URI, or an object with `uri` and `program`.
fn target(params: &ExecuteCommandParams) -> Result<Target, Failure> {
    let usage = || format!("{}: give {{\"uri\": …, \"program\": \"O1234\"}} or a URI", params.command);
    let argument = params.arguments.first().ok_or_else(|| Failure::params(usage()))?;
    let target = match argument {
        Value::String(_) => Uri::deserialize(argument).map(|uri| {
            let program = params.arguments.get(1).and_then(Value::as_str).map(str::to_owned);
            Target::new(uri, program)
        }),
        _ => Target::deserialize(argument),
    };
    target.map_err(|error| Failure::params(format!("{}: {error}", usage())))
}

fn request(
    snapshot: &Snapshot,
    setup: &ProgramSetup,
    file: FileId,
    target: &Target,
) -> Result<Request, Failure> {
    if let Some(fault) = setup.faults.first() {
        return Err(Failure::refused(fault.clone()));
    }
    let text = match &target.text {
        Some(text) => Bytes::from(text.clone().into_bytes()),
        None => snapshot.text_of(file)?.bytes().clone(),
    };
    let mut request = setup.request(text);
    if let Some(name) = &target.program {
        let path = ProgramPath::parse(name);
        request.main =
            Some(path.ok_or_else(|| Failure::params(format!("'{name}' is not a program: O1234")))?);
    }
    Ok(request)
}

fn run(snapshot: &Snapshot, setup: &ProgramSetup, request: &Request) -> Result<CommandResult, Failure> {
    let mut library = setup.library(&snapshot.files);
    let report = snapshot.files.host().run_report(request, &mut library).map_err(Failure::refused)?;
    let (kind, text) = match report.get("alarm").filter(|alarm| !alarm.is_null()) {
        Some(alarm) => {
            let part = |key: &str| alarm.get(key).map(plain).unwrap_or_default();
            let place = format!("{} in line {} of {}", part("code"), part("line"), part("program"));
            (MessageType::ERROR, format!("alarm {place}: {}", part("message")))
        }
        None => {
            let part = |key: &str| report.get(key).map(plain).unwrap_or_default();
            let seconds = report.get("seconds").and_then(Value::as_f64).unwrap_or_default();
            let counts = [("block", "blocks"), ("move", "moves")].map(|(one, many)| {
                let count = part(many);
                format!("{count} {}", if count == "1" { one } else { many })
            });
            let counts = format!("{}, {seconds:.1} s", counts.join(", "));
            match part("outcome").as_str() {
                "limit" => (MessageType::WARNING, format!("a limit ended the run: {counts}")),
                outcome => (MessageType::INFO, format!("{outcome}: {counts}")),
            }
        }
    };
    Ok(CommandResult { message: Some((kind, text)), ..CommandResult::new(report) })
}

/// Returns a value of a report as text.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn verify(snapshot: &Snapshot, setup: &ProgramSetup, request: &Request) -> Result<CommandResult, Failure> {
    let mut library = setup.library(&snapshot.files);
    let reference = setup.paths.reference.as_deref();
    let report = snapshot.files.host().verdict_report(request, &mut library, reference);
    let Some(report) = report.map_err(Failure::refused)? else {
        let text = "no reference: name the program in [references] of gcode.toml, or put job.toml or reference.csv beside it; \
                    for a program without holes state [stock] in the machine file";
        let value = json!({ "verdict": null, "message": text });
        return Ok(CommandResult {
            message: Some((MessageType::WARNING, text.to_owned())),
            ..CommandResult::new(value)
        });
    };
    let part = |key: &str| report.get(key).map(plain).unwrap_or_default();
    let is_pass = part("verdict") == "pass";
    let kind = if is_pass { MessageType::INFO } else { MessageType::ERROR };
    let text = format!("{}: {}", part("verdict").to_uppercase(), part("summary"));
    Ok(CommandResult { message: Some((kind, text)), ..CommandResult::new(report) })
}

/// Proves the claims of the argument, for the ranges of the argument.
fn prove(
    snapshot: &Snapshot,
    setup: &ProgramSetup,
    request: &Request,
    target: &Target,
) -> Result<CommandResult, Failure> {
    let claims = if target.claims.is_empty() { vec![NO_ALARM.to_owned()] } else { target.claims.clone() };
    let libraries = || -> Box<dyn Library> { Box::new(setup.library(&snapshot.files)) };
    let host = snapshot.files.host();
    let report =
        host.proof_report(request, &libraries, (&target.ranges, &claims)).map_err(Failure::refused)?;
    let verdict = report.get("verdict").map(plain).unwrap_or_default();
    let kind = if verdict == "proved" { MessageType::INFO } else { MessageType::WARNING };
    let ranges = match target.ranges.is_empty() {
        true => "from the start of the program".to_owned(),
        false => format!("for {}", target.ranges.join(", ")),
    };
    let text = format!("{verdict} {ranges}: {}", claims.join(", "));
    Ok(CommandResult { message: Some((kind, text)), ..CommandResult::new(report) })
}

fn show(snapshot: &Snapshot, setup: &ProgramSetup, request: &Request) -> Result<CommandResult, Failure> {
    let mut library = setup.library(&snapshot.files);
    let reference = setup.paths.reference.as_deref();
    let page: PathBuf =
        snapshot.files.host().write_page(request, &mut library, reference).map_err(Failure::refused)?;
    let uri = document_uri::of_path(&page);
    let value = json!({ "path": page, "uri": uri });
    let message = (!snapshot.client.has_show_document)
        .then(|| (MessageType::INFO, format!("page: {}", page.display())));
    Ok(CommandResult { shown: uri, message, ..CommandResult::new(value) })
}

/// Returns the page of a program as HTML, for a panel beside the text.
fn page(snapshot: &Snapshot, setup: &ProgramSetup, request: &Request) -> Result<CommandResult, Failure> {
    let mut library = setup.library(&snapshot.files);
    let reference = setup.paths.reference.as_deref();
    let html = snapshot.files.host().page(request, &mut library, reference).map_err(Failure::refused)?;
    Ok(CommandResult::new(json!({ "html": html })))
}

/// Returns a launch configuration for `gcode-sim dap`.
fn launch(snapshot: &Snapshot, setup: &ProgramSetup, target: &Target) -> Value {
    let mut launch = json!({
        "type": "gcode-sim",
        "request": "launch",
        "name": target.program.as_ref().map_or_else(|| "Debug".to_owned(), |program| format!("Debug {program}")),
        "program": setup.path,
        "library": setup.paths.libraries,
        "stopOnEntry": true,
    });
    let ProjectPaths { machine, control, dialect, reference, .. } = &setup.paths;
    let paths = [("machine", machine), ("reference", reference)];
    for (key, path) in paths.into_iter().filter_map(|(key, path)| Some((key, path.as_ref()?))) {
        launch[key] = json!(path);
    }
    let text = control.as_ref().and_then(|path| snapshot.files.text(path).ok());
    let entries = text.and_then(|text| control_file::entries(&text).ok()).unwrap_or_default();
    let dialect = dialect.iter().map(|name| (DIALECT.to_owned(), name.clone()));
    let settings: BTreeMap<_, _> = entries.into_iter().chain(dialect).collect();
    if !settings.is_empty() {
        launch["control"] = json!(settings);
    }
    launch
}

fn renumber(
    snapshot: &Snapshot,
    file: FileId,
    target: &Target,
    progress: &Arc<Progress>,
) -> Result<CommandResult, Failure> {
    let mut programs = snapshot.project.programs().map(|(key, _)| key).filter(|key| key.file == file);
    let is_target =
        |key: &ProgramKey| target.program.as_ref().is_none_or(|name| *name == snapshot.project.label(*key));
    let program =
        programs.find(is_target).ok_or_else(|| Failure::params("the document has no such program"))?;
    let edits = renumber_edits(snapshot, program, NUMBERING, progress).map_err(Failure::refused)?;
    let edit = workspace_edit(snapshot, edits)?;
    let applied = snapshot.client.has_apply_edit.then(|| ("Renumber".to_owned(), edit.clone()));
    Ok(CommandResult { applied, ..CommandResult::new(json!(edit)) })
}
