//! A length offset that isn't the tool's, where the machine file has its length: told where just that puts the tool beside
//! the depth of the holes, and nothing it drilled is right.
use nalgebra::{Point3, Unit, Vector3};

use super::{Comparison, HoleFinding, HoleInspection};
use crate::findings::{HOLE_DEPTH, HOLE_EXTRA, HOLE_IN_AIR, HOLE_MISSING, HOLES_ALIKE, LENGTH_OFFSET};
use crate::holes::LengthMismatch;
use crate::machine::Machine;
use crate::verify::hole_finding::{fold, folded_note};
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::LengthCompensation;
use gcode_part::ProcessLimits;

/// A feed that ends so near the line of a hole is meant for it, mm, …
const MAX_LINE_OFFSET: f64 = 0.5;

/// … if their directions differ by no more than 5°.
const MIN_DIRECTION_COSINE: f64 = 0.996_194_698_091_745_5;

/// What is found of holes that are cut at a wrong depth.
const DEPTH_KINDS: [&FindingKind; 5] = [&HOLE_MISSING, &HOLE_EXTRA, &HOLE_DEPTH, &HOLES_ALIKE, &HOLE_IN_AIR];

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let HoleInspection { comparison, machine, extraction, reference } = inspection;
    let mismatches = extraction.length_mismatches.iter();
    let wrong: Vec<&LengthMismatch> = mismatches.filter(|reach| explains(comparison, reach)).collect();
    if wrong.is_empty() {
        return;
    }
    let by_them = |found: usize| {
        let tool = comparison.actual[found].tool;
        wrong.iter().any(|reach| Some(reach.tool) == tool)
    };
    let pair_of = |wanted: usize| comparison.pairs.iter().find(|pair| pair.nominal == wanted);
    // What is missing or wrong with many holes, a tool with the right offset may have to do with.
    let alone = comparison.pairs.iter().all(|pair| by_them(pair.actual));
    fold(objections, &DEPTH_KINDS, |objection| match (objection.extra, objection.nominal) {
        (Some(extra), _) => by_them(extra),
        (None, Some(wanted)) => pair_of(wanted).map_or(alone, |pair| by_them(pair.actual)),
        (None, None) => alone,
    });
    // With those behind a finding that is folded itself.
    let folded = objections.iter().filter(|objection| objection.is_folded).count();
    let mut told: Vec<HoleFinding> = wrong
        .into_iter()
        .map(|reach| HoleFinding::unlocated(finding(reach, &reference.process_limits, machine)))
        .collect();
    told[0].finding.notes.extend(folded_note(folded));
    objections.splice(0..0, told);
}

fn finding(mismatch: &LengthMismatch, conduct: &ProcessLimits, machine: &Machine) -> Diagnostic {
    let LengthMismatch { tool, length_excess: beyond, .. } = *mismatch;
    let length = machine.length_of(Some(tool)).unwrap_or_default();
    let (by, side) = (rounded_mm(beyond.abs()), if beyond > 0.0 { "deeper" } else { "higher" });
    let own = conduct.tool_process(Some(tool)).and_then(|duty| duty.offset).unwrap_or(tool);
    let (how, help) = match mismatch.compensation {
        LengthCompensation::Off | LengthCompensation::Plus(0) | LengthCompensation::Minus(0) => {
            ("without its length offset".to_owned(), format!("command G43 H{own} before the first hole"))
        }
        LengthCompensation::Plus(h) if h == own => (
            format!("with H{h}, which is {}", rounded_mm(length - beyond)),
            format!("set H{h} in the control to the length of T{tool}"),
        ),
        LengthCompensation::Plus(h) => {
            (format!("with H{h}, which is {}", rounded_mm(length - beyond)), format!("command G43 H{own}"))
        }
        LengthCompensation::Minus(h) => {
            (format!("with G44 H{h}, which subtracts the length"), format!("command G43 H{own}"))
        }
    };
    let length = rounded_mm(length);
    let message = format!("T{tool}, {length} mm long, cuts {how}: its tip is {by} mm {side} than programmed");
    let other = conduct.tools.first().filter(|_| conduct.tool_process(Some(tool)).is_none());
    let help = match other {
        Some(duty) => format!("use the job's tool, T{}, or {help}", duty.number),
        None => help,
    };
    Diagnostic::new(&LENGTH_OFFSET, message)
        .note("this length error alone explains the missed depths; the length comes from the machine file")
        .help(help)
        .with_backtrace(mismatch.backtrace.clone())
}

/// To a thousandth, without what adding up leaves behind that.
fn rounded_mm(mm: f64) -> f64 {
    (mm * 1e3).round() / 1e3 + 0.0
}

/// Whether the tool's holes are beside the wanted depth, and would be right if its tip were where it is programmed.
fn explains(comparison: &Comparison<'_>, reach: &LengthMismatch) -> bool {
    let tolerance = comparison.tolerances.depth;
    let is_right = |(depth, wanted): (f64, f64)| (depth - wanted).abs() <= tolerance;
    let is_cut = |(depth, wanted): (f64, f64)| 0.0 < depth && depth <= wanted + tolerance;
    let mut explained = 0;
    for (end, axis) in &reach.feed_ends {
        let found = depth(comparison, end, axis);
        if found.is_some_and(is_right) {
            return false;
        }
        let Some(programmed) = depth(comparison, &(end + axis.into_inner() * reach.length_excess), axis)
        else {
            continue;
        };
        // A tool that doesn't finish the hole goes less deep: then at least not above it, nor too deep.
        let is_better = is_cut(programmed) && !found.is_some_and(is_cut);
        explained += usize::from(is_right(programmed) || is_better);
    }
    0 < explained && reach.feed_ends.len() <= 2 * explained
}

/// How deep a point is in the wanted hole along whose line it lies, and how deep that is wanted.
fn depth(comparison: &Comparison<'_>, point: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> Option<(f64, f64)> {
    comparison.nominal.iter().find_map(|hole| {
        let out = Vector3::from(hole.axis);
        let from = point - Point3::from(hole.entry);
        let depth = -from.dot(&out);
        let aside = (from + out * depth).norm();
        (aside <= MAX_LINE_OFFSET && MIN_DIRECTION_COSINE <= out.dot(axis)).then_some((depth, hole.depth))
    })
}
