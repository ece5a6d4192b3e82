//! Core of each milled hole: a circle along the wall leaves one if the mill doesn't reach the axis.
use super::*;
use crate::findings::HOLE_CORE;
use crate::holes::MilledCut;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    roundness::add_for_circles(inspection, findings, finding);
}

/// Returns the finding on the core that a mill leaves in a hole or feature.
pub(super) fn finding(what: &str, cut: &MilledCut) -> Option<Diagnostic> {
    let message =
        format!("{what} keeps a core of Φ{:.3}: the mill goes round it and nothing removes it", cut.core?);
    Some(Diagnostic::new(&HOLE_CORE, message).help("drill the core first, or mill from the axis outwards"))
}
