//! As many flutes as are wanted, no more and no fewer.
use super::super::Inspection;
use super::super::round::SAME;
use super::twice;
use crate::diag::{Diagnostic, Site};
use crate::flutes::Kind;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (found, wanted) = (inspection.round.flutes.len(), inspection.wanted.count as usize);
    if found < wanted {
        findings.push(missing(inspection, found, wanted));
    }
    if wanted < found {
        let finding = Diagnostic::error("flute-extra", format!("{found} flutes, {wanted} specified"));
        let (pass, finding) = match beside(inspection) {
            Some((pass, other, apart)) => {
                let note = format!(
                    "pass {} is {apart:.3}° from pass {}: within {}° it would count as a repeated pass \
                     over the same flute",
                    pass + 1,
                    other + 1,
                    SAME * inspection.wanted.index_tolerance.0
                );
                (pass, finding.note(note).help("check A where this pass begins"))
            }
            None => {
                let last = inspection.round.flutes.iter().map(|(pass, _)| *pass).max().unwrap_or(0);
                (last, finding.help("check the end of the loop over the flutes, and the index"))
            }
        };
        let finding = apart(inspection).into_iter().fold(finding, Diagnostic::note);
        let extra = &inspection.ground.passes[pass];
        let middle = extra.trace.samples.get(extra.trace.samples.len() / 2);
        findings.push(
            finding.at(extra.place.clone()).on(middle.map(|sample| Site { pass: Some(pass), at: sample.at })),
        );
    }
}

/// The two flutes that are nearest to each other, the later pass first, where they are less than a quarter of the pitch
/// apart: too near to be meant as two.
fn beside(inspection: &Inspection<'_>) -> Option<(usize, usize, f64)> {
    let flutes = &inspection.round.flutes;
    let next = flutes.iter().cycle().skip(1);
    let apart = flutes.iter().zip(next).map(|(one, other)| {
        (one.0.max(other.0), one.0.min(other.0), (other.1.0 - one.1.0).rem_euclid(360.0))
    });
    let nearest = apart.min_by(|one, other| one.2.total_cmp(&other.2))?;
    Some(nearest).filter(|(.., apart)| *apart < 0.25 * 360.0 / f64::from(inspection.wanted.count))
}

fn missing(inspection: &Inspection<'_>, found: usize, wanted: usize) -> Diagnostic {
    let missing = |message: String| Diagnostic::error("flute-missing", message);
    let sites = inspection.round.absent(inspection.wanted).into_iter().map(|at| Site { pass: None, at });
    let dives = inspection.ground.dives.iter();
    let rapid: Vec<_> = dives.filter(|dive| matches!(dive.kind, Kind::RapidPass(_))).collect();
    if let Some(first) = rapid.first() {
        let all: u64 = rapid.iter().map(|dive| dive.times).sum();
        let which = match first.kind {
            Kind::RapidPass(number) if all == 1 => format!("flute {number}'s pass is"),
            _ => format!("{all} passes are"),
        };
        return missing(format!("{found} flutes, {wanted} specified: {which} made in rapid motion"))
            .help("grind with G01: G00 stays in force until another motion code")
            .at(first.place.clone())
            .on(sites);
    }
    if found == 0 {
        return missing(format!("0 flutes, {wanted} specified: no feed rotates A"))
            .help("command grinding moves as feeds (G01) with an A word");
    }
    let pitch = 360.0 / wanted as f64;
    let mut finding = missing(format!("{found} flutes, {wanted} specified"));
    let again = &inspection.round.again;
    if let Some(first) = again.first() {
        finding = finding.note(twice::sentence(*first));
    }
    if let Some(note) = apart(inspection) {
        finding = finding.note(note);
    } else if let Some(gap) =
        inspection.round.worst_gap.filter(|gap| again.is_empty() && 1.5 * pitch < gap.found.0)
    {
        let (pass, _) = inspection.round.flutes[gap.from];
        finding = finding
            .note(format!(
                "the widest gap round the burr is {:.3}°, nominal {pitch:.3}°, after the flute that begins here",
                gap.found.0
            ))
            .at(inspection.ground.passes[pass].place.clone());
    }
    match again.first() {
        Some(first) => finding
            .at(inspection.ground.passes[first.pass].place.clone())
            .help("check the index of that pass")
            .on(sites),
        None => finding
            .help("check for a loop over the flutes that ends too early, or a missing index move")
            .on(sites),
    }
}

/// In words how far the flutes are apart, where they are ground in even steps and those aren't the wanted ones.
fn apart(inspection: &Inspection<'_>) -> Option<String> {
    let wanted = inspection.wanted;
    let step = inspection.round.step(wanted).filter(|step| wanted.index_tolerance < step.off())?;
    Some(format!(
        "the flutes are {:.3}° apart; {} flutes are {:.3}° apart",
        step.found.0.abs(),
        wanted.count,
        360.0 / f64::from(wanted.count)
    ))
}
