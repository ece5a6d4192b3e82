//! Lowering of blocks of words: codes are looked up, calls separated, values left for the run.
use super::DialectSyntax;
use super::bytecode::{Bytecode, Instruction, Operand, Slot};
use super::g_codes::{self, RowLookup};
use super::lowering::{ExprContext, Lowering};
use super::modes::ModalCall;
use crate::alarm::{Alarm, LocatedAlarm};
use crate::source::Span;
use crate::syntax::ast::{AX, Decimal, Expr, Item, Word, WordValue};

/// G codes × 10 of calls; those of the modal calls are also their states.
pub(super) const MACRO_CALL: u32 = 650;
const MODAL_CALL: u32 = ModalCall::AfterMoves.code();
const EVERY_BLOCK_CALL: u32 = ModalCall::EveryBlock.code();
const MODAL_CALL_END: u32 = ModalCall::Off.code();

/// Returns true for the G code × 10 of a call.
#[inline]
pub(super) fn is_call(code: u32) -> bool {
    matches!(code, MACRO_CALL | MODAL_CALL | EVERY_BLOCK_CALL | MODAL_CALL_END)
}

/// Words of one block.
#[derive(Clone, Debug, Default)]
pub struct Words {
    /// Words in the order written, without those of a call.
    pub list: Vec<LoweredWord>,
    /// Content that blocks of numbers lack, so that their reuse only clears the list.
    uncommon: Option<Box<UncommonWords>>,
}

/// Content that few blocks of words have.
#[derive(Clone, Debug, Default)]
struct UncommonWords {
    call: Option<CallOp>,
    /// Switch of `/n` inside the block, and the words left while it is on.
    form_if_skipped: Option<(u8, Words)>,
    punched_value: Option<u64>,
    comment_length: Option<u32>,
    /// Code of the words, indexed by [`WordOperand::Code`].
    codes: Vec<Bytecode>,
    /// Axis numbers, indexed by [`LoweredWord::axis`].
    axes: Vec<Operand>,
}

/// Word ready for evaluation.
#[derive(Clone, Copy, Debug)]
pub struct LoweredWord {
    /// Letter in upper case.
    pub letter: u8,
    /// Index of the axis number of `AX[…]`, see [`Words::axis`].
    pub axis: Option<u32>,
    /// True for `,R` and `,C`.
    pub comma: bool,
    /// Value.
    pub value: WordOperand,
    /// Span of the word.
    pub span: Span,
}

/// Use that a block makes of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WordUse {
    /// Word outside a call.
    Plain,
    /// Whole number of a call: its program, its start, its repeats.
    Count,
    /// Argument of a macro call.
    Argument,
}

/// Value of a word.
#[derive(Clone, Copy, Debug)]
pub enum WordOperand {
    /// Number as written; increment and unit are applied at run time.
    Literal(Decimal),
    /// G code × 10 written as a number, with its meaning on each control.
    G(u32, RowLookup),
    /// Constant expression; the control rounds it.
    Number(f64),
    /// `#n` with a literal n.
    Variable {
        /// Variable.
        slot: Slot,
        /// Span of the expression.
        span: Span,
    },
    /// Index of the code in its block, see [`Words::code`].
    Code(u32),
}

/// Kind of a call or return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallCode {
    /// G65, macro call.
    Macro,
    /// G66, modal macro call after moves.
    AfterMoves,
    /// G66.1, modal macro call by every block.
    EveryBlock,
    /// G67, end of a modal call.
    Cancel,
    /// M98, subprogram call.
    Subprogram,
    /// M198, call of a file on the device.
    File,
    /// M97 P, call of a part of the same program.
    Local,
    /// M99, return.
    Return,
}

/// Program or block that a call goes to.
#[derive(Clone, Debug)]
pub enum CallTarget {
    /// Number in P.
    Number(LoweredWord),
    /// Program name.
    Name(String),
    /// No P.
    None,
}

/// Call or return.
#[derive(Clone, Debug)]
pub struct CallOp {
    /// Kind of call.
    pub kind: CallCode,
    /// P: the program, or the sequence number of `M99 P`.
    pub target: CallTarget,
    /// L.
    pub repeats: Option<LoweredWord>,
    /// Sequence number to start at: Q of M98, H of M98 without P and Q, or P of M97.
    pub start: Option<LoweredWord>,
    /// Arguments of a macro call in the order written.
    pub arguments: Vec<LoweredWord>,
    /// Span of the call's code.
    pub span: Span,
}

impl CallOp {
    fn new(kind: CallCode, span: Span) -> Self {
        Self { kind, target: CallTarget::None, repeats: None, start: None, arguments: Vec::new(), span }
    }
}

/// G47 × 10: on a Haas the comment of its block is engraved.
const ENGRAVING: u32 = 470;

