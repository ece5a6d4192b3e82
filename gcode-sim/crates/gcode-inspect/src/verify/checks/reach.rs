//! A length offset that is not the tool's length, if this error alone explains why its holes miss their depth.
use super::cutting::{CutFindings, round_thousandth};
use super::*;
use crate::findings::{HOLE_DEPTH, HOLE_EXTRA, HOLE_IN_AIR, HOLE_MISSING, HOLES_ALIKE, LENGTH_OFFSET};
use crate::holes::{CutConditions, LengthMismatch, MAX_LINE_OFFSET, OffsetOrigin};
use crate::machine::tool_name;
use gcode_lang::motion::LengthCompensation;
use gcode_part::{PARALLEL_COSINE, POINT_LENGTH};

/// Findings about holes of a wrong depth.
const DEPTH_KINDS: [&FindingKind; 5] = [&HOLE_MISSING, &HOLE_EXTRA, &HOLE_DEPTH, &HOLES_ALIKE, &HOLE_IN_AIR];

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    explain_depths(inspection, findings);
    let mut reported = CutFindings::default();
    for cut in &inspection.extraction.cut_conditions {
        if let Some(finding) = with_other_length(cut, inspection) {
            reported.add(finding, cut);
        }
    }
    reported.finish(findings);
}

/// Reports the wrong length offsets that explain all depths of their tools.
fn explain_depths(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, extraction, reference, .. } = inspection;
    let mismatches = extraction.length_mismatches.iter();
    let wrong: Vec<&LengthMismatch> = mismatches.filter(|one| explains(comparison, one)).collect();
    if wrong.is_empty() {
        return;
    }
    let is_wrong = |actual: usize| {
        let tool = comparison.actual[actual].tool;
        wrong.iter().any(|mismatch| Some(mismatch.tool) == tool)
    };
    // A tool with the right offset may have missed a hole, or belong to a finding about many holes.
    let are_all_wrong = comparison.pairs.iter().all(|pair| is_wrong(pair.actual));
    findings.fold(&DEPTH_KINDS, |subject| match subject {
        Subject::Extra(extra) => is_wrong(extra),
        Subject::Nominal(nominal) => {
            comparison.pair_of(nominal).map_or(are_all_wrong, |pair| is_wrong(pair.actual))
        }
        Subject::Whole | Subject::Motion => are_all_wrong,
    });
    // The findings folded by a finding that is folded here are included.
    let folded = findings.iter().filter(|one| one.is_folded).count();
    let report = |mismatch| finding(mismatch, &reference.process_limits, machine);
    let mut reported: Vec<Diagnostic> = wrong.iter().map(|mismatch| report(mismatch)).collect();
    reported[0].notes.extend(folded_note(folded));
    findings.put_first(reported);
}

fn finding(mismatch: &LengthMismatch, limits: &ProcessLimits, machine: &Machine) -> Diagnostic {
    let LengthMismatch { tool, length_excess: excess, .. } = *mismatch;
    let length = machine.length_of(Some(tool)).unwrap_or_default();
    let own = limits.tool_process(Some(tool)).and_then(|tool| tool.offset).unwrap_or(tool);
    let offset = round_thousandth(length - excess);
    let (how, help) = match mismatch.compensation {
        LengthCompensation::Off | LengthCompensation::Plus(0) | LengthCompensation::Minus(0) => {
            ("without its length offset".to_owned(), format!("command G43 H{own} before the first hole"))
        }
        LengthCompensation::Plus(h) if h == own => (
            format!("with H{h}, which is {offset}"),
            format!("set H{h} in the control to the length of T{tool}"),
        ),
        LengthCompensation::Plus(h) => {
            (format!("with H{h}, which is {offset}"), format!("command G43 H{own}"))
        }
        LengthCompensation::Minus(h) => {
            (format!("with G44 H{h}, which subtracts the length"), format!("command G43 H{own}"))
        }
    };
    let message = format!(
        "T{tool}, {} mm long, cuts {how}: its tip is {} than programmed",
        round_thousandth(length),
        deviation_of_tip(excess)
    );
    let help = match limits.tools.first().filter(|_| limits.tool_process(Some(tool)).is_none()) {
        Some(other) => format!("use the job's tool, T{}, or {help}", other.number),
        None => help,
    };
    let finding = Diagnostic::new(&LENGTH_OFFSET, message)
        .note("this length error alone explains the depths that are wrong; the length comes from the machine file")
        .help(help);
    OffsetOrigin::locate(mismatch.offset_origin.as_ref(), finding, &mismatch.backtrace)
}

