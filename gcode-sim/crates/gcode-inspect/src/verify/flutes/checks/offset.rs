//! Position of the burr relative to the C axis: the same in the job and in the machine file.
use super::*;
use crate::findings::BURR_OFFSET;

/// Resolution of the measured position, mm.
const OFFSET_TOLERANCE: f64 = 1e-4;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let Some([x, y]) = inspection.actual.offset else { return };
    let [job_x, job_y] = inspection.nominal.c_offset;
    if (x - job_x).abs() <= OFFSET_TOLERANCE && (y - job_y).abs() <= OFFSET_TOLERANCE {
        return;
    }
    // The subtraction of the axis leaves digits beyond these.
    let [x, y] = [x, y].map(|value| (value * 1e6).round() / 1e6);
    let message = format!(
        "the end of the burr's cylinder is at X{x} Y{y} from the C axis in the machine file, X{job_x} \
         Y{job_y} in the job's c_offset"
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
