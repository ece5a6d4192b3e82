//! What is cut before a hole is finished must lie inside the finished hole: the finishing tool doesn't put it back.
use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_CUT_ASIDE;
use crate::verify::position::Deviation;
use gcode_lang::diag::{Diagnostic, Severity};

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    for pair in &comparison.pairs {
        let (wanted, found) = (&comparison.nominal[pair.nominal], &comparison.actual[pair.actual]);
        for cut in &found.earlier_passes {
            let Some(deviation) = Deviation::new(wanted, &cut.bottom, &cut.axis) else { continue };
            let aside = deviation.zone_diameter() / 2.0;
            // A smaller tool may stand aside by what the finishing one takes off; a countersink must be in its place.
            let finished = wanted.diameter.or(found.diameter);
            let spare =
                finished.zip(cut.diameter).map_or(0.0, |(large, small)| (large - small).max(0.0) / 2.0);
            let allowed = spare + comparison.tolerances.position / 2.0;
            if aside <= allowed {
                continue;
            }
            let tool = cut.tool.map_or(String::new(), |tool| format!(" by T{tool}"));
            let message = format!(
                "hole {}: an earlier pass{tool} is out of position by {aside:.4} mm, limit \
                 {allowed:.4}",
                comparison.id(pair.nominal)
            );
            // Another tool whose size isn't known may be as small as it likes.
            let unknown = cut.tool != found.tool && cut.diameter.is_none();
            let finding = match unknown {
                true => Diagnostic::new(&HOLE_CUT_ASIDE, message)
                    .with_severity(Severity::Warning)
                    .help("give the tool diameters in the machine file, so that this can be judged"),
                false => Diagnostic::new(&HOLE_CUT_ASIDE, message)
                    .help("correct the point of that pass: material cut outside the hole cannot be restored"),
            };
            let finding = finding.with_backtrace(cut.backtrace.clone());
            objections.push(match unknown {
                true => HoleFinding::unlocated(finding),
                false => HoleFinding::of_nominal(pair.nominal, finding),
            });
        }
    }
}
