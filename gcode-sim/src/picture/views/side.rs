//! From where a part is looked at: which of its directions are right and up on the sheet.
use nalgebra::{UnitQuaternion, Vector3};

use super::super::role::Point;
use super::super::scene::{Axis, Misfit};
use crate::part::hole::Hole;

/// The direction that comes towards the reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// From +y: x to the right and z down, so that the picture is right-handed, and azimuths (x = r·cos α,
    /// z = r·sin α) grow clockwise.
    #[default]
    Y,
    /// From +z, along a spindle that stands: x to the right and y up.
    Z,
}

impl Side {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Y => "+y",
            Self::Z => "+z",
        }
    }

    /// The part's (x, y, z) on the sheet: right and up.
    pub(super) fn seen(self, [x, y, z]: [f64; 3]) -> Point {
        match self {
            // 0 − z and not −z: no negative zeros in what is compared and printed.
            Self::Y => [x, 0.0 - z],
            Self::Z => [x, y],
        }
    }

    pub(super) fn towards(self) -> Vector3<f64> {
        match self {
            Self::Y => Vector3::y(),
            Self::Z => Vector3::z(),
        }
    }

    pub(super) fn axes(self) -> Vec<Axis> {
        let (name, other) = match self {
            Self::Y => ("z", [0.0, 0.0, 1.0]),
            Self::Z => ("y", [0.0, 1.0, 0.0]),
        };
        vec![
            Axis { name: "x".to_owned(), direction: self.seen([1.0, 0.0, 0.0]) },
            Axis { name: name.to_owned(), direction: self.seen(other) },
        ]
    }

    /// Actual − nominal across the nominal axis, which is turned the shortest way to point at the reader: so a
    /// deviation keeps its length, and the zone is a circle for steep holes too.
    pub(super) fn misfit(self, nominal: &Hole, found: &Hole) -> Option<Misfit> {
        let axis = Vector3::from(nominal.axis);
        let turn = UnitQuaternion::rotation_between(&axis, &self.towards())
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let end = |depth: f64| Some(self.seen((turn * off(nominal, found, depth)?).into()));
        Some(Misfit { entry: end(0.0)?, bottom: end(nominal.depth)? })
    }
}

/// Actual − nominal where the actual axis crosses the plane `depth` below the nominal entry, perpendicular to the
/// nominal axis.
pub(super) fn off(nominal: &Hole, found: &Hole, depth: f64) -> Option<Vector3<f64>> {
    let (axis, along) = (Vector3::from(nominal.axis), Vector3::from(found.axis));
    let exact = Vector3::from(nominal.entry) - axis * depth;
    let from = Vector3::from(found.entry);
    let slope = along.dot(&axis);
    (0.01 < slope.abs()).then(|| from + along * ((exact - from).dot(&axis) / slope) - exact)
}
