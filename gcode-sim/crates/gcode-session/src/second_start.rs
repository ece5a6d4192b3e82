//! Second start of a program, with the offsets that its first run leaves.
use std::sync::Arc;

use super::{Request, Run, extractor, set_up_control, set_up_control_behind};
use gcode_control::{Limits, Outcome, ResidualKind, ResidualValue};
use gcode_inspect::findings::SECOND_START;
use gcode_inspect::holes::{DrilledHole, HoleExtraction};
use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{Memory, NoLibrary};
use gcode_part::Metal;

/// Largest difference between two holes that are the same, mm; of their axes, as a length of unit vectors.
const SAME: f64 = 1e-4;

/// Largest number of blocks of a second start, as a multiple of those of the first.
const MAX_BLOCKS_RATIO: u64 = 2;

/// Largest number of offsets in a message.
const MAX_NAMED: usize = 3;

/// Returns the warning that the program leaves an offset changed and its second start makes other holes.
pub(super) fn finding(
    request: &Request,
    run: &Run,
    metal: &Metal,
    extracted: &HoleExtraction,
) -> Option<Diagnostic> {
    if !matches!(run.outcome, Outcome::End) || extracted.holes.is_empty() {
        return None;
    }
    let start = set_up_control(request, Memory::default()).ok()?;
    if start.has_offsets_of(&run.control) {
        return None;
    }
    let mut control =
        set_up_control_behind(request, run.control.memory().reload(), Some(&run.control)).ok()?;
    if let Some(progress) = &request.progress {
        control.set_progress(Arc::clone(progress));
    }
    let mut extractor = extractor(request, metal.clone());
    let limits = Limits { blocks: request.limits.blocks.min(MAX_BLOCKS_RATIO * run.control.blocks()) };
    let outcome = control.run_observed(limits, &mut NoLibrary, &mut extractor, &mut ());
    if control.is_cancelled() {
        return None;
    }
    let again = extractor.finish().holes;
    let difference = match outcome {
        Outcome::Alarm(stop) => format!("it stops with alarm {}", stop.alarm.code()),
        Outcome::Limit => format!("it has not ended after {} blocks", control.blocks()),
        Outcome::End => {
            let pairs = extracted.holes.iter().zip(&again);
            let aside = pairs.filter(|(one, other)| !is_same(one, other)).count();
            match aside + extracted.holes.len().abs_diff(again.len()) {
                0 => return None,
                1 => "one hole is elsewhere".to_owned(),
                count => format!("{count} holes are elsewhere"),
            }
        }
    };
    let changes = changes(&start.residual_values(), &run.control.residual_values());
    let message = format!("the program leaves {changes}: started again, {difference}");
    Some(
        Diagnostic::new(&SECOND_START, message)
            .with_backtrace(run.control.backtrace())
            .help("set the offset to its number before its first use, or restore it before M30"),
    )
}

/// Returns true if two holes are at one place, of one depth and by one tool.
fn is_same(one: &DrilledHole, other: &DrilledHole) -> bool {
    (one.entry - other.entry).norm() <= SAME
        && (one.axis.into_inner() - other.axis.into_inner()).norm() <= SAME
        && (one.depth - other.depth).abs() <= SAME
        && one.tool == other.tool
}

/// Returns `G54 X at 20, which was 0 at its start`, for the first offsets that differ.
fn changes(before: &[ResidualValue], after: &[ResidualValue]) -> String {
    let is_offset =
        |value: &&ResidualValue| matches!(value.kind, ResidualKind::WorkOffset | ResidualKind::ToolOffset);
    let value_in = |values: &[ResidualValue], name: &str| {
        values.iter().filter(is_offset).find(|value| value.name == name).map_or(0.0, |value| value.value)
    };
    let mut names: Vec<&str> =
        after.iter().chain(before).filter(is_offset).map(|value| value.name.as_str()).collect();
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(*name) && value_in(before, name) != value_in(after, name));
    let shown = names.iter().take(MAX_NAMED).map(|name| {
        format!("{name} at {}, which was {} at its start", value_in(after, name), value_in(before, name))
    });
    let shown: Vec<_> = shown.collect();
    let more = match names.len() {
        count if MAX_NAMED < count => format!(", and {} more offsets", count - MAX_NAMED),
        _ => String::new(),
    };
    format!("{}{more}", shown.join(", "))
}
