//! Finds out that a program will never end: the control is again where it was, and nothing has changed.
//!
//! Brent's method of finding cycles: at each jump back what differs soonest (place, variables, position) is held against
//! that of an earlier jump, which is kept for longer and longer. Where they agree the control itself is copied; when it equals
//! its copy one turn later, all that follows repeats. Between such finds a jump costs a few instructions.
use super::block_effects::RunEnd;
use super::executor::Executor;
use super::flow::{Frame, ProgramFlow};
use super::registers::Registers;
use super::variables::Vars;
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
    differing_place: usize,
}

/// Everything that can decide what the program does next; the record of the run, which it only leaves behind, is not there.
#[derive(Debug)]
struct ControlSnapshot {
    registers: Registers,
    flow: ProgramFlow,
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
    fingerprint: Option<Fingerprint>,
    snapshot: Option<Box<ControlSnapshot>>,
    outermost_jump: Option<BackJump>,
    /// Jumps until another moment is kept.
    remaining_jumps: u64,
    /// A clock was read since `seen` was kept.
    has_read_clock: bool,
    /// Nothing has happened since the program was found to wait for a clock.
    is_waiting: bool,
    /// How long the motion had taken then.
    seconds: f64,
    /// How many they were the last time.
    iterations: u64,
    endless_loop: Option<EndlessLoop>,
}

impl LoopDetector {
    /// The loop that was found to run for ever.
    pub(super) fn endless_loop(&self) -> Option<EndlessLoop> {
        self.endless_loop
    }

    /// A run begins, or goes on.
    pub(super) fn reset(&mut self) {
        self.endless_loop = None;
    }

    /// Told of every jump back; ends the run where the program is now known never to leave the loop.
    #[inline(always)]
    pub(super) fn record_jump(&mut self, executor: &mut Executor) {
        if self.is_waiting || executor.registers.clock.has_been_read.get() {
            self.advance_clock(executor);
        }
        if self.snapshot.is_some() {
            self.record_outer_jump(executor);
        }
        if self.remaining_jumps > 0 && self.fingerprint.as_ref().is_some_and(|seen| !seen.may_match(executor))
        {
            self.remaining_jumps -= 1;
        } else {
            self.check(executor);
        }
    }

    /// Looks closely whether the control has come back, and keeps this moment when it is time.
    #[inline(never)]
    fn check(&mut self, executor: &mut Executor) {
        self.endless_loop = None;
        if self.fingerprint.as_mut().is_some_and(|seen| seen.matches(executor)) {
            self.check_revisit(executor);
            if self.endless_loop.is_some() {
                executor.registers.block_effects.end_run(RunEnd::EndlessLoop);
                return;
            }
        }
        if self.remaining_jumps == 0 {
            self.store_fingerprint(executor);
        }
        self.remaining_jumps -= 1;
    }

    /// Keeps this moment instead of an earlier one, for longer.
    #[cold]
    fn store_fingerprint(&mut self, executor: &Executor) {
        self.clear();
        self.fingerprint = Some(Fingerprint::of(executor));
        self.iterations = (self.iterations * 2).max(4);
        self.remaining_jumps = self.iterations;
    }

    /// The control has come to the moment that was kept.
    #[cold]
    fn check_revisit(&mut self, executor: &Executor) {
        match &self.snapshot {
            None => self.snapshot = Some(Box::new(ControlSnapshot::of(executor))),
            // It waits for the clock, which only motion has moved so far.
            Some(copy) if copy.equals(executor) && self.has_read_clock => {
                (self.seconds, self.is_waiting) = (executor.registers.clock.motion_seconds, true);
                self.clear();
            }
            Some(copy) if copy.equals(executor) => {
                let found =
                    |jump: BackJump| EndlessLoop { program: jump.program, to: jump.to, from: jump.from };
                self.endless_loop = self.outermost_jump.map(found);
            }
            Some(_) => self.clear(),
        }
    }

    /// Takes note of a jump that leads further out, or further up, than those since the control was copied.
    #[cold]
    fn record_outer_jump(&mut self, executor: &Executor) {
        let Frame { program, next: to, .. } = executor.flow.frame;
        let callers = executor.flow.callers.len();
        if self.outermost_jump.is_none_or(|w| (callers, to) < (w.callers, w.to)) {
            self.outermost_jump = Some(BackJump { callers, to, program, from: executor.flow.block });
        }
    }

    /// A program that does nothing but wait for a clock is given a millisecond a jump, so that the wait ends.
    #[cold]
    fn advance_clock(&mut self, executor: &mut Executor) {
        let read = executor.registers.clock.has_been_read.take();
        self.has_read_clock |= read;
        if executor.registers.clock.motion_seconds != self.seconds {
            (self.seconds, self.is_waiting) = (executor.registers.clock.motion_seconds, false);
        }
        if read && self.is_waiting {
            executor.registers.clock.idle_seconds += 0.001;
        }
    }

    fn clear(&mut self) {
        (self.fingerprint, self.snapshot, self.outermost_jump, self.has_read_clock) =
            (None, None, None, false);
    }
}

impl Fingerprint {
    fn of(executor: &Executor) -> Self {
        Self {
            program: executor.flow.frame.program,
            next: executor.flow.frame.next,
            callers: executor.flow.callers.len(),
            machine: executor.registers.state.machine,
            vars: executor.registers.variables.clone(),
            differing_place: 0,
        }
    }

    /// Whether nothing that is looked at first differs. What counts turns tells nearly all moments apart.
    #[inline]
    fn may_match(&self, executor: &Executor) -> bool {
        self.machine[0].to_bits() == executor.registers.state.machine[0].to_bits()
            && self.next == executor.flow.frame.next
            && !self.vars.differs_at(self.differing_place, &executor.registers.variables)
    }

    /// Whether the control has come to this moment again.
    fn matches(&mut self, executor: &Executor) -> bool {
        if !self.may_match(executor)
            || self.program != executor.flow.frame.program
            || self.callers != executor.flow.callers.len()
            || self
                .machine
                .0
                .iter()
                .zip(executor.registers.state.machine.0)
                .any(|(a, b)| a.to_bits() != b.to_bits())
        {
            return false;
        }
        let difference = self.vars.difference(&executor.registers.variables);
        self.differing_place = difference.unwrap_or(self.differing_place);
        difference.is_none()
    }
}

impl ControlSnapshot {
    fn of(executor: &Executor) -> Self {
        let Executor { registers, flow, log: _ } = executor;
        Self { registers: registers.clone(), flow: flow.clone() }
    }

    fn equals(&self, executor: &Executor) -> bool {
        let Executor { registers, flow, log: _ } = executor;
        // M99 of the main program counts only where the count ends the run.
        let counts_passes = registers.data.settings.main_program_cycles.is_some();
        self.flow.continues_like(flow, counts_passes) && self.registers.continues_like(registers)
    }
}
