//! Least distance between the axes of two nominal holes: nearer passes belong to one hole.
use nalgebra::{Point3, Vector3};

use super::entry_planes::PARALLEL_COSINE;
use super::hole::Hole;
use super::point_tree::PointTree;

/// Distance above which holes are not compared, mm.
const MAX_SPACING: f64 = 1.0;

/// Distance below which two holes have one axis, mm.
const SAME_AXIS: f64 = 1e-6;

/// Returns the least distance of an entry from the axis of another hole of the same direction, mm; `None` above 1 mm.
pub(super) fn hole_spacing(holes: &[Hole]) -> Option<f64> {
    let tree = PointTree::new(holes.iter().map(|hole| Point3::from(hole.entry)));
    let mut least = f64::INFINITY;
    tree.pairs(MAX_SPACING, &mut |one, other| {
        let axis = Vector3::from(holes[one].axis);
        if axis.dot(&Vector3::from(holes[other].axis)) < PARALLEL_COSINE {
            return;
        }
        let between = Point3::from(holes[other].entry) - Point3::from(holes[one].entry);
        let distance = (between - axis * between.dot(&axis)).norm();
        if SAME_AXIS < distance {
            least = least.min(distance);
        }
    });
    (least <= MAX_SPACING).then_some(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hole(x: f64, z: f64) -> Hole {
        let entry = [x, 0.0, z];
        Hole { entry, axis: [0.0, 0.0, 1.0], depth: 1.0, ..Hole::default() }
    }

    #[test]
    fn the_nearest_holes_give_the_spacing_and_one_axis_gives_none() {
        assert_eq!(hole_spacing(&[hole(0.0, 0.0), hole(1.5, 0.0)]), None);
        assert_eq!(hole_spacing(&[hole(0.0, 0.0), hole(0.0, -0.5)]), None);
        let spacing = hole_spacing(&[hole(0.0, 0.0), hole(0.45, 0.5), hole(1.2, 0.0)]).unwrap();
        assert!((spacing - 0.45).abs() < 1e-12, "{spacing}");
    }
}
