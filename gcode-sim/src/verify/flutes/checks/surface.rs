//! The contact stays on the tooth bottom, between the programmed points too.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};
use crate::flutes::{ARITHMETIC, Pass, Sample};

pub(super) fn check<'g>(inspection: &Inspection<'g>, findings: &mut Vec<Diagnostic>) {
    let allowed = inspection.wanted.surface_tolerance;
    // Of every pass its worst place.
    let of_pass = |(index, pass): (usize, &'g Pass)| {
        let worst = pass.trace.samples.iter().max_by(|a, b| a.off.abs().total_cmp(&b.off.abs()))?;
        (allowed + ARITHMETIC < worst.off.abs()).then_some((index, worst))
    };
    let mut all: Vec<(usize, &Sample)> =
        inspection.ground.passes.iter().enumerate().filter_map(of_pass).collect();
    all.sort_by(|a, b| b.1.off.abs().total_cmp(&a.1.off.abs()));
    let Some((pass, worst)) = all.first().copied() else { return };
    let pass = &inspection.ground.passes[pass];
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
    let sites = all.iter().map(|(pass, sample)| Site { pass: Some(*pass), at: sample.at });
    findings.push(finding.at(pass.trace.place(worst).clone()).on(sites));
}
