//! Wanted holes that cut into each other, which the drawing may mean: told, not failed. A pattern sees to its own.
use super::{Comparison, HoleFinding};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_part::overlaps;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<HoleFinding>) {
    if comparison.pattern.is_some() {
        return;
    }
    for overlap in overlaps(comparison.nominal) {
        let message = overlap.sentence(comparison.nominal);
        let finding = Diagnostic::new(Severity::Note, "hole-overlap", message)
            .help("if the drawing doesn't mean that: look for a slip in the radius, azimuth or depth of one of them");
        objections.push(HoleFinding::of_nominal(overlap.holes[0], finding));
    }
}
