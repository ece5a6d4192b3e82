//! The contact runs along the flutes at the job's speed.
use super::super::Inspection;
use super::super::speed::SPEED_TOLERANCE;
use crate::findings::FLUTE_SPEED;
use gcode_lang::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(range) = &inspection.speed else { return };
    let mut wrong: Vec<_> = range.worst_by_pass.iter().filter(|worst| worst.is_wrong()).collect();
    wrong.sort_by(|one, other| other.factor().total_cmp(&one.factor()));
    let Some(worst) = wrong.first() else { return };
    let pass = &inspection.actual.passes[worst.pass];
    let message = format!(
        "the wheel moves along {} at {} mm/min; the job specifies {} (tolerance ±{:.0} %)",
        inspection.pass_name(worst.pass),
        format_speed(worst.actual),
        worst.nominal,
        100.0 * SPEED_TOLERANCE
    );
    let place = worst.backtrace(&pass.trace).unwrap_or(&pass.backtrace);
    let all = format!(
        "from {} to {} mm/min along all flutes; out of tolerance in {} of {} passes",
        format_speed(range.min),
        format_speed(range.max),
        wrong.len(),
        inspection.actual.passes.len()
    );
    findings.push(
        Diagnostic::new(&FLUTE_SPEED, message)
            .note(all)
            .help(
                "check F in this block, and that the code it is written for is in force: G93 (F moves a \
                 minute) or G94",
            )
            .with_backtrace(place.clone())
            .with_sites(wrong.iter().map(|worst| Site::new(Some(worst.pass), worst.point))),
    );
}

/// Whole mm/min, of slow ones with a decimal.
fn format_speed(speed: f64) -> String {
    if speed < 100.0 { format!("{speed:.1}") } else { format!("{speed:.0}") }
}
