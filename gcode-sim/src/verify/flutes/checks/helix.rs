//! The helix angle along every flute is that of the law asked for.
use super::super::common::hand;
use super::super::{Inspection, Instead};
use crate::diag::{Diagnostic, Site};
use crate::flutes::Pass;
use crate::job::FluteLaw;
use crate::units::Deg;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let tolerance = inspection.wanted.helix_tolerance;
    let Some(worst) = inspection.helix.worst.filter(|worst| tolerance < worst.off()) else { return };
    let pass = &inspection.ground.passes[worst.pass];
    let here = format!(
        "{} has a helix angle of {:.2}° at polar angle {:.1}°, nominal {:.2}° (tolerance ±{}°)",
        inspection.name(worst.pass),
        worst.found.0,
        worst.polar.0,
        worst.wanted.0,
        tolerance.0
    );
    let mut all: Vec<_> = inspection.helix.of_passes.iter().filter(|w| tolerance < w.off()).collect();
    let error = |message: String| Diagnostic::error("flute-helix", message);
    let finding = match all_alike(inspection) {
        Some((message, help)) => {
            heads(inspection).into_iter().fold(error(message).note(here).help(help), Diagnostic::note)
        }
        None => {
            let finding =
                error(here).help("check how A is computed, in degrees, and its sign in the machine file");
            match all.len() - 1 {
                0 => finding,
                more => finding
                    .note(format!("out of tolerance in {more} more passes; this pass has the largest error")),
            }
        }
    };
    let place = worst.place(&pass.trace, inspection.wanted.gauge).unwrap_or(&pass.place);
    all.sort_by(|one, other| other.off().0.total_cmp(&one.off().0));
    let sites = all.into_iter().map(|worst| Site { pass: Some(worst.pass), at: worst.at });
    findings.push(finding.at(place.clone()).on(sites));
}

/// What all flutes have instead, all along, and what to look at.
fn all_alike(inspection: &Inspection<'_>) -> Option<(String, &'static str)> {
    let wanted = inspection.wanted;
    let flutes = match inspection.round.flutes.len() {
        1 => "the flute has".to_owned(),
        all => format!("all {all} flutes have"),
    };
    Some(match inspection.instead? {
        Instead::Law => {
            let other = match wanted.law {
                FluteLaw::ConstantHelix => FluteLaw::Published,
                FluteLaw::Published => FluteLaw::ConstantHelix,
            };
            let (other, asked) = (other.name(), wanted.law.name());
            (
                format!("{flutes} the helix angle of the law '{other}'; the job specifies '{asked}'"),
                "compute A by the job's law (H of the call)",
            )
        }
        Instead::Helix(helix) if helix.0 * wanted.helix.0 < 0.0 => (
            format!(
                "{flutes} the wrong hand: {}, with a helix of {:.1}°, nominal {:.1}°, {}",
                hand(helix),
                helix.0,
                wanted.helix.0,
                hand(wanted.helix)
            ),
            "check the sign of A, and that of the helix angle in the program: A rotates in the opposite direction",
        ),
        Instead::Helix(helix) => (
            format!("{flutes} a helix of {:.1}°, nominal {:.1}°", helix.0, wanted.helix.0),
            "check the helix angle and the radius that A is computed from, and that A is in degrees",
        ),
        Instead::Deep => (
            format!("{flutes} the wrong helix angle on the nominal diameter, nominal {:.1}°", wanted.helix.0),
            "correct the ground diameter, on which the angle is nominal: see flute-surface",
        ),
    })
}

/// Where all heads stand at the angle that all flutes have: that they do isn't told by itself.
fn heads(inspection: &Inspection<'_>) -> Option<String> {
    let Some(Instead::Helix(helix)) = inspection.instead else { return None };
    follow(inspection).then(|| format!("the head B is also set to {:.1}° in all passes", helix.0))
}

/// Whether every pass has its head at the helix angle that all flutes have instead of the wanted one.
pub(super) fn follow(inspection: &Inspection<'_>) -> bool {
    let Some(Instead::Helix(helix)) = inspection.instead else { return false };
    let tolerance = inspection.wanted.helix_tolerance;
    let there = |angle: Deg| (angle - helix).abs() <= tolerance;
    let stands = |pass: &Pass| {
        pass.head.is_some_and(|(least, most)| there(least) && there(most) && most.0 - least.0 <= 1e-9)
    };
    inspection.helix.worst.is_some_and(|worst| tolerance < worst.off())
        && inspection.ground.passes.iter().all(stands)
}
