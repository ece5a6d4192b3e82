//! Trial of the ellipse program on a part in its nominal position: the ball must keep its distance from the
//! surface all along, also between the programmed points.
use gcode_inspect::machine::Placement;
use gcode_inspect::stylus::{Reading, ReadingPass};
use gcode_lang::diag::Severity;
use gcode_session::read_stylus;
use gcode_sim::report::diagnostic;

use super::{CheckError, TrialProgram, TrialResult};

pub(super) fn run_trial(bench: &TrialProgram<'_>) -> Result<TrialResult, CheckError> {
    let job = bench.job;
    let surface = bench.surface();
    let request = bench.request(Placement::default())?;
    let following = read_stylus(&request, &mut bench.programs(), surface, job.probe.radius)
        .map_err(|e| bench.broken(&e))?;
    let mut tried = TrialResult { seconds: following.run.control.seconds().0, ..bench.result() };
    let sources = following.run.control.memory().sources();
    let findings = following.readings.findings.iter().filter(|finding| Severity::Warning <= finding.severity);
    tried.refusals.extend(findings.map(|finding| diagnostic::render(finding, sources)));
    let passes = following.readings.passes.as_slice();
    let [pass] = passes else {
        let message = format!("{} passes along the surface, 1 specified", passes.len());
        tried.refuse(message);
        return Ok(tried);
    };
    let Some((least, greatest)) = pass.extremes() else { return Ok(tried) };
    let worst = greatest.value.max(-least.value);
    if worst > job.ellipse().chord_error {
        tried.refuse(format!(
            "the distance of the ball from the surface is off by up to {worst:.4} mm; the chord error is {}",
            job.ellipse().chord_error
        ));
    }
    for (reading, nominal) in ends(pass).into_iter().zip([job.ellipse().from, job.ellipse().to]) {
        // The ball touches where the normal through its centre meets the surface.
        let x = reading.ball_centre.x
            - surface.nearest(&reading.ball_centre).normal.x * (job.probe.radius + reading.value);
        // Rounding moves the centre by up to half an increment in x and y each, and the foot of the normal by
        // at most twice that.
        if (x - nominal).abs() > 2.0 * job.control.increment.size() || reading.ball_centre.z != 0.0 {
            tried.refuse(format!(
                "an end is at {}; x = {nominal} on the ellipse is specified",
                reading.ball_centre
            ));
        }
    }
    tried.report(format!(
        "{} moves along {:.1} mm; the distance of the ball from the surface is off by at most {worst:.4} mm, \
         between programmed points too",
        pass.backtraces.len(),
        pass.length()
    ));
    Ok(tried)
}

fn ends(pass: &ReadingPass) -> Vec<Reading> {
    pass.readings.first().into_iter().chain(pass.readings.last()).copied().collect()
}
