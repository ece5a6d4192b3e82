//! Wanted holes that cut into each other, which the drawing may mean: told, not failed. A pattern sees to its own.
use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_OVERLAP;
use gcode_lang::diag::Diagnostic;
use gcode_part::overlaps;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    if comparison.pattern.is_some() {
        return;
    }
    for overlap in overlaps(comparison.nominal) {
        let message = overlap.sentence(comparison.nominal);
        let finding = Diagnostic::new(&HOLE_OVERLAP, message)
            .help("check radius, azimuth and depth of both holes, unless the drawing specifies this");
        objections.push(HoleFinding::of_nominal(overlap.holes[0], finding));
    }
}
