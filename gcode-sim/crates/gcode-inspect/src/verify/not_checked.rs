//! What a verdict on holes says nothing about, in words.
use std::collections::{BTreeMap, BTreeSet};

use super::{Comparison, HolePair};
use crate::holes::HoleExtraction;
use crate::machine::{HeadKind, Machine};
use gcode_lang::motion::LengthCompensation;
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::Reference;
use gcode_part::ToolProcess;

/// What a pass says nothing about, in words: nobody should take it for checked.
pub(super) fn lines(
    comparison: &Comparison<'_>,
    extracted: &HoleExtraction,
    reference: &Reference,
    machine: &Machine,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Vec<String> {
    let mut all = Vec::new();
    all.extend(diameters(comparison, machine));
    all.extend(lengths(extracted, machine));
    all.extend(conduct(extracted, reference, machine));
    let along_feed =
        comparison.pairs.iter().all(|pair| comparison.actual[pair.actual].tool_axis_deviation == Deg::ZERO);
    if machine.head.kind == HeadKind::Free && along_feed {
        all.push("head angles: the head is unknown, each axis is taken along its feed".to_owned());
    }
    let unplaced = extracted.unknown_work_zero.as_ref().filter(|_| reference.surface.is_some());
    all.extend(unplaced.map(|unplaced| unplaced.describe(locate(unplaced.backtrace.block))));
    if reference.surface.is_none() {
        all.push(
            "rapid motion through the part: the reference has no surface; a job file has one".to_owned(),
        );
    }
    all
}

/// Whose diameters aren't checked: by which tools, where the tool table has others.
fn diameters(comparison: &Comparison<'_>, machine: &Machine) -> Vec<String> {
    let unknown = |pair: &&HolePair| {
        comparison.nominal[pair.nominal].diameter.is_some()
            && comparison.actual[pair.actual].diameter.is_none()
    };
    let mut made: BTreeMap<Option<u32>, Vec<&str>> = BTreeMap::new();
    for pair in comparison.pairs.iter().filter(unknown) {
        let tool = comparison.actual[pair.actual].tool.filter(|_| !machine.tools.is_empty());
        made.entry(tool).or_default().push(comparison.id(pair.nominal));
    }
    let words = |(tool, ids): (Option<u32>, Vec<&str>)| match (tool, ids.as_slice()) {
        (None, _) if machine.tools.is_empty() => "diameters: the machine has no tool table".to_owned(),
        (None, ids) => format!("the diameter of {} made before the first tool change", format_ids(ids)),
        (Some(tool), ids) => {
            format!("the diameter of {} made by T{tool}, which is not in the machine file", format_ids(ids))
        }
    };
    made.into_iter().map(words).collect()
}

/// `hole 1,` or `63 holes (r0h0 the first),`.
fn format_ids(ids: &[&str]) -> String {
    match ids {
        [one] => format!("hole {one},"),
        [first, ..] => format!("{} holes (first: {first}),", ids.len()),
        [] => String::new(),
    }
}

/// Tools that cut and whose lengths the machine file doesn't have: which offset stands for each.
fn lengths(extracted: &HoleExtraction, machine: &Machine) -> Vec<String> {
    let unknown = extracted.cut_conditions.iter().filter(|cutting| machine.length_of(cutting.tool).is_none());
    let tools: BTreeSet<_> = unknown.map(|cutting| (cutting.tool, cutting.compensation)).collect();
    let words = |(tool, by): (Option<u32>, LengthCompensation)| {
        let whose = tool.map_or("the tool's length".to_owned(), |number| format!("the length of T{number}"));
        let taken = match by {
            LengthCompensation::Off | LengthCompensation::Plus(0) | LengthCompensation::Minus(0) => {
                "its tip as the programmed point".to_owned()
            }
            LengthCompensation::Plus(h) | LengthCompensation::Minus(h) => format!("H{h} as its length"),
        };
        format!("{whose}: not in the machine file, which takes {taken}")
    };
    tools.into_iter().map(words).collect()
}

/// What the reference doesn't say of how the part is to be worked.
fn conduct(extracted: &HoleExtraction, reference: &Reference, machine: &Machine) -> Option<String> {
    let conduct = &reference.process_limits;
    if extracted.process_limits != *conduct {
        return Some("cutting conditions: the run was simulated without those of the reference".to_owned());
    }
    let tools: BTreeSet<_> = extracted.cut_conditions.iter().map(|cutting| cutting.tool).collect();
    let unsaid = |of: &dyn Fn(&ToolProcess) -> Option<f64>| {
        tools.iter().any(|tool| conduct.tool_process(*tool).and_then(of).is_none())
    };
    let turns = machine.table.rotary_axes().next().is_some();
    let missing = [
        (unsaid(&|duty| duty.speed), "S"),
        (unsaid(&|duty| duty.feed), "F"),
        (turns && conduct.clearance.is_none(), "the clearance while an axis rotates"),
        (turns && conduct.retract.is_none(), "the retract before the rotary moves"),
        (turns && conduct.clamp.is_none(), "the rotary clamp"),
    ];
    let names: Vec<_> = missing.iter().filter(|(missing, _)| *missing).map(|(_, name)| *name).collect();
    (!names.is_empty()).then(|| format!("{}: not specified in the reference", names.join(", ")))
}
