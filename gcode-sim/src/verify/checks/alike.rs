//! One wrong number makes many holes wrong alike: said once of all of them, instead of hole by hole.
use nalgebra::{Point3, Vector3};

use super::mirrored::Mirrored;
use super::{Comparison, Objection, of_rows};
use crate::diag::Diagnostic;
use crate::machine::Machine;
use crate::motion::Axis;
use crate::part::honeycomb::Pattern;
use crate::units::Deg;
use crate::verify::objection::{at_the_call, behind, fold};
use crate::verify::off::offs;

/// Fewer holes are told one by one.
const FEWEST: usize = 3;

/// Depths that differ by less are the same, in mm.
const SAME_DEPTH: f64 = 0.02;

/// What is found of a single hole in a wrong place.
const OF_PLACES: [&str; 4] = ["hole-position", "hole-tilted", "hole-missing", "hole-extra"];

/// More different ways to be wrong aren't one fault.
const WAYS: usize = 64;

pub(in crate::verify) fn check(
    comparison: &Comparison<'_>,
    machine: &Machine,
    objections: &mut Vec<Objection>,
) {
    // What a whole pattern of rows has wrong is explained by its own checks.
    let whole = ["row-angle", "row-pitch", "row-group", "row-seam", "rotary-sign", "mirror-image"];
    let explained = objections.iter().position(|objection| whole.contains(&objection.finding.code.as_str()));
    let mut told = match explained {
        Some(explained) => {
            let folded = fold_explained(comparison, objections) + fold_leaning(comparison, objections);
            objections[explained].finding.notes.extend(behind(folded));
            Vec::new()
        }
        None => {
            let told = places(comparison, machine, objections);
            if !told.is_empty() {
                fold_leaning(comparison, objections);
            }
            told
        }
    };
    told.extend(depths(comparison, objections));
    // Rows that stand wrong may close the circle upon one another: that is no second round.
    let again = if explained.is_none() { twice(comparison, objections) } else { None };
    objections.splice(0..0, told.into_iter().map(Objection::whole));
    objections.extend(again.map(Objection::whole));
}

/// Puts the places behind what is wrong with the whole, as far as that puts them there.
fn fold_explained(comparison: &Comparison<'_>, objections: &mut [Objection]) -> usize {
    if let Some(mirrored) = Mirrored::of(comparison) {
        return fold(objections, &OF_PLACES, |objection| {
            objection.wanted.is_some_and(|wanted| mirrored.wanted[wanted])
                || objection.extra.is_some_and(|extra| mirrored.found[extra])
        });
    }
    match comparison.pattern.and_then(|pattern| of_rows::explains(comparison, pattern)) {
        Some(explains) => fold(objections, &OF_PLACES, explains),
        None => 0,
    }
}

/// A hole of a row that is turned is deeper for that alone: its bottom, on its way round the cylinder's axis, sinks below
/// the plane it should reach.
fn fold_leaning(comparison: &Comparison<'_>, objections: &mut [Objection]) -> usize {
    if comparison.pattern.is_none() {
        return 0;
    }
    let mut leans = vec![false; comparison.wanted.len()];
    for pair in &comparison.pairs {
        let bottom = comparison.found[pair.found].bottom();
        let sinks = libm::hypot(bottom.y, bottom.z) * (1.0 - pair.deviation.tilt.cos());
        leans[pair.wanted] = (pair.deviation.depth_error - sinks).abs() <= comparison.tolerances.depth;
    }
    fold(objections, &["hole-depth"], |objection| objection.wanted.is_some_and(|wanted| leans[wanted]))
}

fn depths(comparison: &Comparison<'_>, objections: &mut [Objection]) -> Vec<Diagnostic> {
    let mut open = vec![false; comparison.wanted.len()];
    for objection in objections.iter().filter(|o| !o.folded && o.finding.code == "hole-depth") {
        objection.wanted.into_iter().for_each(|wanted| open[wanted] = true);
    }
    let wrong: Vec<_> = comparison.pairs.iter().filter(|pair| open[pair.wanted]).collect();
    let groups =
        groups(&wrong, |a, b| (a.deviation.depth_error - b.deviation.depth_error).abs() < SAME_DEPTH);
    let mut told = Vec::new();
    for group in groups {
        let error = group[0].deviation.depth_error;
        let members: Vec<usize> = group.iter().map(|pair| pair.wanted).collect();
        let is_one = among(comparison.wanted.len(), &members);
        let folded = fold(objections, &["hole-depth"], |o| o.wanted.is_some_and(|wanted| is_one[wanted]));
        let by = group.iter().map(|pair| pair.deviation.depth_error.abs());
        let (least, most) =
            by.fold((f64::INFINITY, 0.0f64), |(least, most), by| (least.min(by), most.max(by)));
        let by = match most - least < 0.001 {
            true => format!("{:.3}", error.abs()),
            false => format!("{least:.3} to {most:.3}"),
        };
        let message = format!(
            "{}: {by} mm too {} (tolerance ±{})",
            which(comparison, &members),
            if error > 0.0 { "deep" } else { "shallow" },
            comparison.tolerances.depth
        );
        let mut finding = Diagnostic::error("holes-alike", message)
            .help("check the programmed depth, the zero along the tool axis, the tool length and its offset");
        let wanted = comparison.wanted[group[0].wanted].depth;
        finding.notes.extend(super::depth::factor(wanted, wanted + error).map(str::to_owned));
        finding.notes.extend(behind(folded));
        told.push(at_the_call(finding, &comparison.found[group[0].found].place));
    }
    told
}

