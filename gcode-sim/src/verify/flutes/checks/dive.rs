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
                format!("rapid motion with the wheel in the blank, {depth:.3} mm below its surface")
            }
            Kind::RapidPass(_) => {
                format!(
                    "rapid motion along a flute with the wheel in the blank, {depth:.3} mm below its surface"
                )
            }
            Kind::Below => {
                format!("a feed that does not rotate A takes the wheel {depth:.3} mm below the tooth bottom")
            }
            Kind::Sideways(by) => format!(
                "a feed that does not rotate A takes the wheel {by:.3} mm along the burr in the cut, \
                 {depth:.3} mm below the blank surface"
            ),
            Kind::Near => {
                format!(
                    "the rapid ends with the wheel {:.3} mm off the blank; the job specifies {} mm",
                    -depth,
                    inspection.wanted.clearance.unwrap_or_default()
                )
            }
            Kind::Pit => {
                format!("the wheel is fed {depth:.3} mm below the blank surface where no pass begins")
            }
        };
        let help = match dive.kind {
            Kind::RapidPass(_) => "grind with G01: G00 stays in force until another motion code",
            Kind::Near => "end it at machine.clearance from the blank, or correct that in the job",
            Kind::Rapid | Kind::Below | Kind::Sideways(_) | Kind::Pit => {
                "move Y clear of the burr first, then rotate A and C"
            }
        };
        let again = dive.times - 1;
        let note = match dive.kind {
            Kind::RapidPass(_) => match again {
                0 => Some(dive.moves - 1)
                    .filter(|more| 0 < *more)
                    .map(|more| format!("and {more} more moves of this pass")),
                more => Some(format!(
                    "{} moves of this pass and {more} more that begin at this block",
                    dive.moves
                )),
            },
            Kind::Rapid | Kind::Below | Kind::Sideways(_) | Kind::Pit | Kind::Near => {
                (0 < again).then(|| format!("and {again} more of this block"))
            }
        };
        let finding = match dive.kind {
            Kind::Near => Diagnostic::warning("wheel-near-burr", message),
            Kind::Rapid | Kind::RapidPass(_) | Kind::Below | Kind::Sideways(_) | Kind::Pit => {
                Diagnostic::error("wheel-into-burr", message)
            }
        };
        let finding = finding.help(help).at(dive.place.clone()).on([Site { pass: None, at: dive.at }]);
        findings.push(note.into_iter().fold(finding, Diagnostic::note));
    }
}
