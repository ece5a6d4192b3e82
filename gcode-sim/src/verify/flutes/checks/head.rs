//! B stands at the helix angle and doesn't move during a pass.
use super::super::Inspection;
use super::one_and_others;
use crate::diag::Diagnostic;
use crate::flutes::Pass;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wrong = inspection.ground.passes.iter().filter_map(|pass| Some((pass, wrong(inspection, pass)?)));
    let Some(((pass, message), others)) = one_and_others(wrong) else { return };
    let finding = Diagnostic::error("flute-head", message)
        .help("set B once before each pass, to the helix angle on the cylinder")
        .at(pass.place.clone());
    findings.push(others.into_iter().fold(finding, Diagnostic::note));
}

fn wrong(inspection: &Inspection<'_>, pass: &Pass) -> Option<String> {
    let (wanted, tolerance) = (inspection.wanted.helix, inspection.wanted.helix_tolerance);
    let (least, most) = pass.head?;
    if 1e-9 < most.0 - least.0 {
        return Some(format!("the head swivels from {:.3}° to {:.3}° during a pass", least.0, most.0));
    }
    (tolerance < (least - wanted).abs())
        .then(|| format!("the head stands at {:.3}° where the helix angle is {:.3}°", least.0, wanted.0))
}
