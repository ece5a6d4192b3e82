//! In a row the holes stand at the pitch with which the pattern closes: another one is told with what it adds up to.
use super::{HoleFinding, HoleInspection};
use crate::findings::{ROW_ANGLE, ROW_PITCH};
use crate::verify::causes::describe_causes;
use crate::verify::hole_finding::locate_at_call;
use crate::verify::rows::PatternRows;
use gcode_lang::diag::Diagnostic;

/// Pitches nearer than this, in mm, are the same: holes are rounded to the increment.
const PITCH_TOLERANCE: f64 = 0.002;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(pattern) = comparison.pattern else { return };
    let Some(rows) = PatternRows::of(comparison, pattern) else { return };
    let Some((spacing, row)) = rows.spacing else { return };
    // The pitch that follows from another number of rows is told with their angle.
    let follows = (spacing - pattern.closing_pitch(rows.rows.len() as u32)).abs() < PITCH_TOLERANCE;
    if follows && objections.iter().any(|objection| objection.finding.kind == &ROW_ANGLE) {
        return;
    }
    let pitches = (pattern.length / pattern.pitch).floor();
    let sum = (spacing - pattern.pitch).abs() * pitches;
    if sum <= comparison.tolerances.position / 2.0 {
        return;
    }
    let message = format!(
        "the holes of a row are {spacing:.4} mm apart, nominal {:.4}: over {pitches:.0} pitches the error \
         is {sum:.2} mm",
        pattern.pitch
    );
    let mut finding =
        locate_at_call(Diagnostic::new(&ROW_PITCH, message), &comparison.actual[row.first].backtrace);
    if let Some(asked) = pattern.specified_pitch
        && (spacing - asked).abs() < (spacing - pattern.pitch).abs()
    {
        finding = finding.note(format!(
            "{asked} mm is the specified pitch; the pattern closes round the circumference with {:.4}",
            pattern.pitch
        ));
    }
    if let Some(causes) = describe_causes(pattern, spacing / pattern.pitch, false) {
        finding = finding.note(causes);
    }
    let finding = finding.help("compute the angle from the number of rows that close, then the pitch");
    objections.push(HoleFinding::unlocated(finding));
}
