//! Distance of neighbouring flutes: their paths do not meet.
use super::*;
use crate::findings::FLUTES_MEET;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let limit = 2.0 * inspection.nominal.chord_error;
    let Some(near) = inspection.spacing.nearest_approach.filter(|near| near.distance < limit) else { return };
    let message = format!(
        "neighbouring flutes come within {:.4} mm; limit {limit} mm, twice the chord error",
        near.distance
    );
    let finding = Diagnostic::new(&FLUTES_MEET, message).help("use fewer flutes, or a larger tip angle");
    findings.push(finding.with_sites([Site::new(Some(near.pass), near.point)]));
}
