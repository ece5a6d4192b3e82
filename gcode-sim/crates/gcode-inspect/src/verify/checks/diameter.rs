//! The tool that finishes a hole must have the hole's diameter, where both are known.
use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_DIAMETER;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    for pair in &comparison.pairs {
        let found = &comparison.actual[pair.actual];
        let (Some(wanted), Some(actual)) = (comparison.nominal[pair.nominal].diameter, found.diameter) else {
            continue;
        };
        if (actual - wanted).abs() <= comparison.tolerances.diameter {
            continue;
        }
        let tool = found.tool.map_or(String::new(), |tool| format!(" T{tool}"));
        let message = format!(
            "hole {}: the finishing tool{tool} is Φ{actual}, nominal Φ{wanted}",
            comparison.id(pair.nominal)
        );
        let finding = Diagnostic::new(&HOLE_DIAMETER, message)
            .help("finish the hole with the right tool, or correct the tool table")
            .with_backtrace(found.backtrace.clone());
        objections.push(HoleFinding::of_nominal(pair.nominal, finding));
    }
}
