//! Proof that a program never ends: the control is in a state that it has been in before.
//!
//! Brent's algorithm for cycles: at each jump back a fingerprint (block, variables, position) is compared with that of an
//! earlier jump, which is kept for longer and longer. If they match, the control is copied; if it equals its copy one
//! iteration later, all that follows repeats. Between matches a jump costs a few instructions.
use super::executor::Executor;
use super::flow::{CallFrame, ProgramFlow};
use super::outcome::RunEnd;
use super::registers::Registers;
use super::variables::Vars;
use gcode_lang::motion::Position;
use gcode_lang::program::{OpIndex, ProgramId};
use gcode_lang::source::Span;

/// Values that differ between almost any two jumps of a run that ends.
#[derive(Clone, Debug)]
struct Fingerprint {
    program: ProgramId,
    next: OpIndex,
    callers: usize,
    machine: Position,
    vars: Vars,
    /// Index of the variable that differed last.
    differing_index: usize,
}

/// Everything that can decide what the program does next; the record of the run can't.
#[derive(Clone, Debug)]
struct ControlSnapshot {
    registers: Registers,
    flow: ProgramFlow,
}

/// Jump of a loop to its earliest block in the outermost program.
#[derive(Clone, Copy, Debug)]
pub(super) struct BackJump {
    callers: usize,
    pub(super) program: ProgramId,
    /// Block that the program jumps to.
    pub(super) to: OpIndex,
    /// Block that jumps.
    pub(super) from: Span,
}

#[derive(Clone, Debug, Default)]
pub(super) struct LoopDetector {
    fingerprint: Option<Fingerprint>,
    snapshot: Option<Box<ControlSnapshot>>,
    outermost_jump: Option<BackJump>,
    /// Jumps until another fingerprint is kept.
    remaining_jumps: u64,
    /// The program has read a clock since the fingerprint was kept.
    has_read_clock: bool,
    /// The program waits for a clock and does nothing else.
    is_waiting: bool,
    /// Duration of the motion when the wait began.
    seconds: f64,
    /// Number of jumps for which the fingerprint is kept.
    iterations: u64,
    /// Loop that never ends, if one was found since the run began or continued.
    pub(super) endless_loop: Option<BackJump>,
}

impl LoopDetector {
    /// Records a jump back; ends the run if the program provably never leaves the loop.
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

    /// Compares the whole fingerprint, and keeps that of this jump if it is time.
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

    /// Keeps the fingerprint of this jump, for twice as many jumps as the one before.
    #[cold]
    fn store_fingerprint(&mut self, executor: &Executor) {
        self.clear();
        self.fingerprint = Some(Fingerprint::of(executor));
        self.iterations = (self.iterations * 2).max(4);
        self.remaining_jumps = self.iterations;
    }

    /// Compares the control with its copy, or copies it at the first match of the fingerprint.
    #[cold]
    fn check_revisit(&mut self, executor: &Executor) {
        match &self.snapshot {
            None => self.snapshot = Some(Box::new(ControlSnapshot::of(executor))),
            // The program waits for a clock, which only motion has advanced so far.
            Some(copy) if copy.equals(executor) && self.has_read_clock => {
                (self.seconds, self.is_waiting) = (executor.registers.clock.motion_seconds, true);
                self.clear();
            }
            Some(copy) if copy.equals(executor) => self.endless_loop = self.outermost_jump,
            Some(_) => self.clear(),
        }
    }

    /// Keeps the jump if it goes further out, or further up, than those since the control was copied.
    #[cold]
    fn record_outer_jump(&mut self, executor: &Executor) {
        let CallFrame { program, next: to, .. } = executor.flow.frame;
        let callers = executor.flow.callers.len();
        if self.outermost_jump.is_none_or(|jump| (callers, to) < (jump.callers, jump.to)) {
            self.outermost_jump = Some(BackJump { callers, program, to, from: executor.flow.block });
        }
    }

    /// Advances the clock by a millisecond per jump while the program only waits for it, so that the wait ends.
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
        let Executor { registers, flow, log: _ } = executor;
        Self {
            program: flow.frame.program,
            next: flow.frame.next,
            callers: flow.callers.len(),
            machine: registers.state.machine_position,
            vars: registers.variables.clone(),
            differing_index: 0,
        }
    }

    /// Returns false if one of the values that differ most often differs; a loop counter does in nearly all jumps.
    #[inline]
    fn may_match(&self, executor: &Executor) -> bool {
        self.machine[0].to_bits() == executor.registers.state.machine_position[0].to_bits()
            && self.next == executor.flow.frame.next
            && !self.vars.differs_at(self.differing_index, &executor.registers.variables)
    }

    /// Returns true if all values are equal.
    fn matches(&mut self, executor: &Executor) -> bool {
        let Executor { registers, flow, log: _ } = executor;
        if !self.may_match(executor)
            || self.program != flow.frame.program
            || self.callers != flow.callers.len()
            || self.machine.0.map(f64::to_bits) != registers.state.machine_position.0.map(f64::to_bits)
        {
            return false;
        }
        let difference = self.vars.difference(&registers.variables);
        self.differing_index = difference.unwrap_or(self.differing_index);
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
        // The passes of the main program count only if their number ends the run.
        let counts_passes = registers.data.settings.main_program_cycles.is_some();
        self.flow.continues_like(flow, counts_passes) && self.registers.continues_like(registers)
    }
}
