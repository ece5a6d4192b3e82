//! While an axis turns, and where a rapid goes past the part, the tool must be clear of it: no nearer than the job lets
//! feeds begin, and never so near that a length set a little wrong would touch.
use crate::diag::Diagnostic;
use crate::holes::per_block::again;
use crate::holes::{CONTACT, Passing, ROUNDED, Way};
use crate::part::conduct::Conduct;

pub(in crate::verify) fn findings(passings: &[Passing], conduct: &Conduct) -> Vec<Diagnostic> {
    let told = passings
        .iter()
        .map(|passing| again(finding(passing, conduct), passing.times).at(passing.place.clone()));
    told.collect()
}

fn finding(passing: &Passing, conduct: &Conduct) -> Diagnostic {
    let above = passing.tip.max(0.0);
    match passing.way {
        Way::Turning { letter, by } => {
            let mut message =
                format!("{letter} rotates by {:.3}° with the tool {above:.3} mm above the part", by.0);
            if passing.tip < CONTACT {
                let finding = Diagnostic::error("turns-near-part", message).note(format!(
                    "an error of {CONTACT} mm in the tool length or the part position makes it touch"
                ));
                return finding.help(format!("retract to a safe height before {letter} rotates"));
            }
            if let Some(edge) = passing.edge.filter(|edge| *edge < passing.tip - ROUNDED) {
                let (far, side) = (edge.abs(), if edge < 0.0 { "below the surface" } else { "above" });
                message.push_str(&format!(", the edge of a flat end {far:.3} mm {side}"));
            }
            let help = format!(
                "retract before {letter} rotates: the job starts feeds {} mm above the surface, and a \
                 rotation needs more clearance",
                conduct.clearance.unwrap_or_default()
            );
            Diagnostic::warning("turns-near-part", message).help(help)
        }
        Way::Low { letter, by } => {
            let retract = conduct.retract.unwrap_or_default();
            let message = format!(
                "{letter} rotates by {:.3}° with the tool {above:.3} mm above the part; the job specifies \
                 {retract} mm",
                by.0
            );
            Diagnostic::warning("turns-near-part", message)
                .help(format!("retract to machine.retract before {letter} rotates, or correct it in the job"))
        }
        Way::Past => {
            let message = format!("the rapid passes {above:.3} mm above the part surface");
            let finding = Diagnostic::warning("rapid-near-part", message).note(format!(
                "an error of {CONTACT} mm in the tool length or the part position makes it touch"
            ));
            finding.help("move from hole to hole at a safe height")
        }
        Way::Towards if CONTACT <= passing.tip => {
            let approach = conduct.approach.unwrap_or_default();
            let message =
                format!("the rapid ends {above:.3} mm above the part; the job specifies {approach} mm");
            Diagnostic::warning("rapid-near-part", message)
                .help("raise R, or the end of the approach, to machine.clearance, or correct it in the job")
        }
        Way::Towards => {
            let message = format!("the rapid ends {above:.3} mm above the part");
            let finding = Diagnostic::warning("rapid-near-part", message);
            finding.help("end it at the clearance where the feed begins; check R for a missing decimal point")
        }
    }
}
