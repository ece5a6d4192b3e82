//! While an axis turns, and where a rapid goes past the part, the tool must be clear of it: no nearer than the job lets
//! feeds begin, and never so near that a length set a little wrong would touch.
use crate::holes::per_block::again;
use crate::holes::{CONTACT, CloseMotion, CloseMotionKind, ROUNDED};
use gcode_lang::diag::Diagnostic;
use gcode_part::ProcessLimits;

pub(in crate::verify) fn findings(passings: &[CloseMotion], conduct: &ProcessLimits) -> Vec<Diagnostic> {
    let told = passings
        .iter()
        .map(|passing| again(finding(passing, conduct), passing.times).at(passing.place.clone()));
    told.collect()
}

fn finding(passing: &CloseMotion, conduct: &ProcessLimits) -> Diagnostic {
    let above = passing.tip.max(0.0);
    match passing.way {
        CloseMotionKind::Turning { letter, by } => {
            let mut message =
                format!("{letter} turns {:.3}° while the tool stands {above:.3} mm above the part", by.0);
            if passing.tip < CONTACT {
                let finding = Diagnostic::error("turns-near-part", message)
                    .note(format!("a tool length or a part that is {CONTACT} mm off makes it touch"));
                return finding.help(format!("retract to a safe height before {letter} turns"));
            }
            if let Some(edge) = passing.edge.filter(|edge| *edge < passing.tip - ROUNDED) {
                let (far, side) = (edge.abs(), if edge < 0.0 { "below the surface" } else { "above" });
                message.push_str(&format!(", the edge of a flat end {far:.3} mm {side}"));
            }
            let help = format!(
                "retract before {letter} turns: from {} mm above the surface the job feeds, and turning wants more",
                conduct.clearance.unwrap_or_default()
            );
            Diagnostic::warning("turns-near-part", message).help(help)
        }
        CloseMotionKind::Low { letter, by } => {
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
                .note(format!("a tool length or a part that is {CONTACT} mm off makes it touch"));
            finding.help("go from hole to hole at a safe height")
        }
        CloseMotionKind::RapidTowards if CONTACT <= passing.tip => {
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
