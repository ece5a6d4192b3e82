//! No flute is ground a second time.
use super::super::Inspection;
use super::super::spacing::RepeatedPass;
use crate::findings::FLUTE_TWICE;
use gcode_lang::diag::{Diagnostic, Severity, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let round = &inspection.spacing;
    // Instead of a flute that is missing: told with that one.
    let Some(first) =
        round.repeated.first().filter(|_| inspection.nominal.count as usize <= round.flutes.len())
    else {
        return;
    };
    let rounds = |flute: usize| {
        let times = |pass: usize| round.repeated.iter().filter(|again| again.first_pass == pass).count();
        // A flute's angle may be that of a later pass over it.
        let begun =
            round.repeated.iter().find(|again| again.pass == flute).map_or(flute, |again| again.first_pass);
        1 + times(begun)
    };
    let of_first = rounds(first.first_pass);
    let is_round = round.flutes.iter().all(|(flute, _)| rounds(*flute) == of_first);
    let (severity, help) = match is_round {
        true => (
            Severity::Warning,
            "keep the repeated pass if the wheel is meant to spark out; otherwise remove it",
        ),
        false => (
            Severity::Error,
            "remove the pass from the program; check for one iteration too many in a loop over the flutes",
        ),
    };
    let finding = Diagnostic::new(&FLUTE_TWICE, sentence(*first)).with_severity(severity).help(help);
    let finding = match (is_round, round.repeated.len() - 1) {
        (true, _) => finding.note(format!("every flute is ground {of_first} times")),
        (false, 0) => finding,
        (false, more) => finding.note(format!("{more} more passes repeat flutes that are already ground")),
    };
    let sites = round.repeated.iter().filter_map(|again| {
        let samples = &inspection.actual.passes[again.pass].trace.samples;
        Some(Site::new(Some(again.pass), samples.get(samples.len() / 2)?.point))
    });
    findings.push(
        finding.with_backtrace(inspection.actual.passes[first.pass].backtrace.clone()).with_sites(sites),
    );
}

/// In words which pass goes over which flute.
pub(super) fn sentence(again: RepeatedPass) -> String {
    format!("pass {} repeats the flute of pass {}", again.pass + 1, again.first_pass + 1)
}
