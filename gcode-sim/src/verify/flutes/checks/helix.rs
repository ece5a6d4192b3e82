//! The helix angle along every flute is that of the law asked for.
use super::super::{Inspection, WorstHelix};
use crate::diag::Diagnostic;
use crate::job::FluteLaw;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let tolerance = inspection.wanted.helix_tolerance;
    let Some(worst) = inspection.helix.worst.filter(|worst| tolerance < worst.off()) else { return };
    let pass = &inspection.ground.passes[worst.pass];
    let message = format!(
        "the helix angle is {:.2}° at polar angle {:.1}° where {:.2}° is wanted: {}° either way is allowed",
        worst.found.0, worst.polar.0, worst.wanted.0, tolerance.0
    );
    let finding = Diagnostic::error("flute-helix", message).at(pass.place.clone());
    findings.push(finding.help(help(inspection, &worst)));
}

fn help(inspection: &Inspection<'_>, worst: &WorstHelix) -> String {
    let law = inspection.wanted.law;
    let other = match law {
        FluteLaw::ConstantHelix => FluteLaw::Published,
        FluteLaw::Published => FluteLaw::ConstantHelix,
    };
    if (worst.found - worst.other).abs() < inspection.wanted.helix_tolerance * 2.0 {
        return format!(
            "this is what the law '{}' has there, and the job asks for '{}'",
            other.name(),
            law.name()
        );
    }
    if (worst.found + worst.wanted).abs() < inspection.wanted.helix_tolerance * 2.0 {
        return "A turns the wrong way round: the flute has the other hand".to_owned();
    }
    "check how A is computed, in degrees, and its sign in the machine file".to_owned()
}
