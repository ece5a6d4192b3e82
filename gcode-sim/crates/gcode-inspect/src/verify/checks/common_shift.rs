//! One wrong number makes many holes wrong alike: said once of all of them, instead of hole by hole.
use nalgebra::{Point3, Vector3};

use super::mirrored::MirrorImage;
use super::{Comparison, HoleFinding, HoleInspection, explained_by_rows};
use crate::findings::{
    HOLE_DEPTH, HOLE_EXTRA, HOLE_MISSING, HOLE_POSITION, HOLE_TILTED, HOLE_TWICE, HOLES_ALIKE, MIRROR_IMAGE,
    ROTARY_SIGN, ROW_ANGLE, ROW_GROUP, ROW_PITCH, ROW_SEAM,
};
use crate::machine::Machine;
use crate::verify::displacement::displacements;
use crate::verify::hole_finding::{fold, folded_note, locate_at_call};
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::AxisIndex;
use gcode_lang::units::Deg;
use gcode_part::Pattern;

/// Fewer holes are told one by one.
const MIN_GROUP_SIZE: usize = 3;

/// Depths that differ by less are the same, in mm.
const SAME_DEPTH: f64 = 0.02;

/// What is found of a single hole in a wrong place.
const POSITION_KINDS: [&FindingKind; 4] = [&HOLE_POSITION, &HOLE_TILTED, &HOLE_MISSING, &HOLE_EXTRA];

/// More different ways to be wrong aren't one fault.
const MAX_GROUPS: usize = 64;

/// Findings about a whole pattern.
const PATTERN_KINDS: [&FindingKind; 6] =
    [&ROW_ANGLE, &ROW_PITCH, &ROW_GROUP, &ROW_SEAM, &ROTARY_SIGN, &MIRROR_IMAGE];

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let HoleInspection { comparison, machine, .. } = inspection;
    // What a whole pattern of rows has wrong is explained by its own checks.
    let explained = objections.iter().position(|objection| objection.is_one_of(&PATTERN_KINDS));
    let mut reported = match explained {
        Some(explained) => {
            let folded = fold_explained(comparison, objections) + fold_tilted(comparison, objections);
            objections[explained].finding.notes.extend(folded_note(folded));
            Vec::new()
        }
        None => {
            let told = report_common_shifts(comparison, machine, objections);
            if !told.is_empty() {
                fold_tilted(comparison, objections);
            }
            told
        }
    };
    reported.extend(report_common_depths(comparison, objections));
    // Rows that stand wrong may close the circle upon one another: that is no second round.
    let repeated = if explained.is_none() { report_repeated_set(comparison, objections) } else { None };
    objections.splice(0..0, reported.into_iter().map(HoleFinding::unlocated));
    objections.extend(repeated.map(HoleFinding::unlocated));
}

/// Puts the places behind what is wrong with the whole, as far as that puts them there.
fn fold_explained(comparison: &Comparison<'_>, objections: &mut [HoleFinding]) -> usize {
    if let Some(mirrored) = MirrorImage::of(comparison) {
        return fold(objections, &POSITION_KINDS, |objection| {
            objection.nominal.is_some_and(|wanted| mirrored.nominal[wanted])
                || objection.extra.is_some_and(|extra| mirrored.actual[extra])
        });
    }
    match comparison.pattern.and_then(|pattern| explained_by_rows::explains(comparison, pattern)) {
        Some(explains) => fold(objections, &POSITION_KINDS, explains),
        None => 0,
    }
}

/// A hole of a row that is turned is deeper for that alone: its bottom, on its way round the cylinder's axis, sinks below
/// the plane it should reach.
fn fold_tilted(comparison: &Comparison<'_>, objections: &mut [HoleFinding]) -> usize {
    if comparison.pattern.is_none() {
        return 0;
    }
    let mut is_tilt_only = vec![false; comparison.nominal.len()];
    for pair in &comparison.pairs {
        let bottom = comparison.actual[pair.actual].bottom();
        let sinks = libm::hypot(bottom.y, bottom.z) * (1.0 - pair.deviation.tilt.cos());
        is_tilt_only[pair.nominal] =
            (pair.deviation.depth_error - sinks).abs() <= comparison.tolerances.depth;
    }
    fold(objections, &[&HOLE_DEPTH], |objection| objection.nominal.is_some_and(|wanted| is_tilt_only[wanted]))
}

