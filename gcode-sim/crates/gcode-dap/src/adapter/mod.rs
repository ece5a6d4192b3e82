//! The adapter: requests in, responses and events out, and the state between them.
mod breakpoint_requests;
mod execution;
mod host;
mod launch_keys;
mod launching;
mod outbox;
mod program_files;
mod source_requests;
mod stack;
mod typed_values;
mod variables;

pub use host::{Host, LaunchedProgram};

use std::collections::BTreeMap;
use std::rc::Rc;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use self::outbox::Outbox;
use self::program_files::ProgramFiles;
use self::stack::GotoTarget;
use crate::debuggee::{
    Breakpoint, Debuggee, Exception, Filters, Goal, OutputLine, ProgramPlace, VariablePlace,
};
use crate::protocol::arguments::{Launch, Source, SourceBreakpoint};
use crate::protocol::bodies;
use crate::protocol::message::Request;
use gcode_inspect::verify::Tolerances;
use gcode_part::Reference;

/// Blocks that a run executes before requests are heard again.
const SLICE: u32 = 5_000;

/// The only thread.
const THREAD: i64 = 1;

/// Body of a response.
type Answer = Result<Value, String>;

/// Debug adapter of one client.
pub struct Adapter<H> {
    host: H,
    canonical: Rc<dyn Fn(&str) -> String>,
    outbox: Outbox,
    client: Client,
    is_initialized: bool,
    files: ProgramFiles,
    breakpoints: RequestedBreakpoints,
    launch: Option<Launch>,
    is_configured: bool,
    session: Option<Session>,
    /// What the run is doing; `None` while it stands.
    goal: Option<Goal>,
    exception: Option<Exception>,
    goto_targets: Vec<GotoTarget>,
    is_over: bool,
}

/// Conventions of the client.
#[derive(Clone, Debug)]
struct Client {
    first_line: i64,
    first_column: i64,
    uses_uris: bool,
}

impl Default for Client {
    fn default() -> Self {
        Self { first_line: 1, first_column: 1, uses_uris: false }
    }
}

/// Breakpoints as requested, for this run and the next.
#[derive(Default)]
struct RequestedBreakpoints {
    last_id: i64,
    /// By the canonical paths of their files.
    lines: BTreeMap<String, RequestedLines>,
    programs: Vec<Breakpoint<ProgramPlace>>,
    variables: Vec<Breakpoint<VariablePlace>>,
    filters: Filters,
}

/// Breakpoints on lines of one file, with what the client has been told of them.
struct RequestedLines {
    source: Source,
    breakpoints: Vec<(i64, SourceBreakpoint)>,
    answers: Vec<bodies::Breakpoint>,
}

impl RequestedBreakpoints {
    fn next_id(&mut self) -> i64 {
        self.last_id += 1;
        self.last_id
    }
}

/// A launched program.
struct Session {
    debuggee: Debuggee,
    request: gcode_session::Request,
    reference: Option<(Reference, Tolerances)>,
    /// The run has begun, if only to stand in front of its first block.
    has_begun: bool,
    has_ended: bool,
    /// Number of files that the client has been told of.
    reported_sources: usize,
}

impl<H: Host> Adapter<H> {
    /// Waits for the first request.
    pub fn new(host: H) -> Self {
        Self {
            canonical: host.canonical(),
            host,
            outbox: Outbox::default(),
            client: Client::default(),
            is_initialized: false,
            files: ProgramFiles::default(),
            breakpoints: RequestedBreakpoints::default(),
            launch: None,
            is_configured: false,
            session: None,
            goal: None,
            exception: None,
            goto_targets: Vec::new(),
            is_over: false,
        }
    }

    /// Handles one message of the client.
    pub fn receive(&mut self, message: &[u8]) {
        let request = match Request::parse(message) {
            Ok(request) => request,
            Err(malformed) => {
                return self.outbox.respond(malformed.seq, &malformed.command, Err(malformed.reason));
            }
        };
        let answer = self.handle(&request.command, request.arguments);
        self.outbox.respond(request.seq, &request.command, answer);
    }

    /// Answers bytes that are no message.
    pub fn refuse(&mut self, reason: &str) {
        self.outbox.respond(0, "", Err(reason.to_owned()));
    }

    /// Returns true while the run goes on and [`Adapter::work`] has something to do.
    pub fn is_running(&self) -> bool {
        self.goal.is_some()
    }

    /// Returns true after the client has disconnected.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Takes the messages for the client, in their order.
    pub fn take_messages(&mut self) -> Vec<String> {
        self.outbox.take()
    }

    /// Lets the run go on for one slice. What takes longer ends and begins anew at the next slice if the host has a message.
    pub fn work(&mut self) {
        let (Some(mut goal), Some(session)) = (self.goal, &mut self.session) else { return };
        if let Some((reference, tolerances)) = &session.reference {
            let (of, is_interrupted) = ((reference, *tolerances), || self.host.has_message());
            match session.debuggee.find_bad_holes(&session.request, of, &is_interrupted) {
                Ok(true) => {}
                Ok(false) => return,
                Err(error) => {
                    self.write(&OutputLine { text: error.to_string(), block: None });
                    self.goal = None;
                    return self.outbox.send_events();
                }
            }
        }
        let mut output = Vec::new();
        let stop = session.debuggee.advance(&mut goal, SLICE, &mut output);
        self.goal = Some(goal);
        self.report_sources();
        output.iter().for_each(|line| self.write(line));
        if let Some(stop) = stop {
            self.stop(stop);
        }
        self.outbox.send_events();
    }

