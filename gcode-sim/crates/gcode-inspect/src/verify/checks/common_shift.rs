//! One deviation that many holes share because of one wrong number: one finding instead of one for each hole.
use super::transformed::shift_words;
use super::*;
use crate::findings::{
    HOLE_DEPTH, HOLE_EXTRA, HOLE_MISSING, HOLE_POSITION, HOLE_TILTED, HOLE_TWICE, HOLES_ALIKE,
    HOLES_TRANSFORMED, MIRROR_IMAGE, ROTARY_SIGN, ROW_ANGLE, ROW_GROUP, ROW_PITCH, ROW_SEAM,
};
use crate::verify::displacement::{HoleDisplacement, displacements};
use crate::verify::hole_finding::calls_of;
use gcode_lang::motion::Backtrace;
use gcode_lang::source::Span;

/// A finding about many holes, with its words for the first line of the verdict.
type GroupFinding = (Diagnostic, Option<String>);

/// Least number of holes for one finding.
pub(super) const MIN_GROUP_SIZE: usize = 3;

/// Largest number of groups: more different deviations have no common cause.
const MAX_GROUPS: usize = 64;

/// Depths that differ by less are equal, mm.
const SAME_DEPTH: f64 = 0.02;

/// Tilts that differ by less are equal.
const SAME_TILT: Deg = Deg(0.02);

/// Offsets below this are rounding, mm.
const MIN_OFFSET: f64 = 0.0005;

/// Findings about the position of a single hole.
const POSITION_KINDS: [&FindingKind; 4] = [&HOLE_POSITION, &HOLE_TILTED, &HOLE_MISSING, &HOLE_EXTRA];

/// Findings about a whole pattern.
const PATTERN_KINDS: [&FindingKind; 7] =
    [&ROW_ANGLE, &ROW_PITCH, &ROW_GROUP, &ROW_SEAM, &ROTARY_SIGN, &MIRROR_IMAGE, &HOLES_TRANSFORMED];

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    // The checks on rows explain a fault of the whole pattern; its rows may meet, which is no repetition.
    let (mut reported, repeated) = match findings.first_of_kind(&PATTERN_KINDS) {
        Some(explanation) => {
            let folded = fold_explained(inspection, findings) + fold_tilted(comparison, findings);
            findings.add_notes(explanation, folded_note(folded));
            (Vec::new(), Vec::new())
        }
        None => {
            let reported = report_common_shifts(comparison, inspection.machine, findings);
            if !reported.is_empty() {
                fold_tilted(comparison, findings);
            }
            (reported, report_repeated_sets(comparison, findings))
        }
    };
    // A tilted hole is less deep: the tilt comes first.
    reported.extend(report_common_tilts(comparison, findings));
    reported.extend(report_common_depths(comparison, findings));
    findings.put_first_summed(reported);
    repeated.into_iter().for_each(|finding| findings.add(Subject::Whole, finding));
}

/// Folds the findings about positions that follow from the fault of the pattern; returns their number.
fn fold_explained(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) -> usize {
    if let Some(image) = &inspection.mirror_image {
        return findings.fold(&POSITION_KINDS, |subject| image.in_place.contains(&subject));
    }
    if let Some(transformation) = &inspection.transformation {
        let subjects: BTreeSet<Subject> = transformation
            .explained
            .iter()
            .flat_map(|(nominal, actual)| [Some(Subject::Nominal(*nominal)), actual.map(Subject::Extra)])
            .flatten()
            .collect();
        let folded = findings.fold(&POSITION_KINDS, |subject| subjects.contains(&subject));
        // Without the tool of the extra holes the nominal ones are not finished.
        let unfinished = if transformation.extra.is_some() { &tools::FOLLOWING_KINDS[..] } else { &[] };
        return folded + findings.fold(unfinished, |subject| subjects.contains(&subject));
    }
    match explained_by_rows::explains(inspection) {
        Some(explains) => findings.fold(&POSITION_KINDS, explains),
        None => 0,
    }
}

