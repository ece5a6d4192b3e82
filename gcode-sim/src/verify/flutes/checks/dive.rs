//! Between the passes the wheel's contact stays off the burr: off the blank in rapid motion, off the tooth bottom always.
use super::super::Inspection;
use crate::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    for dive in &inspection.ground.dives {
        let message = if dive.rapid {
            format!("rapid motion while the wheel touches the blank, {:.3} mm below its surface", dive.depth)
        } else {
            format!("a feed that doesn't turn A takes the wheel {:.3} mm below the tooth bottom", dive.depth)
        };
        findings.push(
            Diagnostic::error("wheel-into-burr", message)
                .help("move Y clear of the burr first, then turn A and C")
                .at(dive.place.clone()),
        );
    }
}
