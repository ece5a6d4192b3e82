//! Swivel B of the head: at the helix angle, and constant during a pass.
use super::helix::do_heads_match;
use super::*;
use crate::findings::FLUTE_HEAD;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    // The finding on the helix angle names heads that match it.
    if do_heads_match(inspection) {
        return;
    }
    let fault = |pass: &GrindingPass| {
        let message = head_error(inspection.nominal, pass)?;
        let point = pass.trace.samples.first()?.point;
        Some((message, FirstOccurrence { backtrace: pass.backtrace.clone(), point }))
    };
    findings.extend(report_passes(inspection, fault, |message| {
        Diagnostic::new(&FLUTE_HEAD, message)
            .help("set B once before each pass, to the helix angle on the cylinder")
    }));
}

fn head_error(nominal: &Flutes, pass: &GrindingPass) -> Option<String> {
    let (min, max) = pass.head_range?;
    if 1e-9 < max.0 - min.0 {
        return Some(format!("the head swivels from {:.3}° to {:.3}° during a pass", min.0, max.0));
    }
    exceeds((min - nominal.helix).abs().0, nominal.helix_tolerance.0)
        .then(|| format!("the head is at {:.3}°, the helix angle is {:.3}°", min.0, nominal.helix.0))
}