    fn handle(&mut self, command: &str, arguments: Value) -> Answer {
        match (command, self.is_initialized) {
            ("initialize", true) => return Err("the session is initialized already".to_owned()),
            ("initialize", false) | ("disconnect", _) | (_, true) => {}
            (_, false) => return Err(format!("the request 'initialize' comes before '{command}'")),
        }
        match command {
            "initialize" => self.initialize(&read(command, or_empty(arguments))?),
            "launch" => self.launch(&or_empty(arguments)),
            "configurationDone" => self.configuration_done(),
            "restart" => self.restart(read(command, or_empty(arguments))?),
            "terminate" => self.terminate(),
            "disconnect" => self.disconnect(),
            "setBreakpoints" => self.set_breakpoints(&read(command, arguments)?),
            "setFunctionBreakpoints" => self.set_function_breakpoints(&read(command, arguments)?),
            "dataBreakpointInfo" => self.data_breakpoint_info(&read(command, arguments)?),
            "setDataBreakpoints" => self.set_data_breakpoints(&read(command, arguments)?),
            "setExceptionBreakpoints" => self.set_exception_breakpoints(&read(command, arguments)?),
            "breakpointLocations" => self.breakpoint_locations(&read(command, arguments)?),
            "threads" => self.threads(),
            "continue" => self.resume(&read(command, arguments)?),
            "next" => self.next(&read(command, arguments)?),
            "stepIn" => self.step_in(&read(command, arguments)?),
            "stepOut" => self.step_out(&read(command, arguments)?),
            "stepBack" => self.step_back(&read(command, arguments)?),
            "reverseContinue" => self.reverse_continue(&read(command, arguments)?),
            "pause" => self.pause(&read(command, arguments)?),
            "gotoTargets" => self.goto_targets(&read(command, arguments)?),
            "goto" => self.goto(&read(command, arguments)?),
            "exceptionInfo" => self.exception_info(&read(command, arguments)?),
            "stackTrace" => self.stack_trace(&read(command, arguments)?),
            "scopes" => self.scopes(&read(command, arguments)?),
            "variables" => self.variables(&read(command, arguments)?),
            "setVariable" => self.set_variable(&read(command, arguments)?),
            "setExpression" => self.set_expression(&read(command, arguments)?),
            "evaluate" => self.evaluate(&read(command, arguments)?),
            "source" => self.source(&read(command, arguments)?),
            "loadedSources" => self.loaded_sources(),
            _ => Err(format!("the request '{command}' is not supported")),
        }
    }

    /// Returns the session while its run stands.
    fn standing(&mut self) -> Result<&mut Session, String> {
        let is_running = self.goal.is_some();
        let session = self.session.as_mut().ok_or("no program is launched")?;
        if session.has_ended {
            return Err("the run has ended: restart it".to_owned());
        }
        if is_running || !session.has_begun {
            return Err("the run goes on: pause it first".to_owned());
        }
        Ok(session)
    }
}

/// Reads the arguments of a request. One that is null is absent.
fn read<T: DeserializeOwned>(command: &str, mut arguments: Value) -> Result<T, String> {
    if let Value::Object(all) = &mut arguments {
        all.retain(|_, argument| !argument.is_null());
    }
    T::deserialize(&arguments).map_err(|error| {
        let error = error.to_string();
        let key = wrong_key::<T>(&arguments, &error).map_or_else(String::new, |key| format!("'{key}': "));
        format!("arguments of '{command}': {key}{error}")
    })
}

/// Returns the argument that an error is about: without it there is no error, or another one.
fn wrong_key<T: DeserializeOwned>(arguments: &Value, error: &str) -> Option<String> {
    let all = arguments.as_object()?;
    let key = all.keys().find(|key| {
        let others = all.iter().filter(|(other, _)| other != key);
        let others = others.map(|(key, value)| (key.clone(), value.clone())).collect();
        let read = serde_json::from_value::<T>(Value::Object(others));
        read.err().is_none_or(|other| other.to_string() != error)
    });
    key.cloned()
}

/// Returns an object in the place of absent arguments.
fn or_empty(arguments: Value) -> Value {
    if arguments.is_null() { Value::Object(serde_json::Map::new()) } else { arguments }
}

/// Returns a body.
fn body(of: impl Serialize) -> Answer {
    serde_json::to_value(of).map_err(|error| error.to_string())
}

/// Refuses a thread other than the only one.
fn check_thread(thread: i64) -> Result<(), String> {
    if thread == THREAD {
        Ok(())
    } else {
        Err(format!("there is no thread {thread}: the only one is {THREAD}"))
    }
}
