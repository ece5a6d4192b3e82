//! Begin and end of a session: initialize, launch, restart, disconnect.
use std::rc::Rc;

use serde_json::Value;

use super::{Adapter, Answer, Client, Host, Session, body, launch_keys, read};
use crate::debuggee::{Debuggee, End, FILTERS, Goal, OutputLine, Stop};
use crate::protocol::arguments::{Initialize, Launch, Restart};
use crate::protocol::bodies::{Capabilities, ExceptionFilter, ExitEvent};
use crate::run::ReversibleRun;

/// Exit codes of a run, as those of `gcode-sim run`.
const PASSED: i64 = 0;
const STOPPED: i64 = 3;

/// Exit code of a run that the user ends, as that of a command at the second Ctrl-C.
const TERMINATED: i64 = 130;

impl<H: Host> Adapter<H> {
    pub(super) fn initialize(&mut self, arguments: &Initialize) -> Answer {
        self.is_initialized = true;
        self.client = Client {
            first_line: i64::from(arguments.lines_start_at_1),
            first_column: i64::from(arguments.columns_start_at_1),
            uses_uris: arguments.path_format.as_deref() == Some("uri"),
        };
        self.outbox.event("initialized", Value::Null);
        body(Capabilities {
            supports_configuration_done_request: true,
            supports_function_breakpoints: true,
            supports_conditional_breakpoints: true,
            supports_hit_conditional_breakpoints: true,
            supports_evaluate_for_hovers: true,
            supports_step_back: true,
            supports_set_variable: true,
            supports_set_expression: true,
            supports_restart_request: true,
            supports_goto_targets_request: true,
            supports_exception_info_request: true,
            supports_delayed_stack_trace_loading: true,
            supports_loaded_sources_request: true,
            supports_log_points: true,
            supports_terminate_request: true,
            supports_data_breakpoints: true,
            supports_breakpoint_locations_request: true,
            exception_breakpoint_filters: FILTERS
                .iter()
                .map(|row| ExceptionFilter {
                    filter: row.filter,
                    label: row.label,
                    description: row.description,
                    default: row.filter == "alarm",
                })
                .collect(),
        })
    }

    pub(super) fn launch(&mut self, arguments: &Value) -> Answer {
        if self.session.as_ref().is_some_and(|session| !session.has_ended) {
            return Err("a program is launched already".to_owned());
        }
        let launch = self.read_launch("launch", arguments)?;
        self.load(&launch)?;
        self.launch = Some(launch);
        self.begin();
        Ok(Value::Null)
    }

    /// Reads the arguments of a launch, and tells the client which keys are not used.
    fn read_launch(&mut self, command: &str, arguments: &Value) -> Result<Launch, String> {
        let launch = read(command, arguments.clone())?;
        let unused = arguments.as_object().map_or_else(|| Ok(Vec::new()), launch_keys::unused)?;
        unused.into_iter().for_each(|text| self.write(&OutputLine { text, block: None }));
        Ok(launch)
    }

    /// Makes a session of a program, with the breakpoints requested so far.
    fn load(&mut self, arguments: &Launch) -> Result<(), String> {
        let launched = self.host.launch(arguments)?;
        let control = gcode_session::set_up(&launched.request, None).map_err(|error| error.to_string())?;
        let run = ReversibleRun::new(control, launched.library);
        let mut debuggee = Debuggee::new(run, Rc::clone(&self.canonical));
        if arguments.no_debug {
            debuggee.ignore_stops();
        }
        debuggee.set_filters(self.breakpoints.filters.clone());
        let breakpoints = debuggee.breakpoints_mut();
        breakpoints.programs.clone_from(&self.breakpoints.programs);
        breakpoints.variables.clone_from(&self.breakpoints.variables);
        self.session = Some(Session {
            debuggee,
            request: launched.request,
            reference: launched.reference,
            has_begun: false,
            has_ended: false,
            reported_sources: 0,
        });
        self.exception = None;
        self.goto_targets.clear();
        // The files may have changed since their breakpoints were set.
        self.files.forget_texts();
        self.set_lines_again();
        self.report_missing_programs();
        Ok(())
    }

    pub(super) fn configuration_done(&mut self) -> Answer {
        self.is_configured = true;
        self.begin();
        Ok(Value::Null)
    }

    /// Begins the run once it is launched and configured.
    fn begin(&mut self) {
        let stops = self.launch.as_ref().is_some_and(|launch| launch.stop_on_entry && !launch.no_debug);
        let Some(session) = self.session.as_mut().filter(|session| self.is_configured && !session.has_begun)
        else {
            return;
        };
        session.has_begun = true;
        self.report_sources();
        if stops {
            if let Some(session) = &mut self.session {
                session.debuggee.stand_here();
            }
            self.stop(Stop::Entry);
        } else {
            self.goal = Some(Goal::Continue);
        }
    }

    pub(super) fn restart(&mut self, arguments: Restart) -> Answer {
        let launch = match (arguments.arguments, &self.launch) {
            (Some(changed), Some(_)) if changed.get("program").is_some() => {
                self.read_launch("restart", &changed)?
            }
            (_, Some(launch)) => launch.clone(),
            (_, None) => return Err("no program is launched".to_owned()),
        };
        self.load(&launch)?;
        self.goal = None;
        self.launch = Some(launch);
        self.begin();
        Ok(Value::Null)
    }

    pub(super) fn terminate(&mut self) -> Answer {
        self.goal = None;
        if self.session.as_ref().is_some_and(|session| !session.has_ended) {
            self.report_end(End::Terminated);
        }
        Ok(Value::Null)
    }

    pub(super) fn disconnect(&mut self) -> Answer {
        self.goal = None;
        self.session = None;
        self.is_over = true;
        Ok(Value::Null)
    }

    /// Tells the client that the run has ended.
    pub(super) fn report_end(&mut self, end: End) {
        if let Some(session) = &mut self.session {
            session.has_ended = true;
        }
        let exit_code = match end {
            End::Program => PASSED,
            End::Stopped => STOPPED,
            End::Terminated => TERMINATED,
        };
        self.outbox.event("exited", ExitEvent { exit_code });
        self.outbox.event("terminated", Value::Null);
    }
}
