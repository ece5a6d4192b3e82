//! Whole rows of a honeycomb that nobody drilled are named as rows.
use nalgebra::Point3;

use super::{Comparison, HoleFinding, HoleInspection};
use crate::findings::{HOLE_MISSING, ROW_ANGLE, ROW_GROUP, ROW_MISSING, ROW_SHORT};
use crate::verify::hole_finding::{fold, folded_note, locate_at_call};
use gcode_lang::diag::Diagnostic;
use gcode_lang::units::Deg;
use gcode_part::Pattern;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(pattern) = comparison.pattern else { return };
    let Some(last) = comparison.pairs.last() else { return };
    // Half of the pattern is told as that, and rows at other angles as those.
    if objections.iter().any(|objection| objection.is_one_of(&[&ROW_GROUP, &ROW_ANGLE, &ROW_SHORT])) {
        return;
    }
    let rows = missing_rows(comparison, pattern);
    if rows.is_empty() {
        return;
    }
    let row = |wanted: usize| pattern.row_of(&Point3::from(comparison.nominal[wanted].entry));
    let gone = |wanted: usize| rows.contains(&row(wanted));
    let count = comparison.missing.iter().filter(|wanted| gone(**wanted)).count();
    let folded = fold(objections, &[&HOLE_MISSING], |objection| objection.nominal.is_some_and(gone));
    let (first, to) = (rows[0], rows[rows.len() - 1]);
    let at = |row: usize| Deg(360.0 * row as f64 / f64::from(pattern.rows));
    let message = match rows.as_slice() {
        [one] => format!("row {one} is missing: {count} holes at {:.3}°", at(*one).0),
        [one, other] => format!(
            "rows {one} and {other} are missing: {count} holes at {:.3}° and {:.3}°",
            at(*one).0,
            at(*other).0
        ),
        _ if to - first + 1 == rows.len() => format!(
            "rows {first} to {to} are missing: {count} holes from {:.3}° to {:.3}°",
            at(first).0,
            at(to).0
        ),
        _ => {
            let names: Vec<_> = rows.iter().map(usize::to_string).collect();
            format!("rows {} are missing: {count} holes", names.join(", "))
        }
    };
    let help = match to + 1 == pattern.rows as usize {
        true => format!("check whether the loop over the rows ends too early: rows count from 0 to {to}"),
        false => "check for a row that is skipped or drilled at another angle".to_owned(),
    };
    let mut finding = Diagnostic::new(&ROW_MISSING, message).help(help);
    finding.notes.extend(folded_note(folded));
    let place = &comparison.actual[last.actual].backtrace;
    objections.insert(0, HoleFinding::unlocated(locate_at_call(finding, place)));
}

/// Rows of which no hole is there, and near which nothing is drilled that nobody asked for.
fn missing_rows(comparison: &Comparison<'_>, pattern: &Pattern) -> Vec<usize> {
    let mut there = vec![false; pattern.rows as usize];
    for pair in &comparison.pairs {
        there[pattern.row_of(&Point3::from(comparison.nominal[pair.nominal].entry))] = true;
    }
    for extra in &comparison.extra {
        let hole = &comparison.actual[*extra];
        if let Some(at) = pattern.crossing(&hole.bottom(), &hole.axis)
            && comparison.nominal_on_line_of(*extra).is_none()
        {
            there[pattern.row_of(&at)] = true;
        }
    }
    let mut wanted = vec![false; there.len()];
    for hole in &comparison.missing {
        wanted[pattern.row_of(&Point3::from(comparison.nominal[*hole].entry))] = true;
    }
    (0..there.len()).filter(|row| wanted[*row] && !there[*row]).collect()
}
