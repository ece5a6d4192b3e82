//! Holes that lead to the entry of another one from the opposite side: the part ends there.
use nalgebra::{Point3, Vector3};

use super::hole::Hole;
use super::limits::NOISE;
use super::point_tree::PointTree;

/// Largest distance between the axes of two holes that face each other, mm.
const SAME_AXIS: f64 = 0.01;

/// Returns for each hole the depth at which another one of the list begins from the opposite side, on its axis and within its own depth;
/// `None` without one, and of a hole that is listed as through.
pub(super) fn facing_depths(holes: &[Hole]) -> Vec<Option<f64>> {
    let axis = |hole: &Hole| Vector3::from(hole.axis);
    let first = holes.first().map(axis);
    if holes.iter().all(|hole| first.is_some_and(|first| 0.0 < first.dot(&axis(hole)))) {
        return vec![None; holes.len()];
    }
    let entries = PointTree::new(holes.iter().map(|hole| Point3::from(hole.entry)));
    let facing = |hole: &Hole| {
        let (entry, out) = (Point3::from(hole.entry), axis(hole));
        let bottom = entry - out * hole.depth;
        let margin = Vector3::repeat(SAME_AXIS);
        let mut least: Option<f64> = None;
        entries.in_box(&(entry.inf(&bottom) - margin), &(entry.sup(&bottom) + margin), &mut |index| {
            let other = &holes[index];
            let to = Point3::from(other.entry) - entry;
            let begins = -to.dot(&out);
            let is_facing = axis(other).dot(&out) < -1.0 + NOISE && to.cross(&out).norm() <= SAME_AXIS;
            if is_facing && NOISE < begins && begins <= hole.depth + NOISE {
                least = Some(least.unwrap_or(f64::INFINITY).min(begins));
            }
        });
        least
    };
    holes.iter().map(|hole| facing(hole).filter(|_| !hole.through)).collect()
}
