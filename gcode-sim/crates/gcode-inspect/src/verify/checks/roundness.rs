//! Roundness of each milled hole: the path of the mill decides it.
use super::*;
use crate::findings::HOLE_ROUNDNESS;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let limit = comparison.tolerances.diameter;
    for (pair, _, drilled) in comparison.matched() {
        let Some(roundness) = drilled.roundness.filter(|roundness| limit < *roundness) else { continue };
        let id = comparison.id(pair.nominal);
        let message = format!(
            "hole {id} is not round: the distances of the mill's path from the axis differ by {roundness:.3} mm, \
             limit {limit}"
        );
        let finding = Diagnostic::new(&HOLE_ROUNDNESS, message)
            .help("mill a full circle by I and J, from a start that lies on it")
            .with_backtrace(drilled.backtrace.clone());
        findings.add(Subject::Nominal(pair.nominal), finding);
    }
}
