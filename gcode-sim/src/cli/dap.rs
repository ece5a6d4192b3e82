//! `gcode-sim dap`: the Debug Adapter Protocol over standard input and output, and the files that a launch names.
#![expect(clippy::disallowed_methods, reason = "the command line reads standard input and finds files")]

use std::io::{BufWriter, ErrorKind};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use gcode_dap::{Adapter, Host, LaunchArguments, LaunchedProgram};
use gcode_inspect::verify::Tolerances;
use gcode_lang::source::Bytes;
use gcode_part::NominalPart;
use serde_json::Value;

use super::conditions::{ProgramArguments, RunConditions};
use super::message_frames::{FrameError, read_body, write_body};
use super::{ExitStatus, UsageError, input, options, reference_file};

/// Blocks after which the search for bad holes ends.
const MAX_BLOCKS: u64 = 10_000_000;

/// Message of the client, or bytes that are none.
type Incoming = Result<Vec<u8>, FrameError>;

pub(super) fn run() -> Result<ExitStatus, UsageError> {
    let (sender, receiver) = channel();
    let waiting = Arc::new(AtomicUsize::new(0));
    let unread = Arc::clone(&waiting);
    std::thread::spawn(move || read_messages(&sender, &unread));
    serve(&receiver, &waiting)
}

/// Reads standard input to its end, and counts the messages.
fn read_messages(sender: &Sender<Incoming>, waiting: &AtomicUsize) {
    let mut stdin = std::io::stdin().lock();
    while let Ok(Some(message)) = read_body(&mut stdin) {
        waiting.fetch_add(1, Ordering::Relaxed);
        if sender.send(message).is_err() {
            return;
        }
    }
    // The client is gone: nothing is to go on.
    waiting.fetch_add(1, Ordering::Relaxed);
}

/// Handles messages until the client disconnects or is gone; in between the run goes on.
fn serve(receiver: &Receiver<Incoming>, waiting: &Arc<AtomicUsize>) -> Result<ExitStatus, UsageError> {
    let mut adapter = Adapter::new(Files { waiting: Arc::clone(waiting) });
    while !adapter.is_over() {
        let message = if adapter.is_running() {
            match receiver.try_recv() {
                Ok(message) => Some(message),
                Err(TryRecvError::Empty) => None,
                Err(TryRecvError::Disconnected) => break,
            }
        } else {
            match receiver.recv() {
                Ok(message) => Some(message),
                Err(_) => break,
            }
        };
        if message.is_some() {
            waiting.fetch_sub(1, Ordering::Relaxed);
        }
        match message {
            Some(Ok(message)) => adapter.receive(&message),
            Some(Err(reason)) => adapter.refuse(&reason),
            None => adapter.work(),
        }
        if !send(&adapter.take_messages())? {
            break;
        }
    }
    Ok(ExitStatus::Passed)
}

/// Writes messages; returns false if their reader is gone.
fn send(messages: &[String]) -> Result<bool, UsageError> {
    let mut stdout = BufWriter::new(std::io::stdout().lock());
    let written = messages.iter().try_for_each(|message| write_body(&mut stdout, message.as_bytes()));
    match written {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(UsageError::new(format!("standard output cannot be written: {error}"))),
    }
}

/// The files of this computer, and the number of messages that wait.
struct Files {
    waiting: Arc<AtomicUsize>,
}

impl Host for Files {
    fn has_message(&self) -> bool {
        0 < self.waiting.load(Ordering::Relaxed)
    }

    fn launch(&mut self, arguments: &LaunchArguments) -> Result<LaunchedProgram, String> {
        launch(arguments).map_err(|refusal| in_terms_of_launch(&refusal.to_string()))
    }

    fn program_text(&mut self, path: &str) -> Result<Bytes, String> {
        input::program_text(Path::new(path)).map_err(|refusal| refusal.to_string())
    }

    fn absolute(&self, path: &str) -> String {
        std::path::absolute(path).map_or_else(|_| path.to_owned(), |path| path.display().to_string())
    }

