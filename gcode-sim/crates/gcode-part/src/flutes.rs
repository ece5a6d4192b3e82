//! The wanted flutes of a burr: what surface they lie on, how they cross its meridians, how many there are.
use nalgebra::Point3;

use super::profile::Profile;
use crate::job::{AxisSigns, Burr, FluteLaw};
use gcode_lang::units::Deg;

/// What a burr's program is held against; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flutes {
    pub profile: Profile,
    pub count: u32,
    /// On the cylinder; below 0 left-hand.
    pub helix: Deg,
    pub law: FluteLaw,
    /// Where a flute begins, along x.
    pub start: f64,
    /// Polar angle of the normal where it ends.
    pub tip_angle: Deg,
    /// How far the blank stands above the tooth bottom.
    pub tooth_depth: f64,
    /// How far the contact's path may be from the flute it follows.
    pub chord_error: f64,
    /// Over how long a stretch of a flute its helix angle is measured.
    pub gauge: f64,
    /// How far it may be from the surface.
    pub surface_tolerance: f64,
    /// Of the helix angle, either way.
    pub helix_tolerance: Deg,
    /// Of a flute's place round the burr, either way.
    pub index_tolerance: Deg,
    /// Of the contact along a flute, mm/min, where the job says it.
    pub speed: Option<f64>,
    /// Into the blank, mm/min, where the job says it.
    pub plunge: Option<f64>,
    /// From the blank, where rapid motion ends at the nearest, mm, where the job says it.
    pub clearance: Option<f64>,
    /// Of the wheel, r/min, where the job says it.
    pub wheel: Option<f64>,
    /// From the C axis to the end of the cylinder at C 0, x and y, as the job has it.
    pub c_offset: [f64; 2],
    /// Which way the axes run, where the job says it.
    pub signs: Option<AxisSigns>,
}

impl Flutes {
    pub fn from_job(job: &Burr) -> Self {
        let profile = Profile::new(&job.shape);
        Self {
            profile,
            count: job.flutes,
            helix: Deg(job.helix),
            law: job.law,
            start: profile.pole() + job.shape.length,
            tip_angle: Deg(job.shape.tip_angle),
            tooth_depth: job.shape.tooth_depth,
            chord_error: job.chord_error,
            gauge: job.gauge(),
            surface_tolerance: job.chord_error,
            helix_tolerance: Deg(job.tolerance.helix),
            index_tolerance: Deg(job.tolerance.index),
            speed: job.program.is_speed_specified.then_some(job.program.speed),
            plunge: job.program.is_plunge_specified.then_some(job.program.plunge),
            clearance: job.grinder.is_clearance_specified.then_some(job.grinder.clearance),
            wheel: job.program.is_wheel_specified.then_some(job.program.wheel),
            c_offset: job.grinder.c_offset,
            signs: job.grinder.are_signs_specified.then_some(job.grinder.signs),
        }
    }

    /// How long all flutes are together, mm, reckoned with the angle on the cylinder.
    pub fn length(&self) -> f64 {
        let steps = (90.0 - self.tip_angle.0).ceil().max(1.0);
        let polar = |step: f64| Deg(90.0 + (self.tip_angle.0 - 90.0) * step / steps);
        let at = |step: f64| self.profile.point_at_polar(polar(step));
        let chords = (0..steps as u32).map(|step| (at(f64::from(step) + 1.0) - at(f64::from(step))).norm());
        let meridian = (self.start - at(0.0).x).abs() + chords.sum::<f64>();
        f64::from(self.count) * meridian / self.helix.cos()
    }

    /// The tangent of the helix angle at a point of the surface: way around over way along the meridian.
    ///
    /// Of the published law only its own statement is used, that a flute's azimuth is tan(helix) times the way along
    /// the axis over the distance from it: its slope comes of differences along the meridian.
    pub fn slope(&self, law: FluteLaw, at: &Point3<f64>) -> f64 {
        let tan = self.helix.tan();
        match law {
            FluteLaw::ConstantHelix => tan,
            FluteLaw::Published => {
                let (meridian, _) = self.profile.directions(at);
                let from_axis = |p: &Point3<f64>| libm::hypot(p.y, p.z);
                let azimuth = |p: &Point3<f64>| -tan * p.x / from_axis(p);
                let h = 1e-4 * from_axis(at);
                let (before, after) = (at - meridian * h, at + meridian * h);
                from_axis(at) * (azimuth(&after) - azimuth(&before)) / (2.0 * h)
            }
        }
    }

    /// The helix angle that a law has at a polar angle.
    pub fn helix_angle(&self, law: FluteLaw, polar: Deg) -> Deg {
        Deg::atan2(self.slope(law, &self.profile.point_at_polar(polar)), 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;

    fn flutes(helix: f64, more: &str) -> Flutes {
        let text = format!(
            "family = \"burr\"\n[burr]\ndiameter = 12.0\nlength = 25.0\nflutes = 16\nhelix = {helix:?}\n\
             law = \"published\"\ntip_angle = 5.0\nchord_error = 0.002\n[machine]\nc_offset = [40.0, -15.0]\n{more}"
        );
        match Job::parse(&text).unwrap() {
            Job::Burr(job) => Flutes::from_job(&job),
            other => panic!("{other:?} is no burr"),
        }
    }

    /// tan 30° / sin θ: 33.69° at 60°, 49.107° at 30°, 81.414° at 5°.
    #[test]
    fn the_published_law_grows_steeper_towards_the_tip() {
        let flutes = flutes(30.0, "");
        assert!((flutes.start - 19.0).abs() < 1e-12);
        for (polar, angle) in [(90.0, 30.0), (60.0, 33.690_067), (30.0, 49.106_605), (5.0, 81.415_551)] {
            let found = flutes.helix_angle(FluteLaw::Published, Deg(polar));
            assert!((found.0 - angle).abs() < 1e-3, "{found:?} at {polar}");
            let constant = flutes.helix_angle(FluteLaw::ConstantHelix, Deg(polar));
            assert!((constant.0 - 30.0).abs() < 1e-9);
        }
    }

    /// Where the arcs of 14 and 4 meet (8.4 along, 3.2 off the axis, tangent 0.8 along and 0.6 inwards):
    /// d(8.4/3.2)·3.2 = 0.8 + 8.4·0.6/3.2 = 2.375.
    #[test]
    fn on_a_nose_of_arcs_too() {
        let flutes = flutes(30.0, "profile = { large = 14.0, small = 4.0 }\n");
        assert!((flutes.start - 15.0).abs() < 1e-9);
        let slope = flutes.slope(FluteLaw::Published, &Point3::new(-8.4, -3.2, 0.0));
        assert!((slope - 2.375 * Deg(30.0).tan()).abs() < 1e-3, "{slope}");
    }
}
