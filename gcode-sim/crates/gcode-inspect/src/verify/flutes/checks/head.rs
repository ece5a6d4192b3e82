//! B stands at the helix angle and doesn't move during a pass.
use super::super::Inspection;
use super::helix::do_heads_match;
use super::report_passes;
use crate::findings::FLUTE_HEAD;
use crate::flutes::{FirstOccurrence, GrindingPass};
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    // That is told with the helix angle.
    if do_heads_match(inspection) {
        return;
    }
    let wrong = |pass: &GrindingPass| {
        let message = head_error(inspection, pass)?;
        let at = pass.trace.samples.first()?.point;
        Some((message, FirstOccurrence { backtrace: pass.backtrace.clone(), point: at }))
    };
    findings.extend(report_passes(inspection, wrong, |message| {
        Diagnostic::new(&FLUTE_HEAD, message)
            .help("set B once before each pass, to the helix angle on the cylinder")
    }));
}

fn head_error(inspection: &Inspection<'_>, pass: &GrindingPass) -> Option<String> {
    let (wanted, tolerance) = (inspection.nominal.helix, inspection.nominal.helix_tolerance);
    let (least, most) = pass.head_range?;
    if 1e-9 < most.0 - least.0 {
        return Some(format!("the head swivels from {:.3}° to {:.3}° during a pass", least.0, most.0));
    }
    (tolerance < (least - wanted).abs())
        .then(|| format!("the head is at {:.3}°, the helix angle is {:.3}°", least.0, wanted.0))
}