/// Folds depth findings that follow from the tilt: the bottom of a hole in a rotated row sinks below its plane.
fn fold_tilted(comparison: &Comparison<'_>, findings: &mut HoleFindings) -> usize {
    if comparison.pattern.is_none() {
        return 0;
    }
    let tilted = comparison.matched().filter(|(pair, _, drilled)| {
        let bottom = drilled.bottom();
        let sinks = libm::hypot(bottom.y, bottom.z) * (1.0 - pair.deviation.tilt.cos());
        !exceeds((pair.deviation.depth_error - sinks).abs(), comparison.tolerances.depth)
    });
    let tilted: BTreeSet<Subject> = tilted.map(|(pair, ..)| Subject::Nominal(pair.nominal)).collect();
    findings.fold(&[&HOLE_DEPTH], |subject| tilted.contains(&subject))
}

/// Returns the pairs of holes that have a finding of a kind.
fn pairs_with<'c>(
    kind: &'static FindingKind,
    comparison: &'c Comparison<'_>,
    findings: &HoleFindings,
) -> Vec<&'c HolePair> {
    let shown = findings.iter().filter(|one| !one.is_folded && one.finding.kind == kind);
    let shown: BTreeSet<Subject> = shown.map(|one| one.subject).collect();
    comparison.pairs.iter().filter(|pair| shown.contains(&Subject::Nominal(pair.nominal))).collect()
}

/// Reports holes with one tilt, of a head, a table or a tilted plane; a depth error that follows from it is folded.
fn report_common_tilts(comparison: &Comparison<'_>, findings: &mut HoleFindings) -> Vec<GroupFinding> {
    let wrong = pairs_with(&HOLE_TILTED, comparison, findings);
    let tilt = |pair: &HolePair| pair.deviation.tilt;
    let report = |group: Vec<&HolePair>| {
        let (nominal, actual) = group.iter().map(|pair| (pair.nominal, pair.actual)).unzip();
        let (holes, folded) = fold_group(comparison, findings, &[&HOLE_TILTED], nominal, actual);
        let follows = |pair: &&&HolePair| {
            let shortened = comparison.nominal[pair.nominal].depth * (tilt(pair).cos() - 1.0);
            !exceeds((pair.deviation.depth_error - shortened).abs(), comparison.tolerances.depth)
        };
        let following: BTreeSet<Subject> =
            group.iter().filter(follows).map(|pair| Subject::Nominal(pair.nominal)).collect();
        let folded = folded + findings.fold(&[&HOLE_DEPTH], |subject| following.contains(&subject));
        let error = format!("tilted by {:.3}°", tilt(group[0]).0);
        let message = format!("{holes}: {error} (position tolerance Φ{})", comparison.tolerances.position);
        let finding = Diagnostic::new(&HOLES_ALIKE, message)
            .help("check the head angle or the tilted plane, and that the feed runs along the holes");
        let members: BTreeSet<usize> = group.iter().map(|pair| pair.actual).collect();
        (locate_group(finding, folded, comparison, &members, group[0].actual), summed(&holes, &error))
    };
    groups(wrong, |a, b| (tilt(a).0 - tilt(b).0).abs() < SAME_TILT.0).into_iter().map(report).collect()
}

fn report_common_depths(comparison: &Comparison<'_>, findings: &mut HoleFindings) -> Vec<GroupFinding> {
    let wrong = pairs_with(&HOLE_DEPTH, comparison, findings);
    let error = |pair: &HolePair| pair.deviation.depth_error;
    let report = |group: Vec<&HolePair>| {
        let (nominal, actual) = group.iter().map(|pair| (pair.nominal, pair.actual)).unzip();
        let (holes, folded) = fold_group(comparison, findings, &[&HOLE_DEPTH], nominal, actual);
        let sizes = || group.iter().map(|pair| error(pair).abs());
        let first = error(group[0]);
        let error = format!(
            "{} mm too {}",
            format_range(sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max)),
            if first > 0.0 { "deep" } else { "shallow" },
        );
        let message = format!("{holes}: {error} (tolerance ±{})", comparison.tolerances.depth);
        let mut finding = Diagnostic::new(&HOLES_ALIKE, message)
            .help("check the programmed depth, the zero along the tool axis, the tool length and its offset");
        let nominal = comparison.nominal[group[0].nominal].depth;
        finding.notes.extend(depth::mistaken_factor(nominal, nominal + first).map(str::to_owned));
        let members: BTreeSet<usize> = group.iter().map(|pair| pair.actual).collect();
        (locate_group(finding, folded, comparison, &members, group[0].actual), summed(&holes, &error))
    };
    groups(wrong, |a, b| (error(a) - error(b)).abs() < SAME_DEPTH).into_iter().map(report).collect()
}

