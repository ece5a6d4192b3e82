//! Plane geometry of a contour: its segments, the parallels of the tool centre, and the corners between
//! segments.
//!
//! The module knows no blocks, modes or axes. Lengths are mm. Left and right refer to the direction of
//! travel, seen from the positive third axis of the plane; a distance is positive to the left.
use std::ops::{Add, Div, Mul, Sub};

mod corner;
mod segment;

pub(crate) use corner::{Blend, corner_points, is_outside, wall_corner};
pub(crate) use segment::Segment;

/// Returns the vector rotated by 90° counterclockwise.
fn left_normal(direction: Point) -> Point {
    Point::new(-direction.y, direction.x)
}

/// Returns the cross product, positive if `b` points to the left of `a`.
fn cross(a: Point, b: Point) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Largest sine between directions that count as equal.
///
/// An error of this fraction of the radius along the path is an error of half its square across it.
const SAME_DIRECTION: f64 = 1e-6;

/// Coordinates along the first and second axis of the plane, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Point {
    pub x: f64,
    pub y: f64,
}

impl Point {
    pub(crate) const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    pub(crate) fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y
    }

    pub(crate) fn norm(self) -> f64 {
        self.dot(self).sqrt()
    }

    pub(crate) fn normalize(self) -> Self {
        self / self.norm()
    }
}

impl Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl Mul<f64> for Point {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

impl Div<f64> for Point {
    type Output = Self;
    fn div(self, divisor: f64) -> Self {
        Self::new(self.x / divisor, self.y / divisor)
    }
}
