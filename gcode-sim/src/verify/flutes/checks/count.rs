//! As many flutes as are wanted, no more and no fewer.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (found, wanted) = (inspection.round.flutes.len(), inspection.wanted.count as usize);
    if found == 0 {
        let message = format!("no flute is ground where {wanted} are wanted: no feed turns A");
        findings.push(
            Diagnostic::error("flute-missing", message).help("grinding moves are feeds (G01) with an A word"),
        );
        return;
    }
    if found < wanted {
        let pitch = 360.0 / wanted as f64;
        let mut finding =
            Diagnostic::error("flute-missing", format!("{found} flutes where {wanted} are wanted"));
        if let Some(gap) = inspection.round.worst_gap.filter(|gap| 1.5 * pitch < gap.found.0) {
            let (pass, _) = inspection.round.flutes[gap.from];
            finding = finding
                .note(format!(
                    "the widest gap round the burr is {:.3}° where {pitch:.3}° are wanted, behind the flute that begins here",
                    gap.found.0
                ))
                .at(inspection.ground.passes[pass].place.clone());
        }
        let sites = inspection.round.absent(inspection.wanted).into_iter().map(|at| Site { pass: None, at });
        let help = "the loop over the flutes ends too early, or an index move is missing";
        findings.push(finding.help(help).on(sites));
    }
    if wanted < found {
        let message = format!("{found} flutes where {wanted} are wanted");
        let last = inspection.round.flutes.iter().map(|(pass, _)| *pass).max().unwrap_or(0);
        let pass = &inspection.ground.passes[last];
        let middle = pass.trace.samples.get(pass.trace.samples.len() / 2);
        findings.push(
            Diagnostic::error("flute-extra", message)
                .help("the loop over the flutes goes on too long, or the index is too small")
                .at(pass.place.clone())
                .on(middle.map(|sample| Site { pass: Some(last), at: sample.at })),
        );
    }
}
