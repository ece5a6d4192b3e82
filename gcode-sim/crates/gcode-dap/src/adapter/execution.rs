//! Requests that let the run go on, stop or go elsewhere, and what the client is told of it.
use serde_json::Value;

use super::stack::GotoTarget;
use super::{Adapter, Answer, Host, THREAD, body, check_thread};
use crate::debuggee::{Goal, OutputLine, Stop};
use crate::protocol::arguments::{Goto, GotoTargets, Thread};
use crate::protocol::bodies::{self, Continue, ExceptionDetails, ExceptionInfo, Output, StopEvent};
use crate::run::{Change, ChangeRefusal};
use gcode_lang::source::Span;

/// Category of all output.
const CATEGORY: &str = "console";

impl<H: Host> Adapter<H> {
    /// Sets the run off towards a goal that depends on the depth of calls.
    fn go(&mut self, thread: &Thread, goal: impl FnOnce(usize, u64) -> Goal) -> Answer {
        check_thread(thread.thread_id)?;
        let session = self.standing()?;
        let goal = goal(session.debuggee.control().call_depth(), session.debuggee.position());
        session.debuggee.set_off(goal);
        self.goal = Some(goal);
        self.exception = None;
        Ok(Value::Null)
    }

    pub(super) fn resume(&mut self, arguments: &Thread) -> Answer {
        self.go(arguments, |_, _| Goal::Continue)?;
        body(Continue { all_threads_continued: true })
    }

    pub(super) fn next(&mut self, arguments: &Thread) -> Answer {
        self.go(arguments, |depth, _| Goal::Next { depth })
    }

    pub(super) fn step_in(&mut self, arguments: &Thread) -> Answer {
        self.go(arguments, |_, _| Goal::StepIn)
    }

    pub(super) fn step_out(&mut self, arguments: &Thread) -> Answer {
        self.go(arguments, |depth, _| Goal::StepOut { depth })
    }

    pub(super) fn reverse_continue(&mut self, arguments: &Thread) -> Answer {
        self.go(arguments, |_, end| Goal::ReverseContinue { end })
    }

    pub(super) fn step_back(&mut self, arguments: &Thread) -> Answer {
        check_thread(arguments.thread_id)?;
        let has_moved = self.standing()?.debuggee.step_back();
        self.stop(if has_moved { Stop::Step } else { Stop::Entry });
        Ok(Value::Null)
    }

    pub(super) fn pause(&mut self, arguments: &Thread) -> Answer {
        check_thread(arguments.thread_id)?;
        let session = self.session.as_mut().ok_or("no program is launched")?;
        match self.goal {
            Some(Goal::ReverseContinue { end }) => session.debuggee.stand_at(end),
            Some(_) => session.debuggee.pause(),
            None => return Ok(Value::Null),
        }
        self.stop(Stop::Pause(String::new()));
        Ok(Value::Null)
    }

    pub(super) fn goto_targets(&mut self, arguments: &GotoTargets) -> Answer {
        self.standing()?;
        let (canonical, site) = self.block_at(&arguments.source, arguments.line, None)?;
        let id = self.goto_targets.len() as i64 + 1;
        let label = format!("{}, line {}", site.program, site.line);
        let target = bodies::GotoTarget {
            id,
            label,
            line: self.client_line(site.line),
            column: self.client_column(site.column),
        };
        self.goto_targets.push(GotoTarget { path: canonical, site });
        body(bodies::GotoTargets { targets: vec![target] })
    }

    pub(super) fn goto(&mut self, arguments: &Goto) -> Answer {
        check_thread(arguments.thread_id)?;
        self.standing()?;
        let index = arguments.target_id.checked_sub(1).and_then(|index| usize::try_from(index).ok());
        let target = index.and_then(|index| self.goto_targets.get(index)).cloned();
        let target = target.ok_or_else(|| format!("there is no goto target {}", arguments.target_id))?;
        let source = self.loaded_source(&target.path);
        let session = self.standing()?;
        let start = target.site.start;
        let change = source.map(|source| Change::Jump { to: Span { source, start, end: start } });
        let refusal = match change {
            Some(change) => session.debuggee.change(change).err(),
            None => Some(ChangeRefusal::OtherProgram),
        };
        if refusal.is_some() {
            let control = session.debuggee.control();
            let here = control.memory().get(control.program_at_work()).label();
            return Err(format!(
                "line {} is in {} and the run is in {here}: a goto stays in the program at work",
                target.site.line, target.site.program
            ));
        }
        self.stop(Stop::Goto);
        Ok(Value::Null)
    }

    pub(super) fn exception_info(&mut self, arguments: &Thread) -> Answer {
        check_thread(arguments.thread_id)?;
        let exception = self.exception.clone().ok_or("the run has not stopped at an exception")?;
        let frames = self.frames()?;
        let lines: Vec<String> =
            frames.iter().map(|frame| format!("{}, line {}", frame.name, frame.line)).collect();
        body(ExceptionInfo {
            exception_id: exception.code.clone(),
            description: exception.text(),
            break_mode: "always",
            details: ExceptionDetails {
                message: exception.message,
                type_name: exception.code,
                stack_trace: lines.join("\n"),
            },
        })
    }

    /// Tells the client why the run stands, or that it has ended.
    pub(super) fn stop(&mut self, stop: Stop) {
        self.goal = None;
        self.exception = None;
        let mut stopped = StopEvent {
            reason: "step",
            description: None,
            thread_id: THREAD,
            text: None,
            all_threads_stopped: true,
            hit_breakpoint_ids: Vec::new(),
        };
        match stop {
            Stop::End(end) => return self.report_end(end),
            Stop::Entry => stopped.reason = "entry",
            Stop::Step => {}
            Stop::Goto => stopped.reason = "goto",
            Stop::Pause(text) => {
                stopped.reason = "pause";
                stopped.description = (!text.is_empty()).then(|| format!("Paused on {text}"));
                stopped.text = (!text.is_empty()).then_some(text);
            }
            Stop::Breakpoint(ids) => {
                (stopped.reason, stopped.hit_breakpoint_ids) = ("breakpoint", ids);
            }
            Stop::ProgramBreakpoint(ids) => {
                (stopped.reason, stopped.hit_breakpoint_ids) = ("function breakpoint", ids);
            }
            Stop::VariableBreakpoint(ids) => {
                (stopped.reason, stopped.hit_breakpoint_ids) = ("data breakpoint", ids);
            }
            Stop::Exception(exception) => {
                stopped.reason = "exception";
                stopped.description = Some(format!("Paused on {}", exception.code));
                stopped.text = Some(exception.text());
                self.exception = Some(exception);
            }
        }
        self.outbox.event("stopped", stopped);
    }

    /// Writes a line to the client's console.
    pub(super) fn write(&mut self, line: &OutputLine) {
        let place = line.block.and_then(|block| self.place(block));
        let (source, line_number, column) = match place {
            Some((source, line, column)) => (Some(source), Some(line), Some(column)),
            None => (None, None, None),
        };
        let output = format!("{}\n", line.text);
        self.outbox.event("output", Output { category: CATEGORY, output, source, line: line_number, column });
    }
}
