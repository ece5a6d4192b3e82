//! No flute's path runs into its neighbour.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let least = 2.0 * inspection.wanted.chord_error;
    let Some(near) = inspection.round.nearest.filter(|near| near.apart < least) else { return };
    findings.push(
        Diagnostic::error(
            "flutes-meet",
            format!(
                "neighbouring flutes come within {:.4} mm; limit {least} mm, twice the chord error",
                near.apart
            ),
        )
        .help("use fewer flutes, or a larger tip angle")
        .on([Site { pass: Some(near.pass), at: near.at }]),
    );
}
