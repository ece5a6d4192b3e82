//! Path of the tool on the part between programmed points: linear in machine coordinates, in general curved
//! on the part.
use nalgebra::Point3;

use super::error::PeriodicError;
use super::{HeadKind, LinkMotion, Machine, Pose, Setup};
use gcode_lang::motion::{PlanarArc, Position};
use gcode_lang::units::Deg;

/// One motion of the axes: straight in axis space, or an arc in the plane of two of them.
#[derive(Clone, Copy, Debug)]
pub struct AxisMotion<'a> {
    /// Start position.
    pub from: &'a Position,
    /// End position.
    pub to: &'a Position,
    /// Arc of two of the axes; `None` for linear motion.
    pub arc: Option<&'a PlanarArc>,
}

impl AxisMotion<'_> {
    /// Returns the position after the fraction `t` of the motion, 0 to 1.
    pub fn position(&self, t: f64) -> Position {
        let mut at = *self.from;
        for (axis, (from, to)) in self.from.0.iter().zip(&self.to.0).enumerate() {
            at[axis] = from + (to - from) * t;
        }
        if let Some(arc) = self.arc {
            let (first, second) = arc.plane;
            let (x, y) = (self.from[first] - arc.centre.0, self.from[second] - arc.centre.1);
            let turned = arc.sweep * t;
            at[first] = arc.centre.0 + x * turned.cos() - y * turned.sin();
            at[second] = arc.centre.1 + x * turned.sin() + y * turned.cos();
        }
        at
    }

    /// Returns the radius of the arc at its start; 0 without an arc.
    pub(crate) fn radius(&self) -> f64 {
        self.arc.map_or(0.0, |arc| {
            libm::hypot(self.from[arc.plane.0] - arc.centre.0, self.from[arc.plane.1] - arc.centre.1)
        })
    }
}

impl Machine {
    /// Calls `each` with poses of the tool on the part along a motion, from start to end.
    ///
    /// The poses are so close together that the path deviates from the chord between two of them by at most
    /// `tolerance` mm.
    pub fn for_each_pose(
        &self,
        travel: &AxisMotion<'_>,
        setup: &Setup,
        tolerance: f64,
        mut each: impl FnMut(Pose),
    ) {
        let steps = self.chord_count(travel, setup, tolerance);
        for step in 0..=steps {
            let at = travel.position(f64::from(step) / f64::from(steps));
            each(self.forward(&at, setup));
        }
    }

    /// Returns true if the tool moves straight on the part: no rotation of table or head, and no arc.
    pub(crate) fn is_straight(&self, travel: &AxisMotion<'_>) -> bool {
        travel.arc.is_none() && self.total_rotation(travel) == Deg::ZERO
    }

    /// Returns the sum of the rotations of table and head.
    pub(crate) fn total_rotation(&self, travel: &AxisMotion<'_>) -> Deg {
        self.table.total_rotation(travel.from, travel.to) + self.head.total_rotation(travel.from, travel.to)
    }

    /// Returns the number of chords from which the path deviates by at most `tolerance` mm.
    ///
    /// A path p(t) deviates from its chord by at most |p''|·Δt²/8. If table and head rotate by γ in all, the
    /// slides travel b, and no lever is longer than ρ, |p''| is at most γ²·ρ + 2·γ·b. An arc of sweep s and
    /// radius R adds s²·R, and the error of an axis its own curvature.
    pub(crate) fn chord_count(&self, travel: &AxisMotion<'_>, setup: &Setup, tolerance: f64) -> u32 {
        let turn = self.total_rotation(travel).to_rad();
        let sweep = travel.arc.map_or(0.0, |arc| arc.sweep.to_rad());
        let waves = self.wave_bend(travel, setup);
        if turn == 0.0 && sweep == 0.0 && waves == 0.0 {
            return 1;
        }
        let chord = self.slide_length(travel);
        let path_length = if sweep == 0.0 { chord } else { chord + sweep.abs() * travel.radius() };
        let lever = self.max_lever(travel.from, setup).max(self.max_lever(travel.to, setup)) + path_length;
        let bend = turn * turn * lever + 2.0 * turn * path_length + sweep * sweep * travel.radius() + waves;
        (bend / (8.0 * tolerance)).sqrt().ceil().clamp(1.0, 100_000.0) as u32
    }

