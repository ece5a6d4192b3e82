//! Number of flutes.
use super::super::spacing::SAME_FLUTE;
use super::*;
use crate::findings::{FLUTE_EXTRA, FLUTE_MISSING};
use crate::flutes::CollisionKind;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (actual, nominal) = (inspection.spacing.flutes.len(), inspection.nominal.count as usize);
    if actual < nominal {
        let points = inspection.spacing.missing_points(inspection.nominal).into_iter();
        let finding = missing(inspection, format!("{actual} flutes, {nominal} specified"));
        findings.push(finding.with_sites(points.map(|at| Site::new(None, at))));
    }
    if nominal < actual {
        findings.push(extra(inspection, format!("{actual} flutes, {nominal} specified")));
    }
}

fn extra(inspection: &Inspection<'_>, message: String) -> Diagnostic {
    let finding = Diagnostic::new(&FLUTE_EXTRA, message);
    let (pass, finding) = match passes_beside(inspection) {
        Some((pass, other, gap)) => {
            let note = format!(
                "pass {} is {gap:.3}° from pass {}: within {}° it would count as a repeated pass \
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
    let GrindingPass { trace, backtrace, .. } = &inspection.actual.passes[pass];
    let middle = trace.samples.get(trace.samples.len() / 2);
    let finding = describe_gap(inspection).into_iter().fold(finding, Diagnostic::note);
    finding
        .with_backtrace(backtrace.clone())
        .with_sites(middle.map(|sample| Site::new(Some(pass), sample.point)))
}

/// Returns the two nearest flutes, the later pass first, if their gap is below a quarter of the pitch: too close to be
/// two intended flutes.
fn passes_beside(inspection: &Inspection<'_>) -> Option<(usize, usize, f64)> {
    let flutes = &inspection.spacing.flutes;
    let next = flutes.iter().cycle().skip(1);
    let gaps = flutes.iter().zip(next).map(|(one, other)| {
        (one.0.max(other.0), one.0.min(other.0), (other.1.0 - one.1.0).rem_euclid(360.0))
    });
    let nearest = gaps.min_by(|one, other| one.2.total_cmp(&other.2))?;
    Some(nearest).filter(|(.., gap)| *gap < 0.25 * 360.0 / f64::from(inspection.nominal.count))
}

fn missing(inspection: &Inspection<'_>, message: String) -> Diagnostic {
    let missing = |message: String| Diagnostic::new(&FLUTE_MISSING, message);
    let (spacing, passes) = (&inspection.spacing, &inspection.actual.passes);
    let collisions = inspection.actual.collisions.iter();
    let rapid: Vec<_> = collisions.filter(|one| matches!(one.kind, CollisionKind::RapidPass(_))).collect();
    if let Some(first) = rapid.first() {
        let which = match (first.kind, rapid.iter().map(|one| one.count).sum::<u64>()) {
            (CollisionKind::RapidPass(number), 1) => format!("flute {number}'s pass is"),
            (_, all) => format!("{all} passes are"),
        };
        return missing(format!("{message}: {which} made in rapid motion"))
            .help("grind with G01: G00 stays in force until another motion code")
            .with_backtrace(first.backtrace.clone());
    }
    if spacing.flutes.is_empty() {
        return missing(format!("{message}: no feed rotates A"))
            .help("command grinding moves as feeds (G01) with an A word");
    }
    let finding = missing(message);
    if let Some(first) = spacing.repeated.first() {
        let finding = finding.note(twice::sentence(*first));
        return describe_gap(inspection)
            .into_iter()
            .fold(finding, Diagnostic::note)
            .with_backtrace(passes[first.pass].backtrace.clone())
            .help("check the index of that pass");
    }
    let finding =
        finding.help("check for a loop over the flutes that ends too early, or a missing index move");
    if let Some(note) = describe_gap(inspection) {
        return finding.note(note);
    }
    let pitch = 360.0 / f64::from(inspection.nominal.count);
    let Some(gap) = spacing.worst_gap.filter(|gap| 1.5 * pitch < gap.actual.0) else { return finding };
    let (pass, _) = spacing.flutes[gap.from_flute];
    finding
        .note(format!(
            "the widest gap round the burr is {:.3}°, nominal {pitch:.3}°, after the flute that begins here",
            gap.actual.0
        ))
        .with_backtrace(passes[pass].backtrace.clone())
}

/// Returns a note on flutes in even steps that are not the nominal ones.
fn describe_gap(inspection: &Inspection<'_>) -> Option<String> {
    let nominal = inspection.nominal;
    let step = inspection
        .spacing
        .index_step(nominal)
        .filter(|step| exceeds(step.error().0, nominal.index_tolerance.0))?;
    Some(format!(
        "the flutes are {:.3}° apart; {} flutes are {:.3}° apart",
        step.actual.0.abs(),
        nominal.count,
        360.0 / f64::from(nominal.count)
    ))
}
