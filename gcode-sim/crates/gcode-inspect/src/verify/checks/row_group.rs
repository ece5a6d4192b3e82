//! The two groups of rows of a honeycomb, half a pitch apart in x: one is missing, or begins at a wrong x.
use super::*;
use crate::findings::ROW_GROUP;

/// Rows whose starts differ by less begin at the same x, mm.
const SAME_START: f64 = 0.02;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let Some(rows) = inspection.rows.as_ref().filter(|_| !comparison.missing.is_empty()) else { return };
    if let Some((finding, hole)) = shifted_group(rows).or_else(|| missing_group(rows, comparison)) {
        findings.add(Subject::Whole, locate_at_call(finding, &comparison.actual[hole].backtrace));
    }
}

/// Reports rows of which none is staggered, and the hole at which the first begins.
fn missing_group(rows: &PatternRows<'_>, comparison: &Comparison<'_>) -> Option<(Diagnostic, usize)> {
    let pattern = rows.pattern;
    // A cylinder shorter than half a pitch has one group.
    let is_staggered = |hole: &&Hole| (0.25..0.75).contains(&(hole.entry[0] / pattern.pitch).fract());
    let second = comparison.nominal.iter().filter(is_staggered).count();
    if !rows.is_aligned() || second == 0 {
        return None;
    }
    let (half, count, first) = (pattern.pitch / 2.0, rows.rows.len(), rows.rows[0]);
    let begin = match rows.rows.iter().all(|row| (row.start - first.start).abs() < SAME_START) {
        true => format!("begin at x {:.3}", first.start),
        false => format!("begin at whole pitches from x {:.3}", first.start),
    };
    let (message, help) = match rows.is_single_group() {
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
    Some((Diagnostic::new(&ROW_GROUP, message).help(help), first.first))
}

/// Reports the one group that begins at a wrong x, and the hole there.
fn shifted_group(rows: &PatternRows<'_>) -> Option<(Diagnostic, usize)> {
    let pattern = rows.pattern;
    if rows.rows.len() != pattern.rows as usize {
        return None;
    }
    let mut first = [None; 2];
    for row in &rows.rows {
        let group = (row.azimuth.0 / pattern.row_angle().0).round() as usize % 2;
        if SAME_START < (row.start - first[group].get_or_insert(*row).start).abs() {
            return None;
        }
    }
    let [Some(one), Some(other)] = first else { return None };
    if (one.start - other.start).abs() < SAME_START {
        return None;
    }
    let nominal = [0.0, pattern.pitch / 2.0];
    let off = [one.start - nominal[0], other.start - nominal[1]];
    let group = match off.map(|off| off.abs() < SAME_START) {
        [true, false] => 1,
        [false, true] => 0,
        _ => return None,
    };
    let row = [one, other][group];
    let message = format!(
        "the {} group of rows begins at x {:.3}, nominal {:.3}: {:.3} mm too {}",
        ["first", "second"][group],
        row.start,
        nominal[group],
        off[group].abs(),
        if off[group] < 0.0 { "early" } else { "late" }
    );
    let help = "begin the first group at x 0 and the second half a pitch later; the first hole of a row \
                positions the others";
    Some((Diagnostic::new(&ROW_GROUP, message).help(help), row.first))
}
