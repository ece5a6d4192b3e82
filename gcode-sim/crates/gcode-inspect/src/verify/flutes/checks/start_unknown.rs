//! Passes ground while the position of an axis is unknown.
use super::*;
use crate::holes::unknown_position_finding;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let fault = |pass: &GrindingPass| {
        let point = pass.trace.samples.first()?.point;
        let first = FirstOccurrence { backtrace: pass.backtrace.clone(), point };
        (!pass.unknown_axes.is_none()).then_some((pass.unknown_axes, first))
    };
    findings.extend(report_passes(inspection, fault, |axes| {
        unknown_position_finding(&inspection.actual.axes, axes, "a flute is ground")
    }));
}
