//! Diameter of the tool that finishes each hole, if both diameters are known.
use super::*;
use crate::findings::HOLE_DIAMETER;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, hole, drilled) in comparison.matched() {
        // The check on features covers each of them.
        if !hole.features.is_empty() {
            continue;
        }
        let Some((nominal, actual)) = hole.diameter.zip(drilled.diameter) else { continue };
        if !exceeds((actual - nominal).abs(), comparison.tolerances.diameter) {
            continue;
        }
        let tool = drilled.tool.map_or(String::new(), |tool| format!(" T{tool}"));
        let id = comparison.id(pair.nominal);
        let message = format!("hole {id}: the finishing tool{tool} is Φ{actual}, nominal Φ{nominal}");
        let finding = Diagnostic::new(&HOLE_DIAMETER, message)
            .help("finish the hole with the right tool, or correct the tool table")
            .with_backtrace(drilled.backtrace.clone());
        findings.add(Subject::Nominal(pair.nominal), finding);
    }
}
