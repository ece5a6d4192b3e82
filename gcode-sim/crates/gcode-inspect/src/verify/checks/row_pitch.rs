//! Pitch of the holes in a row of a honeycomb: that with which the pattern closes.
use super::*;
use crate::findings::{ROW_ANGLE, ROW_PITCH};
use crate::verify::causes::describe_causes;

/// Pitches that differ by less are equal, mm: holes are rounded to the increment.
const PITCH_TOLERANCE: f64 = 0.002;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let Some(rows) = &inspection.rows else { return };
    let Some((spacing, row)) = rows.spacing else { return };
    let pattern = rows.pattern;
    // The finding on the angle names the pitch of another number of rows.
    let follows = (spacing - pattern.closing_pitch(rows.rows.len() as u32)).abs() < PITCH_TOLERANCE;
    if follows && findings.first_of_kind(&[&ROW_ANGLE]).is_some() {
        return;
    }
    let pitches = (pattern.length / pattern.pitch).floor();
    let sum = (spacing - pattern.pitch).abs() * pitches;
    if !exceeds(sum, comparison.tolerances.position / 2.0) {
        return;
    }
    let message = format!(
        "the holes of a row are {spacing:.4} mm apart, nominal {:.4}: over {pitches:.0} pitches the error \
         is {sum:.2} mm",
        pattern.pitch
    );
    let finding = Diagnostic::new(&ROW_PITCH, message)
        .help("compute the angle from the number of rows that close, then the pitch");
    let mut finding = locate_at_call(finding, &comparison.actual[row.first].backtrace);
    let is_nearer = |specified: &f64| (spacing - specified).abs() < (spacing - pattern.pitch).abs();
    finding.notes.extend(pattern.specified_pitch.filter(is_nearer).map(|specified| {
        format!(
            "{specified} mm is the specified pitch; the pattern closes round the circumference with {:.4}",
            pattern.pitch
        )
    }));
    finding.notes.extend(describe_causes(pattern, spacing / pattern.pitch, false));
    findings.add(Subject::Whole, finding);
}
