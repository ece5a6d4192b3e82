//! The wheel turns while it grinds, the way round that emitted programs have it.
use super::super::Inspection;
use super::on_passes;
use crate::diag::Diagnostic;
use crate::holes::spindle::stopped;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let idle = on_passes(
        inspection,
        |pass| pass.idle.as_ref().map(|idle| (idle.builder, idle.begun.clone())),
        |builder| {
            let message =
                "the wheel is stopped while it is fed along a flute: no M03 or M04 with an S is in force";
            stopped(message, builder).help("start the wheel with M03 S… before the first pass")
        },
    );
    let reversed = on_passes(
        inspection,
        |pass| pass.reversed.clone().map(|begun| ((), begun)),
        |()| {
            let message = "the wheel grinds with M04; the programs emitted for a burr use M03";
            Diagnostic::warning("wheel-reversed", message)
                .note("the job does not give the wheel's direction of rotation")
                .help("use M03, unless the wheel is meant to run in reverse")
        },
    );
    findings.extend(idle.into_iter().chain(reversed));
}
