//! Gap between the last row of a honeycomb and the first: equal to the others, or there is a seam.
use super::*;
use crate::findings::ROW_SEAM;

/// Largest deviation of a gap that is no seam, as a fraction of the row angle.
const TOLERANCE: f64 = 0.05;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let Some(rows) = &inspection.rows else { return };
    let pattern = rows.pattern;
    let row_angle = pattern.row_angle().0;
    let is_odd = |gap: f64, nominal: f64| (gap - nominal).abs() > TOLERANCE * row_angle;
    let is_seam = |index: &usize| is_odd(rows.gaps[*index].0, rows.typical_gap.0);
    // With several odd gaps rows are missing or not evenly spaced.
    let [seam] = (0..rows.gaps.len()).filter(is_seam).collect::<Vec<_>>()[..] else { return };
    let (before, after) = (rows.rows[seam], rows.rows[(seam + 1) % rows.rows.len()]);
    let gap = rows.gaps[seam];
    // Where rows are missing, the others are in position.
    let steps = (gap.0 / row_angle).round();
    if 2.0 <= steps && !is_odd(gap.0, steps * row_angle) {
        return;
    }
    let message = format!(
        "a seam: the rows at {:.3}° and {:.3}° are {:.3}° ({:.2} mm) apart, all others {:.3}° ({:.2} mm)",
        before.azimuth.0,
        after.azimuth.0,
        gap.0,
        pattern.arc_length(gap),
        rows.typical_gap.0,
        pattern.arc_length(rows.typical_gap)
    );
    let finding = Diagnostic::new(&ROW_SEAM, message).help(
        "make the angle from row to row divide 360: choose a whole number of rows, then compute the angle, \
         then the pitch",
    );
    let backtrace = &inspection.comparison.actual[before.first].backtrace;
    findings.add(Subject::Whole, locate_at_call(finding, backtrace));
}
