//! Nominal flutes of a burr: their surface, their helix law and their number.
use nalgebra::Point3;

use super::profile::Profile;
use crate::job::{AxisSigns, Burr, FluteLaw};
use gcode_lang::units::Deg;

/// Nominal flutes and their tolerances; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flutes {
    /// Tooth-bottom surface.
    pub profile: Profile,
    /// Number of flutes.
    pub count: u32,
    /// Helix angle on the cylinder; negative for a left-hand burr.
    pub helix: Deg,
    /// Law of the helix angle on the nose.
    pub law: FluteLaw,
    /// x of the start of a flute.
    pub start: f64,
    /// Polar angle of the normal at the end of a flute.
    pub tip_angle: Deg,
    /// Height of the blank above the tooth bottom.
    pub tooth_depth: f64,
    /// Tolerance of the contact path's distance from the flute.
    pub chord_error: f64,
    /// Length of the stretch over which a flute's helix angle is measured.
    pub gauge: f64,
    /// Tolerance of the distance from the surface.
    pub surface_tolerance: f64,
    /// Tolerance of the helix angle, either way.
    pub helix_tolerance: Deg,
    /// Tolerance of a flute's azimuth, either way.
    pub index_tolerance: Deg,
    /// Speed of the contact along a flute, mm/min; `None` if the job does not specify it.
    pub speed: Option<f64>,
    /// Feed into the blank, mm/min; `None` if the job does not specify it.
    pub plunge: Option<f64>,
    /// Least distance from the blank at which a rapid ends; `None` if the job does not specify it.
    pub clearance: Option<f64>,
    /// Wheel speed, r/min; `None` if the job does not specify it.
    pub wheel: Option<f64>,
    /// x and y from the C axis to the end of the cylinder at C0, as in the job.
    pub c_offset: [f64; 2],
    /// Directions of the axes; `None` if the job does not specify them.
    pub signs: Option<AxisSigns>,
}

impl Flutes {
    /// Returns the nominal flutes of a burr job.
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
            speed: job.program.speed,
            plunge: job.program.plunge,
            clearance: job.grinder.clearance,
            wheel: job.program.wheel,
            c_offset: job.grinder.c_offset,
            signs: job.grinder.specified_signs,
        }
    }

    /// Returns the total length of all flutes, mm, computed with the helix angle on the cylinder.
    pub fn length(&self) -> f64 {
        let steps = (90.0 - self.tip_angle.0).ceil().max(1.0);
        let polar = |step: f64| Deg(90.0 + (self.tip_angle.0 - 90.0) * step / steps);
        let at = |step: f64| self.profile.point_at_polar(polar(step));
        let chords = (0..steps as u32).map(|step| (at(f64::from(step) + 1.0) - at(f64::from(step))).norm());
        let meridian = (self.start - at(0.0).x).abs() + chords.sum::<f64>();
        f64::from(self.count) * meridian / self.helix.cos()
    }

    /// Returns the tangent of the helix angle at a point of the surface: travel around over travel along the
    /// meridian.
    ///
    /// For the published law only its statement is used: the azimuth of a flute is tan(helix) times the
    /// travel along the axis over the distance from it. The slope comes from differences along the meridian.
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

    /// Returns the helix angle that a law gives at a polar angle.
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

    /// At the junction of the arcs of 14 and 4 (8.4 along, 3.2 off the axis, tangent 0.8 along and 0.6
    /// inwards): d(8.4/3.2)·3.2 = 0.8 + 8.4·0.6/3.2 = 2.375.
    #[test]
    fn on_a_nose_of_arcs_too() {
        let flutes = flutes(30.0, "profile = { large = 14.0, small = 4.0 }\n");
        assert!((flutes.start - 15.0).abs() < 1e-9);
        let slope = flutes.slope(FluteLaw::Published, &Point3::new(-8.4, -3.2, 0.0));
        assert!((slope - 2.375 * Deg(30.0).tan()).abs() < 1e-3, "{slope}");
    }
}
