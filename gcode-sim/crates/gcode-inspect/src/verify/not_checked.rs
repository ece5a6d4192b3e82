//! Sentences on what a verdict on holes does not cover.
use std::collections::{BTreeMap, BTreeSet};

use super::checks::features::ShapeGap;
use super::checks::stock::deeper_than_stock;
use super::{Comparison, HoleInspection};
use crate::findings::BACK_BORED;
use crate::holes::HoleExtraction;
use crate::machine::{HeadKind, Machine, tool_name};
use gcode_lang::motion::LengthCompensation;
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::{Reference, ToolProcess};

/// Motion that no check covers if neither stock nor surface is known.
const MOTION: &str = "motion beside the holes (no stock)";

/// Motion whose search was given up.
const UNSEARCHED: &str = "rapids whose axes may reach too many positions";

/// Metal near feeds of unknown width.
const UNSIZED: &str = "what mills of unknown diameter remove";

/// Metal of feeds beyond the limit.
const CUT_SHORT: &str = "what the feeds after the first million remove";

/// End of a sentence on what a reference could specify: it is no gap in a verdict on that reference.
const UNSPECIFIED: &str = "not specified in the reference";

/// End of a sentence on axes that most machines lack.
const UNCOMMANDED: &str = "no block commands it, and it counts as 0";

/// Returns what these sentences name, for the first line of a verdict: all before the first colon.
pub(super) fn gaps(lines: &[String]) -> Vec<&str> {
    let is_gap = |line: &&String| ![UNSPECIFIED, UNCOMMANDED].iter().any(|end| line.ends_with(end));
    let names = lines.iter().filter(is_gap).map(|line| line.split(": ").next().unwrap_or(line));
    let mut gaps = Vec::new();
    names.for_each(|name| {
        if !gaps.contains(&name) {
            gaps.push(name)
        }
    });
    gaps
}

/// Returns a sentence for each gap of the verdict, so that a pass is not taken for more than it is. What is not checked stands
/// before a colon, the reason behind it.
pub(super) fn lines(inspection: &HoleInspection<'_>, locate: &dyn Fn(Span) -> (String, u32)) -> Vec<String> {
    let HoleInspection { comparison, extraction, reference, machine, .. } = inspection;
    let mut all = diameters(comparison, machine);
    if !machine.tools.is_empty() && extraction.cut_conditions.iter().any(|cut| cut.tool.is_none()) {
        all.push("the tool in the spindle at the start: it cuts before the first tool change".to_owned());
    }
    all.extend(shapes(inspection));
    all.extend(lengths(extraction, machine));
    all.extend(holders(extraction, machine));
    all.extend(conditions(extraction, reference, machine));
    if extraction.findings.iter().any(|finding| finding.kind == &BACK_BORED) {
        all.push("bores made backwards: their depth and diameter".to_owned());
    }
    let mut drilled = comparison.matched().map(|(.., drilled)| drilled);
    if machine.head.kind == HeadKind::Free && drilled.all(|hole| hole.tool_axis_deviation == Deg::ZERO) {
        all.push("head angles: the head is unknown, each axis is taken along its feed".to_owned());
    }
    if extraction.assumed_axes != 0 && !extraction.holes.is_empty() {
        all.push(format!("the position of {}: {UNCOMMANDED}", machine.axes.names(extraction.assumed_axes)));
    }
    if !extraction.is_metal_known {
        all.push(format!(
            "{MOTION}: give [stock] in the reference or the machine file; the metal is known only round the \
             nominal holes, to 1 mm from their walls"
        ));
    } else if let Some(unknown) = &extraction.unknown_rapids {
        all.push(unknown.describe(locate(unknown.backtrace.block)));
    }
    if let Some(unsearched) = &extraction.unsearched_rapids {
        let (program, line) = locate(unsearched.backtrace.block);
        let count = unsearched.count;
        let plural = if count == 1 { "" } else { "s" };
        all.push(format!(
            "{UNSEARCHED} ({count} rapid{plural}, first {program} line {line}): give [rapid] in the machine file"
        ));
    }
    for tool in &extraction.unsized_mills {
        let tool = tool_name(*tool);
        all.push(format!(
            "{UNSIZED}: the machine file has no diameter of {tool}; rapids near its feeds pass"
        ));
    }
    if 0 < extraction.milled_strokes {
        let (count, plural) =
            (extraction.milled_strokes, if extraction.milled_strokes == 1 { "" } else { "s" });
        all.push(format!(
            "{count} stroke{plural} of a mill beside the holes: taken for milling, not for a hole"
        ));
    }
    let covered: Vec<&str> = extraction.covered_entries.iter().map(|index| comparison.id(*index)).collect();
    if !covered.is_empty() {
        let holes = hole_names(&covered);
        all.push(format!("the metal over the entry of {holes}: the stock has it, and no feed removes it"));
    }
    let deeper = deeper_than_stock(inspection);
    if !deeper.is_empty() {
        let holes = hole_names(&deeper);
        all.push(format!(
            "the far side of {holes}: deeper than the stock is thick, and not `through` in the reference"
        ));
    }
    if extraction.is_removal_cut_short {
        all.push(format!("{CUT_SHORT}: rapids where they have removed the metal are reported"));
    }
    all
}

/// Returns `hole 1`, or the number of several with the first.
fn hole_names(ids: &[&str]) -> String {
    match ids {
        [one] => format!("hole {one}"),
        _ => format!("{} holes (first {})", ids.len(), ids[0]),
    }
}

