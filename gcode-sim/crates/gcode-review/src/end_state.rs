//! How the runs ended and what they leave behind: outcome, printed lines, variables, offsets and modes.
use std::collections::BTreeSet;

use super::change::Effect;
use super::record::{Record, ResidualEntry};

/// Whether the runs ended in the same way.
pub(super) fn outcome(old: &Record, new: &Record) -> Option<Effect> {
    let (was, is) = (&old.ending, &new.ending);
    (was.words != is.words).then(|| {
        Effect::new("outcome", format!("{}; before: {}", is.words, was.words))
            .with_old(was.stopped.as_ref())
            .with_new(is.stopped.as_ref())
    })
}

/// Whether the main programs have one name.
pub(super) fn program(old: &Record, new: &Record) -> Option<Effect> {
    let (was, is) = (old.program.as_ref()?, new.program.as_ref()?);
    let message = || format!("{is} instead of {was}: a different program on the control");
    (was != is).then(|| Effect::new("program", message()))
}

/// Everything that the runs print or leave behind differently.
pub(super) fn compare(old: &Record, new: &Record, tolerance: f64) -> Vec<Effect> {
    let mut effects: Vec<Effect> = printed(&old.ending.output, &new.ending.output).into_iter().collect();
    let (was, is) = (&old.ending.left, &new.ending.left);
    let names: BTreeSet<&String> = was.keys().chain(is.keys()).collect();
    effects.extend(names.into_iter().filter_map(|name| value(name, was.get(name), is.get(name), tolerance)));
    effects
}

/// The first line that DPRNT or BPRNT prints differently.
fn printed(was: &[String], is: &[String]) -> Option<Effect> {
    if was == is {
        return None;
    }
    let same = was.iter().zip(is).take_while(|(a, b)| a == b).count();
    let line = |lines: &[String]| lines.get(same).map_or("nothing".to_owned(), |line| format!("'{line}'"));
    let message = format!("printed line {}: {} instead of {}", same + 1, line(is), line(was));
    Some(Effect::new("output", message))
}

/// What the next program finds under a name.
fn value(
    name: &str,
    was: Option<&ResidualEntry>,
    is: Option<&ResidualEntry>,
    tolerance: f64,
) -> Option<Effect> {
    let code = was.or(is)?.code.as_str();
    // Only offsets are lengths and angles; what a variable means nobody knows.
    let is_length = matches!(code, "work-offset" | "tool-offset");
    // What isn't written down is 0; a variable is vacant, a parameter as it was.
    let absent = (!matches!(code, "variable" | "parameter")).then_some(0.0);
    let places = (was.and_then(|left| left.place.as_ref()), is.and_then(|left| left.place.as_ref()));
    let (was, is) = (was.map(|left| left.value).or(absent), is.map(|left| left.value).or(absent));
    let same = match (was, is) {
        (Some(a), Some(b)) if is_length => (a - b).abs() <= tolerance,
        // The last digits of the arithmetic are no change.
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs().max(b.abs()),
        (a, b) => a == b,
    };
    let (old, new) = places;
    let nothing = if code == "parameter" { "unchanged" } else { "vacant" };
    let shown = |value: Option<f64>| value.map_or_else(|| nothing.to_owned(), |v| plain(v).to_string());
    let message = || match (code, was, is) {
        ("mode", Some(was), Some(is)) => {
            format!("the program ends in {} instead of {}", g_code(is), g_code(was))
        }
        _ => format!("{name} ends as {} instead of {}", shown(is), shown(was)),
    };
    (!same).then(|| Effect::new(known(code), message()).with_old(old).with_new(new))
}

/// The name of a change as every entry has it; a file may hold any.
fn known(code: &str) -> &'static str {
    let codes = ["variable", "mode", "work-offset", "tool-offset", "parameter", "signal", "counter"];
    codes.into_iter().find(|known| *known == code).unwrap_or("variable")
}

/// `G01`, `G54.1`.
fn g_code(value: f64) -> String {
    let value = plain(value);
    if value.fract() == 0.0 { format!("G{value:02}") } else { format!("G{value}") }
}

/// Digits that nobody can set aren't shown.
fn plain(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}
