//! Ends of each flute: the end of the shank, and the tip angle.
use super::*;
use crate::findings::FLUTE_END;

/// Tolerance of the end at the shank, along the axis, mm.
const SHANK_TOLERANCE: f64 = 0.05;

/// Tolerance of the polar angle at the tip, degrees.
const TIP_TOLERANCE: f64 = 0.1;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let fault = |pass: &GrindingPass| {
        let (message, point) = end_error(inspection.nominal, pass)?;
        Some((message, FirstOccurrence { backtrace: pass.backtrace.clone(), point }))
    };
    findings.extend(report_passes(inspection, fault, |message| {
        Diagnostic::new(&FLUTE_END, message)
            .help("check the length of the cylinder (X) and the last C: 90° minus the tip angle")
    }));
}

/// Returns the fault of a pass and the point of the wrong end.
fn end_error(nominal: &Flutes, pass: &GrindingPass) -> Option<(String, Point3<f64>)> {
    let samples = || pass.trace.samples.iter();
    let start = samples().max_by(|a, b| a.point.x.total_cmp(&b.point.x))?.point;
    let tip = samples().min_by(|a, b| a.polar.0.total_cmp(&b.polar.0))?;
    if SHANK_TOLERANCE < (start.x - nominal.start).abs() {
        let message = format!(
            "a flute begins {:.3} mm from the end of the cylinder, nominal {:.3} mm",
            start.x, nominal.start
        );
        return Some((message, start));
    }
    let message =
        format!("a flute ends at polar angle {:.3}°, nominal {:.3}°", tip.polar.0, nominal.tip_angle.0);
    (TIP_TOLERANCE < (tip.polar - nominal.tip_angle).abs().0).then_some((message, tip.point))
}