fn places(comparison: &Comparison<'_>, machine: &Machine, objections: &mut [Objection]) -> Vec<Diagnostic> {
    let tolerance = comparison.tolerances.position;
    if comparison.all_in_place() {
        return Vec::new();
    }
    let mut wrong = offs(comparison, machine);
    let phi: Vec<f64> = phis(comparison);
    // What is off along the hole alone stands over its place or below it: that is no matter of places.
    wrong.retain(|off| {
        let aside = off.turned.is_some() || 0.0005 <= off.aside.norm();
        aside && (!off.near || tolerance < phi[off.wanted])
    });
    let mut told = Vec::new();
    for group in groups(&wrong.iter().collect::<Vec<_>>(), |a, b| a.is_like(b)) {
        let members: Vec<usize> = group.iter().map(|off| off.wanted).collect();
        let drilled: Vec<usize> = group.iter().map(|off| off.found).collect();
        let is_wanted = among(comparison.wanted.len(), &members);
        let is_drilled = among(comparison.found.len(), &drilled);
        let folded = fold(objections, &OF_PLACES, |o| {
            o.wanted.is_some_and(|wanted| is_wanted[wanted]) || o.extra.is_some_and(|extra| is_drilled[extra])
        });
        let set = which(comparison, &members);
        let mut finding = match group[0].turned {
            Some((axis, by)) => turned(&set, machine, axis, by),
            None => shifted(&set, &group[0].aside, comparison.pattern),
        };
        finding.notes.extend(behind(folded));
        told.push(at_the_call(finding, &comparison.found[group[0].found].place));
    }
    told
}

/// A row, or the whole part, that is drilled again.
fn twice(comparison: &Comparison<'_>, objections: &mut [Objection]) -> Option<Diagnostic> {
    let again = |extra: &usize| Some((*extra, comparison.wanted_on_line_of(*extra)?));
    let (extras, mut members): (Vec<usize>, Vec<usize>) = comparison.extra.iter().filter_map(again).unzip();
    members.sort_unstable();
    members.dedup();
    if members.len() < FEWEST {
        return None;
    }
    let is_again = among(comparison.found.len(), &extras);
    let folded = fold(objections, &["hole-twice"], |o| o.extra.is_some_and(|extra| is_again[extra]));
    let set = which(comparison, &members);
    let mut finding = Diagnostic::error("hole-twice", format!("{set}: drilled a second time")).help(
        "remove the second call, or the second iteration of the loop: the same tool drills these holes twice",
    );
    finding.notes.extend(behind(folded));
    Some(at_the_call(finding, &comparison.found[extras[0]].place))
}

fn turned(set: &str, machine: &Machine, axis: Axis, by: Deg) -> Diagnostic {
    let letter = machine.axes.letter(axis);
    Diagnostic::error("holes-alike", format!("{set}: rotated by {letter}{:+.3}°", by.0))
        .help(format!("correct {letter} in the program, or its zero in the work offset"))
}

fn shifted(set: &str, aside: &Vector3<f64>, pattern: Option<&Pattern>) -> Diagnostic {
    let axes = [('X', aside.x), ('Y', aside.y), ('Z', aside.z)];
    let by: Vec<_> = axes
        .iter()
        .filter(|(_, by)| 0.0005 <= by.abs())
        .map(|(letter, by)| format!("{letter}{by:+.3}"))
        .collect();
    // A honeycomb's cylinder lies along x: what goes across that leaves its axis.
    let beside = match pattern {
        Some(_) if libm::hypot(aside.y, aside.z) > 0.0005 => ", off the cylinder axis",
        _ => "",
    };
    Diagnostic::error("holes-alike", format!("{set}: shifted by {}{beside}", by.join(" "))).help(
        "correct the programmed point or the work offset: the shift is actual − nominal along the machine axes",
    )
}

/// Which of so many these are.
fn among(count: usize, members: &[usize]) -> Vec<bool> {
    let mut is_one = vec![false; count];
    members.iter().for_each(|member| is_one[*member] = true);
    is_one
}

/// Of each wanted hole that was drilled.
fn phis(comparison: &Comparison<'_>) -> Vec<f64> {
    let mut phi = vec![0.0; comparison.wanted.len()];
    for pair in &comparison.pairs {
        phi[pair.wanted] = pair.deviation.phi();
    }
    phi
}

/// Those that are like one another, three at least, the largest group first.
fn groups<'a, T>(all: &[&'a T], like: impl Fn(&T, &T) -> bool) -> Vec<Vec<&'a T>> {
    let mut groups: Vec<Vec<&'a T>> = Vec::new();
    for one in all {
        match groups.iter().position(|group| like(group[0], one)) {
            Some(group) => groups[group].push(one),
            None if groups.len() < WAYS => groups.push(vec![one]),
            None => {}
        }
    }
    groups.retain(|group| FEWEST <= group.len());
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups
}

/// Which holes these are, in the words of somebody who looks at the part.
fn which(comparison: &Comparison<'_>, members: &[usize]) -> String {
    let (count, all) = (members.len(), comparison.wanted.len());
    if count == all {
        return format!("all {count} holes");
    }
    if let Some(pattern) = comparison.pattern {
        let row = |wanted: usize| pattern.row_of(&Point3::from(comparison.wanted[wanted].entry));
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
