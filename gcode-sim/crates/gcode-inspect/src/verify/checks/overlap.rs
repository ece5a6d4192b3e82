//! Nominal holes that overlap: a note, since the drawing may specify it. A pattern is checked with its job.
use super::*;
use crate::findings::HOLE_OVERLAP;
use gcode_part::overlaps;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let Comparison { nominal, pattern: None, .. } = inspection.comparison else { return };
    for overlap in overlaps(nominal) {
        let finding = Diagnostic::new(&HOLE_OVERLAP, overlap.sentence(nominal))
            .help("check radius, azimuth and depth of both holes, unless the drawing specifies this");
        findings.add(Subject::Nominal(overlap.holes[0]), finding);
    }
}