fn report_common_shifts(
    comparison: &Comparison<'_>,
    machine: &Machine,
    findings: &mut HoleFindings,
) -> Vec<GroupFinding> {
    if comparison.is_all_in_place() {
        return Vec::new();
    }
    let in_place = comparison.pairs.iter().filter(|pair| comparison.is_in_place(pair));
    let in_place: BTreeSet<usize> = in_place.map(|pair| pair.nominal).collect();
    let mut wrong = displacements(comparison, machine);
    // An offset along the hole alone is no displacement.
    wrong.retain(|off| {
        let is_displaced = off.rotation.is_some() || MIN_OFFSET <= off.offset.norm();
        is_displaced && !(off.is_matched && in_place.contains(&off.nominal))
    });
    let report = |group: Vec<&HoleDisplacement>| {
        let (nominal, actual) = group.iter().map(|off| (off.nominal, off.actual)).unzip();
        let (holes, folded) = fold_group(comparison, findings, &POSITION_KINDS, nominal, actual);
        let (error, help) = match group[0].rotation {
            Some((axis, by)) => {
                let letter = machine.axes.letter(axis);
                let help = format!("correct {letter} in the program, or its zero in the work offset");
                (format!("rotated by {letter}{:+.3}°", by.0), help)
            }
            None => describe_shift(&group[0].offset, comparison.pattern),
        };
        let finding = Diagnostic::new(&HOLES_ALIKE, format!("{holes}: {error}")).help(help);
        let members: BTreeSet<usize> = group.iter().map(|off| off.actual).collect();
        (locate_group(finding, folded, comparison, &members, group[0].actual), summed(&holes, &error))
    };
    groups(&wrong, HoleDisplacement::is_same_error).into_iter().map(report).collect()
}

/// Reports rows, or the whole part, that are drilled again: those of spring passes, and the others.
fn report_repeated_sets(comparison: &Comparison<'_>, findings: &mut HoleFindings) -> Vec<Diagnostic> {
    let sets = [(&comparison.repeated, Severity::Warning), (&comparison.extra, HOLE_TWICE.severity)];
    let report = |(drilled, severity): (&Vec<usize>, Severity)| {
        let repeated = |index: &usize| Some((comparison.nominal_on_line_of(*index)?, *index));
        let (nominal, actual): (BTreeSet<usize>, Vec<usize>) = drilled.iter().filter_map(repeated).unzip();
        if nominal.len() < MIN_GROUP_SIZE {
            return None;
        }
        let first = &comparison.actual[actual[0]];
        let nominal = nominal.into_iter().collect();
        let (holes, folded) = fold_group(comparison, findings, &[&HOLE_TWICE], nominal, actual);
        let finding = Diagnostic::new(&HOLE_TWICE, format!("{holes}: drilled a second time"))
            .with_severity(severity)
            .help("remove the second call, or the second iteration of the loop: the same tool drills these holes twice");
        Some(finish_group_finding(finding, folded, &first.backtrace))
    };
    sets.into_iter().filter_map(report).collect()
}

/// Returns a shift in words, and its remedy.
fn describe_shift(offset: &Vector3<f64>, pattern: Option<&Pattern>) -> (String, String) {
    // The cylinder of a honeycomb lies along x.
    let is_off_axis = pattern.is_some() && libm::hypot(offset.y, offset.z) > MIN_OFFSET;
    let off_axis = if is_off_axis { ", off the cylinder axis" } else { "" };
    let help = "correct the programmed point or the work offset: the shift is actual − nominal along the machine axes";
    (format!("shifted by {}{off_axis}", shift_words(offset)), help.to_owned())
}

