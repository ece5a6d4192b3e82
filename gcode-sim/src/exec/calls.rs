//! Calls and returns: frames, letters to locals, nesting, modal calls.
use std::sync::Arc;

use super::eval::{Checked, at};
use super::plan::{CallKind, CallPlan, Flow, Plan, Target};
use super::vars::{Locals, Value};
use super::words::{Raw, count};
use super::{Control, Core};
use crate::alarm::Alarm;
use crate::motion::{Call, Calls};
use crate::program::{CallOp, CallTarget, Calling, Coded, Library, OpIndex, Program, ProgramId, Words};
use crate::source::{Span, Spanned};

/// One program on the way to the block at hand.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) program: ProgramId,
    pub(super) next: OpIndex,
    pub(super) kind: FrameKind,
    /// Where a repetition starts.
    start: OpIndex,
    /// Passes still to come after this one.
    repeats: u32,
    /// The arguments, for repetitions that set them anew.
    arguments: Option<Box<Locals>>,
    /// The calls that led here.
    pub(super) calls: Calls,
    /// DO1 to DO3 that are open: their first and last operation.
    pub(super) loops: [Option<(OpIndex, OpIndex)>; 3],
    /// How many of the modal calls its moves can trigger.
    modal: usize,
    /// Called by a G or M code: such codes are ordinary ones inside.
    by_code: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrameKind {
    Main,
    Subprogram,
    Macro,
    /// Called by a modal call: its locals go back there when it returns.
    Modal(usize),
}

