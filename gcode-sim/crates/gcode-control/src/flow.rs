//! Position in the programs: the current block, its frame, and the call stack.
use std::sync::Arc;

use super::variables::Locals;
use gcode_lang::motion::{Backtrace, Call, CallChain};
use gcode_lang::program::{OpIndex, ProgramId};
use gcode_lang::source::Span;

/// Current block, its frame, and the frames of its callers.
#[derive(Clone, Debug)]
pub(super) struct ProgramFlow {
    /// Block that began last.
    pub(super) block: Span,
    /// CallFrame of the current program.
    pub(super) frame: CallFrame,
    /// Frames of its callers, the main program's first.
    pub(super) callers: Vec<CallFrame>,
    pub(super) modal_calls: Vec<ModalMacro>,
    /// Number of M99 executed in the main program.
    pub(super) main_passes: u32,
}

impl ProgramFlow {
    pub(super) fn new(main: ProgramId) -> Self {
        let frame = CallFrame::main(main);
        Self { block: Span::default(), frame, callers: Vec::new(), modal_calls: Vec::new(), main_passes: 0 }
    }

    /// Returns the current block and the calls that led to it.
    pub(super) fn backtrace(&self) -> Backtrace {
        Backtrace { block: self.block, calls: self.frame.calls.clone() }
    }

    /// Returns true if the same blocks follow; `counts_passes` if the number of main program passes ends the run.
    pub(super) fn continues_like(&self, other: &Self, counts_passes: bool) -> bool {
        let Self { block: _, frame, callers, modal_calls, main_passes } = self;
        frame.continues_like(&other.frame)
            && callers.len() == other.callers.len()
            && callers.iter().zip(&other.callers).all(|(a, b)| a.continues_like(b))
            && *modal_calls == other.modal_calls
            && (!counts_passes || *main_passes == other.main_passes)
    }
}

/// One program of the call stack.
#[derive(Clone, Debug)]
pub(super) struct CallFrame {
    pub(super) program: ProgramId,
    pub(super) next: OpIndex,
    pub(super) kind: FrameKind,
    /// Operation at which a repetition starts.
    pub(super) start: OpIndex,
    /// Passes after this one.
    pub(super) repeats: u32,
    /// Arguments, if every repetition sets them again.
    pub(super) arguments: Option<Box<Locals>>,
    /// Calls that led here.
    pub(super) calls: CallChain,
    /// First and last operation of the open loops DO1 to DO3.
    pub(super) loops: [Option<(OpIndex, OpIndex)>; 3],
    /// Number of modal calls that its moves can trigger.
    pub(super) modal_call_count: usize,
    pub(super) origins: CallOrigins,
    /// M198 has called it or one of its callers.
    pub(super) is_external: bool,
}

/// Kinds of codes that have called a program or one of its callers: inside it they are ordinary codes.
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

    /// Returns true if a code calls: GMP 6008#6 lets G codes call after another kind has called, and the other way round.
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
    /// Macro of the modal call with this index, which gets its locals back.
    Modal(usize),
}

impl CallFrame {
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

    /// Returns true if the same blocks follow two frames.
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
            modal_call_count,
            origins,
            is_external,
        } = self;
        (*program, *next, *kind, *start, *repeats)
            == (other.program, other.next, other.kind, other.start, other.repeats)
            && (arguments, loops, modal_call_count)
                == (&other.arguments, &other.loops, &other.modal_call_count)
            && (*origins, *is_external) == (other.origins, other.is_external)
    }

    /// Jumps to an operation and closes the loops that don't contain it.
    pub(super) fn jump(&mut self, to: OpIndex) {
        self.next = to;
        for open in &mut self.loops {
            if open.is_some_and(|(first, last)| !(first..=last).contains(&to)) {
                *open = None;
            }
        }
    }
}

impl ProgramFlow {
    /// Returns the frame of a program that the current block calls.
    pub(super) fn callee_frame(
        &self,
        program: ProgramId,
        kind: FrameKind,
        repeats: u32,
        origins: CallOrigins,
    ) -> CallFrame {
        let calls = Call { calling_block: self.block, outer_calls: self.frame.calls.clone() };
        CallFrame {
            kind,
            repeats: repeats.saturating_sub(1),
            calls: Some(Arc::new(calls)),
            origins: self.frame.origins.merged_with(origins),
            ..CallFrame::main(program)
        }
    }

    pub(super) fn push(&mut self, frame: CallFrame) {
        self.callers.push(std::mem::replace(&mut self.frame, frame));
    }

    /// Returns the index of the modal call that a block of this program triggers.
    #[inline]
    pub(super) fn triggered_call(&self) -> Option<usize> {
        self.frame.modal_call_count.min(self.modal_calls.len()).checked_sub(1)
    }
}

/// Stored macro call of G66 or G66.1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModalMacro {
    pub(super) program: ProgramId,
    pub(super) repeats: u32,
    pub(super) locals: Locals,
    /// G66.1: every block calls, with its words as arguments.
    pub(super) is_every_block: bool,
    /// Kind of code that has stored it, other than G66 and G66.1.
    pub(super) origins: CallOrigins,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::VACANT;

    fn modal_call() -> ModalMacro {
        let origins = CallOrigins::default();
        ModalMacro { program: ProgramId(1), repeats: 1, locals: VACANT, is_every_block: false, origins }
    }

    #[test]
    fn a_call_keeps_its_calling_block() {
        let mut flow = ProgramFlow::new(ProgramId(0));
        let from = Span { start: 3, end: 8, ..Span::default() };
        flow.block = from;
        let frame = flow.callee_frame(ProgramId(1), FrameKind::Subprogram, 2, CallOrigins::default());
        assert_eq!(frame.repeats, 1, "passes after this one");
        flow.push(frame);
        assert_eq!((flow.callers.len(), flow.frame.program), (1, ProgramId(1)));
        assert_eq!(flow.backtrace().calls.map(|call| call.calling_block), Some(from));
    }

    #[test]
    fn a_modal_call_is_triggered_by_the_blocks_of_its_caller_only() {
        let mut flow = ProgramFlow::new(ProgramId(0));
        assert_eq!(flow.triggered_call(), None);
        flow.modal_calls.push(modal_call());
        assert_eq!(flow.triggered_call(), Some(0));
        flow.frame.modal_call_count = 0;
        assert_eq!(flow.triggered_call(), None, "the macro of the first modal call triggers none");
    }

    #[test]
    fn passes_of_the_main_program_count_if_they_end_the_run() {
        let flow = ProgramFlow::new(ProgramId(0));
        let later =
            ProgramFlow { main_passes: 1, block: Span { start: 9, ..Span::default() }, ..flow.clone() };
        assert!(flow.continues_like(&later, false));
        assert!(!flow.continues_like(&later, true));
        let calls = ProgramFlow { modal_calls: vec![modal_call()], ..flow.clone() };
        assert!(!flow.continues_like(&calls, false));
    }
}
