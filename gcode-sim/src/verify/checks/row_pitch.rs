//! In a row the holes stand at the pitch with which the pattern closes: another one is told with what it adds up to.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::verify::causes::causes;
use crate::verify::rows::Rows;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    let Some(pattern) = comparison.pattern else { return };
    let Some((spacing, row)) = Rows::of(comparison, pattern).and_then(|rows| rows.spacing) else { return };
    let pitches = (pattern.length / pattern.pitch).floor();
    let sum = (spacing - pattern.pitch).abs() * pitches;
    if sum <= comparison.tolerances.position / 2.0 {
        return;
    }
    let message = format!(
        "the holes of a row stand {spacing:.4} mm apart, {:.4} wanted: over {pitches:.0} pitches that is {sum:.2} mm",
        pattern.pitch
    );
    let mut finding = Diagnostic::error("row-pitch", message).at(comparison.found[row.first].place.clone());
    if let Some(asked) = pattern.asked
        && (spacing - asked).abs() < (spacing - pattern.pitch).abs()
    {
        finding = finding.note(format!(
            "{asked} mm are what was asked for; round the circumference the pattern closes with {:.4}",
            pattern.pitch
        ));
    }
    if let Some(causes) = causes(pattern, spacing / pattern.pitch, false) {
        finding = finding.note(causes);
    }
    let finding = finding.help("compute the pitch from the number of rows that close, after the angle");
    objections.push(Objection { wanted: None, finding });
}
