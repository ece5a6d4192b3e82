//! Finds out that a program will never end: the control is again where it was, and nothing has changed.
//!
//! Brent's method of finding cycles: at each jump back a fingerprint of the control is held against one from an
//! earlier jump, which is kept for longer and longer. Where they agree the control itself is copied; when it equals
//! its copy one turn later, all that follows repeats. Between such finds a jump costs a few instructions.
use super::Core;
use super::ahead::Ahead;
use super::frames::Frame;
use super::modal_calls::ModalCall;
use super::offsets::Offsets;
use super::state::State;
use super::vars::Vars;
use crate::control::{ParameterPlace, Settings};
use crate::program::{OpIndex, ProgramId};
use crate::source::Span;

/// What differs between almost any two moments of a run that ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fingerprint {
    program: ProgramId,
    next: OpIndex,
    frames: usize,
    values: u64,
}

/// Everything that can decide what the program does next; what it only leaves behind (time, counts, stops, lines
/// printed) is not there.
#[derive(Debug)]
struct Copy {
    state: State,
    vars: Vars,
    offsets: Offsets,
    ahead: Ahead,
    frames: Vec<Frame>,
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
    parameters: std::collections::BTreeMap<ParameterPlace, f64>,
}

/// The jump that the loop is told by: the one to the earliest block of the outermost program.
#[derive(Clone, Copy, Debug)]
struct Jump {
    frames: usize,
    to: OpIndex,
    program: ProgramId,
    from: Span,
}

/// A loop that was found to run for ever.
#[derive(Clone, Copy, Debug)]
pub(super) struct Endless {
    pub(super) program: ProgramId,
    /// The block it comes back to.
    pub(super) to: OpIndex,
    /// The block that jumps there.
    pub(super) from: Span,
}

#[derive(Debug, Default)]
pub(super) struct Watch {
    seen: Option<Fingerprint>,
    copy: Option<Box<Copy>>,
    widest: Option<Jump>,
    /// Jumps until another fingerprint is kept.
    left: u64,
    /// A clock was read since the fingerprint was kept.
    clock_read: bool,
    /// Nothing has happened since the program was found to wait for a clock.
    waiting: bool,
    seconds: f64,
    /// How many they were the last time.
    turns: u64,
}

impl Watch {
    /// Told of every jump back; the answer is the loop that the program is now known never to leave.
    pub(super) fn jumped(&mut self, core: &mut Core) -> Option<Endless> {
        self.wait(core);
        let frame = core.frame();
        let (program, next, frames) = (frame.program, frame.next, core.frames.len());
        if self.copy.is_some() {
            let wider = |w: Jump| (frames, next) < (w.frames, w.to);
            if self.widest.is_none_or(wider) {
                self.widest = Some(Jump { frames, to: next, program, from: core.block });
            }
        }
        let print = Fingerprint { program, next, frames, values: core.vars.digest() ^ core.place_digest() };
        if self.seen == Some(print) {
            match &self.copy {
                None => self.copy = Some(Box::new(Copy::of(core))),
                // It waits for the clock, which only motion has moved so far.
                Some(copy) if copy.equals(core) && self.clock_read => {
                    self.waiting = true;
                    self.forget();
                }
                Some(copy) if copy.equals(core) => {
                    let jump = self.widest?;
                    return Some(Endless { program: jump.program, to: jump.to, from: jump.from });
                }
                Some(_) => self.forget(),
            }
        }
        if self.left == 0 {
            self.forget();
            self.seen = Some(print);
            self.turns = (self.turns * 2).max(4);
            self.left = self.turns;
        }
        self.left -= 1;
        None
    }

    /// A program that does nothing but wait for a clock is given a millisecond a jump, so that the wait ends.
    fn wait(&mut self, core: &mut Core) {
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

impl Copy {
    fn of(core: &Core) -> Self {
        Self {
            state: *core.state,
            vars: core.vars.clone(),
            offsets: core.offsets.clone(),
            ahead: core.ahead.clone(),
            frames: core.frames.clone(),
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

    fn equals(&self, core: &Core) -> bool {
        let frames = self.frames.len() == core.frames.len()
            && self.frames.iter().zip(&core.frames).all(|(a, b)| a.goes_on_like(b));
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

impl Core {
    fn place_digest(&self) -> u64 {
        self.state.machine.0.iter().fold(0, |digest: u64, axis| digest.rotate_left(7) ^ axis.to_bits())
    }
}