fn report_common_depths(comparison: &Comparison<'_>, objections: &mut [HoleFinding]) -> Vec<Diagnostic> {
    let mut has_depth_finding = vec![false; comparison.nominal.len()];
    for objection in objections.iter().filter(|o| !o.is_folded && o.finding.kind == &HOLE_DEPTH) {
        objection.nominal.into_iter().for_each(|wanted| has_depth_finding[wanted] = true);
    }
    let wrong: Vec<_> = comparison.pairs.iter().filter(|pair| has_depth_finding[pair.nominal]).collect();
    let groups =
        groups(&wrong, |a, b| (a.deviation.depth_error - b.deviation.depth_error).abs() < SAME_DEPTH);
    let mut reported = Vec::new();
    for group in groups {
        let error = group[0].deviation.depth_error;
        let members: Vec<usize> = group.iter().map(|pair| pair.nominal).collect();
        let is_one = membership(comparison.nominal.len(), &members);
        let folded = fold(objections, &[&HOLE_DEPTH], |o| o.nominal.is_some_and(|wanted| is_one[wanted]));
        let by = group.iter().map(|pair| pair.deviation.depth_error.abs());
        let (least, most) =
            by.fold((f64::INFINITY, 0.0f64), |(least, most), by| (least.min(by), most.max(by)));
        let by = match most - least < 0.001 {
            true => format!("{:.3}", error.abs()),
            false => format!("{least:.3} to {most:.3}"),
        };
        let message = format!(
            "{}: {by} mm too {} (tolerance ±{})",
            describe_set(comparison, &members),
            if error > 0.0 { "deep" } else { "shallow" },
            comparison.tolerances.depth
        );
        let mut finding = Diagnostic::new(&HOLES_ALIKE, message)
            .help("check the programmed depth, the zero along the tool axis, the tool length and its offset");
        let wanted = comparison.nominal[group[0].nominal].depth;
        finding.notes.extend(super::depth::mistaken_factor(wanted, wanted + error).map(str::to_owned));
        finding.notes.extend(folded_note(folded));
        reported.push(locate_at_call(finding, &comparison.actual[group[0].actual].backtrace));
    }
    reported
}

fn report_common_shifts(
    comparison: &Comparison<'_>,
    machine: &Machine,
    objections: &mut [HoleFinding],
) -> Vec<Diagnostic> {
    let tolerance = comparison.tolerances.position;
    if comparison.is_all_in_place() {
        return Vec::new();
    }
    let mut wrong = displacements(comparison, machine);
    let phi: Vec<f64> = position_deviations(comparison);
    // What is off along the hole alone stands over its place or below it: that is no matter of places.
    wrong.retain(|off| {
        let aside = off.rotation.is_some() || 0.0005 <= off.offset.norm();
        aside && (!off.is_matched || tolerance < phi[off.nominal])
    });
    let mut reported = Vec::new();
    for group in groups(&wrong.iter().collect::<Vec<_>>(), |a, b| a.is_same_error(b)) {
        let members: Vec<usize> = group.iter().map(|off| off.nominal).collect();
        let drilled: Vec<usize> = group.iter().map(|off| off.actual).collect();
        let is_wanted = membership(comparison.nominal.len(), &members);
        let is_drilled = membership(comparison.actual.len(), &drilled);
        let folded = fold(objections, &POSITION_KINDS, |o| {
            o.nominal.is_some_and(|wanted| is_wanted[wanted])
                || o.extra.is_some_and(|extra| is_drilled[extra])
        });
        let set = describe_set(comparison, &members);
        let mut finding = match group[0].rotation {
            Some((axis, by)) => rotation_finding(&set, machine, axis, by),
            None => shift_finding(&set, &group[0].offset, comparison.pattern),
        };
        finding.notes.extend(folded_note(folded));
        reported.push(locate_at_call(finding, &comparison.actual[group[0].actual].backtrace));
    }
    reported
}

