//! The job and the machine file agree on where the burr is from the C axis.
use super::super::Inspection;
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
        "the machine file has the end of the burr's cylinder X{} Y{} from the C axis, and the job's c_offset is X{job_x} Y{job_y}",
        rounded_mm(x),
        rounded_mm(y)
    );
    findings.push(
        Diagnostic::error("burr-offset", message)
            .note("what is said of the flutes is of the machine file's burr: at the job's place the same moves grind another")
            .help("measure it; then emit the programs again from the job, or correct part.origin in the machine file"),
    );
}

/// Without what the subtraction of the axis leaves.
fn rounded_mm(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
