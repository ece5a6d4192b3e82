//! Every flute reaches from the shank's end to the tip angle.
use nalgebra::Point3;

use super::super::Inspection;
use super::report_passes;
use crate::findings::FLUTE_END;
use crate::flutes::{FirstOccurrence, GrindingPass};
use gcode_lang::diag::Diagnostic;

/// How far an end may be off: along the axis at the shank, mm, and by the polar angle at the tip, degrees.
const SHANK_TOLERANCE: f64 = 0.05;
const TIP_TOLERANCE: f64 = 0.1;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let wrong = |pass: &GrindingPass| {
        let (message, at) = end_error(inspection, pass)?;
        Some((message, FirstOccurrence { backtrace: pass.backtrace.clone(), point: at }))
    };
    findings.extend(report_passes(inspection, wrong, |message| {
        Diagnostic::new(&FLUTE_END, message)
            .help("check the length of the cylinder (X) and the last C: 90° minus the tip angle")
    }));
}

/// What is wrong with a pass, and the end where it is.
fn end_error(inspection: &Inspection<'_>, pass: &GrindingPass) -> Option<(String, Point3<f64>)> {
    let wanted = inspection.nominal;
    let samples = || pass.trace.samples.iter();
    let start = samples().max_by(|a, b| a.point.x.total_cmp(&b.point.x))?;
    let tip = samples().min_by(|a, b| a.polar.0.total_cmp(&b.polar.0))?;
    if SHANK_TOLERANCE < (start.point.x - wanted.start).abs() {
        let message = format!(
            "a flute begins {:.3} mm from the end of the cylinder, nominal {:.3} mm",
            start.point.x, wanted.start
        );
        return Some((message, start.point));
    }
    let message =
        format!("a flute ends at polar angle {:.3}°, nominal {:.3}°", tip.polar.0, wanted.tip_angle.0);
    (TIP_TOLERANCE < (tip.polar - wanted.tip_angle).abs().0).then_some((message, tip.point))
}
