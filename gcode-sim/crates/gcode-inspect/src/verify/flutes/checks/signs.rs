//! The axes run the same way in the job and in the machine file.
use super::super::Inspection;
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
    let message = format!("{names} {verb} the other way in the machine file than by the job's machine.signs");
    findings.push(
        Diagnostic::warning("axis-signs", message)
            .note("what is said of the flutes is of the machine file's machine; programs emitted from the job are for the other")
            .help("command each of them by hand and look; then correct the one that is wrong"),
    );
}
