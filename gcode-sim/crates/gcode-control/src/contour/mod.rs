//! Plane geometry of a contour: its segments, the parallels of the tool centre, and the corners between
//! segments.
//!
//! The module knows no blocks, modes or axes. Lengths are mm. Left and right refer to the direction of
//! travel, seen from the positive third axis of the plane; a distance is positive to the left.
mod blend;
mod corner;
mod crossing;
mod point;
mod segment;

pub(crate) use blend::Blend;
pub(crate) use corner::{corner_points, is_outside, wall_corner};
pub(crate) use segment::Segment;

pub(crate) use point::Point;

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
