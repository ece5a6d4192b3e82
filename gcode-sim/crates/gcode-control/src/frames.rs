//! The programs on the way to the block at hand: frames, nesting, returns.
use std::sync::Arc;

use super::run::RunEnd;
use super::variables::Locals;
use super::{Control, Executor};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Call, CallChain};
use gcode_lang::program::{OpIndex, ProgramId};
use gcode_lang::source::Span;

/// One program on the way to the block at hand.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) program: ProgramId,
    pub(super) next: OpIndex,
    pub(super) kind: FrameKind,
    /// Where a repetition starts.
    pub(super) start: OpIndex,
    /// Passes still to come after this one.
    pub(super) repeats: u32,
    /// The arguments, for repetitions that set them anew.
    pub(super) arguments: Option<Box<Locals>>,
    /// The calls that led here.
    pub(super) calls: CallChain,
    /// DO1 to DO3 that are open: their first and last operation.
    pub(super) loops: [Option<(OpIndex, OpIndex)>; 3],
    /// How many of the modal calls its moves can trigger.
    pub(super) modal_call_count: usize,
    pub(super) origins: CallOrigins,
    /// Called by M198, itself or one of its callers.
    pub(super) is_external: bool,
}

/// The kinds of codes that a program was called by, itself or one of its callers: inside it they are ordinary ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct CallOrigins {
    pub(super) has_g_code: bool,
    /// M, T, S, B and the addresses of 6090 and 6091.
    pub(super) has_other_code: bool,
}

impl CallOrigins {
    fn merged_with(self, more: Self) -> Self {
        Self {
            has_g_code: self.has_g_code || more.has_g_code,
            has_other_code: self.has_other_code || more.has_other_code,
        }
    }

    /// Whether a code still calls: GMP 6008#6 lets G codes call where another kind has called, and the other way round.
    pub(super) fn allows_call(self, is_g_code: bool, allows_nested_calls: bool) -> bool {
        match (allows_nested_calls, is_g_code) {
            (false, _) => self == Self::default(),
            (true, true) => !self.has_g_code,
            (true, false) => !self.has_other_code,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrameKind {
    Main,
    Subprogram,
    Macro,
    /// Called by a modal call: its locals go back there when it returns.
    Modal(usize),
}

impl Frame {
    pub(super) fn main(program: ProgramId) -> Self {
        Self {
            program,
            next: 0,
            kind: FrameKind::Main,
            start: 0,
            repeats: 0,
            arguments: None,
            calls: None,
            loops: [None; 3],
            modal_call_count: usize::MAX,
            origins: CallOrigins::default(),
            is_external: false,
        }
    }

    /// Whether two frames lead to the same blocks from here on.
    pub(super) fn continues_like(&self, other: &Self) -> bool {
        let Self {
            program,
            next,
            kind,
            start,
            repeats,
            arguments,
            calls: _,
            loops,
            modal_call_count: modal,
            origins: by_code,
            is_external: external,
        } = self;
        (*program, *next, *kind, *start, *repeats)
            == (other.program, other.next, other.kind, other.start, other.repeats)
            && *arguments == other.arguments
            && (*loops, *modal) == (other.loops, other.modal_call_count)
            && (*by_code, *external) == (other.origins, other.is_external)
    }

    /// Goes to an operation and leaves the loops that it is not in.
    pub(super) fn jump(&mut self, to: OpIndex) {
        self.next = to;
        for open in &mut self.loops {
            if open.is_some_and(|(first, last)| !(first..=last).contains(&to)) {
                *open = None;
            }
        }
    }
}

impl Executor {
    pub(super) fn check_levels(&self, is_macro: bool) -> Result<(), Alarm> {
        if is_macro && self.vars.level() >= self.settings.macro_levels {
            return Err(Alarm::TooManyMacroCalls { limit: self.settings.macro_levels });
        }
        if self.callers.len() >= self.settings.call_levels {
            return Err(Alarm::TooManyCalls { limit: self.settings.call_levels });
        }
        Ok(())
    }

    pub(super) fn callee_frame(
        &self,
        program: ProgramId,
        start: OpIndex,
        kind: FrameKind,
        repeats: u32,
        by_code: CallOrigins,
        block: Span,
    ) -> Frame {
        let calls = Some(Arc::new(Call { calling_block: block, outer_calls: self.frame.calls.clone() }));
        let by_code = self.frame.origins.merged_with(by_code);
        Frame {
            next: start,
            kind,
            start,
            repeats: repeats.saturating_sub(1),
            calls,
            origins: by_code,
            ..Frame::main(program)
        }
    }

    pub(super) fn push(&mut self, frame: Frame) {
        self.callers.push(std::mem::replace(&mut self.frame, frame));
    }

    /// Back from a subprogram or macro to the program that called it.
    pub(super) fn pop(&mut self) {
        match self.frame.kind {
            FrameKind::Macro => self.vars.pop_level(),
            FrameKind::Modal(index) => {
                let locals = self.vars.locals();
                if let Some(call) = self.modal_calls.get_mut(index)
                    && self.settings.undocumented.modal_keeps_locals
                {
                    call.locals = locals;
                }
                self.vars.pop_level();
            }
            FrameKind::Main | FrameKind::Subprogram => {}
        }
        if let Some(caller) = self.callers.pop() {
            self.frame = caller;
        }
    }

    /// M99 without P in a called program: the next pass, or back.
    pub(super) fn repeat_or_pop(&mut self) {
        let frame = &mut self.frame;
        if frame.repeats == 0 {
            return self.pop();
        }
        frame.repeats -= 1;
        let start = frame.start;
        frame.loops = [None; 3];
        frame.next = start;
        if let Some(arguments) = frame.arguments.clone() {
            self.vars.set_locals(&arguments);
        }
    }
}

impl Control {
    /// Where M99 P leads, before anything of its block has happened; `None` where it leads nowhere.
    pub(super) fn find_return(&self, number: Option<u32>) -> Result<Option<OpIndex>, Alarm> {
        let Some(number) = number.filter(|_| !self.is_last_cycle()) else { return Ok(None) };
        let program = self.memory.get(self.return_frame().program);
        let found = program.find_number(number, 0);
        found.map(Some).ok_or(Alarm::SequenceNumberNotFound { number })
    }

    /// Whether M99 of the main program ends the run.
    fn is_last_cycle(&self) -> bool {
        let last = self
            .executor
            .settings
            .main_program_cycles
            .is_some_and(|cycles| self.executor.cycles + 1 >= cycles);
        last && self.executor.frame.kind == FrameKind::Main
    }

    /// The frame in which the run goes on after M99.
    fn return_frame(&self) -> &Frame {
        match self.executor.frame.kind {
            FrameKind::Main => &self.executor.frame,
            _ => self.executor.callers.last().unwrap_or(&self.executor.frame),
        }
    }

    /// M99, and M99 P with its number and the place that [`Control::find_return`] has found.
    pub(super) fn return_to(&mut self, to: Option<(u32, OpIndex)>) -> Option<RunEnd> {
        let is_main = self.executor.frame.kind == FrameKind::Main;
        let ends_run = self.is_last_cycle();
        if is_main {
            self.executor.cycles += 1;
        }
        if ends_run {
            return Some(RunEnd::ProgramEnd);
        }
        let Some((number, target)) = to else {
            if is_main {
                self.executor.frame.jump(0);
            } else {
                self.executor.repeat_or_pop();
            }
            return None;
        };
        let program = self.memory.get(self.return_frame().program);
        if !is_main {
            self.executor.pop();
        }
        self.executor.note_ambiguous_jump(program, number, target);
        self.executor.frame.jump(target);
        None
    }
}
