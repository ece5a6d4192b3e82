//! Flutes ground a second time.
use super::super::spacing::RepeatedPass;
use super::*;
use crate::findings::FLUTE_TWICE;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let spacing = &inspection.spacing;
    let Some(first) = spacing.repeated.first() else { return };
    // The finding on a missing flute names a pass that is ground in its place.
    if spacing.flutes.len() < inspection.nominal.count as usize {
        return;
    }
    let rounds = |flute: usize| {
        // The angle of a flute may be that of a repeated pass.
        let repeated = spacing.repeated.iter().find(|one| one.pass == flute);
        let begun = repeated.map_or(flute, |one| one.first_pass);
        1 + spacing.repeated.iter().filter(|one| one.first_pass == begun).count()
    };
    let first_rounds = rounds(first.first_pass);
    let is_round = spacing.flutes.iter().all(|(flute, _)| rounds(*flute) == first_rounds);
    let finding = Diagnostic::new(&FLUTE_TWICE, sentence(*first));
    let finding = match (is_round, spacing.repeated.len() - 1) {
        (true, _) => finding
            .with_severity(Severity::Warning)
            .note(format!("every flute is ground {first_rounds} times"))
            .help("keep the repeated pass if the wheel is meant to spark out; otherwise remove it"),
        (false, more) => {
            let note =
                (0 < more).then(|| format!("{more} more passes repeat flutes that are already ground"));
            note.into_iter().fold(finding, Diagnostic::note).help(
                "remove the pass from the program; check for one iteration too many in a loop over the flutes",
            )
        }
    };
    let passes = &inspection.actual.passes;
    let sites = spacing.repeated.iter().filter_map(|one| {
        let samples = &passes[one.pass].trace.samples;
        Some(Site::new(Some(one.pass), samples.get(samples.len() / 2)?.point))
    });
    findings.push(finding.with_backtrace(passes[first.pass].backtrace.clone()).with_sites(sites));
}

/// Returns the sentence on a repeated pass.
pub(super) fn sentence(repeated: RepeatedPass) -> String {
    format!("pass {} repeats the flute of pass {}", repeated.pass + 1, repeated.first_pass + 1)
}
