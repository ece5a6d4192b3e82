//! No flute's path runs into its neighbour.
use super::super::Inspection;
use crate::findings::FLUTES_MEET;
use gcode_lang::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let least = 2.0 * inspection.nominal.chord_error;
    let Some(near) = inspection.spacing.nearest_approach.filter(|near| near.distance < least) else { return };
    findings.push(
        Diagnostic::new(
            &FLUTES_MEET,
            format!(
                "neighbouring flutes come within {:.4} mm; limit {least} mm, twice the chord error",
                near.distance
            ),
        )
        .help("use fewer flutes, or a larger tip angle")
        .with_sites([Site::new(Some(near.pass), near.point)]),
    );
}