/// Reports the length offset of another tool of known length: one that is as long in the machine file may differ on the machine.
/// Where the difference explains depths that are wrong, another finding says so.
fn with_other_length(cut: &CutConditions, inspection: &HoleInspection<'_>) -> Option<Diagnostic> {
    let HoleInspection { comparison, machine, extraction, .. } = inspection;
    let length = machine.length_of(cut.tool).filter(|length| 0.0 < *length)?;
    let LengthCompensation::Plus(h) = cut.compensation else { return None };
    let number = cut.tool.filter(|number| *number != h)?;
    let other = machine.find_tool(h)?.length;
    let is_own = |one: &&LengthMismatch| (one.tool, one.compensation) == (number, cut.compensation);
    let note = match extraction.length_mismatches.iter().find(is_own) {
        Some(one) if explains(comparison, one) => return None,
        Some(one) => format!("its tip is {} than programmed", deviation_of_tip(one.length_excess)),
        None if other == Some(length) => {
            format!("both are {length} mm long in the machine file: on the machine they may differ")
        }
        None => return None,
    };
    let message = format!("{} cuts with H{h}, the number of another tool", tool_name(cut.tool));
    let finding = Diagnostic::new(&LENGTH_OFFSET, message).with_severity(Severity::Warning).note(note);
    Some(finding.help(format!("command H{number}, if offsets have the numbers of their tools")))
}

/// Returns how far the tip of a tool is off, `2 mm higher`, by its length minus its offset.
fn deviation_of_tip(excess: f64) -> String {
    format!("{} mm {}", round_thousandth(excess.abs()), if excess > 0.0 { "deeper" } else { "higher" })
}

/// Returns true if the tool's holes miss the nominal depth, and half of them would not with the tip at the programmed
/// point. A through hole has no nominal depth: there the tip is deeper than programmed.
fn explains(comparison: &Comparison<'_>, mismatch: &LengthMismatch) -> bool {
    let tolerance = comparison.tolerances.depth;
    let is_right = |(depth, nominal): (f64, &Hole)| match nominal.through {
        true => !exceeds(nominal.depth, depth) && !exceeds(depth, longest_break_through(nominal)),
        false => !exceeds((depth - nominal.depth).abs(), tolerance),
    };
    let is_cut = |(depth, nominal): (f64, &Hole)| {
        let deepest =
            if nominal.through { longest_break_through(nominal) } else { nominal.depth + tolerance };
        0.0 < depth && !exceeds(depth, deepest)
    };
    let is_deeper = exceeds(mismatch.length_excess, tolerance);
    let mut explained = 0;
    for (end, axis) in &mismatch.feed_ends {
        let programmed = end + axis.into_inner() * mismatch.length_excess;
        let programmed = depth(comparison, &programmed, axis);
        let is_programmed_right = programmed.is_some_and(is_right);
        let actual = depth(comparison, end, axis);
        let goes_through = actual.is_some_and(|(_, nominal)| nominal.through);
        if actual.is_some_and(is_right) && !(goes_through && is_deeper && is_programmed_right) {
            return false;
        }
        let Some(programmed) = programmed else { continue };
        // A tool that does not finish the hole is less deep, but not above the part.
        let is_better = is_cut(programmed) && !actual.is_some_and(is_cut);
        explained += usize::from(is_programmed_right || is_better);
    }
    0 < explained && mismatch.feed_ends.len() <= 2 * explained
}

/// Returns the deepest tip in a through hole that is no fault, mm: beyond the far side by a drill's point and
/// [`MAX_BREAK_THROUGH`].
fn longest_break_through(nominal: &Hole) -> f64 {
    nominal.depth + POINT_LENGTH * nominal.widest_diameter().unwrap_or(0.0) + MAX_BREAK_THROUGH
}

/// Returns the depth of a point in the nominal hole on whose line it lies, and that hole.
fn depth<'a>(
    comparison: &Comparison<'a>,
    point: &Point3<f64>,
    axis: &Unit<Vector3<f64>>,
) -> Option<(f64, &'a Hole)> {
    comparison.nominal.iter().find_map(|hole| {
        let out = Vector3::from(hole.axis);
        let from = point - Point3::from(hole.entry);
        let depth = -from.dot(&out);
        let aside = (from + out * depth).norm();
        (aside <= MAX_LINE_OFFSET && PARALLEL_COSINE <= out.dot(axis)).then_some((depth, hole))
    })
}
