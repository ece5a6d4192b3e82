//! No flute is ground a second time.
use super::super::Inspection;
use super::super::round::Again;
use crate::diag::{Diagnostic, Severity, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let round = &inspection.round;
    // Instead of a flute that is missing: told with that one.
    let Some(first) = round.again.first().filter(|_| inspection.wanted.count as usize <= round.flutes.len())
    else {
        return;
    };
    let rounds = |flute: usize| {
        let times = |pass: usize| round.again.iter().filter(|again| again.first == pass).count();
        // A flute's angle may be that of a later pass over it.
        let begun = round.again.iter().find(|again| again.pass == flute).map_or(flute, |again| again.first);
        1 + times(begun)
    };
    let of_first = rounds(first.first);
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
    let finding = Diagnostic::new(severity, "flute-twice", sentence(*first)).help(help);
    let finding = match (is_round, round.again.len() - 1) {
        (true, _) => finding.note(format!("every flute is ground {of_first} times")),
        (false, 0) => finding,
        (false, more) => finding.note(format!("{more} more passes repeat flutes that are already ground")),
    };
    let sites = round.again.iter().filter_map(|again| {
        let samples = &inspection.ground.passes[again.pass].trace.samples;
        Some(Site { pass: Some(again.pass), at: samples.get(samples.len() / 2)?.at })
    });
    findings.push(finding.at(inspection.ground.passes[first.pass].place.clone()).on(sites));
}

/// In words which pass goes over which flute.
pub(super) fn sentence(again: Again) -> String {
    format!("pass {} repeats the flute of pass {}", again.pass + 1, again.first + 1)
}
