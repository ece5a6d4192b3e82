//! Every flute reaches from the shank's end to the tip angle.
use super::super::Inspection;
use super::one_and_others;
use crate::diag::Diagnostic;
use crate::flutes::Pass;

/// How far an end may be off: along the axis at the shank, mm, and by the polar angle at the tip, degrees.
const AT_SHANK: f64 = 0.05;
const AT_TIP: f64 = 0.1;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wrong = inspection.ground.passes.iter().filter_map(|pass| Some((pass, wrong(inspection, pass)?)));
    let Some(((pass, message), others)) = one_and_others(wrong) else { return };
    let finding = Diagnostic::error("flute-end", message)
        .help("check the length of the cylinder (X) and the last C, 90° less the tip angle")
        .at(pass.place.clone());
    findings.push(others.into_iter().fold(finding, Diagnostic::note));
}

fn wrong(inspection: &Inspection<'_>, pass: &Pass) -> Option<String> {
    let wanted = inspection.wanted;
    let samples = pass.trace.samples.iter();
    let start = samples.clone().map(|s| s.at.x).fold(f64::NEG_INFINITY, f64::max);
    let tip = samples.map(|s| s.polar.0).fold(f64::INFINITY, f64::min);
    if AT_SHANK < (start - wanted.start).abs() {
        return Some(format!(
            "a flute begins {start:.3} mm behind the end of the cylinder where {:.3} mm are wanted",
            wanted.start
        ));
    }
    (AT_TIP < (tip - wanted.tip_angle.0).abs())
        .then(|| format!("a flute ends at polar angle {tip:.3}° where {:.3}° is wanted", wanted.tip_angle.0))
}
