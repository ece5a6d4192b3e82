//! `[limits]` of an alignment job: tolerances of the set-up. The section and each of its keys are optional.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{AlignmentLimits, EllipsePath};
use crate::job::Surface;
use crate::reader::bounds::{Bounded, ShiftLimit, TiltLimit};
use gcode_lang::units::Deg;

/// Tolerances of the set-up of a part.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLimits {
    /// Tolerance of the shift in x and in z after the last run-out, mm [default: 0.025].
    shift: Option<Bounded<ShiftLimit>>,
    /// Tolerance of the tilt about x and about z after the last run-out, degrees [default: the tilt that alone
    /// gives `dial` on the ellipse, 0.001 to 0.1].
    tilt: Option<Bounded<TiltLimit>>,
    /// Tolerance of the dial reading along the ellipse, mm [default: 0.03].
    dial: Option<Bounded<ShiftLimit>>,
}

impl FileLimits {
    /// Returns the limits, with the defaults of *Improved Processing Technology of Positioning Pin Hole on
    /// Melon Mold*: 0.03 along the ellipse, and a run-out of 0.05, twice the shift.
    pub(super) fn limits(&self, surface: Surface, path: EllipsePath) -> AlignmentLimits {
        let dial = self.dial.as_ref().map_or(0.03, Bounded::get);
        let tilt = self.tilt.as_ref().map_or_else(|| dial_reading(dial, surface, path), Bounded::get);
        AlignmentLimits { shift: self.shift.as_ref().map_or(0.025, Bounded::get), tilt, dial }
    }
}

/// Returns the tilt about z, degrees, rounded down to thousandths, whose largest dial reading on the path is
/// `dial`. The dial reads δ·(x·n_y − y·n_x).
fn dial_reading(dial: f64, Surface { a, b }: Surface, path: EllipsePath) -> f64 {
    let arm = |x: f64| {
        let y = b * (1.0 - (x / a) * (x / a)).sqrt();
        let (across, up) = (x / (a * a), y / (b * b));
        ((x * up - y * across) / (across * across + up * up).sqrt()).abs()
    };
    // A tilt of a sphere gives no reading.
    let tilt = Deg::from_rad(dial / arm(path.from).max(arm(path.to)).max(f64::MIN_POSITIVE)).0;
    ((tilt * 1e3).floor() / 1e3).clamp(0.001, 0.1)
}

#[cfg(test)]
mod tests {
    use crate::job::Job;

    /// Parses a job with these lines after the required sections.
    fn job(section: &str) -> Result<Job, String> {
        let text = format!(
            "family = \"alignment\"\n\
             control = {{ dialect = \"fanuc-31i\", increment = \"IS-B\" }}\n\
             machine = {{ rotary = {{ letter = \"B\", sign = 1 }} }}\n\
             surface = {{ kind = \"ellipsoid\", a = 1158.8, b = 724.3 }}\n\
             probe = {{ radius = 3.0 }}\n\
             sine_table = {{ length = 200.0, phi = 38.5, gauge_blocks = \"metric-87\" }}\n\
             chord = {{ e_radius = 812.4, f_radius = 318.0, circle = 1.0, candidates = 10 }}\n\
             runout = {{ heights = [150.0, 420.0], angles = [-25.0, 25.0, 11] }}\n\
             {section}"
        );
        Job::parse(&text).map_err(|error| error.to_string())
    }

    fn limits(section: &str) -> [f64; 3] {
        let Ok(Job::Alignment(job)) = job(section) else { panic!("no alignment: {section}") };
        [job.limits.shift, job.limits.tilt, job.limits.dial]
    }

    /// At E, x 812.4 and y 516.48, the normal is (0.5235, 0.8520): 812.4·0.8520 − 516.48·0.5235 = 421.8, and
    /// 0.03/421.8 rad are 0.004 07°; 0.05 are 0.006 79°.
    #[test]
    fn left_out_they_are_those_of_the_paper() {
        assert_eq!(limits(""), [0.025, 0.004, 0.03]);
        assert_eq!(limits("[limits]\ndial = 0.05"), [0.025, 0.006, 0.05]);
        assert_eq!(limits("[limits]\nshift = 0.01\ntilt = 0.002"), [0.01, 0.002, 0.03]);
    }

    #[test]
    fn what_cannot_be_used_is_named_with_its_line() {
        for (section, message) in [
            ("shift = 0", "line 10: key 'limits.shift' is 0: 0.001 to 10 mm"),
            ("tilt = 2", "line 10: key 'limits.tilt' is 2: 0.001 to 1 degrees"),
            ("dial = -0.03", "line 10: key 'limits.dial' is -0.03: 0.001 to 10 mm"),
            ("chord = 1", "line 10: key 'limits.chord' is unknown; allowed: shift, tilt, dial"),
        ] {
            assert_eq!(job(&format!("[limits]\n{section}")).unwrap_err(), message);
        }
    }
}
