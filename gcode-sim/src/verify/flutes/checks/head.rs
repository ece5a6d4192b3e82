//! B stands at the helix angle and doesn't move during a pass.
use super::super::Inspection;
use super::helix::follow;
use super::on_passes;
use crate::diag::Diagnostic;
use crate::flutes::{Begun, Pass};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    // That is told with the helix angle.
    if follow(inspection) {
        return;
    }
    let wrong = |pass: &Pass| {
        let message = wrong(inspection, pass)?;
        let at = pass.trace.samples.first()?.at;
        Some((message, Begun { place: pass.place.clone(), at }))
    };
    findings.extend(on_passes(inspection, wrong, |message| {
        Diagnostic::error("flute-head", message)
            .help("set B once before each pass, to the helix angle on the cylinder")
    }));
}

fn wrong(inspection: &Inspection<'_>, pass: &Pass) -> Option<String> {
    let (wanted, tolerance) = (inspection.wanted.helix, inspection.wanted.helix_tolerance);
    let (least, most) = pass.head?;
    if 1e-9 < most.0 - least.0 {
        return Some(format!("the head swivels from {:.3}° to {:.3}° during a pass", least.0, most.0));
    }
    (tolerance < (least - wanted).abs())
        .then(|| format!("the head is at {:.3}°, the helix angle is {:.3}°", least.0, wanted.0))
}
