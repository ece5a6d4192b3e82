//! Nominal holes that overlap: a note, since the drawing may specify it.
use super::*;
use crate::findings::HOLE_OVERLAP;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    for overlap in &inspection.overlaps {
        let finding = Diagnostic::new(&HOLE_OVERLAP, overlap.sentence(inspection.comparison.nominal))
            .help("check radius, azimuth and depth of both holes, unless the drawing specifies this");
        findings.add(Subject::Nominal(overlap.holes[0]), finding);
    }
}
