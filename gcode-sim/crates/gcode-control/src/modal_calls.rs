//! G66, G66.1 and G67: macro calls that wait for moves, or are made by every block.
use super::Executor;
use super::evaluation::ExecResult;
use super::frames::{CallOrigins, Frame, FrameKind};
use super::plan::BlockFlow;
use super::variables::{Locals, Value};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{CallCode, ProgramId, Words};
use gcode_lang::source::Span;

/// G66: waits for moves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModalCall {
    pub(super) program: ProgramId,
    pub(super) repeats: u32,
    pub(super) locals: Locals,
    /// G66.1: every block calls, and its words are the arguments.
    pub(super) is_every_block: bool,
    /// The kind of code that stored it, where it is no G66 or G66.1.
    pub(super) origins: CallOrigins,
}

impl Executor {
    /// Whether a block with motion may make the modal call that waits for it.
    pub(super) fn check_call_after_move(&self) -> Result<(), Alarm> {
        self.triggered_call().map_or(Ok(()), |_| self.check_levels(true))
    }

    /// After a block with motion: the last modal call that this program's moves can trigger.
    #[inline]
    pub(super) fn call_after_move(&mut self, block: Span) {
        if let Some(index) = self.triggered_call() {
            self.make_modal_call(index, block);
        }
    }

    #[inline(never)]
    fn make_modal_call(&mut self, index: usize, block: Span) {
        let ModalCall { program, repeats, locals, origins: by_code, .. } = self.modal_calls[index].clone();
        let frame = Frame {
            modal_call_count: index,
            ..self.callee_frame(program, 0, FrameKind::Modal(index), repeats, by_code, block)
        };
        self.vars.push_level(&locals);
        self.push(frame);
    }

    /// What comes first after a move is settled where its block does nothing else with the flow of the program.
    #[inline(always)]
    pub(super) fn check_flow_after_move(&self, flow: &BlockFlow, block: Span) -> ExecResult<()> {
        let what = match flow {
            _ if self.triggered_call().is_none() => return Ok(()),
            BlockFlow::Next | BlockFlow::Return { .. } => return Ok(()),
            BlockFlow::Call(_) => "a modal macro call after a block that both moves and calls",
            BlockFlow::CancelModal => "a modal macro call after a block that moves and has G67",
            BlockFlow::End => "a modal macro call after a block that moves and ends the program",
        };
        let what = format!("{what} (write the move in a block of its own)");
        Err(Alarm::NotSimulated { what }.located_at(block))
    }

    /// The modal call that a block of this program can trigger.
    #[inline]
    fn triggered_call(&self) -> Option<usize> {
        self.frame.modal_call_count.min(self.modal_calls.len()).checked_sub(1)
    }

    /// Under G66.1 a block of words is not executed: its words, G L N P among them, are the macro's arguments.
    /// M99 and G67 stay what they are.
    #[inline]
    pub(super) fn call_by_block(
        &mut self,
        words: &Words,
        number: Option<u32>,
        block: Span,
    ) -> ExecResult<bool> {
        if !self.triggered_call().is_some_and(|i| self.modal_calls[i].is_every_block) {
            return Ok(false);
        }
        self.call_by_words(words, number, block)
    }

    #[inline(never)]
    fn call_by_words(&mut self, words: &Words, number: Option<u32>, block: Span) -> ExecResult<bool> {
        match words.call() {
            Some(call) if matches!(call.kind, CallCode::Cancel | CallCode::Return) => return Ok(false),
            Some(call) => {
                return Err(
                    Alarm::NotSimulated { what: "a call while G66.1 is on".into() }.located_at(call.span)
                );
            }
            None => {}
        }
        let mut locals = self.evaluate_arguments(words, &words.list, true)?;
        if let Some(number) = number {
            locals.set(14, Value::Number(f64::from(number)), 0);
        }
        self.check_levels(true).map_err(|alarm| alarm.located_at(block))?;
        self.block = block;
        self.call_every_block_macro(&locals, block);
        Ok(true)
    }

    /// Calls the macro of G66.1.
    pub(super) fn call_every_block_macro(&mut self, locals: &Locals, block: Span) {
        let Some(index) = self.triggered_call() else { return };
        let ModalCall { program, repeats, origins: by_code, .. } = self.modal_calls[index].clone();
        let frame = Frame {
            modal_call_count: index,
            ..self.callee_frame(program, 0, FrameKind::Macro, repeats, by_code, block)
        };
        self.vars.push_level(locals);
        self.push(frame);
    }

    /// #4012.
    pub(super) fn update_modal_code(&mut self) {
        use gcode_lang::program::modes::ModalCall;
        self.state.modal.call = match self.modal_calls.last() {
            None => ModalCall::Off,
            Some(call) if call.is_every_block => ModalCall::EveryBlock,
            Some(_) => ModalCall::AfterMoves,
        };
    }

    /// G67: the last modal call ends.
    pub(super) fn cancel_modal(&mut self) {
        self.modal_calls.pop();
        self.update_modal_code();
    }
}
