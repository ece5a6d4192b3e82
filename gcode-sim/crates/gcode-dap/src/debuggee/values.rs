//! Values as a person reads them.
use gcode_control::{Evaluation, Value};
use gcode_lang::alarm::Alarm;

/// Text of a vacant value.
pub(crate) const VACANT: &str = "vacant";

/// Numbers below this are written with an exponent.
const SMALLEST_DECIMAL: f64 = 1e-7;

/// Returns a number with at most 15 significant digits: the sixteenth is the noise of binary fractions.
pub(crate) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.14e}").parse().unwrap_or(value);
    match rounded.abs() {
        // −0 is 0 on every screen.
        0.0 => "0".to_owned(),
        small if small < SMALLEST_DECIMAL => format!("{rounded:e}"),
        _ => rounded.to_string(),
    }
}

/// Returns a value, or `vacant`.
pub(crate) fn value(value: Value) -> String {
    value.as_number().map_or_else(|| VACANT.to_owned(), number)
}

/// Returns the result of an expression, or `true` or `false` of a condition.
pub(crate) fn evaluation(result: Evaluation) -> String {
    match result {
        Evaluation::Value(of) => value(of),
        Evaluation::Condition(is_true) => is_true.to_string(),
    }
}

/// Returns the code and the wording of an alarm: `PS0112: division by zero`.
pub(crate) fn alarm(alarm: &Alarm) -> String {
    let row = alarm.row();
    format!("{}: {}", row.code, row.message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_noise_and_vacant_is_a_word() {
        for (given, text) in [
            (5.0, "5"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.3"),
            (-0.0, "0"),
            (1158.8, "1158.8"),
            (0.000_1, "0.0001"),
            (-6.5e-17, "-6.5e-17"),
            (123_456_789.25, "123456789.25"),
        ] {
            assert_eq!(number(given), text);
        }
        assert_eq!(value(Value::Vacant), "vacant");
        assert_eq!(evaluation(Evaluation::Condition(false)), "false");
        assert_eq!(alarm(&Alarm::DivideByZero).split(':').next(), Some("PS0112"));
    }
}
