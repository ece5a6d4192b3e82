//! Position tolerance of an axis (ISO 1101): the actual axis lies in a cylinder round the nominal one.
use nalgebra::{Point3, Unit, Vector3};

use gcode_lang::units::Deg;
use gcode_part::Hole;

/// Deviation of an actual hole from a nominal one; lengths in mm, unrounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Intersection of the actual axis with the plane through the nominal entry, perpendicular to the nominal axis.
    pub entry: Point3<f64>,
    /// Intersection with the parallel plane through the nominal bottom.
    pub bottom: Point3<f64>,
    /// Distance of the axes in the plane of the entry.
    pub at_entry: f64,
    /// Distance of the axes in the plane of the bottom.
    pub at_bottom: f64,
    /// Depth of the deepest point below the plane of the nominal entry, minus the nominal depth.
    pub depth_error: f64,
    /// Angle between the axes.
    pub tilt: Deg,
}

impl Deviation {
    /// Returns the deviation of the axis through `deepest`, the deepest point of any tool, out of the part along `axis`;
    /// `None` for an axis parallel to the planes. The axis of a through hole may lead out of either side; the depth then
    /// counts from that side.
    pub fn new(nominal: &Hole, deepest: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> Option<Self> {
        let (entry, out) = (Point3::from(nominal.entry), Vector3::from(nominal.axis));
        let end = entry - out * nominal.depth;
        let is_from_far_side = nominal.through && axis.dot(&out) < 0.0;
        let (start, out) = if is_from_far_side { (end, -out) } else { (entry, out) };
        let slope = axis.dot(&out);
        if slope < 1e-9 {
            return None;
        }
        let crossing =
            |plane: &Point3<f64>| deepest + axis.into_inner() * ((plane - deepest).dot(&out) / slope);
        let (at_entry, at_end) = (crossing(&entry), crossing(&end));
        Some(Self {
            entry: at_entry,
            bottom: at_end,
            at_entry: (at_entry - entry).norm(),
            at_bottom: (at_end - end).norm(),
            depth_error: (start - deepest).dot(&out) - nominal.depth,
            // The sine of a small angle has more significant digits than its cosine.
            tilt: Deg::atan2(axis.cross(&out).norm(), slope),
        })
    }

    /// Returns the diameter of the smallest zone that contains the axis: a straight axis is farthest off at one of its ends.
    pub fn zone_diameter(&self) -> f64 {
        2.0 * self.at_entry.max(self.at_bottom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nominal() -> Hole {
        Hole {
            id: None,
            entry: [10.0, 20.0, 30.0],
            axis: [0.0, 0.0, 1.0],
            depth: 10.0,
            diameter: None,
            ..Hole::default()
        }
    }

    /// The axis is inclined by 0.03 in x over 10 in z: through (10.05, 20.04, 20) it passes z = 30 at x = 10.08.
    #[test]
    fn deviations_of_a_tilted_axis_are_those_computed_by_hand() {
        let axis = Unit::new_normalize(Vector3::new(0.03, 0.0, 10.0));
        let found = Deviation::new(&nominal(), &Point3::new(10.05, 20.04, 20.0), &axis).unwrap();
        assert!((found.entry - Point3::new(10.08, 20.04, 30.0)).norm() < 1e-12);
        assert!((found.at_bottom - 0.064_031_242_374_328_5).abs() < 1e-12, "√(0.05² + 0.04²)");
        assert!((found.at_entry - 0.089_442_719_099_991_6).abs() < 1e-12, "√(0.08² + 0.04²)");
        assert!((found.zone_diameter() - 0.178_885_438_199_983).abs() < 1e-12, "the worse end, doubled");
        assert!(found.depth_error.abs() < 1e-12);
        assert!((found.tilt.0 - 0.171_886_82).abs() < 1e-6, "atan(0.003)");
    }

    #[test]
    fn depth_counts_from_the_nominal_entry() {
        let axis = Vector3::z_axis();
        let found = Deviation::new(&nominal(), &Point3::new(10.0, 20.0, 19.75), &axis).unwrap();
        assert!((found.depth_error - 0.25).abs() < 1e-12);
        assert_eq!(found.zone_diameter(), 0.0);
    }

    #[test]
    fn an_axis_perpendicular_to_the_hole_has_no_position() {
        assert!(Deviation::new(&nominal(), &Point3::origin(), &Vector3::x_axis()).is_none());
    }
}
