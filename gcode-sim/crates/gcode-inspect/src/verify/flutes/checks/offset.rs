//! The job and the machine file agree on where the burr is from the C axis.
use super::super::Inspection;
use crate::findings::BURR_OFFSET;
use gcode_lang::diag::Diagnostic;

/// Measured no finer than this, mm.
const OFFSET_TOLERANCE: f64 = 1e-4;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some([x, y]) = inspection.actual.offset else { return };
    let [job_x, job_y] = inspection.nominal.c_offset;
    if (x - job_x).abs() <= OFFSET_TOLERANCE && (y - job_y).abs() <= OFFSET_TOLERANCE {
        return;
    }
    let message = format!(
        "the end of the burr's cylinder is at X{} Y{} from the C axis in the machine file, X{job_x} \
         Y{job_y} in the job's c_offset",
        rounded_mm(x),
        rounded_mm(y)
    );
    findings.push(
        Diagnostic::new(&BURR_OFFSET, message)
            .note(
                "the results are for the machine file's position; with the job's position the same moves \
                 grind a different burr",
            )
            .help(
                "measure the position; then emit the programs again from the job, or correct part.origin \
                 in the machine file",
            ),
    );
}

/// Without what the subtraction of the axis leaves.
fn rounded_mm(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
