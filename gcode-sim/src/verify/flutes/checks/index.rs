//! The flutes are evenly spaced all along.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};

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
    let message = format!(
        "from one flute to the next it is {:.3}° where {pitch:.3}° is wanted, at x = {:.3} and polar angle {:.1}°: {}° \
         either way is allowed",
        gap.found.0, gap.x, gap.polar.0, wanted.index_tolerance.0
    );
    findings.push(
        Diagnostic::error("flute-index", message)
            .note("of the two flutes this one is farther from the middle between its neighbours")
            .help("check A in this block, and where the flute begins")
            .at(trace.place(&trace.samples[gap.sample]).clone())
            .on([Site { pass: Some(gap.pass), at: trace.samples[gap.sample].at }]),
    );
}