/// A row, or the whole part, that is drilled again.
fn report_repeated_set(comparison: &Comparison<'_>, objections: &mut [HoleFinding]) -> Option<Diagnostic> {
    let repeated = |extra: &usize| Some((*extra, comparison.nominal_on_line_of(*extra)?));
    let (extras, mut members): (Vec<usize>, Vec<usize>) =
        comparison.extra.iter().filter_map(repeated).unzip();
    members.sort_unstable();
    members.dedup();
    if members.len() < MIN_GROUP_SIZE {
        return None;
    }
    let is_again = membership(comparison.actual.len(), &extras);
    let folded = fold(objections, &[&HOLE_TWICE], |o| o.extra.is_some_and(|extra| is_again[extra]));
    let set = describe_set(comparison, &members);
    let mut finding = Diagnostic::new(&HOLE_TWICE, format!("{set}: drilled a second time")).help(
        "remove the second call, or the second iteration of the loop: the same tool drills these holes twice",
    );
    finding.notes.extend(folded_note(folded));
    Some(locate_at_call(finding, &comparison.actual[extras[0]].backtrace))
}

fn rotation_finding(set: &str, machine: &Machine, axis: AxisIndex, by: Deg) -> Diagnostic {
    let letter = machine.axes.letter(axis);
    Diagnostic::new(&HOLES_ALIKE, format!("{set}: rotated by {letter}{:+.3}°", by.0))
        .help(format!("correct {letter} in the program, or its zero in the work offset"))
}

fn shift_finding(set: &str, offset: &Vector3<f64>, pattern: Option<&Pattern>) -> Diagnostic {
    let axes = [('X', offset.x), ('Y', offset.y), ('Z', offset.z)];
    let by: Vec<_> = axes
        .iter()
        .filter(|(_, by)| 0.0005 <= by.abs())
        .map(|(letter, by)| format!("{letter}{by:+.3}"))
        .collect();
    // A honeycomb's cylinder lies along x: what goes across that leaves its axis.
    let off_axis_note = match pattern {
        Some(_) if libm::hypot(offset.y, offset.z) > 0.0005 => ", off the cylinder axis",
        _ => "",
    };
    Diagnostic::new(&HOLES_ALIKE, format!("{set}: shifted by {}{off_axis_note}", by.join(" "))).help(
        "correct the programmed point or the work offset: the shift is actual − nominal along the machine axes",
    )
}

/// Which of so many these are.
fn membership(count: usize, members: &[usize]) -> Vec<bool> {
    let mut is_one = vec![false; count];
    members.iter().for_each(|member| is_one[*member] = true);
    is_one
}

/// Of each wanted hole that was drilled.
fn position_deviations(comparison: &Comparison<'_>) -> Vec<f64> {
    let mut phi = vec![0.0; comparison.nominal.len()];
    for pair in &comparison.pairs {
        phi[pair.nominal] = pair.deviation.zone_diameter();
    }
    phi
}

/// Those that are like one another, three at least, the largest group first.
fn groups<'a, T>(all: &[&'a T], is_alike: impl Fn(&T, &T) -> bool) -> Vec<Vec<&'a T>> {
    let mut groups: Vec<Vec<&'a T>> = Vec::new();
    for one in all {
        match groups.iter().position(|group| is_alike(group[0], one)) {
            Some(group) => groups[group].push(one),
            None if groups.len() < MAX_GROUPS => groups.push(vec![one]),
            None => {}
        }
    }
    groups.retain(|group| MIN_GROUP_SIZE <= group.len());
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups
}

/// Which holes these are, in the words of somebody who looks at the part.
fn describe_set(comparison: &Comparison<'_>, members: &[usize]) -> String {
    let (count, all) = (members.len(), comparison.nominal.len());
    if count == all {
        return format!("all {count} holes");
    }
    if let Some(pattern) = comparison.pattern {
        let row = |wanted: usize| pattern.row_of(&Point3::from(comparison.nominal[wanted].entry));
        let of = |belongs: &dyn Fn(usize) -> bool| (0..all).filter(|wanted| belongs(row(*wanted))).count();
        let first = row(members[0]);
        if members.iter().all(|member| row(*member) == first) {
            let whole = of(&|row| row == first);
            return match whole == count {
                true => format!("row {first} ({count} holes)"),
                false => format!("{count} of {whole} holes of row {first}"),
            };
        }
        let group = first % 2;
        if members.iter().all(|member| row(*member) % 2 == group) && of(&|row| row % 2 == group) == count {
            return format!("the {} group of rows ({count} holes)", ["first", "second"][group]);
        }
    }
    format!("{count} of {all} holes (first: {})", comparison.id(members[0]))
}
