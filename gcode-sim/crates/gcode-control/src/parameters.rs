//! Parameters in a program: PRM reads them, the blocks between G10 L52 and G11 write them.
use super::checked::ExecResult;
use super::notes::Note;
use super::plan::{BlockPlan, TableWrite};
use super::planner::Planner;
use super::words::{BlockWords, WordNumber};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{ParameterError, ParameterId, Settings, is_without_effect};
use gcode_lang::program::Words;
use gcode_lang::program::g_codes::{Effect, OneShot};
use gcode_lang::source::Span;

impl Planner<'_> {
    /// A block between G10 L52 and G11: `N_ R_`, with P for an axis and Q for a bit.
    pub(super) fn plan_parameter(
        &self,
        (words, number): (&Words, Option<u32>),
        block_words: &mut BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        plan.reset(&self.registers.state);
        let format_alarm = |what: &str| Alarm::ParameterFormat { what: what.to_owned() }.located_at(span);
        self.registers.evaluate_words(words, None, block_words)?;
        let mut codes = block_words.g_codes();
        match (codes.next(), codes.next()) {
            (None, _) => {}
            (Some(code), None) if code.effect == Effect::OneShot(OneShot::DataInputEnd) => {
                plan.state.is_in_parameter_input = false;
                return match block_words.first_unread() {
                    None if words.call().is_none() => Ok(()),
                    _ => Err(format_alarm("words in a block with G11")),
                };
            }
            _ => return Err(format_alarm("another G code before G11")),
        }
        if block_words.m_code_count > 0 || words.call().is_some() {
            return Err(format_alarm("an M code before G11"));
        }
        let number = number.and_then(|number| u16::try_from(number).ok());
        let number =
            number.ok_or_else(|| format_alarm("N, the parameter's number, is missing or too large"))?;
        let (raw, _) = block_words.get(b'R').ok_or_else(|| format_alarm("R is missing"))?;
        let axis = match block_words.count(b'P')? {
            None => None,
            Some(axis) => {
                Some(self.data.axis_of(f64::from(axis)).map_err(|_| format_alarm("P is not an axis"))?)
            }
        };
        let bit = match block_words.count(b'Q')? {
            None => None,
            Some(bit) => {
                Some(self.data.parameter_bit(f64::from(bit)).ok_or_else(|| format_alarm("Q is not 0 to 7"))?)
            }
        };
        if block_words.first_unread().is_some() {
            return Err(format_alarm("other words than N P Q R"));
        }
        let id = ParameterId { number, bit, axis };
        if let WordNumber::Literal(literal) = raw
            && literal.places.is_none()
            && literal.digits != 0
            && Settings::is_length_parameter(id)
        {
            let what = format!("R without a decimal point for parameter {number}, a length");
            return Err(Alarm::NotSimulated { what }.located_at(block_words.span(b'R')));
        }
        let value = match raw {
            WordNumber::Literal(literal) => literal.value(),
            WordNumber::Computed(value) => value,
        };
        let result = self.data.settings.clone().set_parameter(id, value);
        let has_no_effect = result == Err(ParameterError::Unknown) && is_without_effect(number);
        match result {
            Ok(()) => {}
            Err(_) if has_no_effect => plan.notes.push(Note::ParameterWithoutEffect { number }),
            Err(ParameterError::MissingAxis) => return Err(format_alarm("P, the axis, is missing")),
            Err(ParameterError::UnexpectedAxis) => return Err(format_alarm("the parameter has no axis P")),
            Err(ParameterError::UnexpectedBit) => return Err(format_alarm("the parameter has no bit Q")),
            Err(ParameterError::InvalidValue) => {
                return Err(format_alarm("the value is not allowed for this parameter"));
            }
            Err(ParameterError::MissingBit) => {
                let what = format!("parameter {number} without Q, as a whole byte");
                return Err(Alarm::NotSimulated { what }.located_at(span));
            }
            Err(ParameterError::Unknown | ParameterError::ReadOnly) => {
                let what = format!("a change of parameter {number}");
                return Err(Alarm::NotSimulated { what }.located_at(span));
            }
        }
        plan.writes.push(TableWrite::Parameter { id, value, has_no_effect });
        Ok(())
    }
}
