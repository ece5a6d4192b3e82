//! Viewing direction: the part's directions that point right and up on the sheet, and the projection of scenes.
use nalgebra::{UnitQuaternion, Vector3};

use super::scene::{Axis, Mark, Point, Scene, Shape, Stroke, ZoneDeviation};
use gcode_part::Hole;

/// The part's direction that points to the reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// From +y: x to the right and z down, so that the picture is right-handed and azimuths (x = r·cos α, z =
    /// r·sin α) increase clockwise.
    #[default]
    Y,
    /// From +z, along an upright spindle: x to the right and y up.
    Z,
    /// From +x: y to the right and z up.
    X,
    /// From −x: z to the right and y up.
    MinusX,
}

impl Side {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Y => "+y",
            Self::Z => "+z",
            Self::X => "+x",
            Self::MinusX => "−x",
        }
    }

    /// Projects (x, y, z) of the part to the sheet: right and up.
    pub(super) fn project(self, [x, y, z]: [f64; 3]) -> Point {
        match self {
            // 0 − z instead of −z avoids negative zeros in compared and printed values.
            Self::Y => [x, 0.0 - z],
            Self::Z => [x, y],
            Self::X => [y, z],
            Self::MinusX => [z, y],
        }
    }

    /// Returns the unit vector to the reader.
    pub fn towards(self) -> Vector3<f64> {
        match self {
            Self::Y => Vector3::y(),
            Self::Z => Vector3::z(),
            Self::X => Vector3::x(),
            Self::MinusX => -Vector3::x(),
        }
    }

    /// Projects a deviation from the nominal axis, which is rotated the shortest way into the line of sight: a
    /// deviation keeps its length, and the zone is a circle for steep holes too.
    pub(super) fn zone_deviation(self, axis: [f64; 3], off: ZoneDeviation<3>) -> ZoneDeviation {
        let (axis, towards) = (Vector3::from(axis), self.towards());
        // A hole drilled from behind is seen through the part: reversed, its deviation would point the wrong
        // way.
        let towards = if axis.dot(&towards) < 0.0 { -towards } else { towards };
        let turn = UnitQuaternion::rotation_between(&axis, &towards).unwrap_or_default();
        let seen = |off: [f64; 3]| self.project((turn * Vector3::from(off)).into());
        ZoneDeviation { entry: seen(off.entry), bottom: seen(off.bottom) }
    }
}

/// Returns actual − nominal at both ends of a hole, perpendicular to the nominal axis; `None` if the axes are
/// nearly perpendicular.
pub(super) fn deviation(nominal: &Hole, found: &Hole) -> Option<ZoneDeviation<3>> {
    let end = |depth: f64| Some(displacement(nominal, found, depth)?.into());
    Some(ZoneDeviation { entry: end(0.0)?, bottom: end(nominal.depth)? })
}

/// Returns actual − nominal where the actual axis crosses the plane `depth` below the nominal entry.
fn displacement(nominal: &Hole, found: &Hole, depth: f64) -> Option<Vector3<f64>> {
    let (axis, along) = (Vector3::from(nominal.axis), Vector3::from(found.axis));
    let exact = Vector3::from(nominal.entry) - axis * depth;
    let from = Vector3::from(found.entry);
    let slope = along.dot(&axis);
    (0.01 < slope.abs()).then(|| from + along * ((exact - from).dot(&axis) / slope) - exact)
}

impl Scene<3> {
    /// Projects a scene of the part to the sheet. Lines and axes that run straight towards the reader are
    /// omitted.
    pub fn seen_from(&self, side: Side) -> Scene {
        let axes = self
            .axes
            .iter()
            .map(|axis| Axis { name: axis.name.clone(), direction: side.project(axis.direction) });
        let strokes = self.strokes.iter().map(|stroke| Stroke {
            shape: stroke.shape.map(|point| side.project(point)),
            pen: stroke.pen,
            caption: stroke.caption.clone(),
        });
        Scene {
            axes: axes.filter(|axis| axis.direction != [0.0, 0.0]).collect(),
            strokes: strokes.filter(|stroke| !stroke.shape.is_a_point()).collect(),
            marks: self.marks.iter().map(|mark| mark.seen_from(side)).collect(),
            zone: self.zone,
        }
    }
}

impl<const D: usize> Shape<D> {
    /// Maps every point of the shape.
    fn map<const E: usize>(&self, to: impl Fn([f64; D]) -> [f64; E]) -> Shape<E> {
        match self {
            Self::Line(points) => Shape::Line(points.iter().map(|point| to(*point)).collect()),
            Self::Circle { centre, radius } => Shape::Circle { centre: to(*centre), radius: *radius },
            Self::Arrow(ends) => Shape::Arrow(ends.map(to)),
            Self::Zero(at) => Shape::Zero(to(*at)),
            Self::Text { at, align, text } => Shape::Text { at: to(*at), align: *align, text: text.clone() },
        }
    }
}

impl Shape {
    /// Returns true for a polyline without extent.
    fn is_a_point(&self) -> bool {
        let Self::Line(points) = self else { return false };
        points.iter().all(|p| libm::hypot(p[0] - points[0][0], p[1] - points[0][1]) <= 1e-3)
    }
}

impl Mark<3> {
    fn seen_from(&self, side: Side) -> Mark {
        let axis = self.direction.unwrap_or_default();
        Mark {
            position: side.project(self.position),
            radius: self.radius,
            depth: self.depth,
            status: self.status,
            label: self.label.clone(),
            direction: self.direction.map(|axis| side.project(axis)),
            deviation: self.deviation.map(|off| side.zone_deviation(axis, off)),
            actual: self.actual.map(|at| side.project(at)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drilled(entry: [f64; 3], axis: [f64; 3]) -> Hole {
        Hole { id: None, entry, axis, depth: 10.0, diameter: None, ..Hole::default() }
    }

    /// Right × up points to the reader: nothing is mirrored.
    #[test]
    fn every_side_is_right_handed() {
        for side in [Side::X, Side::MinusX, Side::Y, Side::Z] {
            let part = [Vector3::x(), Vector3::y(), Vector3::z()];
            let lies = |at: Point| {
                part.into_iter().find_map(|axis| {
                    let seen = side.project(axis.into());
                    if seen == at { Some(axis) } else { (seen.map(|v| 0.0 - v) == at).then_some(-axis) }
                })
            };
            let (right, up) = (lies([1.0, 0.0]).unwrap(), lies([0.0, 1.0]).unwrap());
            assert_eq!(right.cross(&up), side.towards(), "{side:?}");
        }
    }

    #[test]
    fn a_hole_drilled_from_behind_keeps_the_direction_of_its_deviation() {
        let (z, from) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
        for axis in [z, from] {
            let (nominal, found) = (drilled([30.0, 5.0, 0.0], axis), drilled([30.02, 5.01, 0.0], axis));
            let deviation = Side::Z.zone_deviation(axis, deviation(&nominal, &found).unwrap());
            for end in [deviation.entry, deviation.bottom] {
                assert!(
                    (end[0] - 0.02).abs() < 1e-9 && (end[1] - 0.01).abs() < 1e-9,
                    "{axis:?}: {deviation:?}"
                );
            }
        }
    }
}
