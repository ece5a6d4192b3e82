//! The flutes are evenly spaced all along.
use super::super::Inspection;
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
                "the flutes are {:.3}° apart where {:.3}° is asked for: {}° either way is allowed",
                step.actual.0.abs(),
                step.nominal.0.abs(),
                wanted.index_tolerance.0
            );
            Diagnostic::error("flute-index", message)
                .note(format!("from the last to the first of them {:.3}° are left", gap.actual.0))
                .help("check the index of A, 360° over the number of flutes")
                .at(inspection.actual.passes[step.pass].backtrace.clone())
        }
        None => {
            let message = format!(
                "from one flute to the next it is {:.3}° where {pitch:.3}° is wanted, at x = {:.3} and polar angle {:.1}°: \
                 {}° either way is allowed",
                gap.actual.0, gap.x, gap.polar.0, wanted.index_tolerance.0
            );
            let name = inspection.pass_name(gap.pass);
            let note = match gap.index_error {
                Some(off) => {
                    Some(format!("{name} stands {:.3}° from its place between the others there", off.0))
                }
                None => (wanted.count == 2).then(|| format!("either may be right: {name} is ground later")),
            };
            let finding = Diagnostic::error("flute-index", message)
                .help("check A in this block, and where the flute begins")
                .at(trace.backtrace(&trace.samples[gap.first_sample]).clone());
            note.into_iter().fold(finding, Diagnostic::note)
        }
    };
    findings.push(finding.on([Site::new(Some(gap.pass), trace.samples[gap.sample].point)]));
}
