//! The helix angle along every flute is that of the law asked for.
use super::super::common::helix_hand;
use super::super::{CommonDeviation, Inspection};
use crate::findings::FLUTE_HELIX;
use crate::flutes::GrindingPass;
use gcode_lang::diag::{Diagnostic, Site};
use gcode_lang::units::Deg;
use gcode_part::job::FluteLaw;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let tolerance = inspection.nominal.helix_tolerance;
    let Some(worst) = inspection.helix.worst.filter(|worst| tolerance < worst.error()) else { return };
    let pass = &inspection.actual.passes[worst.pass];
    let here = format!(
        "{} has a helix angle of {:.2}° at polar angle {:.1}°, nominal {:.2}° (tolerance ±{}°)",
        inspection.pass_name(worst.pass),
        worst.actual.0,
        worst.polar.0,
        worst.nominal.0,
        tolerance.0
    );
    let mut all: Vec<_> = inspection.helix.worst_by_pass.iter().filter(|w| tolerance < w.error()).collect();
    let error = |message: String| Diagnostic::new(&FLUTE_HELIX, message);
    let finding = match common_error(inspection) {
        Some((message, help)) => describe_heads(inspection)
            .into_iter()
            .fold(error(message).note(here).help(help), Diagnostic::note),
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
    let place = worst.backtrace(&pass.trace, inspection.nominal.gauge).unwrap_or(&pass.backtrace);
    all.sort_by(|one, other| other.error().0.total_cmp(&one.error().0));
    let sites = all.into_iter().map(|worst| Site::new(Some(worst.pass), worst.point));
    findings.push(finding.with_backtrace(place.clone()).with_sites(sites));
}

/// What all flutes have instead, all along, and what to look at.
fn common_error(inspection: &Inspection<'_>) -> Option<(String, &'static str)> {
    let wanted = inspection.nominal;
    let flutes = match inspection.spacing.flutes.len() {
        1 => "the flute has".to_owned(),
        all => format!("all {all} flutes have"),
    };
    Some(match inspection.common_deviation? {
        CommonDeviation::OtherLaw => {
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
        CommonDeviation::OtherHelix(helix) if helix.0 * wanted.helix.0 < 0.0 => (
            format!(
                "{flutes} the wrong hand: {}, with a helix of {:.1}°, nominal {:.1}°, {}",
                helix_hand(helix),
                helix.0,
                wanted.helix.0,
                helix_hand(wanted.helix)
            ),
            "check the sign of A, and that of the helix angle in the program: A rotates in the opposite direction",
        ),
        CommonDeviation::OtherHelix(helix) => (
            format!("{flutes} a helix of {:.1}°, nominal {:.1}°", helix.0, wanted.helix.0),
            "check the helix angle and the radius that A is computed from, and that A is in degrees",
        ),
        CommonDeviation::GroundHigh => (
            format!("{flutes} the wrong helix angle on the nominal diameter, nominal {:.1}°", wanted.helix.0),
            "correct the ground diameter, on which the angle is nominal: see flute-surface",
        ),
    })
}

/// Where all heads stand at the angle that all flutes have: that they do isn't told by itself.
fn describe_heads(inspection: &Inspection<'_>) -> Option<String> {
    let Some(CommonDeviation::OtherHelix(helix)) = inspection.common_deviation else { return None };
    do_heads_match(inspection).then(|| format!("the head B is also set to {:.1}° in all passes", helix.0))
}

/// Whether every pass has its head at the helix angle that all flutes have instead of the wanted one.
pub(super) fn do_heads_match(inspection: &Inspection<'_>) -> bool {
    let Some(CommonDeviation::OtherHelix(helix)) = inspection.common_deviation else { return false };
    let tolerance = inspection.nominal.helix_tolerance;
    let there = |angle: Deg| (angle - helix).abs() <= tolerance;
    let stands = |pass: &GrindingPass| {
        pass.head_range.is_some_and(|(least, most)| there(least) && there(most) && most.0 - least.0 <= 1e-9)
    };
    inspection.helix.worst.is_some_and(|worst| tolerance < worst.error())
        && inspection.actual.passes.iter().all(stands)
}
