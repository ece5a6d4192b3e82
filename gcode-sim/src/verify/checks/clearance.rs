//! While an axis turns, and where a rapid goes past the part, the tool must be clear of it: no nearer than the job lets
//! feeds begin, and never so near that a length set a little wrong would touch.
use crate::diag::Diagnostic;
use crate::holes::{CONTACT, Passing, Way};

/// What rounding may take off the job's clearance, in mm.
const ROUNDED: f64 = 0.01;

/// `clearance`: the job's, in mm.
pub(in crate::verify) fn findings(passings: &[Passing], clearance: Option<f64>) -> Vec<Diagnostic> {
    let finding = |passing| finding(passing, clearance).map(|found| counted(found, passing));
    passings.iter().filter_map(finding).collect()
}

fn finding(passing: &Passing, clearance: Option<f64>) -> Option<Diagnostic> {
    let above = passing.tip.max(0.0);
    match passing.way {
        Way::Turning { letter, by } => {
            let near = passing.edge.map_or(passing.tip, |edge| edge.min(passing.tip));
            let touches = passing.tip < CONTACT;
            if !touches && clearance.is_none_or(|clearance| clearance + ROUNDED < near) {
                return None;
            }
            let mut message =
                format!("{letter} turns {:.3}° while the tool stands {above:.3} mm above the part", by.0);
            if touches {
                let finding = Diagnostic::error("turns-near-part", message)
                    .note(format!("a tool length or a part that is {CONTACT} mm off makes it touch"));
                return Some(finding.help(format!("retract to a safe height before {letter} turns")));
            }
            if let Some(edge) = passing.edge.filter(|edge| *edge < passing.tip - ROUNDED) {
                let (far, side) = (edge.abs(), if edge < 0.0 { "below the surface" } else { "above" });
                message.push_str(&format!(", the edge of a flat end {far:.3} mm {side}"));
            }
            let help = format!(
                "retract before {letter} turns: from {} mm above the surface the job feeds, and turning wants more",
                clearance.unwrap_or_default()
            );
            Some(Diagnostic::warning("turns-near-part", message).help(help))
        }
        Way::Past => {
            let message = format!("the rapid goes past the part {above:.3} mm above the surface");
            let finding = Diagnostic::warning("rapid-near-part", message)
                .note(format!("a tool length or a part that is {CONTACT} mm off makes it touch"));
            Some(finding.help("go from hole to hole at a safe height"))
        }
        Way::Towards => {
            let message = format!("the rapid ends {above:.3} mm above the part");
            let finding = Diagnostic::warning("rapid-near-part", message);
            Some(finding.help("end it at a clearance from which the feed begins: is R without a point?"))
        }
    }
}

fn counted(finding: Diagnostic, passing: &Passing) -> Diagnostic {
    let finding = match passing.times {
        1 => finding,
        2 => finding.note("and once more at the same block"),
        times => finding.note(format!("and {} more times at the same block", times - 1)),
    };
    finding.at(passing.place.clone())
}