/// Returns the holes of unknown diameter, by their tools.
fn diameters(comparison: &Comparison<'_>, machine: &Machine) -> Vec<String> {
    let mut by_tool: BTreeMap<Option<u32>, Vec<&str>> = BTreeMap::new();
    for (pair, nominal, drilled) in comparison.matched() {
        if nominal.diameter.is_none() && nominal.features.is_empty() {
            continue;
        }
        for pass in drilled.passes().filter(|pass| pass.diameter.is_none()) {
            let ids = by_tool.entry(pass.tool.filter(|_| !machine.tools.is_empty())).or_default();
            let id = comparison.id(pair.nominal);
            if ids.last() != Some(&id) {
                ids.push(id);
            }
        }
    }
    let sentence = |(tool, ids): (Option<u32>, Vec<&str>)| {
        let holes = hole_names(&ids);
        match tool {
            None if machine.tools.is_empty() => "diameters: the machine has no tool table".to_owned(),
            None => format!("the diameter of {holes}: made before the first tool change"),
            Some(tool) if machine.find_tool(tool).is_none() => {
                format!("the diameter of {holes}: T{tool} is not in the machine file")
            }
            Some(tool) => format!("the diameter of {holes}: the machine file has none of T{tool}"),
        }
    };
    by_tool.into_iter().map(sentence).collect()
}

/// Returns the tools whose end the machine file does not describe, with what was taken for it.
fn shapes(inspection: &HoleInspection<'_>) -> Vec<String> {
    let mut ids: BTreeMap<ShapeGap, Vec<&str>> = BTreeMap::new();
    for hole in &inspection.features {
        for gap in &hole.gaps {
            let holes = ids.entry(*gap).or_default();
            let id = inspection.comparison.id(hole.nominal);
            if holes.last() != Some(&id) {
                holes.push(id);
            }
        }
    }
    let sentence = |(gap, ids): (ShapeGap, Vec<&str>)| {
        let holes = hole_names(&ids);
        match gap {
            ShapeGap::SpotDrill(tool) => {
                format!(
                    "the end of {0} in {holes}: the machine file has no kind or point_angle; {0} is taken for a spot drill",
                    tool_name(tool)
                )
            }
            ShapeGap::Undrilled(tool) => {
                format!("the hole in which {} cuts: the program does not drill {holes}", tool_name(tool))
            }
            ShapeGap::FullThrough(tool) => {
                format!(
                    "the full diameter of {holes} on the far side: the machine file has no point_angle of {}",
                    tool_name(tool)
                )
            }
            ShapeGap::FullDepth(tool) => {
                format!(
                    "the depth of the full diameter of {holes}: the machine file has no point_angle of {}",
                    tool_name(tool)
                )
            }
            ShapeGap::Angle(tool) => {
                format!(
                    "the angle of the countersink of {holes}: the machine file has no point_angle of {}",
                    tool_name(tool)
                )
            }
        }
    };
    ids.into_iter().map(sentence).collect()
}

/// Returns the tools of unknown length, and the length taken for each.
fn lengths(extraction: &HoleExtraction, machine: &Machine) -> Vec<String> {
    let unknown = extraction.cut_conditions.iter().filter(|cut| machine.length_of(cut.tool).is_none());
    let tools: BTreeSet<_> = unknown.map(|cut| (cut.tool, cut.compensation)).collect();
    let sentence = |(tool, compensation): (Option<u32>, LengthCompensation)| {
        let whose = tool.map_or("the tool's length".to_owned(), |number| format!("the length of T{number}"));
        let taken = match compensation {
            LengthCompensation::Off | LengthCompensation::Plus(0) | LengthCompensation::Minus(0) => {
                "its tip as the programmed point".to_owned()
            }
            LengthCompensation::Plus(h) | LengthCompensation::Minus(h) => format!("H{h} as its length"),
        };
        format!("{whose}: not in the machine file, which takes {taken}")
    };
    tools.into_iter().map(sentence).collect()
}

/// Returns the tools whose holder is described, but not where it is.
fn holders(extraction: &HoleExtraction, machine: &Machine) -> Option<String> {
    let tools: BTreeSet<u32> = extraction.cut_conditions.iter().filter_map(|cut| cut.tool).collect();
    let is_nowhere = |number: &&u32| {
        machine
            .find_tool(**number)
            .is_some_and(|tool| tool.holder_diameter.is_some() && tool.length.is_none())
    };
    let names: Vec<_> = tools.iter().filter(is_nowhere).map(|number| format!("T{number}")).collect();
    (!names.is_empty())
        .then(|| format!("the holder of {} in the holes: the machine file has no length", names.join(", ")))
}

/// Returns the limits of the process that the reference does not specify.
fn conditions(extraction: &HoleExtraction, reference: &Reference, machine: &Machine) -> Option<String> {
    let limits = &reference.process_limits;
    if extraction.process_limits != *limits {
        return Some("cutting conditions: the run was simulated without those of the reference".to_owned());
    }
    let tools: BTreeSet<_> = extraction.cut_conditions.iter().map(|cut| cut.tool).collect();
    let lacks = |value: &dyn Fn(&ToolProcess) -> Option<f64>| {
        tools.iter().any(|tool| limits.tool_process(*tool).and_then(value).is_none())
    };
    let rotates = machine.table.rotary_axes().next().is_some();
    let conditions = [
        (lacks(&|tool| tool.speed), "S"),
        (lacks(&|tool| tool.feed), "F"),
        (rotates && limits.clearance.is_none(), "the clearance while an axis rotates"),
        (rotates && limits.retract.is_none(), "the retract before the rotary moves"),
        (rotates && limits.clamp.is_none(), "the rotary clamp"),
    ];
    let names: Vec<_> = conditions.iter().filter(|(lacks, _)| *lacks).map(|(_, name)| *name).collect();
    (!names.is_empty()).then(|| format!("{}: {UNSPECIFIED}", names.join(", ")))
}
