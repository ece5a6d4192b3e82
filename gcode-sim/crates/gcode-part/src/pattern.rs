//! The pattern of a honeycomb on a cylinder about x: metric, pitch, rows, and distances of points in that metric.
use nalgebra::{Point3, Vector3};

use crate::job::Metric;
use gcode_lang::units::Deg;

/// What a hole's neighbours must be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    pub metric: Metric,
    /// Of the cylinder on which the distances count, mm.
    pub diameter: f64,
    /// Rows of both groups together.
    pub rows: u32,
    /// The distance of all neighbours once the pattern closes, mm.
    pub pitch: f64,
    /// The pitch that was asked for, mm; `None` where divisions were.
    pub specified_pitch: Option<f64>,
    /// Holes stand at 0 ≤ x ≤ length, mm.
    pub length: f64,
    /// Where the holes begin, mm.
    pub outer: f64,
    /// 0 where the cylinder is solid, mm.
    pub bore: f64,
}

impl Pattern {
    /// The distance of two points of the cylinder in the pattern's metric, mm.
    pub fn distance(&self, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
        match self.metric {
            Metric::Chord => (b - a).norm(),
            Metric::Arc => libm::hypot(b.x - a.x, self.arc_length(angle(a, b))),
        }
    }

    /// So long is an angle on the cylinder, mm.
    pub fn arc_length(&self, angle: Deg) -> f64 {
        self.diameter / 2.0 * angle.to_rad()
    }

    /// Where a straight line out of the part crosses the cylinder on which the distances count; `None` where it
    /// doesn't.
    pub fn crossing(&self, on: &Point3<f64>, out: &Vector3<f64>) -> Option<Point3<f64>> {
        // |p + t·u| = r in the yz plane, the outer one of both solutions.
        let (p, u) = (on.yz().coords, out.yz());
        let (a, half_b, c) = (u.dot(&u), p.dot(&u), p.dot(&p) - self.diameter * self.diameter / 4.0);
        let root = half_b * half_b - a * c;
        (a > 1e-12 && root >= 0.0).then(|| on + out * ((root.sqrt() - half_b) / a))
    }

    /// From a hole to the one abreast of it two rows further: behind the six neighbours the nearest, mm.
    pub fn second_neighbour_distance(&self) -> f64 {
        let radius = self.diameter / 2.0;
        self.distance(&point(0.0, Deg::ZERO, radius), &point(0.0, self.row_angle() * 2.0, radius))
    }

    /// The row whose azimuth is nearest to that of a point, counted from 0.
    pub fn row_of(&self, p: &Point3<f64>) -> usize {
        let rows = (azimuth(p).0 / self.row_angle().0).round();
        rows.rem_euclid(f64::from(self.rows)) as usize
    }

    /// The pitch that so many rows of both groups close with, mm.
    pub fn closing_pitch(&self, rows: u32) -> f64 {
        solve_pitch(self.metric, self.diameter, rows)
    }

    /// The pitch that the same rows close with in the other metric, mm.
    pub fn pitch_in_metric(&self, metric: Metric) -> f64 {
        solve_pitch(metric, self.diameter, self.rows)
    }

    /// From one row to the next.
    pub fn row_angle(&self) -> Deg {
        Deg(360.0 / f64::from(self.rows))
    }
}

/// Azimuth of a point, from z towards y, −180 to 180.
pub fn azimuth(p: &Point3<f64>) -> Deg {
    Deg::atan2(p.y, p.z)
}

/// From the one azimuth to the other, 0 to 180.
pub(super) fn angle(a: &Point3<f64>, b: &Point3<f64>) -> Deg {
    let (cross, dot) = (a.y * b.z - a.z * b.y, a.y * b.y + a.z * b.z);
    Deg::atan2(cross.abs(), dot)
}

/// A point of the cylinder of this radius.
pub(super) fn point(x: f64, azimuth: Deg, radius: f64) -> Point3<f64> {
    Point3::new(x, radius * azimuth.sin(), radius * azimuth.cos())
}

/// The pitch at which so many rows close: a hole's neighbours in the next row are as far as those in its own, mm.
pub(super) fn solve_pitch(metric: Metric, diameter: f64, rows: u32) -> f64 {
    let guess = Pattern {
        metric,
        diameter,
        rows,
        pitch: 0.0,
        specified_pitch: None,
        length: 0.0,
        outer: diameter,
        bore: 0.0,
    };
    // The neighbour in the next row stands half a pitch further: with a small pitch it is farther than the pitch.
    let next = |pitch: f64| {
        let (here, there) =
            (point(0.0, Deg::ZERO, diameter / 2.0), point(pitch / 2.0, guess.row_angle(), diameter / 2.0));
        guess.distance(&here, &there)
    };
    let (mut low, mut high) = (0.0, 2.0 * next(0.0));
    loop {
        let middle = low + (high - low) / 2.0;
        if middle <= low || high <= middle {
            return middle;
        }
        if next(middle) > middle {
            low = middle;
        } else {
            high = middle;
        }
    }
}
