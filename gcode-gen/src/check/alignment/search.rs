//! Advice on the search distance of a touch if the job's is too short for the misplacements of the run-out
//! trial.
use gcode_control::Outcome;
use gcode_inspect::machine::Placement;
use gcode_part::job::Alignment;
use gcode_sim::report::figures::short;

use super::{TrialProgram, common_variable};
use crate::families::alignment::emit;

/// Margin of O8211 at both ends of a touch, and an allowance for rounding, mm.
const MARGIN: f64 = 0.05;

/// Returns a sentence with a sufficient search distance for parts in these positions; `None` if none
/// suffices.
pub(super) fn advice(bench: &TrialProgram<'_>, parts: &[Placement]) -> Option<String> {
    let mut job = bench.job.clone();
    job.probe.search = job.surface.a.min(1000.0);
    let package = emit(&job);
    let wide = TrialProgram { job: &job, package: &package, main: bench.main };
    let mut farthest = 0.0_f64;
    for part in parts {
        let run = wide.run(*part, Vec::new()).ok()?;
        if !matches!(run.outcome, Outcome::End) {
            return None;
        }
        for (first, height) in [600, 800].into_iter().zip(job.runout.heights) {
            let expected = expected(&job, height);
            let readings = (first..first + job.runout.angles.count)
                .map(|number| (common_variable(&run, number) - expected).abs());
            farthest = readings.fold(farthest, f64::max);
        }
    }
    search_advice(bench, "the surfaces of these parts are", farthest)
}

/// Returns a sentence with a sufficient search distance for a surface this far from its position; `None` if
/// the job's suffices.
pub(super) fn search_advice(bench: &TrialProgram<'_>, what: &str, farthest: f64) -> Option<String> {
    let enough = ((farthest + MARGIN) * 10.0).ceil() / 10.0;
    (enough > bench.job.probe.search && enough <= 1000.0).then(|| {
        format!(
            "{}: {what} up to {} mm from their nominal position, key 'probe.search' is {}: use {}\n",
            bench.name(),
            short((farthest * 100.0).ceil() / 100.0),
            short(bench.job.probe.search),
            short(enough)
        )
    })
}

/// Returns x in the middle of a touch, where O8211 expects the centre of the ball.
fn expected(job: &Alignment, height: f64) -> f64 {
    let (across, up) = (job.surface.a + job.probe.radius, job.surface.b + job.probe.radius);
    across * (1.0 - (height / up) * (height / up)).sqrt()
}

#[cfg(test)]
mod tests {
    use crate::check::check;
    use crate::families;
    use gcode_part::job::Job;

    fn refusals(search: &str) -> String {
        let text = families::alignment::FAMILY
            .new_job
            .replace("search = 10.0", &format!("search = {search}"))
            .replace("circle = 1.0", "circle = 0.1");
        let job = Job::parse(&text).unwrap();
        check(&job, &families::emit(&job)).unwrap().refusals.concat()
    }

    /// By hand: at y = 420 a tilt of 0.3° moves the surface by 420·(a²/b² − 1)·0.3° in rad = 3.43 along r;
    /// the two tilts at the ends of B and shifts of 0.3 add some tenths. E, rotated by 0.25° about y, moves
    /// by 812.4·0.25° in rad = 3.54, and a candidate by half a circle more.
    #[test]
    fn too_short_a_search_is_refused_with_a_sufficient_one() {
        let messages = refusals("2.0");
        let advised: Vec<f64> = messages
            .split("'probe.search' is 2: use ")
            .skip(1)
            .map(|rest| rest.split('\n').next().unwrap().parse().unwrap())
            .collect();
        assert!(advised.len() == 2 && advised.iter().all(|value| (3.4..6.0).contains(value)), "{messages}");
        let most = advised.into_iter().fold(0.0, f64::max);
        assert_eq!(refusals(&format!("{most:?}")), "", "{most} does");
    }
}