/// G66: waits for moves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModalCall {
    program: ProgramId,
    repeats: u32,
    locals: Locals,
    /// G66.1: every block calls, and its words are the arguments.
    every: bool,
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
            modal: usize::MAX,
            by_code: false,
        }
    }

    /// Whether two frames lead to the same blocks from here on.
    pub(super) fn goes_on_like(&self, other: &Self) -> bool {
        let Self { program, next, kind, start, repeats, arguments, calls: _, loops, modal, by_code } = self;
        (*program, *next, *kind, *start, *repeats)
            == (other.program, other.next, other.kind, other.start, other.repeats)
            && *arguments == other.arguments
            && (*loops, *modal, *by_code) == (other.loops, other.modal, other.by_code)
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

impl Core {
    /// A parameter-defined G or M code that calls a macro: the block's words are its arguments.
    pub(super) fn call_by_code(&self, program: &Program, words: &Words, plan: &mut Plan) -> Checked<bool> {
        let settings = &self.settings;
        if (settings.g_calls.is_empty() && settings.m_calls.is_empty()) || self.frame().by_code {
            return Ok(false);
        }
        let Some(first) = words.list.first() else { return Ok(false) };
        let Some(raw) = self.raw(program, first)? else { return Ok(false) };
        let number = match first.letter {
            b'M' => {
                let code = at(count(raw, b'M'), first.span)?;
                settings.m_calls.iter().find(|(m, _)| *m == code).map(|(_, program)| *program)
            }
            b'G' => {
                let code = match raw {
                    Raw::Computed(value) => (value * 10.0).round() as u16,
                    Raw::Literal(_) => return Ok(false),
                };
                settings.g_calls.iter().find(|(g, _)| *g == code).map(|(_, program)| *program)
            }
            _ => None,
        };
        let Some(number) = number else { return Ok(false) };
        let locals = self.arguments(program, &words.list[1..], false)?;
        let repeats = match words.list[1..].iter().find(|w| w.letter == b'L') {
            Some(word) => self.coded_count(program, word)?.unwrap_or(1),
            None => 1,
        };
        plan.flow = Flow::Call(Box::new(CallPlan {
            kind: CallKind::Code,
            target: Target::Number(number),
            repeats,
            start: None,
            locals,
            calls_now: true,
            span: first.span,
        }));
        Ok(true)
    }

    fn coded_count(&self, program: &Program, word: &Coded) -> Checked<Option<u32>> {
        let Some(raw) = self.raw(program, word)? else { return Ok(None) };
        at(count(raw, word.letter), word.span).map(Some)
    }

    /// 7. The call or return of a block.
    pub(super) fn prepare_call(&self, program: &Program, call: &CallOp, plan: &mut Plan) -> Checked<()> {
        let kind = match call.kind {
            Calling::Return => {
                let to = match &call.target {
                    CallTarget::Number(word) => self.coded_count(program, word)?,
                    CallTarget::Name(_) | CallTarget::None => None,
                };
                plan.flow = Flow::Return(to);
                return Ok(());
            }
            Calling::Cancel => {
                plan.flow = Flow::CancelModal;
                if self.modal_calls.is_empty() && self.settings.unsure.g67_alarms {
                    return Err(Alarm::CancelWithoutModalCall.at(call.span));
                }
                return Ok(());
            }
            Calling::EveryBlock => CallKind::EveryBlock,
            Calling::Macro => CallKind::Macro,
            Calling::AfterMoves => CallKind::Modal,
            Calling::Subprogram => CallKind::Subprogram,
        };
        let missing = Alarm::ProgramNotNamed.at(call.span);
        let mut repeats = match &call.repeats {
            Some(word) => self.coded_count(program, word)?,
            None => None,
        };
        let target = match &call.target {
            CallTarget::None => return Err(missing),
            CallTarget::Name(name) => Target::Name(name.clone()),
            CallTarget::Number(word) => {
                let number = self.coded_count(program, word)?.ok_or(missing)?;
                // M98 P with more than four digits: repeats in front of a four-digit program number.
                if kind == CallKind::Subprogram && repeats.is_none() && number > 9999 {
                    repeats = Some(number / 10_000);
                    Target::Number(number % 10_000)
                } else {
                    Target::Number(number)
                }
            }
        };
        let start = match &call.start {
            Some(word) => self.coded_count(program, word)?,
            None => None,
        };
        let every = kind == CallKind::EveryBlock;
        let locals = self.arguments(program, &call.arguments, every)?;
        let own = self.settings.unsure.every_block_calls_itself && !call.arguments.is_empty();
        let calls_now = !every || own;
        let repeats = repeats.unwrap_or(1);
        plan.flow = Flow::Call(Box::new(CallPlan {
            kind,
            target,
            repeats,
            start,
            locals,
            calls_now,
            span: call.span,
        }));
        Ok(())
    }
}

impl Control {
    /// Finds the program of a call and checks the nesting, before anything of the block has happened.
    pub(super) fn resolve(&mut self, call: &mut CallPlan, library: &mut impl Library) -> Result<(), Alarm> {
        let program = match &call.target {
            Target::Number(number) => {
                let found = self.memory.fetch(*number, library);
                found.ok_or(Alarm::ProgramNotFound { number: *number })?
            }
            Target::Name(name) => {
                let found = self.memory.find_name(name);
                found.ok_or_else(|| Alarm::FileNotFound { name: name.clone() })?
            }
            Target::Found(program, _) => *program,
        };
        let start = match call.start {
            None => 0,
            Some(number) => {
                let found = self.memory.get(program).find_number(number, 0);
                found.ok_or(Alarm::SequenceNumberNotFound { number })?
            }
        };
        if call.kind != CallKind::Modal && call.calls_now {
            self.core.check_levels(call.kind != CallKind::Subprogram)?;
        }
        call.target = Target::Found(program, start);
        Ok(())
    }
}

impl Core {
    pub(super) fn frame(&self) -> &Frame {
        &self.frames[self.frames.len() - 1]
    }

    pub(super) fn frame_mut(&mut self) -> &mut Frame {
        let last = self.frames.len() - 1;
        &mut self.frames[last]
    }

    fn check_levels(&self, is_macro: bool) -> Result<(), Alarm> {
        if is_macro && self.vars.level() >= self.settings.macro_levels {
            return Err(Alarm::TooManyMacroCalls { limit: self.settings.macro_levels });
        }
        if self.frames.len() > self.settings.call_levels {
            return Err(Alarm::TooManyCalls { limit: self.settings.call_levels });
        }
        Ok(())
    }

    /// Makes a call that [`Control::resolve`] has found.
    pub(super) fn enter(&mut self, call: &CallPlan, block: Span) {
        let Target::Found(program, start) = call.target else { return };
        if call.repeats == 0 {
            return;
        }
        let kind = match call.kind {
            CallKind::Modal | CallKind::EveryBlock => {
                let every = call.kind == CallKind::EveryBlock;
                let locals = call.locals;
                self.modal_calls.push(ModalCall { program, repeats: call.repeats, locals, every });
                self.show_modal_call();
                if call.calls_now && every {
                    self.call_with(&call.locals, block);
                }
                return;
            }
            CallKind::Subprogram => FrameKind::Subprogram,
            CallKind::Macro | CallKind::Code => FrameKind::Macro,
        };
        if kind == FrameKind::Macro {
            self.vars.enter(&call.locals);
        }
        let again = self.settings.unsure.repeats_reset_locals && call.repeats > 1;
        let arguments = again.then(|| Box::new(call.locals));
        let by_code = call.kind == CallKind::Code || self.frame().by_code;
        let modal = self.frame().modal;
        self.push(Frame {
            arguments,
            by_code,
            modal,
            ..self.called(program, start, kind, call.repeats, block)
        });
    }

    fn called(
        &self,
        program: ProgramId,
        start: OpIndex,
        kind: FrameKind,
        repeats: u32,
        block: Span,
    ) -> Frame {
        let calls = Some(Arc::new(Call { from: block, outer: self.frame().calls.clone() }));
        Frame { next: start, kind, start, repeats: repeats.saturating_sub(1), calls, ..Frame::main(program) }
    }

    fn push(&mut self, frame: Frame) {
        self.frames.push(frame);
    }

    /// After a block with motion: the last modal call that this program's moves can trigger.
    pub(super) fn call_after_move(&mut self, block: Span) -> Result<(), Alarm> {
        let Some(index) = self.waiting_call() else { return Ok(()) };
        self.check_levels(true)?;
        let ModalCall { program, repeats, locals, .. } = self.modal_calls[index].clone();
        let frame =
            Frame { modal: index, ..self.called(program, 0, FrameKind::Modal(index), repeats, block) };
        self.vars.enter(&locals);
        self.push(frame);
        Ok(())
    }

    /// The modal call that a block of this program can trigger.
    fn waiting_call(&self) -> Option<usize> {
        self.frame().modal.min(self.modal_calls.len()).checked_sub(1)
    }

    /// Under G66.1 a block of words is not executed: its words, G L N P among them, are the macro's arguments.
    /// M99 and G67 stay what they are.
    pub(super) fn call_by_block(
        &mut self,
        program: &Program,
        words: &Words,
        number: Option<u32>,
        block: Span,
    ) -> Checked<bool> {
        if self.modal_calls.is_empty() || !self.waiting_call().is_some_and(|i| self.modal_calls[i].every) {
            return Ok(false);
        }
        match &words.call {
            Some(call) if matches!(call.kind, Calling::Cancel | Calling::Return) => return Ok(false),
            Some(call) => {
                return Err(Alarm::NotSimulated { what: "a call while G66.1 is on".into() }.at(call.span));
            }
            None => {}
        }
        let mut locals = self.arguments(program, &words.list, true)?;
        if let Some(number) = number {
            locals[14] = Value::Number(f64::from(number));
        }
        self.check_levels(true).map_err(|alarm| alarm.at(block))?;
        self.block = block;
        self.call_with(&locals, block);
        Ok(true)
    }

    /// Calls the macro of G66.1.
    fn call_with(&mut self, locals: &Locals, block: Span) {
        let Some(index) = self.waiting_call() else { return };
        let ModalCall { program, repeats, .. } = self.modal_calls[index].clone();
        let frame = Frame { modal: index, ..self.called(program, 0, FrameKind::Macro, repeats, block) };
        self.vars.enter(locals);
        self.push(frame);
    }

    /// #4012.
    fn show_modal_call(&mut self) {
        use crate::program::modes::ModalCall;
        self.state.modal.call = match self.modal_calls.last() {
            None => ModalCall::Off,
            Some(call) if call.every => ModalCall::EveryBlock,
            Some(_) => ModalCall::AfterMoves,
        };
    }

    /// G67: the last modal call ends.
    pub(super) fn cancel_modal(&mut self) {
        self.modal_calls.pop();
        self.show_modal_call();
    }

    /// Back from a subprogram or macro to the program that called it.
    pub(super) fn leave(&mut self) {
        match self.frame().kind {
            FrameKind::Macro => self.vars.leave(),
            FrameKind::Modal(index) => {
                let locals = *self.vars.locals();
                if let Some(call) = self.modal_calls.get_mut(index)
                    && self.settings.unsure.modal_keeps_locals
                {
                    call.locals = locals;
                }
                self.vars.leave();
            }
            FrameKind::Main | FrameKind::Subprogram => {}
        }
        self.frames.pop();
    }

    /// M99 without P in a called program: the next pass, or back.
    pub(super) fn repeat_or_leave(&mut self) {
        let frame = self.frame_mut();
        if frame.repeats == 0 {
            return self.leave();
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
    /// M99, M99 P.
    pub(super) fn go_back(
        &mut self,
        to: Option<u32>,
        span: Span,
    ) -> Result<Option<super::Outcome>, Spanned<Alarm>> {
        let main = self.core.frame().kind == FrameKind::Main;
        if main {
            self.core.cycles += 1;
            if self.core.settings.cycles.is_some_and(|cycles| self.core.cycles >= cycles) {
                return Ok(Some(super::Outcome::End));
            }
        }
        let Some(number) = to else {
            if main {
                self.core.frame_mut().jump(0);
            } else {
                self.core.repeat_or_leave();
            }
            return Ok(None);
        };
        let caller = if main { self.core.frames.len() - 1 } else { self.core.frames.len() - 2 };
        let program = self.memory.get(self.core.frames[caller].program);
        let Some(target) = program.find_number(number, 0) else {
            return Err(Alarm::SequenceNumberNotFound { number }.at(span));
        };
        if !main {
            self.core.leave();
        }
        self.core.frame_mut().jump(target);
        Ok(None)
    }
}
