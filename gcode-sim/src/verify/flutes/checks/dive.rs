//! Between the passes the wheel's contact stays off the burr: off the blank in rapid motion, and in a feed too but
//! straight in where a pass begins and straight out where one ends.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};
use crate::flutes::Kind;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    for dive in &inspection.ground.dives {
        let depth = dive.depth;
        let message = match dive.kind {
            Kind::Rapid => {
                format!("rapid motion while the wheel touches the blank, {depth:.3} mm below its surface")
            }
            Kind::Below => {
                format!("a feed that doesn't turn A takes the wheel {depth:.3} mm below the tooth bottom")
            }
            Kind::Sideways(by) => format!(
                "a feed that doesn't turn A takes the wheel {by:.3} mm along the burr in the cut, {depth:.3} mm below the \
                 blank's surface"
            ),
            Kind::Pit => {
                format!("the wheel is fed {depth:.3} mm below the blank's surface where no pass begins")
            }
        };
        let finding = Diagnostic::error("wheel-into-burr", message)
            .help("move Y clear of the burr first, then turn A and C")
            .at(dive.place.clone())
            .on([Site { pass: None, at: dive.at }]);
        let again = dive.times - 1;
        findings.push(if again == 0 {
            finding
        } else {
            finding.note(format!("and {again} more of this block"))
        });
    }
}
