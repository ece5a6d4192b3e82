//! Plane geometry of a contour: its segments, the parallels a tool's centre runs on, and what happens where two
//! segments meet.
//!
//! Knows nothing of blocks, modes or axes. Lengths are mm; left and right are those of somebody who walks along the
//! segment, seen from the plane's positive third axis; a distance is positive to the left.
mod blend;
mod corner;
mod crossing;
mod point;
mod segment;

pub(crate) use blend::Blend;
pub(crate) use corner::{corner_points, is_outside, wall_corner};
pub(crate) use segment::Segment;

pub(crate) use point::Point;

/// A quarter turn counterclockwise.
fn left_normal(direction: Point) -> Point {
    Point::new(-direction.y, direction.x)
}

/// Positive where `b` turns left of `a`.
fn cross(a: Point, b: Point) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Two directions that differ by less are one: a point that is wrong by this part of the radius along the path is
/// wrong by half its square across it.
const SAME_DIRECTION: f64 = 1e-6;
