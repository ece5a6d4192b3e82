//! Viewing direction: the part's directions that point right and up on the sheet, and the projection of scenes.
use nalgebra::{UnitQuaternion, Vector3};

use super::scene::{Axis, Mark, Point, Scene, Shape, Stroke, ZoneDeviation};
use gcode_part::Hole;

/// Viewing direction: the part's directions that point right and up on the sheet, perpendicular to each other and of
/// the same length: 1, but for isometric views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    right: [f64; 3],
    up: [f64; 3],
}

/// Arrangement of several views on a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// A view lies on the side that it shows: the top above the front, the right on its right.
    #[default]
    Third,
    /// A view lies on the side opposite to the one it shows: the top below the front.
    First,
}

impl Default for Side {
    fn default() -> Self {
        Self::Y
    }
}

impl Side {
    /// From +y: x to the right and z down, so that the picture is right-handed and azimuths (x = r·cos α, z =
    /// r·sin α) increase clockwise.
    pub const Y: Self = Self { right: [1.0, 0.0, 0.0], up: [0.0, 0.0, -1.0] };
    /// From +z, along an upright spindle: x to the right and y up.
    pub const Z: Self = Self { right: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0] };
    /// From +x: y to the right and z up.
    pub const X: Self = Self { right: [0.0, 1.0, 0.0], up: [0.0, 0.0, 1.0] };
    /// From −x: z to the right and y up.
    pub const MINUS_X: Self = Self { right: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0] };

    /// Returns the side on which an axis of the part, 0 to 2, points to the reader, or away from it.
    pub fn along(axis: usize, is_towards: bool) -> Self {
        let x = [1.0, 0.0, 0.0];
        match (axis, is_towards) {
            (0, true) => Self::X,
            (0, false) => Self { right: [0.0, -1.0, 0.0], up: [0.0, 0.0, 1.0] },
            (1, true) => Self::Y,
            (1, false) => Self { right: x, up: [0.0, 0.0, 1.0] },
            (_, true) => Self::Z,
            (_, false) => Self { right: x, up: [0.0, -1.0, 0.0] },
        }
    }

    /// Returns the view from the front of a part whose top this side shows: what lies below in the top view is
    /// nearest to the reader.
    #[must_use]
    pub fn front(self) -> Self {
        Self { right: self.right, up: self.towards().into() }
    }

    /// Returns the view from the right of a part whose top this side shows.
    #[must_use]
    pub fn from_right(self) -> Self {
        Self { right: self.up, up: self.towards().into() }
    }

    /// Returns the isometric view from the front, the right and above of a part whose top this side shows. Edges
    /// along its three directions keep their lengths, as ISO 5456-3 recommends.
    #[must_use]
    pub fn isometric(self) -> Self {
        let (right, up) = (Vector3::from(self.right), Vector3::from(self.up));
        let towards = right - up + self.towards();
        let right = (right + up).normalize();
        let up = towards.normalize().cross(&right);
        let enlarge = 1.5f64.sqrt();
        Self { right: (right * enlarge).into(), up: (up * enlarge).into() }
    }

    /// Returns the name of the direction to the reader: `+y`; `front, right and above` if it is no axis.
    pub fn name(self) -> &'static str {
        let towards = self.towards();
        let names = [("+x", "−x"), ("+y", "−y"), ("+z", "−z")];
        let axis = towards.iter().zip(names).find(|(part, _)| 0.99 < part.abs());
        axis.map_or("front, right and above", |(part, (plus, minus))| if 0.0 < *part { plus } else { minus })
    }

    /// Returns the coordinates of a point of the part to the right, up and towards the reader.
    pub(super) fn coordinates(self, at: [f64; 3]) -> [f64; 3] {
        let [right, up] = self.project(at);
        [right, up, 0.0 + self.towards().dot(&Vector3::from(at))]
    }

    /// Returns the point of the part with these coordinates to the right, up and towards the reader.
    pub(super) fn point(self, [right, up, towards]: [f64; 3]) -> [f64; 3] {
        (Vector3::from(self.right) * right + Vector3::from(self.up) * up + self.towards() * towards).into()
    }

    /// Returns the name and the sign of the part's axis along which a coordinate counts, 0 to the right, 1 up, 2 towards
    /// the reader; `None` along no axis.
    pub(super) fn axis_of_coordinate(self, coordinate: usize) -> Option<(char, f64)> {
        let directions = [Vector3::from(self.right), Vector3::from(self.up), self.towards()];
        let parts = directions.get(coordinate)?.iter().zip(['x', 'y', 'z']);
        parts.map(|(part, name)| (name, *part)).find(|(_, part)| 0.99 < part.abs())
    }

    /// Projects (x, y, z) of the part to the sheet: right and up.
    pub(super) fn project(self, at: [f64; 3]) -> Point {
        // The sum begins with 0: negative zeros would show in compared and printed values.
        [self.right, self.up]
            .map(|direction| at.iter().zip(direction).fold(0.0, |sum, (mm, part)| sum + mm * part))
    }

    /// Returns the vector to the reader: the square of the directions' length is its own.
    pub fn towards(self) -> Vector3<f64> {
        Vector3::from(self.right).cross(&Vector3::from(self.up)).map(|part| 0.0 + part)
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
            style: stroke.style,
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
    pub(crate) fn map<const E: usize>(&self, to: impl Fn([f64; D]) -> [f64; E]) -> Shape<E> {
        match self {
            Self::Line(points) => Shape::Line(points.iter().map(|point| to(*point)).collect()),
            Self::Circle { centre, radius } => Shape::Circle { centre: to(*centre), radius: *radius },
            Self::Arrow(ends) => Shape::Arrow(ends.map(to)),
            Self::Zero(at) => Shape::Zero(to(*at)),
            Self::Sign { at, sign } => Shape::Sign { at: to(*at), sign: *sign },
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
    pub(super) fn seen_from(&self, side: Side) -> Mark {
        let axis = self.direction.unwrap_or_default();
        Mark {
            position: side.project(self.position),
            radius: self.radius,
            rim: self.rim,
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
        for side in
            [Side::X, Side::MINUS_X, Side::Y, Side::Z, Side::Z.front(), Side::Y.front(), Side::Y.from_right()]
        {
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

    /// The corner of a cube at the front, on the right and above is in the middle of the isometric view.
    #[test]
    fn edges_keep_their_length_in_the_isometric_view() {
        for (top, corner) in [(Side::Z, [1.0, -1.0, 1.0]), (Side::Y, [1.0, 1.0, 1.0])] {
            let side = top.isometric();
            let seen = side.project(corner);
            assert!(libm::hypot(seen[0], seen[1]) < 1e-12, "{seen:?}");
            for edge in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
                let [right, up] = side.project(edge);
                assert!((libm::hypot(right, up) - 1.0).abs() < 1e-12, "{edge:?}");
            }
            let [right, up] = side.project(top.towards().into());
            assert!(right.abs() < 1e-12 && 0.0 < up, "the top is up");
        }
    }

    /// An upright spindle: front from −y with x to the right and z up, right from +x. A part about y: front from +z.
    #[test]
    fn front_and_right_follow_from_the_top() {
        let seen = [Side::Z.front(), Side::Z.from_right(), Side::Y.front(), Side::Y.from_right()];
        assert_eq!(seen.map(Side::name), ["−y", "+x", "+z", "+x"]);
        let at = [1.0, 2.0, 3.0];
        assert_eq!(seen.map(|side| side.project(at)), [[1.0, 3.0], [2.0, 3.0], [1.0, 2.0], [-3.0, 2.0]]);
    }

    #[test]
    fn a_side_along_an_axis_has_it_to_the_reader() {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            assert_eq!(Side::along(axis, true).name(), format!("+{name}"));
            assert_eq!(Side::along(axis, false).name(), format!("−{name}"));
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
