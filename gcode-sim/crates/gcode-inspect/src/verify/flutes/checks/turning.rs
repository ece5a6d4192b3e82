//! The wheel turns while it grinds, the way round that emitted programs have it.
use super::super::Inspection;
use super::report_passes;
use crate::holes::spindle::spindle_stopped_finding;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let idle = report_passes(
        inspection,
        |pass| pass.stopped_wheel.as_ref().map(|idle| (idle.builder_code, idle.first.clone())),
        |builder| {
            let message =
                "the wheel stands while it is fed along a flute: no M03 or M04 with an S is in force";
            spindle_stopped_finding(message, builder)
                .help("start the wheel with M03 S… before the first pass")
        },
    );
    let reversed = report_passes(
        inspection,
        |pass| pass.reversed_wheel.clone().map(|begun| ((), begun)),
        |()| {
            let message =
                "the wheel grinds with M04, where the programs that are emitted for a burr have M03";
            Diagnostic::warning("wheel-reversed", message)
                .note("which way round this wheel has to turn the job doesn't say")
                .help("M03, if the wheel isn't meant to run backwards")
        },
    );
    findings.extend(idle.into_iter().chain(reversed));
}