/// Returns `3 of 18 holes shifted by X+1.000` for the first line of a verdict.
fn summed(holes: &str, error: &str) -> Option<String> {
    let holes = holes.split(" (first: ").next().unwrap_or(holes);
    Some(format!("{holes} {error}"))
}

/// Locates a finding about some drilled holes at the outermost call that makes no others, or at their first block.
fn locate_group(
    mut finding: Diagnostic,
    folded: usize,
    comparison: &Comparison<'_>,
    members: &BTreeSet<usize>,
    first: usize,
) -> Diagnostic {
    let has_call =
        |backtrace: &Backtrace, block: Span| calls_of(backtrace).any(|call| call.calling_block == block);
    let makes_others = |is_in: &dyn Fn(&Backtrace) -> bool| {
        let others = comparison.actual.iter().enumerate().filter(|(index, _)| !members.contains(index));
        others.map(|(_, hole)| &hole.backtrace).any(is_in)
    };
    let backtrace = &comparison.actual[first].backtrace;
    finding.notes.extend(folded_note(folded));
    let outermost = calls_of(backtrace).last().map(|call| call.calling_block);
    if outermost.is_none_or(|block| !makes_others(&|other| has_call(other, block))) {
        return locate_at_call(finding, backtrace);
    }
    if makes_others(&|other| other.block == backtrace.block) {
        finding.notes.push("this block makes other holes too: the wrong number is elsewhere".to_owned());
    }
    finding.with_backtrace(backtrace.clone())
}

/// Folds the findings about a group of holes; returns its description and their number.
fn fold_group(
    comparison: &Comparison<'_>,
    findings: &mut HoleFindings,
    kinds: &[&FindingKind],
    nominal: Vec<usize>,
    actual: Vec<usize>,
) -> (String, usize) {
    let subjects = nominal.iter().map(|hole| Subject::Nominal(*hole));
    let subjects: BTreeSet<Subject> = subjects.chain(actual.into_iter().map(Subject::Extra)).collect();
    let folded = findings.fold(kinds, |subject| subjects.contains(&subject));
    (describe_set(comparison, &nominal), folded)
}

/// Returns the groups of at least [`MIN_GROUP_SIZE`] that are alike, the largest first.
fn groups<'a, T>(all: impl IntoIterator<Item = &'a T>, is_alike: impl Fn(&T, &T) -> bool) -> Vec<Vec<&'a T>> {
    let mut groups: Vec<Vec<&'a T>> = Vec::new();
    for one in all {
        match groups.iter().position(|group| is_alike(group[0], one)) {
            Some(index) => groups[index].push(one),
            None if groups.len() < MAX_GROUPS => groups.push(vec![one]),
            None => {}
        }
    }
    groups.retain(|group| MIN_GROUP_SIZE <= group.len());
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups
}

/// Describes a set of nominal holes: all, a row, a group of rows, or their number and the first.
pub(super) fn describe_set(comparison: &Comparison<'_>, members: &[usize]) -> String {
    let (count, all) = (members.len(), comparison.nominal.len());
    if count == all {
        return format!("all {count} holes");
    }
    if let Some(pattern) = comparison.pattern {
        let row = |nominal: usize| pattern.row_of(&Point3::from(comparison.nominal[nominal].entry));
        let first = row(members[0]);
        let total = |is_in: &dyn Fn(usize) -> bool| (0..all).filter(|nominal| is_in(row(*nominal))).count();
        if members.iter().all(|member| row(*member) == first) {
            let whole = total(&|row| row == first);
            return match whole == count {
                true => format!("row {first} ({count} holes)"),
                false => format!("{count} of {whole} holes of row {first}"),
            };
        }
        let is_in_group = |row: usize| row % 2 == first % 2;
        if members.iter().all(|member| is_in_group(row(*member))) && total(&is_in_group) == count {
            return format!("the {} group of rows ({count} holes)", ["first", "second"][first % 2]);
        }
    }
    format!("{count} of {all} holes (first: {})", comparison.id(members[0]))
}
