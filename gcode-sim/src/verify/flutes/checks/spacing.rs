//! No flute's path runs into its neighbour.
use super::super::Inspection;
use crate::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let least = 2.0 * inspection.wanted.chord_error;
    let Some(near) = inspection.round.nearest.filter(|near| *near < least) else { return };
    findings.push(
        Diagnostic::error(
            "flutes-meet",
            format!("neighbouring flutes come as near as {near:.4} mm: {least} mm, twice the chord error, is the least"),
        )
        .help("fewer flutes, or a larger tip angle"),
    );
}
