//! End and final state of two runs: outcome, printed lines, variables, offsets and modes.
use std::borrow::Cow;
use std::collections::BTreeSet;

use super::change::Effect;
use super::kinds;
use super::record::{Record, ResidualEntry};

/// Returns the difference of the outcomes.
pub(super) fn outcome([old, new]: [&Record; 2]) -> Option<Effect> {
    let (was, is) = (&old.ending, &new.ending);
    let message = || format!("{}; before: {}", is.words, was.words);
    let blocks = [&was.stopped, &is.stopped].map(|stopped| stopped.as_ref().map(Cow::Borrowed));
    (was.words != is.words).then(|| Effect::new(&kinds::OUTCOME, message(), blocks))
}

/// Returns the difference of the main programs' names.
pub(super) fn program([old, new]: [&Record; 2]) -> Option<Effect> {
    let (was, is) = (old.program.as_ref()?, new.program.as_ref()?);
    let message = || format!("{is} instead of {was}: a different program on the control");
    (was != is).then(|| Effect::new(&kinds::PROGRAM, message(), [None, None]))
}

/// Returns the differences of printed lines and of the final state.
pub(super) fn compare([old, new]: [&Record; 2], tolerance: f64) -> Vec<Effect> {
    let mut effects: Vec<Effect> = printed(&old.ending.output, &new.ending.output).into_iter().collect();
    let (was, is) = (&old.ending.residual, &new.ending.residual);
    let names: BTreeSet<&String> = was.keys().chain(is.keys()).collect();
    effects
        .extend(names.into_iter().filter_map(|name| value(name, [was.get(name), is.get(name)], tolerance)));
    effects
}

/// Returns the difference of the first printed line that differs.
fn printed(was: &[String], is: &[String]) -> Option<Effect> {
    let same = was.iter().zip(is).take_while(|(a, b)| a == b).count();
    let line = |lines: &[String]| lines.get(same).map_or("nothing".to_owned(), |line| format!("'{line}'"));
    let message = || format!("printed line {}: {} instead of {}", same + 1, line(is), line(was));
    (was != is).then(|| Effect::new(&kinds::OUTPUT, message(), [None, None]))
}

/// Returns the difference of a value of the final state, old and new.
fn value(name: &str, entries: [Option<&ResidualEntry>; 2], tolerance: f64) -> Option<Effect> {
    let code = entries[0].or(entries[1])?.code.as_str();
    // A mode that one of both does not have was not recorded; #4130, the P of G54.1, goes with the mode of group 14.
    if (code == kinds::MODE.code || name == "#4130") && entries.contains(&None) {
        return None;
    }
    // A file may have any code.
    let kind = kinds::ALL.iter().copied().find(|kind| kind.code == code).unwrap_or(&kinds::VARIABLE);
    // Only offsets are known to be lengths or angles.
    let is_length = matches!(code, "work-offset" | "tool-offset");
    // Another absent value is 0; an absent variable is vacant, an absent parameter unchanged.
    let absent = (!matches!(code, "variable" | "parameter")).then_some(0.0);
    let [was, is] = entries.map(|entry| entry.map(|entry| entry.value).or(absent));
    let same = match (was, is) {
        (Some(a), Some(b)) if is_length => (a - b).abs() <= tolerance,
        // Rounding errors are no difference.
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs().max(b.abs()),
        (a, b) => a == b,
    };
    let nothing = if code == "parameter" { "unchanged" } else { "vacant" };
    let shown = |value: Option<f64>| value.map_or_else(|| nothing.to_owned(), |v| rounded(v).to_string());
    let message = || match (code, was, is) {
        ("mode", Some(was), Some(is)) => {
            format!("the program ends in {} instead of {}", g_code(is), g_code(was))
        }
        _ => format!("{name} ends as {} instead of {}", shown(is), shown(was)),
    };
    let blocks = entries.map(|entry| entry?.location.as_ref().map(Cow::Borrowed));
    (!same).then(|| Effect::new(kind, message(), blocks))
}

/// Formats a modal code as `G01`, `G54.1`.
fn g_code(value: f64) -> String {
    let value = rounded(value);
    if value.fract() == 0.0 { format!("G{value:02}") } else { format!("G{value}") }
}

/// Rounds to nine decimals, and −0 to 0.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(code: &str, values: [Option<f64>; 2]) -> Option<String> {
        let entry = |value| ResidualEntry { code: code.to_owned(), value, location: None };
        let [old, new] = values.map(|value| value.map(entry));
        value("the mode of group 14", [old.as_ref(), new.as_ref()], 1e-4).map(|effect| effect.message)
    }

    #[test]
    fn a_mode_that_a_record_lacks_is_no_difference() {
        assert_eq!(difference("mode", [None, Some(54.0)]), None);
        assert_eq!(difference("mode", [Some(54.0), None]), None);
        let ends = Some("the program ends in G54.1 instead of G54".to_owned());
        assert_eq!(difference("mode", [Some(54.0), Some(54.1)]), ends);
    }

    #[test]
    fn another_value_that_a_record_lacks_is_0() {
        assert!(difference("work-offset", [None, Some(5.0)]).is_some());
        assert_eq!(difference("work-offset", [None, Some(0.0)]), None);
    }
}
