//! The contact runs along the flutes at the job's speed.
use super::super::Inspection;
use super::super::speed::ALLOWED;
use crate::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(range) = &inspection.speed else { return };
    let mut wrong: Vec<_> = range.of_passes.iter().filter(|worst| worst.is_wrong()).collect();
    wrong.sort_by(|one, other| other.times().total_cmp(&one.times()));
    let Some(worst) = wrong.first() else { return };
    let pass = &inspection.ground.passes[worst.pass];
    let message = format!(
        "the wheel moves along {} at {} mm/min; the job specifies {} (tolerance ±{:.0} %)",
        inspection.name(worst.pass),
        shown(worst.found),
        worst.wanted,
        100.0 * ALLOWED
    );
    let place = worst.place(&pass.trace).unwrap_or(&pass.place);
    let all = format!(
        "from {} to {} mm/min along all flutes; out of tolerance in {} of {} passes",
        shown(range.least),
        shown(range.most),
        wrong.len(),
        inspection.ground.passes.len()
    );
    findings.push(
        Diagnostic::error("flute-speed", message)
            .note(all)
            .help(
                "check F in this block, and that the code it is written for is in force: G93 (F moves a \
                 minute) or G94",
            )
            .at(place.clone())
            .on(wrong.iter().map(|worst| Site { pass: Some(worst.pass), at: worst.at })),
    );
}

/// Whole mm/min, of slow ones with a decimal.
fn shown(speed: f64) -> String {
    if speed < 100.0 { format!("{speed:.1}") } else { format!("{speed:.0}") }
}
