//! Every flute reaches from the shank's end to the tip angle.
use nalgebra::Point3;

use super::super::Inspection;
use super::on_passes;
use crate::diag::Diagnostic;
use crate::flutes::{Begun, Pass};

/// How far an end may be off: along the axis at the shank, mm, and by the polar angle at the tip, degrees.
const AT_SHANK: f64 = 0.05;
const AT_TIP: f64 = 0.1;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wrong = |pass: &Pass| {
        let (message, at) = wrong(inspection, pass)?;
        Some((message, Begun { place: pass.place.clone(), at }))
    };
    findings.extend(on_passes(inspection, wrong, |message| {
        Diagnostic::error("flute-end", message)
            .help("check the length of the cylinder (X) and the last C: 90° minus the tip angle")
    }));
}

/// What is wrong with a pass, and the end where it is.
fn wrong(inspection: &Inspection<'_>, pass: &Pass) -> Option<(String, Point3<f64>)> {
    let wanted = inspection.wanted;
    let samples = || pass.trace.samples.iter();
    let start = samples().max_by(|a, b| a.at.x.total_cmp(&b.at.x))?;
    let tip = samples().min_by(|a, b| a.polar.0.total_cmp(&b.polar.0))?;
    if AT_SHANK < (start.at.x - wanted.start).abs() {
        let message = format!(
            "a flute begins {:.3} mm from the end of the cylinder, nominal {:.3} mm",
            start.at.x, wanted.start
        );
        return Some((message, start.at));
    }
    let message =
        format!("a flute ends at polar angle {:.3}°, nominal {:.3}°", tip.polar.0, wanted.tip_angle.0);
    (AT_TIP < (tip.polar - wanted.tip_angle).abs().0).then_some((message, tip.at))
}
