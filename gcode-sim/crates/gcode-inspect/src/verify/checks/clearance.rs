//! Clearance of the tool while an axis rotates and where a rapid passes the part: that of the job, and enough for a small
//! error of the tool length.
use super::*;
use crate::findings::{RAPID_NEAR_PART, TURNS_NEAR_PART};
use crate::holes::per_block::with_repeat_note;
use crate::holes::{CONTACT_CLEARANCE, CloseMotion, CloseMotionKind, ROUNDING_ALLOWANCE};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    for motion in &inspection.extraction.close_motions {
        let finding = finding(motion, &inspection.reference.process_limits);
        let finding = with_repeat_note(finding, motion.count).with_backtrace(motion.backtrace.clone());
        findings.add(Subject::Motion, finding);
    }
}

fn finding(motion: &CloseMotion, limits: &ProcessLimits) -> Diagnostic {
    let (tip, above) = (motion.tip_clearance, motion.tip_clearance.max(0.0));
    let touches =
        format!("an error of {CONTACT_CLEARANCE} mm in the tool length or the part position makes it touch");
    match motion.kind {
        CloseMotionKind::RotaryTurn { letter, angle } => {
            let mut message =
                format!("{letter} rotates by {:.3}° with the tool {above:.3} mm above the part", angle.0);
            if tip < CONTACT_CLEARANCE {
                let help = format!("retract to a safe height before {letter} rotates");
                return Diagnostic::new(&TURNS_NEAR_PART, message).note(touches).help(help);
            }
            if let Some(edge) = motion.edge_clearance.filter(|edge| *edge < tip - ROUNDING_ALLOWANCE) {
                let (far, side) = (edge.abs(), if edge < 0.0 { "below the surface" } else { "above" });
                message.push_str(&format!(", the edge of a flat end {far:.3} mm {side}"));
            }
            let help = format!(
                "retract before {letter} rotates: the job starts feeds {} mm above the surface, and a \
                 rotation needs more clearance",
                limits.clearance.unwrap_or_default()
            );
            Diagnostic::new(&TURNS_NEAR_PART, message).with_severity(Severity::Warning).help(help)
        }
        CloseMotionKind::LowRetract { letter, angle } => {
            let message = format!(
                "{letter} rotates by {:.3}° with the tool {above:.3} mm above the part; the job specifies \
                 {} mm",
                angle.0,
                limits.retract.unwrap_or_default()
            );
            Diagnostic::new(&TURNS_NEAR_PART, message)
                .with_severity(Severity::Warning)
                .help(format!("retract to machine.retract before {letter} rotates, or correct it in the job"))
        }
        CloseMotionKind::RapidPast => {
            let message = format!("the rapid passes {above:.3} mm above the part surface");
            let finding = Diagnostic::new(&RAPID_NEAR_PART, message).note(touches);
            finding.help("move from hole to hole at a safe height")
        }
        CloseMotionKind::RapidTowards if CONTACT_CLEARANCE <= tip => {
            let approach = limits.approach.unwrap_or_default();
            let message =
                format!("the rapid ends {above:.3} mm above the part; the job specifies {approach} mm");
            Diagnostic::new(&RAPID_NEAR_PART, message)
                .help("raise R, or the end of the approach, to machine.clearance, or correct it in the job")
        }
        CloseMotionKind::RapidTowards => {
            let message = format!("the rapid ends {above:.3} mm above the part");
            let finding = Diagnostic::new(&RAPID_NEAR_PART, message);
            finding.help("end it at the clearance where the feed begins; check R for a missing decimal point")
        }
    }
}
