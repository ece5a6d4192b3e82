//! Shared parts of all resident macros: filling in marks, and checks of the text for any control.
use gcode_lang::control::Dialect;

use super::control::alarm_thousands;
use super::start::changed_condition;
#[cfg(test)]
use crate::nc::program::REMARK;

/// Replaces every `{mark}` in a macro's text; `{k}` and `{changed}` follow from the control.
pub(super) fn fill(text: &str, dialect: Dialect, marks: &[(&str, String)]) -> String {
    let text = text.replace("{k}", alarm_thousands(dialect)).replace("{changed}", changed_condition(dialect));
    marks.iter().fold(text, |text, (mark, value)| text.replace(mark, value))
}

/// Fails if a mark is left, if a control cannot show a character, if a remark is longer than those of main
/// programs, or if a message is longer than the 26 characters of an old control.
#[cfg(test)]
pub(super) fn assert_displayable(text: &str) {
    assert!(!text.contains(['{', '}']), "a mark is left:\n{text}");
    let shown = |b: u8| b == b'\n' || (b.is_ascii_graphic() || b == b' ') && !b.is_ascii_lowercase();
    assert!(text.bytes().all(shown), "a character no control shows:\n{text}");
    for line in text.lines() {
        let remark = line.strip_prefix('(').map(|rest| rest.trim_end_matches(')'));
        assert!(
            remark.is_none_or(|remark| remark.len() <= REMARK),
            "{line} has {} characters",
            line.len() - 2
        );
        for stop in ["#3000=", "#3006="] {
            let Some((_, rest)) = line.split_once(stop) else { continue };
            let message = rest.split_once('(').expect(line).1.trim_end_matches(')');
            assert!(message.len() <= 26, "{message} has {} characters", message.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_filled_wherever_they_stand() {
        let marks = [("{a}", "1.".to_owned()), ("{b}", String::new())];
        assert_eq!(fill("{a}{b}-{a} {k}016", Dialect::HaasNgc, &marks), "1.-1. 1016");
        assert_displayable("#3000=1(26 CHARACTERS ARE NOT MORE)\n#3006=1(SO)\n");
    }

    #[test]
    #[should_panic(expected = "has 27 characters")]
    fn a_long_message_is_seen() {
        assert_displayable("IF[#1 EQ #0]THEN #3000=1(27 CHARACTERS ARE TOO MANY!)\n");
    }
}
