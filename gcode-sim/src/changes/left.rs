//! How the runs ended and what they leave behind: outcome, printed lines, M codes, variables, offsets and modes.
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use super::Change;
use crate::exec::{Outcome, Value};
use crate::motion::{Axes, Place};
use crate::session::Run;
use crate::source::Span;

/// Whether the runs ended in the same way.
pub(super) fn outcome(old: &Run, new: &Run) -> Option<Change> {
    let (was, is) = (ending(old), ending(new));
    let change = || Change {
        old: stopped_at(old),
        new: stopped_at(new),
        ..Change::new("outcome", format!("{is}; before: {was}"))
    };
    (was != is).then(change)
}

pub(super) fn compare(old: &Run, new: &Run, tolerance: f64) -> Vec<Change> {
    let mut changes: Vec<Change> = printed(old, new).into_iter().collect();
    changes.extend(passed_on(old, new));
    changes.extend(values(old, new, tolerance));
    changes
}

fn ending(run: &Run) -> String {
    match &run.outcome {
        Outcome::End => "the program ends".to_owned(),
        Outcome::Alarm(stopped) => {
            let row = stopped.alarm.row();
            format!("alarm {} {}", row.code, row.message)
        }
        Outcome::Limit => "the program doesn't end within the limits".to_owned(),
    }
}

fn stopped_at(run: &Run) -> Option<Place> {
    match &run.outcome {
        Outcome::Alarm(stopped) => Some(stopped.place.clone()),
        Outcome::End | Outcome::Limit => None,
    }
}

/// The first line that DPRNT or BPRNT prints differently.
fn printed(old: &Run, new: &Run) -> Option<Change> {
    let (was, is) = (old.control.output(), new.control.output());
    if was == is {
        return None;
    }
    let same = was.iter().zip(is).take_while(|(a, b)| a == b).count();
    let line = |lines: &[Vec<u8>]| match lines.get(same) {
        Some(line) => format!("'{}'", String::from_utf8_lossy(line)),
        None => "nothing".to_owned(),
    };
    let message = format!("printed line {}: {} instead of {}", same + 1, line(is), line(was));
    Some(Change::new("output", message))
}

/// M codes for the machine builder's logic that one of the runs doesn't have.
fn passed_on(old: &Run, new: &Run) -> Vec<Change> {
    let (was, is) = (old.control.passed_on(), new.control.passed_on());
    let place = |block: &Span| Some(Place { block: *block, calls: None });
    let mut changes = Vec::new();
    for (code, block) in was.iter().filter(|(code, _)| !is.contains_key(code)) {
        let mut change = Change::new("m-code", format!("M{code:02} is no longer there"));
        change.old = place(block);
        changes.push(change);
    }
    for (code, block) in is.iter().filter(|(code, _)| !was.contains_key(code)) {
        let mut change = Change::new("m-code", format!("M{code:02} is new"));
        change.new = place(block);
        changes.push(change);
    }
    changes
}

/// What the next program finds: common variables, offsets, and the modes the control is left in.
fn values(old: &Run, new: &Run, tolerance: f64) -> Vec<Change> {
    let known = old.control.variables().chain(new.control.variables());
    let numbers: BTreeSet<u32> = known.map(|(number, _)| number).filter(|number| *number >= 100).collect();
    let commons = numbers.into_iter().map(|number| ("variable", number));
    let system = LEFT.iter().flat_map(|(code, numbers)| numbers.clone().map(|number| (*code, number)));
    commons.chain(system).filter_map(|(code, number)| value(old, new, code, number, tolerance)).collect()
}

fn value(old: &Run, new: &Run, code: &'static str, number: u32, tolerance: f64) -> Option<Change> {
    let read = |run: &Run| run.control.variable(number).ok().and_then(Value::given);
    let (was, is) = (read(old), read(new));
    let same = match (was, is) {
        (Some(a), Some(b)) => (a - b).abs() <= tolerance,
        (a, b) => a == b,
    };
    let shown = |value: Option<f64>| value.map_or_else(|| "vacant".to_owned(), |v| plain(v).to_string());
    let name = named(number, &old.control.settings().axes);
    (!same).then(|| Change::new(code, format!("{name} is left {} instead of {}", shown(is), shown(was))))
}

/// System variables that outlive a run: modes of groups 1 to 22, work offsets, tool offsets (operator's manual, system
/// variables).
const LEFT: [(&str, RangeInclusive<u32>); 6] = [
    ("mode", 4001..=4022),
    ("work-offset", 5201..=5328),
    ("work-offset", 14_001..=19_960),
    ("tool-offset", 10_001..=10_400),
    ("tool-offset", 11_001..=11_400),
    ("tool-offset", 12_001..=13_400),
];

/// `#5222, G54 Y`.
fn named(number: u32, axes: &Axes) -> String {
    let letter = |first: u32| axes.letter(((number - first) % 20) as usize);
    match number {
        4001..=4022 => format!("#{number}, the mode of group {:02},", number - 4000),
        5201..=5220 => format!("#{number}, the external work offset {},", letter(5201)),
        5221..=5328 => format!("#{number}, G{} {},", 54 + (number - 5221) / 20, letter(5221)),
        14_001..=19_960 => format!("#{number}, G54.1 P{} {},", 1 + (number - 14_001) / 20, letter(14_001)),
        10_001..=13_400 => format!("#{number}, of tool offset {},", number % 1000),
        _ => format!("#{number}"),
    }
}

/// Nobody can set more digits, and a residue of the arithmetic is none.
fn plain(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
