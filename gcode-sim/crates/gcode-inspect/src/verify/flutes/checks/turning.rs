//! Rotation of the wheel while it grinds: not stopped, and in the direction of emitted programs.
use super::*;
use crate::findings::WHEEL_REVERSED;
use crate::holes::spindle::spindle_stopped_finding;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let stopped = |pass: &GrindingPass| pass.stopped_wheel.clone().map(|one| (one.builder_code, one.first));
    findings.extend(report_passes(inspection, stopped, |builder_code| {
        let message =
            "the wheel is stopped while it is fed along a flute: no M03 or M04 with an S is in force";
        spindle_stopped_finding(message, builder_code)
            .help("start the wheel with M03 S… before the first pass")
    }));
    let reversed = |pass: &GrindingPass| Some(((), pass.reversed_wheel.clone()?));
    findings.extend(report_passes(inspection, reversed, |()| {
        let message = "the wheel grinds with M04; the programs emitted for a burr use M03";
        Diagnostic::new(&WHEEL_REVERSED, message)
            .note("the job does not give the wheel's direction of rotation")
            .help("use M03, unless the wheel is meant to run in reverse")
    }));
}
