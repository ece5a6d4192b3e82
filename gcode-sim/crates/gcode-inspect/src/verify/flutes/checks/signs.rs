//! Directions of the axes: the same in the job and in the machine file.
use super::*;
use crate::findings::AXIS_SIGNS;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some(job) = inspection.nominal.signs else { return };
    let of_job = [('X', job.x), ('Y', job.y), ('A', job.a), ('B', job.b), ('C', job.c)];
    let is_opposite = |(letter, sign): &&(char, f64)| {
        of_job.iter().any(|(of, job)| of == letter && f64::from(*job) != *sign)
    };
    let opposite = inspection.actual.signs.iter().filter(is_opposite);
    let opposite: Vec<String> = opposite.map(|(letter, _)| letter.to_string()).collect();
    let verb = match opposite.len() {
        0 => return,
        1 => "runs",
        _ => "run",
    };
    let message = format!(
        "{} {verb} in opposite directions in the machine file and in the job's machine.signs",
        opposite.join(", ")
    );
    findings.push(
        Diagnostic::new(&AXIS_SIGNS, message)
            .note("the results are for the machine file's directions; programs emitted from the job assume the job's")
            .help("command each axis by hand, observe its direction and correct the wrong sign"),
    );
}
