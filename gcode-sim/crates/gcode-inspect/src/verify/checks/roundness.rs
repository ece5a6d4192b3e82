//! Roundness of each milled hole: the path of the mill decides it.
use super::*;
use crate::findings::HOLE_ROUNDNESS;
use crate::holes::MilledCut;

/// Judges the circle that finishes each milled hole. The check on features covers the holes that have any.
pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, _, drilled) in comparison.matched().filter(|(_, nominal, _)| nominal.features.is_empty()) {
        let Some(cut) = drilled.finishing_cut.milled else { continue };
        let what = format!("hole {}", comparison.id(pair.nominal));
        if let Some(finding) = finding(&what, &cut, comparison.tolerances.diameter) {
            findings.add(Subject::Nominal(pair.nominal), finding.with_backtrace(drilled.backtrace.clone()));
        }
    }
}

/// Returns the finding on the roundness of a milled hole or feature.
pub(super) fn finding(what: &str, cut: &MilledCut, limit: f64) -> Option<Diagnostic> {
    let message = format!(
        "{what} is not round: the distances of the mill's path from the axis differ by {:.3} mm, limit {limit}",
        cut.roundness
    );
    let finding = Diagnostic::new(&HOLE_ROUNDNESS, message)
        .help("mill a full circle by I and J, from a start that lies on it");
    exceeds(cut.roundness, limit).then_some(finding)
}
