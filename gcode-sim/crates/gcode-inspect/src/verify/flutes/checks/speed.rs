//! Speed of the contact along the flutes: that of the job.
use super::super::measured_range::SPEED_TOLERANCE;
use super::*;
use crate::findings::FLUTE_SPEED;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(range) = &inspection.speed else { return };
    let mut wrong: Vec<_> = range.worst_by_pass.iter().filter(|worst| worst.is_wrong_speed()).collect();
    wrong.sort_by(|one, other| other.error.total_cmp(&one.error));
    let Some(worst) = wrong.first() else { return };
    let pass = &inspection.actual.passes[worst.pass];
    let message = format!(
        "the wheel moves along {} at {} mm/min; the job specifies {} (tolerance ±{:.0} %)",
        inspection.pass_name(worst.pass),
        format_speed(worst.actual),
        worst.nominal,
        100.0 * SPEED_TOLERANCE
    );
    let note = format!(
        "from {} to {} mm/min along all flutes; out of tolerance in {} of {} passes",
        format_speed(range.min),
        format_speed(range.max),
        wrong.len(),
        inspection.actual.passes.len()
    );
    let help = "check F in this block, and that the code it is written for is in force: G93 (F moves a \
                minute) or G94";
    let backtrace = worst.speed_backtrace(&pass.trace).unwrap_or(&pass.backtrace);
    let finding =
        Diagnostic::new(&FLUTE_SPEED, message).note(note).help(help).with_backtrace(backtrace.clone());
    findings.push(finding.with_sites(wrong.iter().map(|worst| Site::new(Some(worst.pass), worst.point))));
}

/// Formats a speed in whole mm/min, a slow one with a decimal.
fn format_speed(speed: f64) -> String {
    if speed < 100.0 { format!("{speed:.1}") } else { format!("{speed:.0}") }
}
