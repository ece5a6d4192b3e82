//! The flutes are evenly spaced all along.
use super::super::Inspection;
use crate::findings::FLUTE_INDEX;
use gcode_lang::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wanted = inspection.nominal;
    // Of another number of flutes there is more to say than how they are spaced.
    if inspection.spacing.flutes.len() != wanted.count as usize {
        return;
    }
    let Some(gap) = inspection.spacing.worst_gap else { return };
    let pitch = 360.0 / f64::from(wanted.count);
    if gap.error <= wanted.index_tolerance {
        return;
    }
    let trace = &inspection.actual.passes[gap.pass].trace;
    let finding = match inspection.spacing.index_step(wanted) {
        Some(step) => {
            let message = format!(
                "the flutes are {:.3}° apart, nominal {:.3}° (tolerance ±{}°)",
                step.actual.0.abs(),
                step.nominal.0.abs(),
                wanted.index_tolerance.0
            );
            Diagnostic::new(&FLUTE_INDEX, message)
                .note(format!("{:.3}° are left from the last flute to the first", gap.actual.0))
                .help("check the index of A: 360° divided by the number of flutes")
                .with_backtrace(inspection.actual.passes[step.pass].backtrace.clone())
        }
        None => {
            let message = format!(
                "neighbouring flutes are {:.3}° apart, nominal {pitch:.3}°, at x = {:.3} and polar angle \
                 {:.1}° (tolerance ±{}°)",
                gap.actual.0, gap.x, gap.polar.0, wanted.index_tolerance.0
            );
            let name = inspection.pass_name(gap.pass);
            let note = match gap.index_error {
                Some(off) => Some(format!(
                    "{name} is off by {:.3}° from its position between the neighbouring flutes",
                    off.0
                )),
                None => {
                    (wanted.count == 2).then(|| format!("either flute may be right: {name} is ground later"))
                }
            };
            let finding = Diagnostic::new(&FLUTE_INDEX, message)
                .help("check A in this block, and the start of the flute")
                .with_backtrace(trace.backtrace(&trace.samples[gap.first_sample]).clone());
            note.into_iter().fold(finding, Diagnostic::note)
        }
    };
    findings.push(finding.with_sites([Site::new(Some(gap.pass), trace.samples[gap.sample].point)]));
}
