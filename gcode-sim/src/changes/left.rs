//! How the runs ended and what they leave behind: outcome, printed lines, M codes, variables, offsets and modes.
use std::collections::{BTreeMap, BTreeSet};

use super::Change;
use super::record::{Record, Where};
use crate::motion::Axes;

/// Whether the runs ended in the same way.
pub(super) fn outcome(old: &Record, new: &Record) -> Option<Change> {
    let (was, is) = (&old.ending, &new.ending);
    (was.words != is.words).then(|| {
        Change::new("outcome", format!("{}; before: {}", is.words, was.words))
            .once_at(was.stopped.as_ref())
            .now_at(is.stopped.as_ref())
    })
}

pub(super) fn compare(old: &Record, new: &Record, tolerance: f64) -> Vec<Change> {
    let mut changes: Vec<Change> = printed(&old.ending.output, &new.ending.output).into_iter().collect();
    changes.extend(m_codes(&old.ending.m_codes, &new.ending.m_codes));
    let numbers: BTreeSet<u32> = old.ending.values.keys().chain(new.ending.values.keys()).copied().collect();
    changes.extend(numbers.into_iter().filter_map(|number| value(old, new, number, tolerance)));
    changes
}

/// The first line that DPRNT or BPRNT prints differently.
fn printed(was: &[String], is: &[String]) -> Option<Change> {
    if was == is {
        return None;
    }
    let same = was.iter().zip(is).take_while(|(a, b)| a == b).count();
    let line = |lines: &[String]| lines.get(same).map_or("nothing".to_owned(), |line| format!("'{line}'"));
    let message = format!("printed line {}: {} instead of {}", same + 1, line(is), line(was));
    Some(Change::new("output", message))
}

/// M codes for the machine builder's logic that one of the runs doesn't have.
fn m_codes(was: &BTreeMap<u32, Where>, is: &BTreeMap<u32, Where>) -> Vec<Change> {
    let lost = was.iter().filter(|(code, _)| !is.contains_key(code));
    let added = is.iter().filter(|(code, _)| !was.contains_key(code));
    let lost = lost.map(|(code, place)| {
        Change::new("m-code", format!("M{code:02} is no longer there")).once_at(Some(place))
    });
    let added =
        added.map(|(code, place)| Change::new("m-code", format!("M{code:02} is new")).now_at(Some(place)));
    lost.chain(added).collect()
}

/// What the next program finds in a variable.
fn value(old: &Record, new: &Record, number: u32, tolerance: f64) -> Option<Change> {
    let (code, name) = named(number, &old.axes);
    let (was, is) = (old.ending.values.get(&number), new.ending.values.get(&number));
    let same = match (was, is) {
        (Some(a), Some(b)) => (a - b).abs() <= tolerance,
        (a, b) => a == b,
    };
    // System variables that aren't written down are 0.
    let absent = if code == "variable" { "vacant" } else { "0" };
    let shown = |value: Option<&f64>| value.map_or_else(|| absent.to_owned(), |v| plain(*v).to_string());
    (!same).then(|| Change::new(code, format!("{name} is left {} instead of {}", shown(is), shown(was))))
}

/// What a variable is, in a code and in words: `#5222, G54 Y,`.
fn named(number: u32, axes: &Axes) -> (&'static str, String) {
    let letter = |first: u32| axes.letter(((number - first) % 20) as usize);
    match number {
        4001..=4022 => ("mode", format!("#{number}, the mode of group {:02},", number - 4000)),
        5201..=5220 => ("work-offset", format!("#{number}, the external work offset {},", letter(5201))),
        5221..=5328 => {
            ("work-offset", format!("#{number}, G{} {},", 54 + (number - 5221) / 20, letter(5221)))
        }
        14_001..=19_960 => {
            ("work-offset", format!("#{number}, G54.1 P{} {},", 1 + (number - 14_001) / 20, letter(14_001)))
        }
        10_001..=13_400 => ("tool-offset", format!("#{number}, of tool offset {},", number % 1000)),
        _ => ("variable", format!("#{number}")),
    }
}

/// Nobody can set more digits, and a residue of the arithmetic is none.
fn plain(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
