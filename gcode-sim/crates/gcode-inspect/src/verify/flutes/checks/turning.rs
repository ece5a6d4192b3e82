//! The wheel turns while it grinds, the way round that emitted programs have it.
use super::super::Inspection;
use super::report_passes;
use crate::findings::WHEEL_REVERSED;
use crate::holes::spindle::spindle_stopped_finding;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let idle = report_passes(
        inspection,
        |pass| pass.stopped_wheel.as_ref().map(|idle| (idle.builder_code, idle.first.clone())),
        |builder| {
            let message =
                "the wheel is stopped while it is fed along a flute: no M03 or M04 with an S is in force";
            spindle_stopped_finding(message, builder)
                .help("start the wheel with M03 S… before the first pass")
        },
    );
    let reversed = report_passes(
        inspection,
        |pass| pass.reversed_wheel.clone().map(|begun| ((), begun)),
        |()| {
            let message = "the wheel grinds with M04; the programs emitted for a burr use M03";
            Diagnostic::new(&WHEEL_REVERSED, message)
                .note("the job does not give the wheel's direction of rotation")
                .help("use M03, unless the wheel is meant to run in reverse")
        },
    );
    findings.extend(idle.into_iter().chain(reversed));
}
