//! The wheel turns while it grinds, the way round that emitted programs have it.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};
use crate::flutes::Begun;
use crate::holes::spindle::stopped;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let passes = || inspection.ground.passes.iter().enumerate();
    let idle: Vec<_> = passes().filter_map(|(index, pass)| Some((index, pass.idle.as_ref()?))).collect();
    if let Some((_, first)) = idle.first() {
        let message = "the wheel stands while it is fed along a flute: no M03 or M04 with an S is in force";
        let finding =
            stopped(message, first.builder).help("start the wheel with M03 S… before the first pass");
        findings.push(on(finding, idle.iter().map(|(index, idle)| (*index, &idle.begun)).collect()));
    }
    let reversed: Vec<_> =
        passes().filter_map(|(index, pass)| Some((index, pass.reversed.as_ref()?))).collect();
    if !reversed.is_empty() {
        let finding = Diagnostic::warning(
            "wheel-reversed",
            "the wheel grinds with M04, where the programs that are emitted for a burr have M03",
        )
        .note("which way round this wheel has to turn the job doesn't say")
        .help("M03, if the wheel isn't meant to run backwards");
        findings.push(on(finding, reversed));
    }
}

/// At the first of the passes, with the count of the others: a loop makes every flute wrong alike.
fn on(finding: Diagnostic, passes: Vec<(usize, &Begun)>) -> Diagnostic {
    let place = passes.first().map(|(_, begun)| begun.place.clone());
    let mut finding = finding.on(passes.iter().map(|(pass, begun)| Site { pass: Some(*pass), at: begun.at }));
    finding.place = place;
    match passes.len() {
        0 | 1 => finding,
        all => finding.note(format!("and so with {} more of the passes", all - 1)),
    }
}
