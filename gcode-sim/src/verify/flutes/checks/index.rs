//! The flutes are evenly spaced all along.
use super::super::Inspection;
use crate::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wanted = inspection.wanted;
    // Of another number of flutes there is more to say than how they are spaced.
    if inspection.round.flutes.len() != wanted.count as usize {
        return;
    }
    let Some(gap) = inspection.round.worst_gap else { return };
    let pitch = 360.0 / f64::from(wanted.count);
    if (gap.found.0 - pitch).abs() <= wanted.index_tolerance.0 {
        return;
    }
    let (pass, _) = inspection.round.flutes[gap.from];
    let message = format!(
        "from one flute to the next it is {:.3}° where {pitch:.3}° is wanted, at x = {:.3}: {}° either way is allowed",
        gap.found.0, gap.x, wanted.index_tolerance.0
    );
    findings.push(
        Diagnostic::error("flute-index", message)
            .note("the first of the two begins here")
            .help("check A at the beginning of both flutes")
            .at(inspection.ground.passes[pass].place.clone()),
    );
}
