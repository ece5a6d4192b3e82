//! Contact of the wheel with the burr between two passes: rapids stay off the blank, feeds lead straight in where a pass
//! begins and straight out where it ends.
use super::*;
use crate::findings::{WHEEL_INTO_BURR, WHEEL_NEAR_BURR};
use crate::flutes::CollisionKind;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    for collision in &inspection.actual.collisions {
        let (depth, again) = (collision.depth, collision.count - 1);
        let mut kind = &WHEEL_INTO_BURR;
        let mut help = "move Y clear of the burr first, then rotate A and C";
        let mut note = (0 < again).then(|| format!("and {again} more of this block"));
        let message = match collision.kind {
            CollisionKind::Rapid => {
                format!("rapid motion with the wheel in the blank, {depth:.3} mm below its surface")
            }
            CollisionKind::RapidPass(_) => {
                help = "grind with G01: G00 stays in force until another motion code";
                note = match (again, collision.moves - 1) {
                    (0, 0) => None,
                    (0, more) => Some(format!("and {more} more moves of this pass")),
                    (again, more) => Some(format!(
                        "{} moves of this pass and {again} more that begin at this block",
                        more + 1
                    )),
                };
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
                kind = &WHEEL_NEAR_BURR;
                help = "end it at machine.clearance from the blank, or correct that in the job";
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
        let finding = Diagnostic::new(kind, message)
            .help(help)
            .with_backtrace(collision.backtrace.clone())
            .with_sites([Site::new(None, collision.point)]);
        findings.push(note.into_iter().fold(finding, Diagnostic::note));
    }
}
