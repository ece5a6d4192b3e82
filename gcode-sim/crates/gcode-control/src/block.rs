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
use super::eval::Checked;
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
    pub(super) fn words(&self, words: &Words, given: &mut BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        let words = self.unskipped(words);
        plan.begin(&self.state);
        let mut calling = None;
        if !self.settings.code_calls.is_empty() {
            if self.macro_by_code(words, plan)? {
                return Ok(());
            }
            calling = self.subprogram_by_code(words)?;
        }
        self.collect(words, calling.as_ref(), given)?;
        self.prepare(words, calling, given, plan)
    }

    /// The words of a block but for those behind a block skip that is on.
    #[inline(always)]
    fn unskipped<'a>(&self, words: &'a Words) -> &'a Words {
        let Some((switch, short)) = words.short() else { return words };
        let is_on = self.skips(*switch);
        self.aftermath.record_note(Note::BlockSkip { switch: (*switch).max(1), is_on });
        if is_on { short } else { words }
    }

    /// Makes the plan of a block of words that are collected. Nothing changes.
    fn prepare(
        &self,
        words: &Words,
        calling: Option<CallingWord>,
        given: &BlockWords,
        plan: &mut BlockPlan,
    ) -> Checked<()> {
        let span = self.block;
        self.beside_return(words)?;
        let act = self.modal_codes(given, plan, span)?;
        if self.has_codes(given, &plan.state) {
            self.codes(given, plan, span)?;
            self.m_codes(given, plan)?;
        }
        let lengthened = self.length(given, plan, span)?;
        match act {
            Some(act) => {
                if lengthened {
                    self.recompute(&mut plan.state);
                }
                self.act(act, given, plan, span)?;
            }
            None => self.motion(given, plan, lengthened, span)?,
        }
        if let Some(call) = words.call() {
            self.prepare_call(words, call, plan)?;
        }
        if let Some(calling) = calling {
            self.plan_calling_word(words, &calling, plan)?;
        }
        if plan.commands_axes {
            plan.state.ended = None;
            self.check_modal_call(&plan.flow, span)?;
        }
        if self.reads_ahead(given, &plan.state) {
            self.look_ahead(act, given, plan, span)?;
        }
        self.check_unread(given, plan)?;
        match &self.settings.stroke {
            Some(stroke) => self.check_stroke(stroke, plan, span),
            None => Ok(()),
        }
    }

    /// Whether a block has anything else than axis words and codes of group 01, or the state depends on D and F alone.
    #[inline]
    fn has_codes(&self, given: &BlockWords, state: &State) -> bool {
        given.has_of(!self.settings.axes.mask())
            || given.has_non_motion_words()
            || given.m_count > 0
            || state.modal.cutter != CutterSide::Off
    }

    /// What nothing has read may still mean something to a control: it isn't passed over in silence. In a block
    /// without axes such words go to the machine builder's logic with his M code.
    #[inline(always)]
    fn check_unread(&self, given: &BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        match given.unread() {
            Some(unread) => self.pass_on(unread, given, plan),
            None => Ok(()),
        }
    }

    #[inline(never)]
    fn pass_on(&self, (letter, span): (char, Span), given: &BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        match plan.passed_on.last() {
            Some(code) if !self.names_axis(given) => {
                plan.notes.push(Note::WordsPassedOn { code: *code, letter });
                Ok(())
            }
            _ => Err(Alarm::NotSimulated { what: format!("{letter} in this block") }.at(span)),
        }
    }

    /// Only N, P and L may stand beside M99 while G66 is on.
    fn beside_return(&self, words: &Words) -> Checked<()> {
        let returns = words.call().is_some_and(|call| call.kind == CallCode::Return);
        if !returns || self.modal_calls.is_empty() {
            return Ok(());
        }
        match words.list.iter().find(|word| word.letter != b'L') {
            Some(word) => Err(Alarm::WordsWithReturn { letter: char::from(word.letter) }.at(word.span)),
            None => Ok(()),
        }
    }

    /// Block skip: whether the switch is on.
    pub(super) fn skips(&self, switch: u8) -> bool {
        self.settings.skip_switches.get(usize::from(switch.max(1)) - 1).copied().unwrap_or(false)
    }
}
