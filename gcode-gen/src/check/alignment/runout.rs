//! Trial of the run-out program on parts of known shift and tilt, which it must determine by probing alone.
use gcode_control::Outcome;
use gcode_inspect::machine::Placement;
use gcode_lang::units::Deg;
use gcode_part::Surface;
use gcode_part::job::Alignment;
use gcode_part::{FitError, FitUncertainty, TouchPlan};
use gcode_session::Run;
use gcode_sim::report::figures::short;

use crate::families::alignment::ALARMS;

use super::{CheckError, TrialProgram, TrialResult, common_variable, search};

/// Allowed errors of the results: mm, degrees.
const TOLERANCES: [f64; 2] = [0.01, 0.004];

/// Alarm numbers of TOUCHES V BEFORE SURFACE and NO CONTACT in O8211.
const MISSED_ALARMS: [u32; 2] = [154, 155];

/// Shift in mm and tilt in degrees about x, y and z. The shift in y and the rotation about y need not be
/// determined, but must not disturb the others.
const TRIAL_PLACEMENTS: [[[f64; 3]; 2]; 4] = [
    [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    [[0.3, 0.0, -0.3], [0.3, 0.0, 0.3]],
    [[-0.3, 0.2, 0.25], [-0.3, 0.0, 0.2]],
    [[0.2, -0.3, 0.3], [0.2, 0.3, -0.3]],
];

pub(super) fn run_trial(bench: &TrialProgram<'_>) -> Result<TrialResult, CheckError> {
    let mut tried = bench.result();
    let noise = match fit_uncertainty(bench.job) {
        Ok(passed) => NoiseEstimate::of(bench.job, passed),
        Err(why) => {
            tried.refuse(describe_fit_error(bench.job, why));
            return Ok(tried);
        }
    };
    let mut worst = [0.0_f64; 2];
    let placed = |[shift, tilt]: [[f64; 3]; 2]| Placement {
        shift: shift.into(),
        tilt: tilt.map(Deg),
        ..Placement::default()
    };
    let mut missed = false;
    for [shift, tilt] in TRIAL_PLACEMENTS {
        let part = placed([shift, tilt]);
        let run = bench.run(part, Vec::new())?;
        let stopped = bench.stop_messages(&run);
        tried.seconds = run.control.seconds().0;
        if !stopped.is_empty() {
            tried.refuse(format!("with the part shifted by {shift:?} and tilted by {tilt:?}"));
            tried.refusals.extend(stopped);
            missed |= is_contact_missed(&run);
            continue;
        }
        for (number, real, kind) in
            [(580, shift[0], 0), (581, shift[2], 0), (582, tilt[0], 1), (583, tilt[2], 1)]
        {
            let off = (common_variable(&run, number) - real).abs();
            worst[kind] = worst[kind].max(off);
            if off.is_nan() || off > TOLERANCES[kind] {
                let message = format!("#{number} is {}, nominal {real}", common_variable(&run, number));
                tried.refuse(message);
            }
        }
    }
    if missed {
        tried.refusals.extend(search::advice(bench, &TRIAL_PLACEMENTS.map(placed)));
    }
    let [shift, tilt] = worst;
    noise.warning().into_iter().for_each(|warning| tried.warn(warning));
    tried.report(format!(
        "shifts of up to 0.3 mm and tilts of up to 0.3 degrees are determined to {shift:.4} mm and \
         {tilt:.4} degrees; {}",
        noise.sentence()
    ));
    Ok(tried)
}

/// Returns true if the run ended because a touch met the part too early or not at all.
fn is_contact_missed(run: &Run) -> bool {
    let text =
        |text: &str| ALARMS.iter().any(|alarm| MISSED_ALARMS.contains(&alarm.number) && alarm.text == text);
    matches!(&run.outcome, Outcome::Alarm(stopped) if text(&stopped.alarm.row().message))
}

/// Computes the amplification of touch noise in the results, from the job's angles and heights.
fn fit_uncertainty(job: &Alignment) -> Result<FitUncertainty, FitError> {
    let runout = &job.runout;
    let sign = f64::from(job.machine.rotary.sign);
    let step = (runout.angles.to - runout.angles.from) / f64::from(runout.angles.count - 1);
    let touches = TouchPlan {
        surface: Surface::Ellipsoid { a: job.surface.a, b: job.surface.b },
        radius: job.probe.radius,
        heights: runout.heights.into(),
        azimuths: (0..runout.angles.count)
            .map(|n| Deg(sign * (runout.angles.from + step * f64::from(n))))
            .collect(),
    };
    touches.uncertainty()
}

fn describe_fit_error(job: &Alignment, why: FitError) -> String {
    let runout = &job.runout;
    let [low, high] = runout.heights.map(short);
    match why {
        FitError::NoContact { height } => {
            format!("key 'runout.heights': at y {} the ball passes the part without contact", short(height))
        }
        FitError::Degenerate if job.surface.a == job.surface.b => {
            "keys 'surface.a' and 'surface.b' are equal: the tilt of a sphere cannot be measured".to_owned()
        }
        FitError::Degenerate => format!(
            "tilt cannot be distinguished from shift at y {low} and {high} over {} {} to {} (keys \
             'runout.heights', 'runout.angles'): the noise of a touch would be amplified more than 300 \
             times; use heights farther apart, or wider angles",
            job.machine.rotary.letter,
            short(runout.angles.from),
            short(runout.angles.to)
        ),
    }
}

/// Effect of the job's touch noise on the results.
struct NoiseEstimate {
    /// Noise of a touch, mm.
    touch: f64,
    /// Largest standard deviations for noise of 1 mm: of #580 and #581 in mm, of #582 and #583 in degrees.
    factors: [f64; 2],
}

impl NoiseEstimate {
    fn of(job: &Alignment, passed: FitUncertainty) -> Self {
        let [x, _, z] = passed.shift;
        let [about_x, about_z] = passed.tilt;
        Self { touch: job.probe_noise(), factors: [x.max(z), about_x.max(about_z)] }
    }

    fn deviations(&self) -> [f64; 2] {
        self.factors.map(|factor| factor * self.touch)
    }

    fn sentence(&self) -> String {
        let [shift, tilt] = self.deviations();
        format!(
            "noise of {} mm per touch gives standard deviations of {shift:.4} mm and {tilt:.4} degrees",
            short(self.touch)
        )
    }

    /// Returns a warning if two standard deviations exceed the allowed errors: one pass in twenty then
    /// exceeds them.
    fn warning(&self) -> Option<String> {
        let twice = self.deviations().map(|deviation| 2.0 * deviation);
        (twice[0] > TOLERANCES[0] || twice[1] > TOLERANCES[1]).then(|| {
            format!(
                "noise of {} mm per touch ('probe.noise') does not allow {} mm and {} degrees: one pass in \
                 twenty is off by more than {:.4} mm or {:.4} degrees (two standard deviations, {:.2} mm \
                 and {:.3} degrees for 1 mm of noise); use wider 'runout.angles', heights farther apart, \
                 more readings, or a better probe",
                short(self.touch),
                TOLERANCES[0],
                TOLERANCES[1],
                twice[0],
                twice[1],
                self.factors[0],
                self.factors[1]
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use gcode_part::job::Job;

    use super::*;
    use crate::families;

    fn job(change: (&str, &str)) -> Alignment {
        let text = families::ALL.iter().find(|family| family.name == "alignment").unwrap().new_job;
        assert!(text.contains(change.0), "{}", change.0);
        match Job::parse(&text.replacen(change.0, change.1, 1)) {
            Ok(Job::Alignment(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    fn warned(change: (&str, &str)) -> Option<String> {
        let job = job(change);
        NoiseEstimate::of(&job, fit_uncertainty(&job).unwrap()).warning()
    }

    /// By the table of docs/methods/alignment.md a touch noise of 0.001 mm causes 0.0018 mm and 0.00087
    /// degrees over ±25. Noise of 0.002 is allowed, because twice the deviations are 0.0072 and 0.0035; 0.003
    /// is not, because they are 0.0108. Over ±15, 0.001 causes 0.0024 degrees.
    #[test]
    fn too_noisy_a_probe_and_too_narrow_a_petal_are_warned_of() {
        assert_eq!(warned(("radius = 3.0", "radius = 3.0")), None);
        assert!(
            warned(("radius = 3.0", "radius = 3.0\nnoise = 0.003"))
                .unwrap()
                .contains("noise of 0.003 mm per touch")
        );
        assert!(warned(("[-25.0, 25.0, 11]", "[-15.0, 15.0, 11]")).is_some());
        assert_eq!(warned(("[-25.0, 25.0, 11]", "[-40.0, 40.0, 11]")), None);
    }

    #[test]
    fn an_undetermined_fit_is_refused_with_its_cause() {
        for (change, expected) in [
            (
                ("[150.0, 420.0]", "[150.0, 151.0]"),
                "tilt cannot be distinguished from shift at y 150 and 151 over B -25 to 25",
            ),
            (("[-25.0, 25.0, 11]", "[-1.0, 1.0, 11]"), "wider angles"),
            (("b = 724.3", "b = 1158.8"), "the tilt of a sphere cannot be measured"),
        ] {
            let job = job(change);
            let message = describe_fit_error(&job, fit_uncertainty(&job).unwrap_err());
            assert!(message.contains(expected), "{message}");
        }
    }
}
