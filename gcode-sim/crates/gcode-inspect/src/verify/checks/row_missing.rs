//! Whole rows of a honeycomb that are missing: one finding with the numbers of the rows.
use super::*;
use crate::findings::{HOLE_MISSING, ROW_ANGLE, ROW_GROUP, ROW_MISSING, ROW_SHORT};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let Some(pattern) = comparison.pattern else { return };
    let Some(last) = comparison.pairs.last() else { return };
    // These findings explain the missing rows.
    if findings.first_of_kind(&[&ROW_GROUP, &ROW_ANGLE, &ROW_SHORT]).is_some() {
        return;
    }
    let row_of = |nominal: usize| pattern.row_of(&Point3::from(comparison.nominal[nominal].entry));
    let rows: Vec<usize> = missing_rows(comparison, pattern, row_of).into_iter().collect();
    let (Some(&first), Some(&to)) = (rows.first(), rows.last()) else { return };
    let is_gone = |nominal: usize| rows.contains(&row_of(nominal));
    let count = comparison.missing.iter().filter(|nominal| is_gone(**nominal)).count();
    let folded = findings
        .fold(&[&HOLE_MISSING], |subject| matches!(subject, Subject::Nominal(nominal) if is_gone(nominal)));
    let at = |row: usize| 360.0 * row as f64 / f64::from(pattern.rows);
    let message = match rows.as_slice() {
        [one] => format!("row {one} is missing: {count} holes at {:.3}°", at(*one)),
        [one, other] => format!(
            "rows {one} and {other} are missing: {count} holes at {:.3}° and {:.3}°",
            at(*one),
            at(*other)
        ),
        _ if to - first + 1 == rows.len() => format!(
            "rows {first} to {to} are missing: {count} holes from {:.3}° to {:.3}°",
            at(first),
            at(to)
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
    let finding = Diagnostic::new(&ROW_MISSING, message).help(help);
    findings.put_first([finish_group_finding(finding, folded, &comparison.actual[last.actual].backtrace)]);
}

/// Returns the rows of which no hole is drilled, and near which no extra hole is.
fn missing_rows(
    comparison: &Comparison<'_>,
    pattern: &Pattern,
    row_of: impl Fn(usize) -> usize,
) -> BTreeSet<usize> {
    let mut rows: BTreeSet<usize> = comparison.missing.iter().map(|nominal| row_of(*nominal)).collect();
    for pair in &comparison.pairs {
        rows.remove(&row_of(pair.nominal));
    }
    for extra in comparison.extra.iter().filter(|extra| comparison.nominal_on_line_of(**extra).is_none()) {
        comparison.crossing(*extra).map(|at| rows.remove(&pattern.row_of(&at)));
    }
    rows
}
