//! Milled circles of one hole, and how far their path leads beyond them.
use nalgebra::{Point3, Unit, Vector3};

use super::arc_run::Ring;
use gcode_part::exceeds;

/// Excess of a path over its circle that is rounding, mm.
pub(super) const EXCESS_SLACK: f64 = 0.02;

/// Circles of one hole.
#[derive(Clone, Debug)]
pub(super) struct HoleCircles {
    /// The widest circle down to each depth, the deepest first.
    pub rings: Vec<Ring>,
    /// The widest circle.
    pub widest: Ring,
    /// False for a circle that may as well be a groove in a face.
    pub is_certain: bool,
    /// Where the path leads farthest beyond the circles.
    pub excess: Option<PathExcess>,
}

/// Place at which a path leads beyond its circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathExcess {
    /// Centre of the circle.
    pub centre: Point3<f64>,
    /// Position of the tip.
    pub tip: Point3<f64>,
    /// Direction away from the axis.
    pub outwards: Vector3<f64>,
    /// Distance beyond the circle, mm.
    pub depth: f64,
}

impl HoleCircles {
    /// Returns true if a position of the tip is inside the widest circle, or on it.
    pub(super) fn contains(&self, tip: &Point3<f64>) -> bool {
        let Ring { centre, out, radius, roundness, .. } = &self.widest;
        !exceeds(distance(tip, centre, out), radius + EXCESS_SLACK + roundness)
    }

    /// Returns true if the whole path stays inside the widest circle.
    pub(super) fn is_whole(&self) -> bool {
        self.excess.is_none_or(|excess| !exceeds(excess.depth, EXCESS_SLACK + self.widest.roundness))
    }
}

/// Returns the distance of a point from an axis.
pub(super) fn distance(p: &Point3<f64>, centre: &Point3<f64>, out: &Unit<Vector3<f64>>) -> f64 {
    let spoke = p - centre;
    (spoke - out.into_inner() * spoke.dot(out)).norm()
}
