//! Spacing of the flutes: even all along.
use super::*;
use crate::findings::FLUTE_INDEX;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (nominal, passes) = (inspection.nominal, &inspection.actual.passes);
    // A wrong number of flutes has its own finding.
    if inspection.spacing.flutes.len() != nominal.count as usize {
        return;
    }
    let tolerance = nominal.index_tolerance;
    let Some(gap) = inspection.spacing.worst_gap.filter(|gap| exceeds(gap.error.0, tolerance.0)) else {
        return;
    };
    let trace = &passes[gap.pass].trace;
    let finding = match inspection.spacing.index_step(nominal) {
        Some(step) => {
            let message = format!(
                "the flutes are {:.3}° apart, nominal {:.3}° (tolerance ±{}°)",
                step.actual.0.abs(),
                step.nominal.0.abs(),
                tolerance.0
            );
            Diagnostic::new(&FLUTE_INDEX, message)
                .note(format!("{:.3}° are left from the last flute to the first", gap.actual.0))
                .help("check the index of A: 360° divided by the number of flutes")
                .with_backtrace(passes[step.pass].backtrace.clone())
        }
        None => {
            let message = format!(
                "neighbouring flutes are {:.3}° apart, nominal {:.3}°, at x = {:.3} and polar angle \
                 {:.1}° (tolerance ±{}°)",
                gap.actual.0,
                360.0 / f64::from(nominal.count),
                gap.x,
                gap.polar.0,
                tolerance.0
            );
            let name = inspection.pass_name(gap.pass);
            let note = match gap.index_error {
                Some(off) => Some(format!(
                    "{name} is off by {:.3}° from its position between the neighbouring flutes",
                    off.0
                )),
                None if nominal.count == 2 => {
                    Some(format!("either flute may be right: {name} is ground later"))
                }
                None => None,
            };
            let finding = Diagnostic::new(&FLUTE_INDEX, message)
                .help("check A in this block, and the start of the flute")
                .with_backtrace(trace.backtrace(&trace.samples[gap.first_sample]).clone());
            note.into_iter().fold(finding, Diagnostic::note)
        }
    };
    findings.push(finding.with_sites([Site::new(Some(gap.pass), trace.samples[gap.sample].point)]));
}
