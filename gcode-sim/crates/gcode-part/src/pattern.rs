//! Pattern of a honeycomb on a cylinder about x: rows, pitch, and distances in its metric.
use nalgebra::{Point3, Vector3};

use super::surface::bisect;
use crate::job::Metric;
use gcode_lang::units::Deg;

/// Nominal relation of a hole to its neighbours; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// Metric of the distance between neighbours.
    pub metric: Metric,
    /// Diameter of the cylinder on which distances are measured.
    pub diameter: f64,
    /// Number of rows of both groups together.
    pub rows: u32,
    /// Distance of all neighbours in the closed pattern.
    pub pitch: f64,
    /// Specified pitch; `None` if the job specifies divisions.
    pub specified_pitch: Option<f64>,
    /// Holes lie at 0 ≤ x ≤ length.
    pub length: f64,
    /// Diameter at which the holes begin.
    pub outer: f64,
    /// Bore diameter; 0 for a solid cylinder.
    pub bore: f64,
}

impl Pattern {
    /// Returns the distance of two points of the cylinder in the pattern's metric, mm.
    pub fn distance(&self, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
        distance(self.metric, self.diameter, a, b)
    }

    /// Returns the arc length of an angle on the cylinder, mm.
    pub fn arc_length(&self, angle: Deg) -> f64 {
        self.diameter / 2.0 * angle.to_rad()
    }

    /// Returns the outer intersection of a line towards `out` with the cylinder of the pattern; `None` if it
    /// misses.
    pub fn crossing(&self, on: &Point3<f64>, out: &Vector3<f64>) -> Option<Point3<f64>> {
        // |p + t·u| = r in the yz plane, the outer of both solutions.
        let (p, u) = (on.yz().coords, out.yz());
        let (a, half_b, c) = (u.dot(&u), p.dot(&u), p.dot(&p) - self.diameter * self.diameter / 4.0);
        let root = half_b * half_b - a * c;
        (a > 1e-12 && root >= 0.0).then(|| on + out * ((root.sqrt() - half_b) / a))
    }

    /// Returns the distance to the hole two rows further at the same x, mm: the nearest after the six
    /// neighbours.
    pub fn second_neighbour_distance(&self) -> f64 {
        let radius = self.diameter / 2.0;
        self.distance(&point(0.0, Deg::ZERO, radius), &point(0.0, self.row_angle() * 2.0, radius))
    }

    /// Returns the row, from 0, whose azimuth is nearest to that of a point.
    pub fn row_of(&self, p: &Point3<f64>) -> usize {
        let rows = (azimuth(p).0 / self.row_angle().0).round();
        rows.rem_euclid(f64::from(self.rows)) as usize
    }

    /// Returns the pitch with which this number of rows of both groups closes, mm.
    pub fn closing_pitch(&self, rows: u32) -> f64 {
        solve_pitch(self.metric, self.diameter, rows)
    }

    /// Returns the pitch with which the same rows close in the given metric, mm.
    pub fn pitch_in_metric(&self, metric: Metric) -> f64 {
        solve_pitch(metric, self.diameter, self.rows)
    }

    /// Returns the angle between neighbouring rows.
    pub fn row_angle(&self) -> Deg {
        Deg(360.0 / f64::from(self.rows))
    }
}

/// Returns the azimuth of a point, from z towards y, −180 to 180.
pub fn azimuth(p: &Point3<f64>) -> Deg {
    Deg::atan2(p.y, p.z)
}

/// Returns the distance of two points of a cylinder in a metric, mm.
fn distance(metric: Metric, diameter: f64, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    match metric {
        Metric::Chord => (b - a).norm(),
        Metric::Arc => libm::hypot(b.x - a.x, diameter / 2.0 * angle(a, b).to_rad()),
    }
}

/// Returns the angle between the azimuths of two points, 0 to 180.
fn angle(a: &Point3<f64>, b: &Point3<f64>) -> Deg {
    let (cross, dot) = (a.y * b.z - a.z * b.y, a.y * b.y + a.z * b.z);
    Deg::atan2(cross.abs(), dot)
}

/// Returns the point of a cylinder about x at this azimuth.
pub(super) fn point(x: f64, azimuth: Deg, radius: f64) -> Point3<f64> {
    Point3::new(x, radius * azimuth.sin(), radius * azimuth.cos())
}

/// Returns the pitch with which this number of rows closes, mm: neighbours in the next row are as far as
/// those in the same row.
pub(super) fn solve_pitch(metric: Metric, diameter: f64, rows: u32) -> f64 {
    // The neighbour in the next row is half a pitch further along x: for a small pitch it is farther than the
    // pitch.
    let next = |pitch: f64| {
        let (radius, row) = (diameter / 2.0, Deg(360.0 / f64::from(rows)));
        distance(metric, diameter, &point(0.0, Deg::ZERO, radius), &point(pitch / 2.0, row, radius))
    };
    bisect(0.0, 2.0 * next(0.0), |pitch| next(pitch) <= pitch)
}
