//! The axes run the same way in the job and in the machine file.
use super::super::Inspection;
use crate::findings::AXIS_SIGNS;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(job) = inspection.nominal.signs else { return };
    let of_job = [('X', job.x), ('Y', job.y), ('A', job.a), ('B', job.b), ('C', job.c)];
    let other = |(letter, sign): &(char, f64)| {
        of_job.iter().any(|(of, job)| of == letter && f64::from(*job) != *sign)
    };
    let others: Vec<String> =
        inspection.actual.signs.iter().filter(|of| other(of)).map(|(letter, _)| letter.to_string()).collect();
    if others.is_empty() {
        return;
    }
    let (names, verb) = (others.join(", "), if others.len() == 1 { "runs" } else { "run" });
    let message =
        format!("{names} {verb} in opposite directions in the machine file and in the job's machine.signs");
    findings.push(
        Diagnostic::new(&AXIS_SIGNS, message)
            .note("the results are for the machine file's directions; programs emitted from the job assume the job's")
            .help("command each axis by hand, observe its direction and correct the wrong sign"),
    );
}
