//! A block of words: checked as a whole, then carried out.
//!
//! What one block does, in this order (operator's manual, order of execution in a block; the machine builder
//! decides about M codes, this is the usual choice):
//!  1. modal G codes, F S T D H;
//!  2. tool change, spindle and coolant on;
//!  3. tool length offset;
//!  4. dwell, G10, coordinate systems, reference return, or the move;
//!  5. spindle and coolant off;
//!  6. stop, end;
//!  7. call or return.
//!
//! Most blocks of long programs are plain moves, for which six of these have nothing to do: see [`super::plain_move`].
use super::Executor;
use super::code_calls::CallingWord;
use super::evaluation::ExecResult;
use super::notes::Note;
use super::plan::BlockPlan;
use super::state::State;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::modes::CutterSide;
use gcode_lang::program::{CallCode, Words};
use gcode_lang::source::Span;

impl Executor {
    /// Checks a block of words and makes the plan of it. An alarm leaves no trace.
    pub(super) fn plan_words(
        &self,
        words: &Words,
        block_words: &mut BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        let words = self.without_skipped(words);
        plan.reset(&self.state);
        let mut calling_word = None;
        if !self.settings.code_calls.is_empty() {
            if self.plan_macro_by_code(words, plan)? {
                return Ok(());
            }
            calling_word = self.subprogram_by_code(words)?;
        }
        self.evaluate_words(words, calling_word.as_ref(), block_words)?;
        self.plan_block(words, calling_word, block_words, plan)
    }

    /// The words of a block but for those behind a block skip that is on.
    #[inline(always)]
    fn without_skipped<'a>(&self, words: &'a Words) -> &'a Words {
        let Some((switch, short)) = words.skipped_form() else { return words };
        let is_on = self.is_skip_on(*switch);
        self.block_effects.record_note(Note::BlockSkip { switch: (*switch).max(1), is_on });
        if is_on { short } else { words }
    }

    /// Makes the plan of a block of words that are collected. Nothing changes.
    fn plan_block(
        &self,
        words: &Words,
        calling_word: Option<CallingWord>,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        let span = self.block;
        self.check_words_with_return(words)?;
        let axis_use = self.apply_modal_codes(block_words, plan, span)?;
        if self.has_codes(block_words, &plan.state) {
            self.plan_coded_words(block_words, plan, span)?;
            self.plan_m_codes(block_words, plan)?;
        }
        let has_new_length = self.plan_length(block_words, plan, span)?;
        match axis_use {
            Some(act) => {
                if has_new_length {
                    self.recompute_position(&mut plan.state);
                }
                self.execute_axis_use(act, block_words, plan, span)?;
            }
            None => self.plan_motion(block_words, plan, has_new_length, span)?,
        }
        if let Some(call) = words.call() {
            self.plan_call(words, call, plan)?;
        }
        if let Some(calling) = calling_word {
            self.plan_calling_word(words, &calling, plan)?;
        }
        if plan.commands_axes {
            plan.state.last_end_point = None;
            self.check_flow_after_move(&plan.flow, span)?;
        }
        if self.needs_lookahead(block_words, &plan.state) {
            self.plan_lookahead(axis_use, block_words, plan, span)?;
        }
        self.check_unread(block_words, plan)?;
        match &self.settings.stroke_limits {
            Some(stroke) => self.check_stroke(stroke, plan, span),
            None => Ok(()),
        }
    }

    /// Whether a block has anything else than axis words and codes of group 01, or the state depends on D and F alone.
    #[inline]
    fn has_codes(&self, block_words: &BlockWords, state: &State) -> bool {
        block_words.has_letters(!self.settings.axes.letter_bits())
            || block_words.has_non_motion_words()
            || block_words.m_code_count > 0
            || state.modal.cutter != CutterSide::Off
    }

    /// What nothing has read may still mean something to a control: it isn't passed over in silence. In a block
    /// without axes such words go to the machine builder's logic with his M code.
    #[inline(always)]
    fn check_unread(&self, block_words: &BlockWords, plan: &mut BlockPlan) -> ExecResult<()> {
        match block_words.first_unread() {
            Some(unread) => self.pass_to_machine_builder(unread, block_words, plan),
            None => Ok(()),
        }
    }

    #[inline(never)]
    fn pass_to_machine_builder(
        &self,
        (letter, span): (char, Span),
        block_words: &BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        match plan.auxiliary_codes.last() {
            Some(code) if !self.names_axis(block_words) => {
                plan.notes.push(Note::WordsPassedOn { code: *code, letter });
                Ok(())
            }
            _ => Err(Alarm::NotSimulated { what: format!("{letter} in this block") }.located_at(span)),
        }
    }

    /// Only N, P and L may stand beside M99 while G66 is on.
    fn check_words_with_return(&self, words: &Words) -> ExecResult<()> {
        let returns = words.call().is_some_and(|call| call.kind == CallCode::Return);
        if !returns || self.modal_calls.is_empty() {
            return Ok(());
        }
        match words.list.iter().find(|word| word.letter != b'L') {
            Some(word) => {
                Err(Alarm::WordsWithReturn { letter: char::from(word.letter) }.located_at(word.span))
            }
            None => Ok(()),
        }
    }

    /// Block skip: whether the switch is on.
    pub(super) fn is_skip_on(&self, switch: u8) -> bool {
        self.settings.skip_switches.get(usize::from(switch.max(1)) - 1).copied().unwrap_or(false)
    }
}
