//! Numbers in NC text: always with a decimal point, never with more digits than a control accepts.

/// Number of digits that all three dialects accept in one number.
const DIGITS: usize = 9;

/// Number of decimals. Six are a nanometre, or 0.02 µm at the end of a radius of 1000 mm: only the control
/// rounds noticeably, once, where the axis moves.
const PLACES: usize = 6;

/// Formats a value in mm, degrees or mm/min: `1158.8` stays `1158.8`, `420` becomes `420.`.
pub fn number(value: f64) -> String {
    let whole = format!("{:.0}", value.abs().trunc()).len();
    let places = PLACES.min(DIGITS.saturating_sub(whole));
    let text = format!("{value:.places$}");
    let text = if text.contains('.') { text.trim_end_matches('0').to_owned() } else { text + "." };
    if text == "-0." { "0.".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_a_point_and_no_digits_too_many() {
        assert_eq!(number(420.0), "420.");
        assert_eq!(number(1158.8), "1158.8");
        assert_eq!(number(0.1), "0.1");
        assert_eq!(number(-720.0), "-720.");
        assert_eq!(number(-0.000_000_1), "0.");
        assert_eq!(number(100.0 / 3.0), "33.333333");
        assert_eq!(number(10_000.0 / 3.0), "3333.33333", "nine digits");
        assert_eq!(number(99_998.765_432), "99998.7654", "nine digits");
        assert_eq!(number(240_000.0), "240000.");
    }
}