impl Words {
    fn new(list: Vec<LoweredWord>, call: Option<CallOp>) -> Self {
        let uncommon =
            call.map(|call| Box::new(UncommonWords { call: Some(call), ..UncommonWords::default() }));
        Self { list, uncommon }
    }

    /// Returns the list, emptied for the words of another block.
    #[inline]
    pub(super) fn cleared_list(&mut self) -> &mut Vec<LoweredWord> {
        self.uncommon = None;
        self.list.clear();
        &mut self.list
    }

    fn uncommon_mut(&mut self) -> &mut UncommonWords {
        self.uncommon.get_or_insert_default()
    }

    /// Keeps the number of characters in the comment of a block with G47.
    pub(super) fn keep_text_length(&mut self, length: usize) {
        if self.list.iter().any(|word| matches!(word.value, WordOperand::G(ENGRAVING, _))) {
            self.uncommon_mut().comment_length = Some(length as u32);
        }
    }

    /// Returns the number of characters in the comment of a block with G47, the text that a Haas engraves.
    pub fn comment_length(&self) -> Option<u32> {
        self.uncommon.as_ref()?.comment_length
    }

    /// Keeps the sixteen hexadecimal digits in the comment of the block.
    pub(super) fn set_punched_value(&mut self, value: u64) {
        self.uncommon_mut().punched_value = Some(value);
    }

    /// Returns true if the block has neither a call nor an inner skip.
    #[inline]
    pub fn is_plain(&self) -> bool {
        self.uncommon
            .as_ref()
            .is_none_or(|uncommon| uncommon.call.is_none() && uncommon.form_if_skipped.is_none())
    }

    /// Iterates over the G codes written as numbers, each with its meaning on each control.
    pub fn g_codes(&self) -> impl Iterator<Item = RowLookup> + '_ {
        self.list.iter().filter_map(|word| match word.value {
            WordOperand::G(_, found) => Some(found),
            WordOperand::Literal(_)
            | WordOperand::Number(_)
            | WordOperand::Variable { .. }
            | WordOperand::Code(_) => None,
        })
    }

    /// Calls `each` with every word that is evaluated, those of a call included, to change its value.
    pub fn for_each_word(&mut self, mut each: impl FnMut(WordUse, &mut LoweredWord)) {
        self.list.iter_mut().for_each(|word| each(WordUse::Plain, word));
        let Some(call) = self.uncommon.as_mut().and_then(|uncommon| uncommon.call.as_mut()) else { return };
        let target = match &mut call.target {
            CallTarget::Number(word) => Some(word),
            CallTarget::Name(_) | CallTarget::None => None,
        };
        target.into_iter().chain(&mut call.start).chain(&mut call.repeats).for_each(|word| {
            each(WordUse::Count, word);
        });
        call.arguments.iter_mut().for_each(|word| each(WordUse::Argument, word));
    }

    /// Returns the call of the block.
    pub fn call(&self) -> Option<&CallOp> {
        self.uncommon.as_ref()?.call.as_ref()
    }

    /// Returns the call of the block for a change of its target.
    pub(super) fn call_mut(&mut self) -> Option<&mut CallOp> {
        self.uncommon.as_mut()?.call.as_mut()
    }

    /// Returns the switch of `/n` inside the block, and the words left while it is on.
    pub fn form_if_skipped(&self) -> Option<&(u8, Self)> {
        self.uncommon.as_ref()?.form_if_skipped.as_ref()
    }

    /// Returns the value of the sixteen hexadecimal digits in the comment: the data of a punched `G10 L85
    /// P500`.
    pub fn punched_value(&self) -> Option<u64> {
        self.uncommon.as_ref()?.punched_value
    }

    /// Returns the code of a word's value.
    pub fn code(&self, index: u32) -> &[Instruction] {
        self.uncommon.as_ref().map_or(&[], |uncommon| &uncommon.codes[index as usize])
    }

    /// Returns the axis number of a word.
    pub fn axis(&self, index: u32) -> Option<&Operand> {
        self.uncommon.as_ref()?.axes.get(index as usize)
    }
}

impl Lowering {
    /// Lowers a block of words; `skips` are its inner switches with their positions among the items.
    pub(super) fn lower_words(
        &mut self,
        items: &[Item],
        skips: &[(u8, usize)],
    ) -> Result<Words, LocatedAlarm> {
        let mut form_if_skipped = None;
        if let Some(((switch, index), before)) = skips.split_last() {
            form_if_skipped = Some((*switch, self.lower_words(&items[..*index], before)?));
        }
        (self.codes, self.axes) = (Vec::new(), Vec::new());
        let mut words = self.lower_list(items)?;
        let (codes, axes) = (std::mem::take(&mut self.codes), std::mem::take(&mut self.axes));
        if form_if_skipped.is_some() || !codes.is_empty() || !axes.is_empty() {
            let uncommon = words.uncommon_mut();
            (uncommon.form_if_skipped, uncommon.codes, uncommon.axes) = (form_if_skipped, codes, axes);
        }
        Ok(words)
    }

