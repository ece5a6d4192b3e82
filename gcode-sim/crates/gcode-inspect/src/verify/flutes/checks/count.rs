//! As many flutes as are wanted, no more and no fewer.
use super::super::Inspection;
use super::super::spacing::SAME_FLUTE;
use super::twice;
use crate::findings::{FLUTE_EXTRA, FLUTE_MISSING};
use crate::flutes::CollisionKind;
use gcode_lang::diag::{Diagnostic, Site};

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (found, wanted) = (inspection.spacing.flutes.len(), inspection.nominal.count as usize);
    if found < wanted {
        findings.push(missing(inspection, found, wanted));
    }
    if wanted < found {
        let finding = Diagnostic::new(&FLUTE_EXTRA, format!("{found} flutes, {wanted} specified"));
        let (pass, finding) = match passes_beside(inspection) {
            Some((pass, other, apart)) => {
                let note = format!(
                    "pass {} is {apart:.3}° from pass {}: within {}° it would count as a repeated pass \
                     over the same flute",
                    pass + 1,
                    other + 1,
                    SAME_FLUTE * inspection.nominal.index_tolerance.0
                );
                (pass, finding.note(note).help("check A where this pass begins"))
            }
            None => {
                let last = inspection.spacing.flutes.iter().map(|(pass, _)| *pass).max().unwrap_or(0);
                (last, finding.help("check the end of the loop over the flutes, and the index"))
            }
        };
        let finding = describe_gap(inspection).into_iter().fold(finding, Diagnostic::note);
        let extra = &inspection.actual.passes[pass];
        let middle = extra.trace.samples.get(extra.trace.samples.len() / 2);
        findings.push(
            finding
                .with_backtrace(extra.backtrace.clone())
                .with_sites(middle.map(|sample| Site::new(Some(pass), sample.point))),
        );
    }
}

/// The two flutes that are nearest to each other, the later pass first, where they are less than a quarter of the pitch
/// apart: too near to be meant as two.
fn passes_beside(inspection: &Inspection<'_>) -> Option<(usize, usize, f64)> {
    let flutes = &inspection.spacing.flutes;
    let next = flutes.iter().cycle().skip(1);
    let apart = flutes.iter().zip(next).map(|(one, other)| {
        (one.0.max(other.0), one.0.min(other.0), (other.1.0 - one.1.0).rem_euclid(360.0))
    });
    let nearest = apart.min_by(|one, other| one.2.total_cmp(&other.2))?;
    Some(nearest).filter(|(.., apart)| *apart < 0.25 * 360.0 / f64::from(inspection.nominal.count))
}

fn missing(inspection: &Inspection<'_>, found: usize, wanted: usize) -> Diagnostic {
    let missing = |message: String| Diagnostic::new(&FLUTE_MISSING, message);
    let sites =
        inspection.spacing.missing_points(inspection.nominal).into_iter().map(|at| Site::new(None, at));
    let dives = inspection.actual.collisions.iter();
    let rapid: Vec<_> = dives.filter(|dive| matches!(dive.kind, CollisionKind::RapidPass(_))).collect();
    if let Some(first) = rapid.first() {
        let all: u64 = rapid.iter().map(|dive| dive.count).sum();
        let which = match first.kind {
            CollisionKind::RapidPass(number) if all == 1 => format!("flute {number}'s pass is"),
            _ => format!("{all} passes are"),
        };
        return missing(format!("{found} flutes, {wanted} specified: {which} made in rapid motion"))
            .help("grind with G01: G00 stays in force until another motion code")
            .with_backtrace(first.backtrace.clone())
            .with_sites(sites);
    }
    if found == 0 {
        return missing(format!("0 flutes, {wanted} specified: no feed rotates A"))
            .help("command grinding moves as feeds (G01) with an A word");
    }
    let pitch = 360.0 / wanted as f64;
    let mut finding = missing(format!("{found} flutes, {wanted} specified"));
    let again = &inspection.spacing.repeated;
    if let Some(first) = again.first() {
        finding = finding.note(twice::sentence(*first));
    }
    if let Some(note) = describe_gap(inspection) {
        finding = finding.note(note);
    } else if let Some(gap) =
        inspection.spacing.worst_gap.filter(|gap| again.is_empty() && 1.5 * pitch < gap.actual.0)
    {
        let (pass, _) = inspection.spacing.flutes[gap.from_flute];
        finding = finding
            .note(format!(
                "the widest gap round the burr is {:.3}°, nominal {pitch:.3}°, after the flute that begins here",
                gap.actual.0
            ))
            .with_backtrace(inspection.actual.passes[pass].backtrace.clone());
    }
    match again.first() {
        Some(first) => finding
            .with_backtrace(inspection.actual.passes[first.pass].backtrace.clone())
            .help("check the index of that pass")
            .with_sites(sites),
        None => finding
            .help("check for a loop over the flutes that ends too early, or a missing index move")
            .with_sites(sites),
    }
}

/// In words how far the flutes are apart, where they are ground in even steps and those aren't the wanted ones.
fn describe_gap(inspection: &Inspection<'_>) -> Option<String> {
    let wanted = inspection.nominal;
    let step = inspection.spacing.index_step(wanted).filter(|step| wanted.index_tolerance < step.error())?;
    Some(format!(
        "the flutes are {:.3}° apart; {} flutes are {:.3}° apart",
        step.actual.0.abs(),
        wanted.count,
        360.0 / f64::from(wanted.count)
    ))
}
