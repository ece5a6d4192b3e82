//! Runs of a grinder: the flutes that a program grinds on the nominal burr, and the verdict on them.
use super::{Request, Run, SessionError, assumptions, causes, completion, run};
use gcode_inspect::flutes::{FluteTracker, GrinderError, GrindingResult};
use gcode_inspect::verify::flutes::{FluteVerdict, verify_flutes};
use gcode_lang::program::Library;
use gcode_part::Flutes;

/// A run with the flutes that it grinds.
#[derive(Debug)]
pub struct GrindingRun {
    /// The run.
    pub run: Run,
    /// The ground flutes, and the findings of the run.
    pub result: GrindingResult,
    /// The nominal flutes.
    pub nominal: Flutes,
}

/// An error that prevents following the wheel.
#[derive(Debug, thiserror::Error)]
pub enum GrindingError {
    /// The machine is not a grinder for this burr.
    #[error(transparent)]
    Machine(#[from] GrinderError),
    /// The run cannot begin.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// Runs a program and follows the wheel's contact on the nominal burr.
///
/// # Errors
/// [`GrindingError`] if the machine is not a grinder for this burr or the run cannot begin.
pub fn grind(
    request: &Request,
    library: &mut impl Library,
    nominal: &Flutes,
) -> Result<GrindingRun, GrindingError> {
    let mut tracker = FluteTracker::new(&request.machine, *nominal)?;
    let run = run(request, library, &mut tracker)?;
    let mut result = tracker.finish();
    result.findings.extend(run.note_findings());
    result.findings.extend(causes::unset_work_offsets(&run, &request.machine, "flutes"));
    result.findings.extend(run.stop_finding());
    Ok(GrindingRun { run, result, nominal: *nominal })
}

impl GrindingRun {
    /// Verifies the ground flutes against the nominal ones, and completes the verdict by the request of the run.
    pub fn verify(&self, request: &Request) -> FluteVerdict {
        let locate = |span| self.run.locate(span);
        let mut verdict = verify_flutes(&self.nominal, &self.result, &locate);
        let assumptions = || {
            let tracker = FluteTracker::new(&request.machine, self.nominal).ok();
            let followed = tracker.map(|tracker| assumptions::of_flutes(request, &self.run, tracker));
            followed.unwrap_or_default().numbered(&self.run)
        };
        completion::complete(&mut verdict, request, &self.run, Vec::new(), assumptions);
        verdict
    }
}
