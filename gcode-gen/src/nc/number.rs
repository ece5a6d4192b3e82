//! Numbers as a control reads them: always with a point, never more digits than it takes.
use gcode_sim::control::Increment;

/// Digits a control takes in one number (0i-F, 30i; the older ones take one fewer).
const DIGITS: usize = 9;

/// A value in mm, degrees or mm/min, one digit finer than the increment: macro arguments keep it, and the control
/// rounds once, where the axis moves. `1158.8` becomes `1158.8`, `420` becomes `420.`.
pub fn number(value: f64, increment: Increment) -> String {
    let finest = match increment {
        Increment::IsA => 3,
        Increment::IsB => 4,
        Increment::IsC => 5,
    };
    let whole = format!("{:.0}", value.abs().trunc()).len();
    let places = finest.min(DIGITS.saturating_sub(whole));
    let text = format!("{value:.places$}");
    let text = if text.contains('.') { text.trim_end_matches('0').to_owned() } else { text + "." };
    if text == "-0." { "0.".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_a_point_and_no_digits_too_many() {
        let shown = |value| number(value, Increment::IsB);
        assert_eq!(shown(420.0), "420.");
        assert_eq!(shown(1158.8), "1158.8");
        assert_eq!(shown(0.1), "0.1");
        assert_eq!(shown(-720.0), "-720.");
        assert_eq!(shown(-0.000_01), "0.");
        assert_eq!(shown(100.0 / 3.0), "33.3333");
        assert_eq!(number(100.0 / 3.0, Increment::IsA), "33.333");
        assert_eq!(number(100.0 / 3.0, Increment::IsC), "33.33333");
        assert_eq!(number(99_998.765_432, Increment::IsC), "99998.7654", "nine digits");
    }
}
