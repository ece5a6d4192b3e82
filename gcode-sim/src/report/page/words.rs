//! Numbers and texts as the page writes them.
use crate::report::figures::rounded;

/// Replaces invisible characters and those that change the reading direction in a text from a program or a
/// file name.
pub(super) fn shown(text: &str) -> String {
    let hidden = |c: char| matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}');
    text.chars()
        .map(|c| match c {
            '\t' => ' ',
            c if c.is_control() || hidden(c) => '\u{fffd}',
            c => c,
        })
        .collect()
}

/// Formats a variable's value with up to six decimals.
pub(super) fn value(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-6 || 1e12 <= value.abs() {
        return format!("{value:.3e}");
    }
    let text = rounded(value, 6);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Formats `1 h 18 min 3 s`, `18.2 s`.
pub(super) fn duration(seconds: f64) -> String {
    if seconds < 60.0 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours == 0 { format!("{minutes} min {rest} s") } else { format!("{hours} h {minutes} min {rest} s") }
}

/// Formats `12 345`, with no-break spaces.
pub(super) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_durations_are_formatted() {
        assert_eq!([value(1158.8), value(-0.5), value(0.0), value(7.0)], ["1158.8", "-0.5", "0", "7"]);
        assert_eq!(value(2.5e-9), "2.500e-9");
        assert_eq!(count(1_234_567), "1\u{a0}234\u{a0}567");
        assert_eq!(count(5460), "5460");
        assert_eq!(
            [duration(18.2), duration(1093.3), duration(4683.0)],
            ["18.2 s", "18 min 13 s", "1 h 18 min 3 s"]
        );
    }

    #[test]
    fn invisible_and_direction_characters_are_replaced() {
        assert_eq!(shown("A\u{202e}B\u{0}C\tD"), "A\u{fffd}B\u{fffd}C D");
    }
}
