//! Between the passes the wheel's contact stays off the burr: off the blank in rapid motion, and in a feed too but
//! straight in where a pass begins and straight out where one ends.
use super::super::Inspection;
use crate::findings::{WHEEL_INTO_BURR, WHEEL_NEAR_BURR};
use crate::flutes::CollisionKind;
use gcode_lang::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    for dive in &inspection.actual.collisions {
        let depth = dive.depth;
        let message = match dive.kind {
            CollisionKind::Rapid => {
                format!("rapid motion with the wheel in the blank, {depth:.3} mm below its surface")
            }
            CollisionKind::RapidPass(_) => {
                format!(
                    "rapid motion along a flute with the wheel in the blank, {depth:.3} mm below its surface"
                )
            }
            CollisionKind::BelowToothBottom => {
                format!("a feed that does not rotate A takes the wheel {depth:.3} mm below the tooth bottom")
            }
            CollisionKind::Sideways(by) => format!(
                "a feed that does not rotate A takes the wheel {by:.3} mm along the burr in the cut, \
                 {depth:.3} mm below the blank surface"
            ),
            CollisionKind::LowClearance => {
                format!(
                    "the rapid ends with the wheel {:.3} mm off the blank; the job specifies {} mm",
                    -depth,
                    inspection.nominal.clearance.unwrap_or_default()
                )
            }
            CollisionKind::PlungeWithoutPass => {
                format!("the wheel is fed {depth:.3} mm below the blank surface where no pass begins")
            }
        };
        let help = match dive.kind {
            CollisionKind::RapidPass(_) => "grind with G01: G00 stays in force until another motion code",
            CollisionKind::LowClearance => {
                "end it at machine.clearance from the blank, or correct that in the job"
            }
            CollisionKind::Rapid
            | CollisionKind::BelowToothBottom
            | CollisionKind::Sideways(_)
            | CollisionKind::PlungeWithoutPass => "move Y clear of the burr first, then rotate A and C",
        };
        let again = dive.count - 1;
        let note = match dive.kind {
            CollisionKind::RapidPass(_) => match again {
                0 => Some(dive.moves - 1)
                    .filter(|more| 0 < *more)
                    .map(|more| format!("and {more} more moves of this pass")),
                more => Some(format!(
                    "{} moves of this pass and {more} more that begin at this block",
                    dive.moves
                )),
            },
            CollisionKind::Rapid
            | CollisionKind::BelowToothBottom
            | CollisionKind::Sideways(_)
            | CollisionKind::PlungeWithoutPass
            | CollisionKind::LowClearance => (0 < again).then(|| format!("and {again} more of this block")),
        };
        let finding = match dive.kind {
            CollisionKind::LowClearance => Diagnostic::new(&WHEEL_NEAR_BURR, message),
            CollisionKind::Rapid
            | CollisionKind::RapidPass(_)
            | CollisionKind::BelowToothBottom
            | CollisionKind::Sideways(_)
            | CollisionKind::PlungeWithoutPass => Diagnostic::new(&WHEEL_INTO_BURR, message),
        };
        let finding = finding
            .help(help)
            .with_backtrace(dive.backtrace.clone())
            .with_sites([Site::new(None, dive.point)]);
        findings.push(note.into_iter().fold(finding, Diagnostic::note));
    }
}
