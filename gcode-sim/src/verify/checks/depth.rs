//! Every hole must be as deep as wanted.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    for pair in &comparison.pairs {
        let error = pair.deviation.depth_error;
        if error.abs() <= comparison.tolerances.depth {
            continue;
        }
        let nominal = comparison.wanted[pair.wanted].depth;
        let message = format!(
            "hole {} is {:.3} mm deep, {nominal} wanted: {:.3} mm too {} ({} allowed)",
            comparison.id(pair.wanted),
            nominal + error,
            error.abs(),
            if error > 0.0 { "deep" } else { "shallow" },
            comparison.tolerances.depth
        );
        let finding = Diagnostic::error("hole-depth", message)
            .help("check the programmed depth, the tool's length and its offset")
            .at(comparison.found[pair.found].place.clone());
        objections.push(Objection { wanted: Some(pair.wanted), finding });
    }
}