    fn lower_list(&mut self, items: &[Item]) -> Result<Words, LocatedAlarm> {
        let words =
            items.iter().filter_map(|item| if let Item::Word(word) = item { Some(word) } else { None });
        let mut list = Vec::with_capacity(items.len());
        // Macro calls begin with a G code, all other calls with an M code; names occur in calls only.
        let (mut by_g, mut by_m) = (false, false);
        for word in words.clone() {
            let lowered = self.lower_word(word)?;
            by_g |= matches!(lowered.value, WordOperand::G(code, _) if is_call(code));
            by_m |= lowered.letter == b'M' || matches!(word.value, WordValue::Name(_));
            list.push(lowered);
        }
        match (by_g, by_m) {
            (false, false) => return Ok(Words::new(list, None)),
            (false, true) => return subprogram(list, words),
            (true, _) => {}
        }
        const CALLS: [(u32, CallCode); 4] = [
            (MACRO_CALL, CallCode::Macro),
            (MODAL_CALL, CallCode::AfterMoves),
            (EVERY_BLOCK_CALL, CallCode::EveryBlock),
            (MODAL_CALL_END, CallCode::Cancel),
        ];
        for (code, kind) in CALLS {
            let is_call_code = |word: &LoweredWord| matches!(word.value, WordOperand::G(c, _) if c == code);
            let Some(at) = list.iter().position(is_call_code) else { continue };
            let span = list[at].span;
            self.record_syntax(DialectSyntax::GCodeCall(code), span);
            if kind != CallCode::Cancel {
                if at > 0 {
                    check_codes_before_call(&list[..at])?;
                    self.record_syntax(DialectSyntax::CodesBeforeCall, list[0].span);
                }
                return macro_call(list, at, kind, words);
            }
            list.remove(at);
            return Ok(Words::new(list, Some(CallOp::new(kind, span))));
        }
        subprogram(list, words)
    }

    fn lower_word(&mut self, word: &Word) -> Result<LoweredWord, LocatedAlarm> {
        let letter = word.address.letter;
        let value = match &word.value {
            WordValue::Literal(number) if letter == b'G' && number.negative => {
                return Err(Alarm::IllegalMinus { letter: 'G' }.located_at(word.span));
            }
            WordValue::Literal(number) => literal(letter, *number).ok_or_else(|| {
                Alarm::ImproperGCode { code: number.value().to_string(), other: None }.located_at(word.span)
            })?,
            // All axes have the same increment.
            WordValue::Expr(expr) if letter == AX => self.lower_computed_word(expr, b'X')?,
            WordValue::Expr(expr) => self.lower_computed_word(expr, letter)?,
            // The call in the same block uses the name.
            WordValue::Name(_) => {
                self.record_syntax(DialectSyntax::NewWord("<NAME>"), word.span);
                WordOperand::Literal(Decimal { negative: false, digits: 0, places: None })
            }
        };
        let axis = match &word.axis {
            Some(axis) => {
                let axis = self.operand(axis, ExprContext::MACRO)?;
                self.axes.push(axis);
                Some(self.axes.len() as u32 - 1)
            }
            None => None,
        };
        Ok(LoweredWord { letter, axis, comma: word.address.comma, value, span: word.span })
    }

    fn lower_computed_word(&mut self, expr: &Expr, letter: u8) -> Result<WordOperand, LocatedAlarm> {
        Ok(match self.word_value(expr, letter)? {
            Operand::Number(number) => WordOperand::Number(number),
            Operand::Variable { slot, span } => WordOperand::Variable { slot, span },
            Operand::Code(code) => {
                self.codes.push(code);
                WordOperand::Code(self.codes.len() as u32 - 1)
            }
        })
    }
}

/// Returns the operand of a literal; `None` for an impossible G code.
fn literal(letter: u8, number: Decimal) -> Option<WordOperand> {
    if letter == b'G' {
        let code = g_code(number)?;
        return Some(WordOperand::G(code, g_codes::find(code)));
    }
    Some(WordOperand::Literal(number))
}

/// Returns G code × 10 of a literal; `None` with more than one decimal.
#[inline]
pub(super) fn g_code(number: Decimal) -> Option<u32> {
    let tenths = match number.places {
        None => number.digits.checked_mul(10)?,
        Some(places) => {
            let unit = 10_u64.checked_pow(u32::from(places))?;
            let tenths = number.digits.checked_mul(10)?;
            if tenths % unit != 0 {
                return None;
            }
            tenths / unit
        }
    };
    if number.negative { None } else { u32::try_from(tenths).ok() }
}

