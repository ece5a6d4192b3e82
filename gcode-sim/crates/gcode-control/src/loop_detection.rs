//! Finds out that a program will never end: the control is again where it was, and nothing has changed.
//!
//! Brent's method of finding cycles: at each jump back what differs soonest (place, variables, position) is held against
//! that of an earlier jump, which is kept for longer and longer. Where they agree the control itself is copied; when it equals
//! its copy one turn later, all that follows repeats. Between such finds a jump costs a few instructions.
use super::Executor;
use super::frames::Frame;
use super::lookahead::Lookahead;
use super::modal_calls::ModalCall;
use super::offsets::Offsets;
use super::run::RunEnd;
use super::state::State;
use super::vars::Vars;
use gcode_lang::control::{ParameterId, Settings};
use gcode_lang::motion::Position;
use gcode_lang::program::{OpIndex, ProgramId};
use gcode_lang::source::Span;

/// What differs between almost any two moments of a run that ends.
#[derive(Debug)]
struct Fingerprint {
    program: ProgramId,
    next: OpIndex,
    callers: usize,
    machine: Position,
    vars: Vars,
    /// The place of the variable that told the control from this moment the last time.
    differed: usize,
}

/// Everything that can decide what the program does next; what it only leaves behind (time, counts, stops, lines
/// printed) is not there.
#[derive(Debug)]
struct ControlSnapshot {
    state: State,
    vars: Vars,
    offsets: Offsets,
    ahead: Lookahead,
    frame: Frame,
    callers: Vec<Frame>,
    modal_calls: Vec<ModalCall>,
    names: std::collections::BTreeMap<String, u32>,
    outputs: u32,
    clocks: (f64, f64),
    idle: f64,
    switches: [f64; 2],
    parts: [f64; 2],
    cycles: u32,
    output_open: bool,
    settings: Settings,
    parameters: std::collections::BTreeMap<ParameterId, f64>,
}

/// The jump that the loop is told by: the one to the earliest block of the outermost program.
#[derive(Clone, Copy, Debug)]
struct BackJump {
    callers: usize,
    to: OpIndex,
    program: ProgramId,
    from: Span,
}

/// A loop that was found to run for ever.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndlessLoop {
    pub(super) program: ProgramId,
    /// The block it comes back to.
    pub(super) to: OpIndex,
    /// The block that jumps there.
    pub(super) from: Span,
}

#[derive(Debug, Default)]
pub(super) struct LoopDetector {
    seen: Option<Fingerprint>,
    copy: Option<Box<ControlSnapshot>>,
    widest: Option<BackJump>,
    /// Jumps until another moment is kept.
    left: u64,
    /// A clock was read since `seen` was kept.
    clock_read: bool,
    /// Nothing has happened since the program was found to wait for a clock.
    waiting: bool,
    /// How long the motion had taken then.
    seconds: f64,
    /// How many they were the last time.
    iterations: u64,
    found: Option<EndlessLoop>,
}

impl LoopDetector {
    /// The loop that was found to run for ever.
    pub(super) fn endless(&self) -> Option<EndlessLoop> {
        self.found
    }

    /// A run begins, or goes on.
    pub(super) fn begin(&mut self) {
        self.found = None;
    }

    /// Told of every jump back; ends the run where the program is now known never to leave the loop.
    #[inline(always)]
    pub(super) fn jumped(&mut self, core: &mut Executor) {
        if self.waiting || core.clock_read.get() {
            self.wait(core);
        }
        if self.copy.is_some() {
            self.widen(core);
        }
        if self.left > 0 && self.seen.as_ref().is_some_and(|seen| !seen.may_be_again(core)) {
            self.left -= 1;
        } else {
            self.check(core);
        }
    }

    /// Looks closely whether the control has come back, and keeps this moment when it is time.
    #[inline(never)]
    fn check(&mut self, core: &mut Executor) {
        self.found = None;
        if self.seen.as_mut().is_some_and(|seen| seen.is_again(core)) {
            self.check_revisit(core);
            if self.found.is_some() {
                core.aftermath.end_run(RunEnd::EndlessLoop);
                return;
            }
        }
        if self.left == 0 {
            self.keep(core);
        }
        self.left -= 1;
    }

    /// Keeps this moment instead of an earlier one, for longer.
    #[cold]
    fn keep(&mut self, core: &Executor) {
        self.forget();
        self.seen = Some(Fingerprint::of(core));
        self.iterations = (self.iterations * 2).max(4);
        self.left = self.iterations;
    }

