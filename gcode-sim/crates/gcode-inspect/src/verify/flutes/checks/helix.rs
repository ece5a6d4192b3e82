//! Helix angle along each flute: that of the job's law.
use super::super::common::{CommonDeviation, helix_hand};
use super::*;
use crate::findings::FLUTE_HELIX;
use gcode_lang::units::Deg;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let tolerance = inspection.nominal.helix_tolerance.0;
    let Some(worst) = inspection.worst_helix().filter(|worst| exceeds(worst.error, tolerance)) else {
        return;
    };
    let Some(range) = &inspection.helix else { return };
    let here = format!(
        "{} has a helix angle of {:.2}° at polar angle {:.1}°, nominal {:.2}° (tolerance ±{tolerance}°)",
        inspection.pass_name(worst.pass),
        worst.actual,
        worst.polar.0,
        worst.nominal
    );
    let mut wrong: Vec<_> =
        range.worst_by_pass.iter().filter(|worst| exceeds(worst.error, tolerance)).collect();
    let (finding, note) = match common_error(inspection) {
        Some((message, help)) => {
            let finding = Diagnostic::new(&FLUTE_HELIX, message).note(here).help(help);
            (finding, describe_heads(inspection))
        }
        None => {
            let note = (1 < wrong.len()).then(|| {
                let more = wrong.len() - 1;
                format!("out of tolerance in {more} more passes; this pass has the largest error")
            });
            let help = "check how A is computed, in degrees, and its sign in the machine file";
            (Diagnostic::new(&FLUTE_HELIX, here).help(help), note)
        }
    };
    let pass = &inspection.actual.passes[worst.pass];
    let backtrace = worst.helix_backtrace(&pass.trace, inspection.nominal.gauge).unwrap_or(&pass.backtrace);
    wrong.sort_by(|one, other| other.error.total_cmp(&one.error));
    let sites = wrong.into_iter().map(|worst| Site::new(Some(worst.pass), worst.point));
    let finding = note.into_iter().fold(finding, Diagnostic::note);
    findings.push(finding.with_backtrace(backtrace.clone()).with_sites(sites));
}

/// Returns the deviation that all flutes share, and the help.
fn common_error(inspection: &Inspection<'_>) -> Option<(String, &'static str)> {
    let nominal = inspection.nominal;
    let flutes = inspection.all_flutes("have", "has");
    Some(match inspection.common_deviation? {
        CommonDeviation::OtherLaw => (
            format!(
                "{flutes} the helix angle of the law '{}'; the job specifies '{}'",
                other_law(nominal.law).name(),
                nominal.law.name()
            ),
            "compute A by the job's law (H of the call)",
        ),
        CommonDeviation::OtherHelix(helix) if helix.0 * nominal.helix.0 < 0.0 => (
            format!(
                "{flutes} the wrong hand: {}, with a helix of {:.1}°, nominal {:.1}°, {}",
                helix_hand(helix),
                helix.0,
                nominal.helix.0,
                helix_hand(nominal.helix)
            ),
            "check the sign of A, and that of the helix angle in the program: A rotates in the opposite direction",
        ),
        CommonDeviation::OtherHelix(helix) => (
            format!("{flutes} a helix of {:.1}°, nominal {:.1}°", helix.0, nominal.helix.0),
            "check the helix angle and the radius that A is computed from, and that A is in degrees",
        ),
        CommonDeviation::GroundHigh => (
            format!(
                "{flutes} the wrong helix angle on the nominal diameter, nominal {:.1}°",
                nominal.helix.0
            ),
            "correct the ground diameter, on which the angle is nominal: see flute-surface",
        ),
    })
}

/// Returns a note on heads that are set to the angle of the flutes: they have no finding of their own.
fn describe_heads(inspection: &Inspection<'_>) -> Option<String> {
    let Some(CommonDeviation::OtherHelix(helix)) = inspection.common_deviation else { return None };
    do_heads_match(inspection).then(|| format!("the head B is also set to {:.1}° in all passes", helix.0))
}

/// Returns true if every pass has its head at the helix angle of all flutes instead of the nominal one.
pub(super) fn do_heads_match(inspection: &Inspection<'_>) -> bool {
    let Some(CommonDeviation::OtherHelix(helix)) = inspection.common_deviation else { return false };
    let tolerance = inspection.nominal.helix_tolerance;
    let is_at_helix = |angle: Deg| !exceeds((angle - helix).abs().0, tolerance.0);
    let matches = |pass: &GrindingPass| {
        let range = pass.head_range;
        range.is_some_and(|(min, max)| is_at_helix(min) && is_at_helix(max) && max.0 - min.0 <= 1e-9)
    };
    inspection.worst_helix().is_some_and(|worst| exceeds(worst.error, tolerance.0))
        && inspection.actual.passes.iter().all(matches)
}
