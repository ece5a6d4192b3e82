//! A honeycomb has two groups of rows, one half a pitch later in x than the other: where all rows begin alike, one is
//! missing, or stands where the other does.
use super::{Comparison, HoleFinding, HoleInspection};
use crate::findings::ROW_GROUP;
use crate::verify::hole_finding::locate_at_call;
use crate::verify::rows::PatternRows;
use gcode_lang::diag::Diagnostic;
use gcode_part::Pattern;

/// Rows that begin nearer to one another than this, in mm, begin alike.
const SAME_SHIFT: f64 = 0.02;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(pattern) = comparison.pattern.filter(|_| !comparison.missing.is_empty()) else { return };
    let late = |x: f64| (0.25..0.75).contains(&(x / pattern.pitch).fract());
    let second = comparison.nominal.iter().filter(|hole| late(hole.entry[0])).count();
    let Some(rows) = PatternRows::of(comparison, pattern) else { return };
    if let Some(finding) = shifted_group(comparison, pattern, &rows) {
        objections.push(HoleFinding::unlocated(finding));
        return;
    }
    if !rows.is_aligned(pattern) {
        return;
    }
    // On a cylinder shorter than half a pitch there is one group anyway.
    if second == 0 {
        return;
    }
    let (half, count, first) = (pattern.pitch / 2.0, rows.rows.len(), rows.rows[0]);
    let alike = rows.rows.iter().all(|row| (row.start - first.start).abs() < SAME_SHIFT);
    let begin = match alike {
        true => format!("begin at x {:.3}", first.start),
        false => format!("begin at whole pitches from x {:.3}", first.start),
    };
    let (message, help) = match rows.is_single_group(pattern) {
        true => (
            format!(
                "one of the two groups of rows is missing, half of the pattern: all {count} rows {begin}, \
                 no row is staggered; {second} of {} holes belong to the other group",
                comparison.nominal.len()
            ),
            format!(
                "drill the second group: rotated by {:.4}° from the first and half a pitch ({half:.3} mm) later in x",
                pattern.row_angle().0
            ),
        ),
        false => (
            format!("no row is staggered: all {count} rows {begin}"),
            format!("begin every second row half a pitch later in x: {half:.3} mm"),
        ),
    };
    let finding = locate_at_call(
        Diagnostic::new(&ROW_GROUP, message).help(help),
        &comparison.actual[first.first].backtrace,
    );
    objections.push(HoleFinding::unlocated(finding));
}

/// One group begins where it should and the other doesn't.
fn shifted_group(comparison: &Comparison<'_>, pattern: &Pattern, rows: &PatternRows) -> Option<Diagnostic> {
    if rows.rows.len() != pattern.rows as usize {
        return None;
    }
    let mut begins = [f64::NAN; 2];
    let mut first = [rows.rows[0]; 2];
    for row in &rows.rows {
        let group = (row.azimuth.0 / pattern.row_angle().0).round() as usize % 2;
        if begins[group].is_nan() {
            (begins[group], first[group]) = (row.start, *row);
        } else if SAME_SHIFT < (row.start - begins[group]).abs() {
            return None;
        }
    }
    let wanted = [0.0, pattern.pitch / 2.0];
    let off = [0, 1].map(|group: usize| begins[group] - wanted[group]);
    let alike = (begins[0] - begins[1]).abs() < SAME_SHIFT;
    let group = match off.map(|off| off.abs() < SAME_SHIFT) {
        [true, false] if !alike => 1,
        [false, true] if !alike => 0,
        _ => return None,
    };
    let message = format!(
        "the {} group of rows begins at x {:.3}, nominal {:.3}: {:.3} mm too {}",
        ["first", "second"][group],
        begins[group],
        wanted[group],
        off[group].abs(),
        if off[group] < 0.0 { "early" } else { "late" }
    );
    let help = "begin the first group at x 0 and the second half a pitch later; the first hole of a row \
                positions the others";
    Some(locate_at_call(
        Diagnostic::new(&ROW_GROUP, message).help(help),
        &comparison.actual[first[group].first].backtrace,
    ))
}
