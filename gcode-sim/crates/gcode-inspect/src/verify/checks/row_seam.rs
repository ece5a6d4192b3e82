//! Round the cylinder the last row stands as far from the first as all others from their next: else there is a seam.
use super::{HoleFinding, HoleInspection};
use crate::findings::ROW_SEAM;
use crate::verify::hole_finding::locate_at_call;
use crate::verify::rows::PatternRows;
use gcode_lang::diag::Diagnostic;

/// A gap that differs by less than this part of a row is no seam.
const SHARE: f64 = 0.05;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(pattern) = comparison.pattern else { return };
    let Some(rows) = PatternRows::of(comparison, pattern) else { return };
    let odd = |gap: f64| (gap - rows.typical_gap.0).abs() > SHARE * pattern.row_angle().0;
    let seams: Vec<usize> = (0..rows.gaps.len()).filter(|index| odd(rows.gaps[*index].0)).collect();
    // Many odd gaps are no seam: there rows are missing, or stand anyhow.
    let [seam] = seams.as_slice() else { return };
    let (before, after) = (rows.rows[*seam], rows.rows[(seam + 1) % rows.rows.len()]);
    let gap = rows.gaps[*seam];
    // Where rows are missing, the others stand as they should.
    let steps = (gap.0 / pattern.row_angle().0).round();
    if 2.0 <= steps && (gap.0 - steps * pattern.row_angle().0).abs() <= SHARE * pattern.row_angle().0 {
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
    objections
        .push(HoleFinding::unlocated(locate_at_call(finding, &comparison.actual[before.first].backtrace)));
}