    fn canonical(&self) -> Rc<dyn Fn(&str) -> String> {
        Rc::new(|path| {
            let found = Path::new(path).canonicalize().or_else(|_| std::path::absolute(path));
            found.map_or_else(|_| path.to_owned(), |path| path.display().to_string())
        })
    }
}

/// Reads everything that a launch names; what it leaves out comes from the project, as for the other commands.
fn launch(arguments: &LaunchArguments) -> Result<LaunchedProgram, UsageError> {
    if arguments.program == "-" {
        return Err(UsageError::new(
            "launch: 'program' is the path of a file; standard input is the protocol's",
        ));
    }
    let LaunchArguments { machine, main_program, reference, .. } = arguments;
    let texts = [("program", Some(&arguments.program)), ("mainProgram", main_program.as_ref())]
        .into_iter()
        .chain([("machine", machine.as_ref()), ("reference", reference.as_ref())])
        .chain(arguments.library.iter().map(|folder| ("library", Some(folder))));
    if let Some((key, _)) =
        texts.into_iter().find(|(_, text)| text.is_some_and(|text| text.trim().is_empty()))
    {
        return Err(UsageError::new(format!("launch: '{key}' is empty: give it a value or leave it out")));
    }
    if let Some(missing) = arguments.library.iter().find(|folder| !Path::new(folder).is_dir()) {
        return Err(UsageError::new(format!("launch: 'library', {missing}: no such folder")));
    }
    let pairs = |key: &str, values: &std::collections::BTreeMap<String, Value>| {
        let pair = |(name, value): (&String, &Value)| Ok(format!("{name}={}", setting(key, name, value)?));
        values.iter().map(pair).collect::<Result<Vec<_>, UsageError>>()
    };
    let conditions = RunConditions {
        main_program: arguments.main_program.clone(),
        libraries: arguments.library.iter().map(PathBuf::from).collect(),
        machine: arguments.machine.as_ref().map(PathBuf::from),
        control: pairs("control", &arguments.control)?,
        set: pairs("variables", &arguments.variables)?,
        max_blocks: MAX_BLOCKS,
        ..RunConditions::default()
    };
    let program = ProgramArguments { program: PathBuf::from(&arguments.program), conditions };
    let given = arguments.reference.as_deref().map(Path::new);
    let (program, path) = reference_file::completed(&program, given)?;
    let (mut request, mut folders) = options::request(&program)?;
    let is_given = given.is_some();
    let nominal = match path {
        Some(path) => Some(options::read_nominal(&path, &request, &mut folders)?),
        None => None,
    };
    let reference = match nominal {
        Some(NominalPart::Holes(reference)) => {
            request = request.for_reference(&reference);
            let tolerances = Tolerances::of(&reference, None);
            Some((reference, tolerances))
        }
        Some(NominalPart::Flutes(_)) if is_given => {
            return Err(UsageError::new("launch: 'reference' is a burr; the debugger compares holes"));
        }
        Some(NominalPart::Flutes(_)) | None => None,
    };
    Ok(LaunchedProgram { request, library: Box::new(folders), reference })
}

/// Returns a refusal of the command line with the keys of a launch in place of its flags.
fn in_terms_of_launch(refusal: &str) -> String {
    let keys = [
        ("--control", "launch: 'control'"),
        ("--set", "launch: 'variables'"),
        ("--program", "launch: 'mainProgram'"),
    ];
    let flag = keys.iter().find_map(|(flag, key)| Some((refusal.strip_prefix(flag)?, key)));
    flag.map_or_else(|| refusal.to_owned(), |(rest, key)| format!("{key}{rest}"))
}

/// Returns a value of the launch as the command line has it: `true` is 1.
fn setting(key: &str, name: &str, value: &Value) -> Result<String, UsageError> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        Value::Bool(is_on) => Ok(u8::from(*is_on).to_string()),
        Value::Null | Value::Array(_) | Value::Object(_) => {
            Err(UsageError::new(format!("launch: '{key}', '{name}': write a number or a text")))
        }
    }
}
