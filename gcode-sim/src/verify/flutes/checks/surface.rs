//! The contact stays on the tooth bottom, between the programmed points too.
use super::super::Inspection;
use crate::diag::Diagnostic;
use crate::flutes::ARITHMETIC;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let allowed = inspection.wanted.surface_tolerance;
    let samples = inspection
        .ground
        .passes
        .iter()
        .flat_map(|pass| pass.trace.samples.iter().map(move |sample| (pass, sample)));
    let Some((pass, worst)) = samples.max_by(|a, b| a.1.off.abs().total_cmp(&b.1.off.abs())) else { return };
    if worst.off.abs() <= allowed + ARITHMETIC {
        return;
    }
    let (side, off) = if worst.off < 0.0 { ("below", -worst.off) } else { ("above", worst.off) };
    let finding = Diagnostic::error(
        "flute-surface",
        format!(
            "the contact is {off:.4} mm {side} the tooth bottom at polar angle {:.1}°: {allowed} mm is allowed",
            worst.polar.0
        ),
    );
    let most = inspection.wanted.profile.radius();
    let finding = match off > 20.0 * allowed || off > 0.05 * most {
        true => finding.help(
            "X and Y don't keep the arc's centre in place while C turns: check the sign of each axis, the formula for Y, \
             and c_offset against the machine file's part.origin",
        ),
        false => finding.help("the moves are too long, or the increment is too coarse for this chord error"),
    };
    findings.push(finding.at(pass.trace.place(worst).clone()));
}
