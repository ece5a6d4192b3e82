//! While an axis turns, and where a rapid goes past the part, the tool must be clear of it: no nearer than the job lets
//! feeds begin, and never so near that a length set a little wrong would touch.
use super::{HoleFinding, HoleInspection};
use crate::findings::{RAPID_NEAR_PART, TURNS_NEAR_PART};
use crate::holes::per_block::with_repeat_note;
use crate::holes::{CONTACT_CLEARANCE, CloseMotion, CloseMotionKind, ROUNDING_ALLOWANCE};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_part::ProcessLimits;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut Vec<HoleFinding>) {
    findings.extend(inspection.extraction.close_motions.iter().map(|motion| {
        let finding = finding(motion, &inspection.reference.process_limits);
        let finding = with_repeat_note(finding, motion.count).with_backtrace(motion.backtrace.clone());
        HoleFinding::of_motion(finding)
    }));
}

fn finding(close_motion: &CloseMotion, conduct: &ProcessLimits) -> Diagnostic {
    let above = close_motion.tip_clearance.max(0.0);
    match close_motion.kind {
        CloseMotionKind::RotaryTurn { letter, angle: by } => {
            let mut message =
                format!("{letter} rotates by {:.3}° with the tool {above:.3} mm above the part", by.0);
            if close_motion.tip_clearance < CONTACT_CLEARANCE {
                let finding = Diagnostic::new(&TURNS_NEAR_PART, message).note(format!(
                    "an error of {CONTACT_CLEARANCE} mm in the tool length or the part position makes it touch"
                ));
                return finding.help(format!("retract to a safe height before {letter} rotates"));
            }
            if let Some(edge) = close_motion
                .edge_clearance
                .filter(|edge| *edge < close_motion.tip_clearance - ROUNDING_ALLOWANCE)
            {
                let (far, side) = (edge.abs(), if edge < 0.0 { "below the surface" } else { "above" });
                message.push_str(&format!(", the edge of a flat end {far:.3} mm {side}"));
            }
            let help = format!(
                "retract before {letter} rotates: the job starts feeds {} mm above the surface, and a \
                 rotation needs more clearance",
                conduct.clearance.unwrap_or_default()
            );
            Diagnostic::new(&TURNS_NEAR_PART, message).with_severity(Severity::Warning).help(help)
        }
        CloseMotionKind::LowRetract { letter, angle: by } => {
            let retract = conduct.retract.unwrap_or_default();
            let message = format!(
                "{letter} rotates by {:.3}° with the tool {above:.3} mm above the part; the job specifies \
                 {retract} mm",
                by.0
            );
            Diagnostic::new(&TURNS_NEAR_PART, message)
                .with_severity(Severity::Warning)
                .help(format!("retract to machine.retract before {letter} rotates, or correct it in the job"))
        }
        CloseMotionKind::RapidPast => {
            let message = format!("the rapid passes {above:.3} mm above the part surface");
            let finding = Diagnostic::new(&RAPID_NEAR_PART, message).note(format!(
                "an error of {CONTACT_CLEARANCE} mm in the tool length or the part position makes it touch"
            ));
            finding.help("move from hole to hole at a safe height")
        }
        CloseMotionKind::RapidTowards if CONTACT_CLEARANCE <= close_motion.tip_clearance => {
            let approach = conduct.approach.unwrap_or_default();
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
