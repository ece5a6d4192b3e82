//! Earlier passes of a hole lie inside the finished hole: the finishing tool does not restore material.
use super::*;
use crate::findings::HOLE_CUT_ASIDE;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, nominal, drilled) in comparison.matched() {
        for pass in &drilled.earlier_passes {
            let Some(deviation) = Deviation::new(nominal, &pass.bottom, &pass.axis) else { continue };
            let offset = deviation.zone_diameter() / 2.0;
            // The finishing tool removes the deviation of a smaller tool; a countersink must be in position.
            let sizes = nominal.diameter.or(drilled.diameter).zip(pass.diameter);
            let spare = sizes.map_or(0.0, |(large, small)| (large - small).max(0.0) / 2.0);
            let allowed = spare + comparison.tolerances.position / 2.0;
            if offset <= allowed {
                continue;
            }
            let tool = pass.tool.map_or(String::new(), |tool| format!(" by T{tool}"));
            let message = format!(
                "hole {}: an earlier pass{tool} is out of position by {offset:.4} mm, limit \
                 {allowed:.4}",
                comparison.id(pair.nominal)
            );
            let finding = Diagnostic::new(&HOLE_CUT_ASIDE, message).with_backtrace(pass.backtrace.clone());
            // Another tool of unknown diameter may be small enough.
            if pass.tool != drilled.tool && pass.diameter.is_none() {
                let help = "give the tool diameters in the machine file, so that this can be judged";
                findings.add(Subject::Whole, finding.with_severity(Severity::Warning).help(help));
            } else {
                let help = "correct the point of that pass: material cut outside the hole cannot be restored";
                findings.add(Subject::Nominal(pair.nominal), finding.help(help));
            }
        }
    }
}