/// Separates the call of G65, G66 or G66.1; all words after the code are its arguments, those before it stay.
fn macro_call<'a>(
    mut list: Vec<LoweredWord>,
    at: usize,
    kind: CallCode,
    words: impl Iterator<Item = &'a Word>,
) -> Result<Words, LocatedAlarm> {
    let span = list[at].span;
    let arguments = list.split_off(at + 1);
    list.pop();
    let mut call = CallOp::new(kind, span);
    for (lowered, word) in arguments.into_iter().zip(words.skip(at + 1)) {
        match (lowered.letter, &word.value) {
            (b'P', WordValue::Name(name)) => call.target = CallTarget::Name(name.clone()),
            (b'P', _) => call.target = CallTarget::Number(lowered),
            (_, WordValue::Name(_)) => {
                return Err(Alarm::NotAWord { text: "a name without P".into() }.located_at(lowered.span));
            }
            (b'L', _) => call.repeats = Some(lowered),
            (b'G', _) if matches!(lowered.value, WordOperand::G(code, _) if is_call(code) && code != MODAL_CALL_END) =>
            {
                return Err(Alarm::TwoMacroCalls.located_at(lowered.span));
            }
            (b'M', WordValue::Literal(number)) if number.places.is_none() && number.digits == 98 => {
                return Err(Alarm::TwoMacroCalls.located_at(lowered.span));
            }
            (b'G', _) if kind != CallCode::EveryBlock => {
                return Err(Alarm::GAsArgument.located_at(lowered.span));
            }
            _ => call.arguments.push(lowered),
        }
    }
    Ok(Words::new(list, Some(call)))
}

/// Raises the alarm of a word before a macro call that is no code: G other than a call, F, S, T, D, H or M.
fn check_codes_before_call(before: &[LoweredWord]) -> Result<(), LocatedAlarm> {
    for word in before {
        match (word.letter, word.value) {
            (_, WordOperand::G(code, _)) if is_call(code) => {
                return Err(Alarm::TwoMacroCalls.located_at(word.span));
            }
            (b'G' | b'F' | b'S' | b'T' | b'D' | b'H' | b'M', _) => {}
            _ => {
                let what = "words before the macro call".into();
                return Err(Alarm::MacroFormat { what }.located_at(word.span));
            }
        }
    }
    Ok(())
}

/// Separates the call of M97 P, M98, M99 or M198 with its P, L and Q; the other words act first.
fn subprogram<'a>(
    list: Vec<LoweredWord>,
    words: impl Iterator<Item = &'a Word> + Clone,
) -> Result<Words, LocatedAlarm> {
    let has = |letter: u8| words.clone().any(|word| word.address.letter == letter);
    let kind = |word: &Word| match (word.address.letter, &word.value) {
        (b'M', WordValue::Literal(Decimal { negative: false, digits, places: None })) => match digits {
            // M97 without P ends a macro interrupt.
            97 if has(b'P') => Some(CallCode::Local),
            98 => Some(CallCode::Subprogram),
            99 => Some(CallCode::Return),
            198 => Some(CallCode::File),
            _ => None,
        },
        _ => None,
    };
    let mut calls = words.clone().filter_map(|word| Some((word, kind(word)?)));
    let Some((call, calling)) = calls.next() else {
        if let Some(word) = words.clone().find(|w| matches!(w.value, WordValue::Name(_))) {
            return Err(Alarm::NotAWord { text: "a name without M98 or G65".into() }.located_at(word.span));
        }
        return Ok(Words::new(list, None));
    };
    if let Some((second, _)) = calls.next() {
        return Err(Alarm::TwoSubprogramCalls.located_at(second.span));
    }
    let mut call_op = CallOp::new(calling, call.span);
    let mut other_words = Vec::with_capacity(list.len());
    for (lowered, word) in list.into_iter().zip(words.clone()) {
        match (lowered.letter, &word.value) {
            (b'M', _) if kind(word).is_some() => {}
            (b'P', WordValue::Name(name)) => call_op.target = CallTarget::Name(name.clone()),
            (_, WordValue::Name(_)) => {
                return Err(Alarm::NotAWord { text: "a name without P".into() }.located_at(lowered.span));
            }
            (b'P', _) if calling == CallCode::Local => call_op.start = Some(lowered),
            (b'P', _) => call_op.target = CallTarget::Number(lowered),
            (b'L', _) if calling != CallCode::Return => call_op.repeats = Some(lowered),
            (b'Q', _) if calling == CallCode::Subprogram => call_op.start = Some(lowered),
            // M98 with H alone: some controls call the subprogram at this N of the same program.
            (b'H', _) if calling == CallCode::Subprogram && !has(b'P') && !has(b'Q') => {
                call_op.start = Some(lowered)
            }
            _ => other_words.push(lowered),
        }
    }
    Ok(Words::new(other_words, Some(call_op)))
}
