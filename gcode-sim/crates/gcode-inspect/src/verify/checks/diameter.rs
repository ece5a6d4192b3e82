//! Diameter of the tool that finishes each hole, if both diameters are known.
use super::*;
use crate::findings::HOLE_DIAMETER;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, hole, _) in comparison.matched() {
        let drilled = comparison.finishing(pair);
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
        let cutter = drilled.finishing_cut.milled.and(inspection.machine.diameter_of(drilled.tool));
        // The path is compensated by the radius; a diameter in its place shifts it by one more radius on either side.
        let is_radius =
            |cutter: f64| !exceeds((nominal - actual - cutter).abs(), comparison.tolerances.diameter);
        let is_diameter =
            |cutter: f64| !exceeds((actual - nominal - cutter / 2.0).abs(), comparison.tolerances.diameter);
        let help = match cutter {
            Some(cutter) if is_radius(cutter) => format!(
                "the difference is Φ{cutter}, that of the mill: if D is the diameter of the mill and not its radius, state \
                 --control ODI=1"
            ),
            Some(cutter) if is_diameter(cutter) => format!(
                "the difference is the radius of the mill, {}: if D is the radius of the mill and not its diameter, \
                 state --control ODI=0",
                cutter / 2.0
            ),
            _ => "finish the hole with the right tool, or correct the tool table".to_owned(),
        };
        let finding =
            Diagnostic::new(&HOLE_DIAMETER, message).help(help).with_backtrace(drilled.backtrace.clone());
        findings.add(Subject::Nominal(pair.nominal), finding);
    }
}
