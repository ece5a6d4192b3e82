//! The flutes are evenly spaced all along.
use super::super::Inspection;
use gcode_lang::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wanted = inspection.wanted;
    // Of another number of flutes there is more to say than how they are spaced.
    if inspection.round.flutes.len() != wanted.count as usize {
        return;
    }
    let Some(gap) = inspection.round.worst_gap else { return };
    let pitch = 360.0 / f64::from(wanted.count);
    if gap.off <= wanted.index_tolerance {
        return;
    }
    let trace = &inspection.ground.passes[gap.pass].trace;
    let finding = match inspection.round.step(wanted) {
        Some(step) => {
            let message = format!(
                "the flutes are {:.3}° apart where {:.3}° is asked for: {}° either way is allowed",
                step.found.0.abs(),
                step.wanted.0.abs(),
                wanted.index_tolerance.0
            );
            Diagnostic::error("flute-index", message)
                .note(format!("from the last to the first of them {:.3}° are left", gap.found.0))
                .help("check the index of A, 360° over the number of flutes")
                .at(inspection.ground.passes[step.pass].place.clone())
        }
        None => {
            let message = format!(
                "from one flute to the next it is {:.3}° where {pitch:.3}° is wanted, at x = {:.3} and polar angle {:.1}°: \
                 {}° either way is allowed",
                gap.found.0, gap.x, gap.polar.0, wanted.index_tolerance.0
            );
            let name = inspection.name(gap.pass);
            let note = match gap.index_error {
                Some(off) => {
                    Some(format!("{name} stands {:.3}° from its place between the others there", off.0))
                }
                None => (wanted.count == 2).then(|| format!("either may be right: {name} is ground later")),
            };
            let finding = Diagnostic::error("flute-index", message)
                .help("check A in this block, and where the flute begins")
                .at(trace.place(&trace.samples[gap.first]).clone());
            note.into_iter().fold(finding, Diagnostic::note)
        }
    };
    findings.push(finding.on([Site::new(Some(gap.pass), trace.samples[gap.sample].at)]));
}