    /// The control has come to the moment that was kept.
    #[cold]
    fn check_revisit(&mut self, core: &Executor) {
        match &self.copy {
            None => self.copy = Some(Box::new(ControlSnapshot::of(core))),
            // It waits for the clock, which only motion has moved so far.
            Some(copy) if copy.equals(core) && self.clock_read => {
                (self.seconds, self.waiting) = (core.seconds, true);
                self.forget();
            }
            Some(copy) if copy.equals(core) => {
                let found =
                    |jump: BackJump| EndlessLoop { program: jump.program, to: jump.to, from: jump.from };
                self.found = self.widest.map(found);
            }
            Some(_) => self.forget(),
        }
    }

    /// Takes note of a jump that leads further out, or further up, than those since the control was copied.
    #[cold]
    fn widen(&mut self, core: &Executor) {
        let Frame { program, next: to, .. } = core.frame;
        let callers = core.callers.len();
        if self.widest.is_none_or(|w| (callers, to) < (w.callers, w.to)) {
            self.widest = Some(BackJump { callers, to, program, from: core.block });
        }
    }

    /// A program that does nothing but wait for a clock is given a millisecond a jump, so that the wait ends.
    #[cold]
    fn wait(&mut self, core: &mut Executor) {
        let read = core.clock_read.take();
        self.clock_read |= read;
        if core.seconds != self.seconds {
            (self.seconds, self.waiting) = (core.seconds, false);
        }
        if read && self.waiting {
            core.idle += 0.001;
        }
    }

    fn forget(&mut self) {
        (self.seen, self.copy, self.widest, self.clock_read) = (None, None, None, false);
    }
}

impl Fingerprint {
    fn of(core: &Executor) -> Self {
        Self {
            program: core.frame.program,
            next: core.frame.next,
            callers: core.callers.len(),
            machine: core.state.machine,
            vars: core.vars.clone(),
            differed: 0,
        }
    }

    /// Whether nothing that is looked at first differs. What counts turns tells nearly all moments apart.
    #[inline]
    fn may_be_again(&self, core: &Executor) -> bool {
        self.machine[0].to_bits() == core.state.machine[0].to_bits()
            && self.next == core.frame.next
            && !self.vars.differ_at(self.differed, &core.vars)
    }

    /// Whether the control has come to this moment again.
    fn is_again(&mut self, core: &Executor) -> bool {
        if !self.may_be_again(core)
            || self.program != core.frame.program
            || self.callers != core.callers.len()
            || self.machine.0.iter().zip(core.state.machine.0).any(|(a, b)| a.to_bits() != b.to_bits())
        {
            return false;
        }
        let difference = self.vars.difference(&core.vars);
        self.differed = difference.unwrap_or(self.differed);
        difference.is_none()
    }
}

impl ControlSnapshot {
    fn of(core: &Executor) -> Self {
        Self {
            state: *core.state,
            vars: core.vars.clone(),
            offsets: core.offsets.clone(),
            ahead: core.ahead.clone(),
            frame: core.frame.clone(),
            callers: core.callers.clone(),
            modal_calls: core.modal_calls.clone(),
            names: core.names.clone(),
            outputs: core.outputs,
            clocks: core.clocks,
            idle: core.idle,
            switches: core.switches,
            parts: core.parts,
            cycles: core.cycles,
            output_open: core.printed.open,
            settings: core.settings.clone(),
            parameters: core.parameters.clone(),
        }
    }

    fn equals(&self, core: &Executor) -> bool {
        let frames = self.frame.goes_on_like(&core.frame)
            && self.callers.len() == core.callers.len()
            && self.callers.iter().zip(&core.callers).all(|(a, b)| a.goes_on_like(b));
        frames
            && self.state == *core.state
            && self.vars.same(&core.vars)
            && self.offsets == core.offsets
            && self.ahead == core.ahead
            && self.modal_calls == core.modal_calls
            && self.names == core.names
            && (self.outputs, self.clocks, self.idle) == (core.outputs, core.clocks, core.idle)
            && (self.switches, self.parts) == (core.switches, core.parts)
            && self.output_open == core.printed.open
            && (&self.settings, &self.parameters) == (&core.settings, &core.parameters)
            // M99 of the main program counts only where the count ends the run.
            && (core.settings.cycles.is_none() || self.cycles == core.cycles)
    }
}
