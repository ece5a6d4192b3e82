//! The helix angle along every flute is that of the law asked for.
use super::super::{Inspection, WorstHelix};
use crate::diag::{Diagnostic, Site};
use crate::flutes::Window;
use crate::job::FluteLaw;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let tolerance = inspection.wanted.helix_tolerance;
    let Some(worst) = inspection.helix.worst.filter(|worst| tolerance < worst.off()) else { return };
    let pass = &inspection.ground.passes[worst.pass];
    let message = format!(
        "the helix angle is {:.2}° at polar angle {:.1}° where {:.2}° is wanted: {}° either way is allowed",
        worst.found.0, worst.polar.0, worst.wanted.0, tolerance.0
    );
    let place = worst.place(&pass.trace, inspection.wanted.gauge).unwrap_or(&pass.place);
    let finding = Diagnostic::error("flute-helix", message).at(place.clone());
    let mut all: Vec<_> = inspection.helix.of_passes.iter().filter(|w| tolerance < w.off()).collect();
    all.sort_by(|one, other| other.off().0.total_cmp(&one.off().0));
    let sites = all.into_iter().map(|worst| Site { pass: Some(worst.pass), at: worst.at });
    findings.push(finding.help(help(inspection, &worst)).on(sites));
}

/// Another law or the other hand is named only where the whole flute has it, not one place by chance.
fn help(inspection: &Inspection<'_>, worst: &WorstHelix) -> String {
    let law = inspection.wanted.law;
    let other = match law {
        FluteLaw::ConstantHelix => FluteLaw::Published,
        FluteLaw::Published => FluteLaw::ConstantHelix,
    };
    let gauge = inspection.wanted.gauge;
    let allowed = inspection.wanted.helix_tolerance * 2.0;
    let all_along = |fits: &dyn Fn(&Window<'_>) -> bool| {
        inspection.ground.passes[worst.pass].trace.windows(gauge).all(|window| fits(&window))
    };
    if all_along(&|window| (window.helix - window.other).abs() < allowed) {
        return format!(
            "all along the flute this is what the law '{}' has, and the job asks for '{}'",
            other.name(),
            law.name()
        );
    }
    if all_along(&|window| (window.helix + window.wanted).abs() < allowed) {
        return "A turns the wrong way round: the flute has the other hand".to_owned();
    }
    "check how A is computed, in degrees, and its sign in the machine file".to_owned()
}
