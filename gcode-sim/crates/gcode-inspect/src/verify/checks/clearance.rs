//! While an axis turns, and where a rapid goes past the part, the tool must be clear of it: no nearer than the job lets
//! feeds begin, and never so near that a length set a little wrong would touch.
use crate::holes::per_block::with_repeat_note;
use crate::holes::{CONTACT_CLEARANCE, CloseMotion, CloseMotionKind, ROUNDING_ALLOWANCE};
use gcode_lang::diag::Diagnostic;
use gcode_part::ProcessLimits;

pub(in crate::verify) fn findings(close_motions: &[CloseMotion], conduct: &ProcessLimits) -> Vec<Diagnostic> {
    let told = close_motions.iter().map(|passing| {
        with_repeat_note(finding(passing, conduct), passing.count).at(passing.backtrace.clone())
    });
    told.collect()
}

fn finding(close_motion: &CloseMotion, conduct: &ProcessLimits) -> Diagnostic {
    let above = close_motion.tip_clearance.max(0.0);
    match close_motion.kind {
        CloseMotionKind::RotaryTurn { letter, angle: by } => {
            let mut message =
                format!("{letter} turns {:.3}° while the tool stands {above:.3} mm above the part", by.0);
            if close_motion.tip_clearance < CONTACT_CLEARANCE {
                let finding = Diagnostic::error("turns-near-part", message).note(format!(
                    "a tool length or a part that is {CONTACT_CLEARANCE} mm off makes it touch"
                ));
                return finding.help(format!("retract to a safe height before {letter} turns"));
            }
            if let Some(edge) = close_motion
                .edge_clearance
                .filter(|edge| *edge < close_motion.tip_clearance - ROUNDING_ALLOWANCE)
            {
                let (far, side) = (edge.abs(), if edge < 0.0 { "below the surface" } else { "above" });
                message.push_str(&format!(", the edge of a flat end {far:.3} mm {side}"));
            }
            let help = format!(
                "retract before {letter} turns: from {} mm above the surface the job feeds, and turning wants more",
                conduct.clearance.unwrap_or_default()
            );
            Diagnostic::warning("turns-near-part", message).help(help)
        }
        CloseMotionKind::LowRetract { letter, angle: by } => {
            let retract = conduct.retract.unwrap_or_default();
            let message = format!(
                "{letter} turns {:.3}° while the tool stands {above:.3} mm above the part, and the job wants {retract} mm there",
                by.0
            );
            Diagnostic::warning("turns-near-part", message)
                .help(format!("retract to machine.retract before {letter} turns, or correct it in the job"))
        }
        CloseMotionKind::RapidPast => {
            let message = format!("the rapid goes past the part {above:.3} mm above the surface");
            let finding = Diagnostic::warning("rapid-near-part", message)
                .note(format!("a tool length or a part that is {CONTACT_CLEARANCE} mm off makes it touch"));
            finding.help("go from hole to hole at a safe height")
        }
        CloseMotionKind::RapidTowards if CONTACT_CLEARANCE <= close_motion.tip_clearance => {
            let approach = conduct.approach.unwrap_or_default();
            let message =
                format!("the rapid ends {above:.3} mm above the part, and the job feeds from {approach} mm");
            Diagnostic::warning("rapid-near-part", message)
                .help("raise R, or the end of the approach, to machine.clearance, or correct it in the job")
        }
        CloseMotionKind::RapidTowards => {
            let message = format!("the rapid ends {above:.3} mm above the part");
            let finding = Diagnostic::warning("rapid-near-part", message);
            finding.help("end it at a clearance from which the feed begins: is R without a point?")
        }
    }
}
