//! A run with breakpoints, filters of exceptions and steps in both directions. It knows no protocol.
//!
//! The run stands in front of its next block. Comments and empty lines are no places to stand: the run passes them.
mod bad_holes;
mod breakpoints;
mod exceptions;
mod hit_condition;
mod log_message;
mod named_values;
mod stop;
#[cfg(test)]
mod tests;
pub(crate) mod values;

pub(crate) use breakpoints::{BlockPlace, Breakpoint, Breakpoints, Conditions, ProgramPlace, VariablePlace};
pub(crate) use exceptions::{BAD_HOLE, Exception, FILTERS, Filters, VACANT_READ};
pub(crate) use hit_condition::HitCondition;
pub(crate) use log_message::LogMessage;
pub(crate) use stop::{End, Goal, OutputLine, Stop};

use std::rc::Rc;

use self::bad_holes::BadHoles;
use self::breakpoints::{Access, Arrival, Hits};
use crate::run::{Change, ChangeRefusal, ReversibleRun};
use gcode_control::{Control, Outcome};
use gcode_inspect::verify::Tolerances;
use gcode_lang::motion::{Event, EventKind, EventSink};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::ProgramName;
use gcode_part::Reference;
use gcode_session::{Request, SessionError};

/// Operator stops of one block.
#[derive(Default)]
struct BlockStops(Vec<(&'static str, String)>);

impl EventSink for BlockStops {
    fn event(&mut self, event: &Event<'_>) {
        if let EventKind::Stop { kind, text, .. } = event.kind {
            self.0.push((kind.name(), text.clone()));
        }
    }
}

/// What has been decided about the next block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NextBlock {
    /// Nothing: breakpoints and exceptions may stop the run there.
    New,
    /// The run stands there: breakpoints write their messages and don't stop it again.
    Standing,
    /// Everything.
    Reached,
}

/// Run under a debugger.
pub(crate) struct Debuggee {
    run: ReversibleRun,
    breakpoints: Breakpoints,
    filters: Filters,
    /// Bad holes of the run with this number of changes.
    bad_holes: Option<(u64, BadHoles)>,
    /// Position and number of changes of the alarm at which the run stands.
    raised: Option<(u64, u64)>,
    next_block: NextBlock,
    /// A program has begun, and none of its blocks has been executed but comments.
    has_entered: bool,
    ignores_stops: bool,
    canonical: Rc<dyn Fn(&str) -> String>,
}

impl Debuggee {
    /// Stands in front of the first block; `canonical` returns the canonical path of a loaded file.
    pub(crate) fn new(run: ReversibleRun, canonical: Rc<dyn Fn(&str) -> String>) -> Self {
        let mut debuggee = Self {
            run,
            breakpoints: Breakpoints::default(),
            filters: Filters::default(),
            bad_holes: None,
            raised: None,
            next_block: NextBlock::New,
            has_entered: true,
            ignores_stops: false,
            canonical,
        };
        debuggee.pass_empty_blocks();
        debuggee
    }

    /// Lets the run go through without any stop.
    pub(crate) fn ignore_stops(&mut self) {
        self.ignores_stops = true;
    }

    /// Returns the control, whose next block is lowered.
    pub(crate) fn control(&self) -> &Control {
        self.run.control()
    }

    /// Returns the span of the next block.
    #[cfg(test)]
    pub(crate) fn next_span(&self) -> Option<Span> {
        self.run.next_block()
    }

    /// Returns the number of executed blocks.
    pub(crate) fn position(&self) -> u64 {
        self.run.position()
    }

    /// Returns the breakpoints, to be changed.
    pub(crate) fn breakpoints_mut(&mut self) -> &mut Breakpoints {
        &mut self.breakpoints
    }

    /// Replaces the filters of exceptions.
    pub(crate) fn set_filters(&mut self, filters: Filters) {
        self.filters = filters;
    }

    /// Finds the holes that come out bad, if the filter for them is on and the run has changed since. Returns false if the search
    /// is interrupted.
    pub(crate) fn find_bad_holes(
        &mut self,
        request: &Request,
        reference: (&Reference, Tolerances),
        is_interrupted: &dyn Fn() -> bool,
    ) -> Result<bool, SessionError> {
        let revision = self.run.revision();
        if self.filters.has(BAD_HOLE) && self.bad_holes.as_ref().is_none_or(|(of, _)| *of != revision) {
            let found = bad_holes::find(request, reference, &mut self.run, is_interrupted)?;
            let Some(found) = found else { return Ok(false) };
            self.bad_holes = Some((revision, found));
        }
        Ok(true)
    }

    /// Makes a change in front of the next block.
    pub(crate) fn change(&mut self, change: Change) -> Result<(), ChangeRefusal> {
        self.run.change(change)?;
        self.raised = None;
        self.breakpoints.forget_hits_behind(self.run.position());
        if matches!(change, Change::Jump { .. }) {
            self.has_entered = false;
            self.stand_here();
        }
        Ok(())
    }

    /// Runs a number of blocks towards a goal, or one stretch of a way back. Returns the stop, if there is one.
    pub(crate) fn advance(
        &mut self,
        goal: &mut Goal,
        blocks: u32,
        output: &mut Vec<OutputLine>,
    ) -> Option<Stop> {
        self.breakpoints.locate(self.run.control(), &*self.canonical);
        if let Goal::ReverseContinue { end } = goal {
            return self.go_back_a_stretch(end);
        }
        for _ in 0..blocks {
            let stop = match self.next_block {
                NextBlock::New => self.reach_block(Some(*goal), output),
                NextBlock::Standing => self.reach_block(None, output),
                NextBlock::Reached => None,
            };
            if stop.is_some() {
                self.next_block = NextBlock::Reached;
                return stop;
            }
            if let Some(stop) = self.execute_block(output) {
                self.pass_empty_blocks();
                return Some(stop);
            }
        }
        None
    }

    /// Prepares for a goal: a step executes at least one block.
    pub(crate) fn set_off(&mut self, goal: Goal) {
        if goal != Goal::Continue && self.next_block == NextBlock::New {
            self.next_block = NextBlock::Standing;
        }
    }

    /// Decides whether the run stops in front of the next block; without a goal it stands there.
    fn reach_block(&mut self, goal: Option<Goal>, output: &mut Vec<OutputLine>) -> Option<Stop> {
        let control = self.run.control();
        if control.is_next_empty() {
            return None;
        }
        let position = self.run.position();
        let site = self.run.next_block()?;
        if !self.ignores_stops {
            if self.filters.has(VACANT_READ)
                && let Some(exception) = Exception::of_vacant_read(control)
            {
                return Some(Stop::Exception(exception));
            }
            if let Some(exception) = self.bad_hole() {
                return Some(Stop::Exception(exception));
            }
            if !self.breakpoints.is_empty() {
                let site = (site.source, site.start);
                let hits = self.breakpoints.reach_block(control, site, position);
                let lines = write_messages(hits, self.run.next_block(), output);
                let arrival = Arrival { control, has_entered: self.has_entered };
                let hits = self.breakpoints.reach_programs(&arrival, position);
                let programs = write_messages(hits, self.run.next_block(), output);
                let stop = Stop::at_breakpoints(lines, programs).filter(|_| goal.is_some());
                if stop.is_some() {
                    return stop;
                }
            }
        }
        let depth = control.call_depth();
        let is_done = match goal? {
            Goal::Continue | Goal::ReverseContinue { .. } => false,
            Goal::StepIn => true,
            Goal::Next { depth: from } => depth <= from,
            Goal::StepOut { depth: from } => depth < from,
        };
        is_done.then_some(Stop::Step)
    }

    fn bad_hole(&self) -> Option<Exception> {
        let (revision, holes) = self.bad_holes.as_ref().filter(|_| self.filters.has(BAD_HOLE))?;
        let sentences = holes.get(&self.run.position()).filter(|_| *revision == self.run.revision())?;
        Some(Exception { code: BAD_HOLE.to_owned(), message: sentences.join("; ") })
    }

    /// Executes the next block and decides whether the run stops behind it.
    fn execute_block(&mut self, output: &mut Vec<OutputLine>) -> Option<Stop> {
        let (position, block) = (self.run.position(), self.run.next_block());
        let control = self.run.control();
        let was_empty = control.is_next_empty();
        let level = control.vars().level();
        let watches = !self.ignores_stops && !self.breakpoints.variables.is_empty();
        let access = if watches { Access::of_next(control) } else { Access::default() };
        let printed = control.output().len();
        let mut stops = BlockStops::default();
        let outcome = self.run.step(&mut stops);
        let control = self.run.control();
        for line in &control.output()[printed.min(control.output().len())..] {
            output.push(OutputLine { text: gcode_control::printable(line), block });
        }
        for (_, text) in &mut stops.0 {
            *text = named_values::with_values(text, control);
        }
        let messages = stops.0.iter().filter(|(_, text)| !text.is_empty());
        output.extend(messages.map(|(name, text)| OutputLine { text: format!("{name}: {text}"), block }));
        if let Some(outcome) = outcome {
            return Some(self.end(&outcome, position, output));
        }
        self.next_block = NextBlock::New;
        self.has_entered = self.run.has_entered() || was_empty && self.has_entered;
        if self.breakpoints.located_for_fewer(self.run.control()) {
            self.breakpoints.locate(self.run.control(), &*self.canonical);
        }
        if self.ignores_stops {
            return None;
        }
        let hits =
            self.breakpoints.reach_variables(self.run.control(), (level, &access), self.run.position());
        if let Some((name, text)) = stops.0.into_iter().next() {
            return Some(Stop::Pause(if text.is_empty() {
                name.to_owned()
            } else {
                format!("{name}: {text}")
            }));
        }
        let ids = write_messages(hits, block, output);
        (!ids.is_empty()).then_some(Stop::VariableBreakpoint(ids))
    }

    /// Returns the stop at the end of a run. An alarm with its filter puts the run back in front of its block, once.
    fn end(&mut self, outcome: &Outcome, position: u64, output: &mut Vec<OutputLine>) -> Stop {
        let stopped = match outcome {
            Outcome::End => return Stop::End(End::Program),
            Outcome::Limit => {
                let block = Some(self.run.control().backtrace().block);
                let text = "the program never ends: its blocks repeat without change".to_owned();
                output.push(OutputLine { text, block });
                return Stop::End(End::Stopped);
            }
            Outcome::Alarm(stopped) => stopped,
        };
        let exception = Exception::of_alarm(&stopped.alarm);
        let here = (position, self.run.revision());
        let is_second = self.raised == Some(here);
        if !is_second {
            output.push(OutputLine { text: exception.text(), block: Some(stopped.backtrace.block) });
        }
        if self.ignores_stops || is_second || !self.filters.stops_at_alarm(&exception.code) {
            return Stop::End(End::Stopped);
        }
        self.run.go_back_to(position);
        self.raised = Some(here);
        self.next_block = NextBlock::Reached;
        Stop::Exception(exception)
    }

    /// Stands here, at the start or behind a jump: breakpoints on the next block don't stop the run again.
    pub(crate) fn stand_here(&mut self) {
        self.pass_empty_blocks();
        self.next_block = NextBlock::Standing;
    }

    /// Returns true if a program is loaded or in the library.
    pub(crate) fn has_program(&mut self, name: &ProgramName) -> bool {
        self.run.has_program(name)
    }

    /// Returns true if a program, loaded or in the library, has a sequence number. Without a name it is the main program.
    pub(crate) fn has_number(&mut self, name: Option<&ProgramName>, number: u32) -> bool {
        self.run.has_number(name, number)
    }

    /// Interrupts the run.
    pub(crate) fn pause(&mut self) {
        self.pass_empty_blocks();
    }

    /// Passes comments and empty lines in front of the next block.
    fn pass_empty_blocks(&mut self) {
        while self.run.control().is_next_empty() && self.run.step(&mut ()).is_none() {}
    }

    /// Goes back to the block before, or to the first one from the choice of another. False at the start of the run.
    pub(crate) fn step_back(&mut self) -> bool {
        let from = self.run.position();
        let mut to = from;
        while let Some(before) = to.checked_sub(1) {
            to = before;
            self.run.go_back_to(to);
            if !self.run.control().is_next_empty() {
                break;
            }
        }
        self.stand();
        if self.run.position() < from {
            return true;
        }
        // In front of the first block only the choice of another one can be undone.
        let is_undone = self.run.undo_jump();
        self.stand();
        is_undone
    }

    /// Goes to a position, where the run then stands.
    pub(crate) fn stand_at(&mut self, position: u64) {
        self.run.go_back_to(position);
        self.stand();
    }

    fn stand(&mut self) {
        self.raised = None;
        self.next_block = NextBlock::Reached;
        self.has_entered = self.run.has_entered();
        self.pass_empty_blocks();
    }

    /// Looks for the last stop between the checkpoint before `end` and `end`; without one, `end` becomes that checkpoint.
    fn go_back_a_stretch(&mut self, end: &mut u64) -> Option<Stop> {
        let start = self.run.checkpoint_before(*end);
        self.run.go_back_to(start);
        let mut found = None;
        let mut has_entered = self.run.has_entered();
        while self.run.position() < *end {
            let control = self.run.control();
            let is_empty = control.is_next_empty();
            if !is_empty && let Some(stop) = self.stop_before(has_entered) {
                found = Some((self.run.position(), stop));
            }
            if self.run.step(&mut ()).is_some() {
                break;
            }
            has_entered = self.run.has_entered() || is_empty && has_entered;
        }
        if let Some((position, stop)) = found {
            self.stand_at(position);
            return Some(stop);
        }
        *end = start;
        (start == 0).then(|| {
            self.stand_at(0);
            if self.run.has_jumped_here() { Stop::Goto } else { Stop::Entry }
        })
    }

    /// Returns the stop of a way back in front of the next block.
    fn stop_before(&self, has_entered: bool) -> Option<Stop> {
        let (control, position) = (self.run.control(), self.run.position());
        let site = self.run.next_block()?;
        let arrival = Arrival { control, has_entered };
        let (lines, programs) = self.breakpoints.stops_before(&arrival, (site.source, site.start), position);
        let stop = Stop::at_breakpoints(lines, programs);
        if stop.is_some() {
            return stop;
        }
        if !self.breakpoints.variables.is_empty() {
            let ids = self.breakpoints.stops_at_access(control, &Access::of_next(control), position);
            if !ids.is_empty() {
                return Some(Stop::VariableBreakpoint(ids));
            }
        }
        if let Some(exception) = self.bad_hole() {
            return Some(Stop::Exception(exception));
        }
        let vacant = if self.filters.has(VACANT_READ) { Exception::of_vacant_read(control) } else { None };
        vacant.map(Stop::Exception)
    }
}

/// Adds the messages of breakpoints to the output, and returns those that stop the run.
fn write_messages(hits: Hits, block: Option<Span>, output: &mut Vec<OutputLine>) -> Vec<i64> {
    output.extend(hits.messages.into_iter().map(|text| OutputLine { text, block }));
    if let Some(alarm) = hits.refusal {
        let text = format!("the condition of the breakpoint can't be evaluated: {}", values::alarm(&alarm));
        output.push(OutputLine { text, block });
    }
    hits.ids
}
