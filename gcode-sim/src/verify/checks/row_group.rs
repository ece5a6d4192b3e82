//! A honeycomb has two groups of rows, one half a pitch later in x than the other: where all rows begin alike, one is
//! missing, or stands where the other does.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::part::honeycomb::Pattern;
use crate::verify::objection::at_the_call;
use crate::verify::rows::Rows;

/// Rows that begin nearer to one another than this, in mm, begin alike.
const SAME: f64 = 0.02;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    let Some(pattern) = comparison.pattern.filter(|_| !comparison.missing.is_empty()) else { return };
    let late = |x: f64| (0.25..0.75).contains(&(x / pattern.pitch).fract());
    let second = comparison.wanted.iter().filter(|hole| late(hole.entry[0])).count();
    let Some(rows) = Rows::of(comparison, pattern) else { return };
    if let Some(finding) = one_shifted(comparison, pattern, &rows) {
        objections.push(Objection::whole(finding));
        return;
    }
    if !rows.in_step(pattern) {
        return;
    }
    // On a cylinder shorter than half a pitch there is one group anyway.
    if second == 0 {
        return;
    }
    let (half, count, first) = (pattern.pitch / 2.0, rows.rows.len(), rows.rows[0]);
    let alike = rows.rows.iter().all(|row| (row.start - first.start).abs() < SAME);
    let begin = match alike {
        true => format!("begin at x {:.3}", first.start),
        false => format!("begin at whole pitches from x {:.3}", first.start),
    };
    let (message, help) = match rows.one_group(pattern) {
        true => (
            format!(
                "one of the two groups of rows is missing, half of the pattern: all {count} rows {begin}, \
                 no row is staggered; {second} of {} holes belong to the other group",
                comparison.wanted.len()
            ),
            format!(
                "drill the second group: rotated by {:.4}° from the first and half a pitch ({half:.3} mm) later in x",
                pattern.step().0
            ),
        ),
        false => (
            format!("no row is staggered: all {count} rows {begin}"),
            format!("begin every second row half a pitch later in x: {half:.3} mm"),
        ),
    };
    let finding =
        at_the_call(Diagnostic::error("row-group", message).help(help), &comparison.found[first.first].place);
    objections.push(Objection::whole(finding));
}

/// One group begins where it should and the other doesn't.
fn one_shifted(comparison: &Comparison<'_>, pattern: &Pattern, rows: &Rows) -> Option<Diagnostic> {
    if rows.rows.len() != pattern.rows as usize {
        return None;
    }
    let mut begins = [f64::NAN; 2];
    let mut first = [rows.rows[0]; 2];
    for row in &rows.rows {
        let group = (row.azimuth.0 / pattern.step().0).round() as usize % 2;
        if begins[group].is_nan() {
            (begins[group], first[group]) = (row.start, *row);
        } else if SAME < (row.start - begins[group]).abs() {
            return None;
        }
    }
    let wanted = [0.0, pattern.pitch / 2.0];
    let off = [0, 1].map(|group: usize| begins[group] - wanted[group]);
    let alike = (begins[0] - begins[1]).abs() < SAME;
    let group = match off.map(|off| off.abs() < SAME) {
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
    Some(at_the_call(
        Diagnostic::error("row-group", message).help(help),
        &comparison.found[first[group].first].place,
    ))
}
