//! Numbers as tables show them: rounded, signed, counted.

use gcode_lang::diag::{Diagnostic, Severity};

/// Rounds to `places` decimals; never returns "-0.000".
pub fn rounded(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|b| b == b'0' || b == b'.') => zero.to_owned(),
        _ => text,
    }
}

/// Formats with a sign and four decimals: `+0.1200`.
pub fn signed(value: f64) -> String {
    signed_to(value, 4)
}

/// Formats with a sign, which 0 has not, and `places` decimals.
pub fn signed_to(value: f64, places: usize) -> String {
    let text = rounded(value, places);
    match value > 0.0 && text.bytes().any(|b| b.is_ascii_digit() && b != b'0') {
        true => format!("+{text}"),
        false => text,
    }
}

/// Formats with a sign and three decimals, as on a drawing: `+0.120`, `−1.500`.
pub fn with_sign(value: f64) -> String {
    signed_to(value, 3).replace('-', "−")
}

/// Formats `1 hole`, `5 holes`.
pub fn count<N: std::fmt::Display + PartialEq + From<u8>>(number: N, what: &str) -> String {
    format!("{number} {what}{}", if number == N::from(1) { "" } else { "s" })
}

/// Counts errors and warnings, `2 errors, 1 warning`; `None` without any.
pub(crate) fn finding_counts<'a>(findings: impl Iterator<Item = &'a Diagnostic> + Clone) -> Option<String> {
    let kinds = [(Severity::Error, "error"), (Severity::Warning, "warning")];
    let numbers = kinds.map(|(severity, name)| {
        let of_severity = findings.clone().filter(|finding| finding.severity == severity);
        (of_severity.map(|finding| 1 + finding.more).sum::<usize>(), name)
    });
    let words: Vec<String> =
        numbers.iter().filter(|(number, _)| 0 < *number).map(|(number, name)| count(*number, name)).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// Formats with up to six decimals: `6`, `5.9`, `66.132`.
pub fn short(value: f64) -> String {
    rounded(value, 6).trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Formats a variable as the control's screen shows it: eight digits at most, and 0 for what is less than the last of them.
pub fn as_on_control(value: f64) -> String {
    const DIGITS: i32 = 8;
    let value = if value.abs() < 5e-8 { 0.0 } else { value };
    let whole = if value.abs() < 1.0 { 0 } else { libm::log10(value.abs()).floor() as i32 + 1 };
    let places = (DIGITS - whole.max(1)).max(0) as usize;
    let text = rounded(value, places);
    if places == 0 { text } else { text.trim_end_matches('0').trim_end_matches('.').to_owned() }
}

/// Formats a time: `13.2 s`, `18 min 22 s`, `2 h 05 min`.
pub fn duration(seconds: f64) -> String {
    let (whole, minutes) = (seconds.round(), (seconds / 60.0).round());
    if seconds < 59.95 {
        format!("{seconds:.1} s")
    } else if whole < 3600.0 {
        format!("{:.0} min {:02.0} s", (whole / 60.0).floor(), whole % 60.0)
    } else {
        format!("{:.0} h {:02.0} min", (minutes / 60.0).floor(), minutes % 60.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::findings::HOLE_TWICE;

    /// A list that shows one of three warnings has three.
    #[test]
    fn findings_that_a_list_leaves_out_count() {
        let warning = Diagnostic::new(&HOLE_TWICE, "").with_severity(Severity::Warning);
        let shown = [Diagnostic { more: 2, ..warning }, Diagnostic::new(&HOLE_TWICE, "")];
        assert_eq!(finding_counts(shown.iter()).as_deref(), Some("1 error, 3 warnings"));
        assert_eq!(finding_counts(shown[1..].iter()).as_deref(), Some("1 error"));
    }

    #[test]
    fn a_variable_has_eight_digits_at_most() {
        for (value, expected) in [
            (2.909_14e-18, "0"),
            (-4.9e-8, "0"),
            (1e-7, "0.0000001"),
            (58.212_999_999_9, "58.213"),
            (0.049_997_160_670_518_46, "0.0499972"),
            (-0.020_008_345_607, "-0.0200083"),
            (12.5, "12.5"),
            (1.0 / 3.0, "0.3333333"),
            (1_234.567_891_2, "1234.5679"),
            (100.0, "100"),
            (99_999_999.0, "99999999"),
            (123_456_789.4, "123456789"),
        ] {
            assert_eq!(as_on_control(value), expected, "{value}");
        }
    }

    #[test]
    fn a_time_is_in_seconds_minutes_or_hours() {
        for (seconds, expected) in [
            (0.0, "0.0 s"),
            (59.94, "59.9 s"),
            (59.96, "1 min 00 s"),
            (1102.4, "18 min 22 s"),
            (3599.4, "59 min 59 s"),
            (3599.6, "1 h 00 min"),
            (7499.0, "2 h 05 min"),
            (7169.0, "1 h 59 min"),
            (7171.0, "2 h 00 min"),
        ] {
            assert_eq!(duration(seconds), expected, "{seconds}");
        }
    }
}
