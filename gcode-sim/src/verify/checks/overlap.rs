//! Wanted holes that cut into each other, which the drawing may mean: told, not failed. A pattern sees to its own.
use super::{Comparison, Objection};
use crate::diag::{Diagnostic, Severity};
use crate::part::overlap::overlaps;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    if comparison.pattern.is_some() {
        return;
    }
    for overlap in overlaps(comparison.wanted) {
        let message = overlap.sentence(comparison.wanted);
        let finding = Diagnostic::new(Severity::Note, "hole-overlap", message)
            .help("check radius, azimuth and depth of both holes, unless the drawing specifies this");
        objections.push(Objection::of(overlap.holes[0], finding));
    }
}
