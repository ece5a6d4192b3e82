//! The tool that finishes a hole must have the hole's diameter, where both are known.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    for pair in &comparison.pairs {
        let found = &comparison.found[pair.found];
        let (Some(wanted), Some(actual)) = (comparison.wanted[pair.wanted].diameter, found.diameter) else {
            continue;
        };
        if (actual - wanted).abs() <= comparison.tolerances.diameter {
            continue;
        }
        let tool = found.tool.map_or(String::new(), |tool| format!(" T{tool}"));
        let message = format!(
            "hole {}: the finishing tool{tool} is Φ{actual}, nominal Φ{wanted}",
            comparison.id(pair.wanted)
        );
        let finding = Diagnostic::error("hole-diameter", message)
            .help("finish the hole with the right tool, or correct the tool table")
            .at(found.place.clone());
        objections.push(Objection::of(pair.wanted, finding));
    }
}