    /// Returns the curvature due to errors of the axes: a wave of amplitude A over n periods has |p''| of at
    /// most A·(2·π·n)².
    fn wave_bend(&self, travel: &AxisMotion<'_>, setup: &Setup) -> f64 {
        let lever = self.max_lever(travel.from, setup).max(self.max_lever(travel.to, setup))
            + self.slide_length(travel);
        let bend = |error: &PeriodicError, by: f64, lever: f64| {
            let turn = Deg(360.0 * by / error.period).to_rad();
            error.amplitude.abs() * turn * turn * lever
        };
        let mut sum = 0.0;
        for link in self.table.0.iter().chain(&self.slides.0) {
            let lever = match link.motion {
                LinkMotion::Rotary { .. } => Deg(lever).to_rad(),
                LinkMotion::Linear { .. } => 1.0,
            };
            sum += bend(&link.error, travel.to[link.axis] - travel.from[link.axis], lever);
        }
        if let HeadKind::Axis { axis, .. } = self.head.kind {
            sum += bend(&self.head.error, travel.to[axis] - travel.from[axis], Deg(lever).to_rad());
        }
        sum
    }

    /// Returns the travel of the slides of both chains between the ends.
    fn slide_length(&self, travel: &AxisMotion<'_>) -> f64 {
        let mut by = Position::default();
        for (axis, (from, to)) in travel.from.0.iter().zip(&travel.to.0).enumerate() {
            by[axis] = to - from;
        }
        self.slides.displacement(&by).norm() + self.table.displacement(&by).norm()
    }

    /// Returns the tip's distance from the farthest centre of the table, or the head's own reach if that is
    /// longer.
    pub(crate) fn max_lever(&self, at: &Position, setup: &Setup) -> f64 {
        let tip = self.tool_pose(at, setup).tip;
        let arm = |centre: &Point3<f64>| (tip - centre).norm();
        self.table.rotation_centres().map(arm).fold(self.head.pivot + self.tool_length(setup), f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance_to_chords(points: &[Point3<f64>], p: Point3<f64>) -> f64 {
        let to_chord = |pair: &[Point3<f64>]| {
            let along = pair[1] - pair[0];
            let t = ((p - pair[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (p - (pair[0] + along * t)).norm()
        };
        points.windows(2).map(to_chord).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_curve_of_a_rotating_table_is_followed_to_the_tolerance() {
        let machine = Machine::default();
        let (from, mut to) = (Position([700.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Position::default());
        to[0] = 500.0;
        to[4] = 75.0;
        let travel = AxisMotion { from: &from, to: &to, arc: None };
        let mut points = Vec::new();
        machine.for_each_pose(&travel, &Setup::default(), 0.05, |pose| points.push(pose.tip));
        assert!(points.len() > 10 && points.len() < 200, "{}", points.len());
        for step in 0..=997 {
            // By hand: at B the tip (x, y, 0) is on the part at azimuth B.
            let t = f64::from(step) / 997.0;
            let (x, b) = (700.0 - 200.0 * t, Deg(75.0 * t));
            let exact = Point3::new(x * b.cos(), 20.0 - 20.0 * t, x * b.sin());
            assert!(distance_to_chords(&points, exact) < 0.05, "at {t}");
        }
    }

    #[test]
    fn an_arc_is_followed_to_the_tolerance() {
        let machine = Machine::default();
        let from = Position([10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let arc = PlanarArc { plane: (0, 1), centre: (0.0, 0.0), sweep: Deg(360.0) };
        let travel = AxisMotion { from: &from, to: &from, arc: Some(&arc) };
        let mut points = Vec::new();
        machine.for_each_pose(&travel, &Setup::default(), 0.01, |pose| points.push(pose.tip));
        for pair in points.windows(2) {
            let middle = nalgebra::center(&pair[0], &pair[1]);
            assert!(middle.coords.norm() > 9.99, "{middle}");
        }
    }
}
