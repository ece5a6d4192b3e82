//! Transform from programmed to work coordinates: mirror, scaling, rotation and tilted plane.
use super::kinematics::{Vector, sine_cosine};
use super::plane::{PlaneEntry, Tilt};
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};

/// Transform from programmed to work coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Transform {
    /// Mirrored axes, as bits.
    pub(super) mirrored_axes: u8,
    pub(super) mirror_position: Position,
    pub(super) scaling: Option<Scale>,
    pub(super) rotation: Option<PlaneRotation>,
    pub(super) tilt: Option<Tilt>,
    /// Plane of which only some blocks have been commanded.
    pub(super) plane_entry: Option<PlaneEntry>,
    /// Axes whose centre of rotation or scaling is an unknown position, as bits.
    pub(super) unknown_centre: u8,
}

/// Scaling of G51.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) centre: Position,
    pub(super) factor: Position,
}

/// Rotation of G68 in the plane of two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaneRotation {
    pub(super) plane: (AxisIndex, AxisIndex),
    pub(super) centre: (f64, f64),
    pub(super) angle: f64,
    sine: f64,
    cosine: f64,
}

impl PlaneRotation {
    pub(super) fn new(plane: (AxisIndex, AxisIndex), centre: (f64, f64), angle: f64) -> Self {
        let (sine, cosine) = sine_cosine(angle);
        Self { plane, centre, angle, sine, cosine }
    }

    fn apply(&self, point: &mut Position, sine: f64) {
        let (a, b) = (point[self.plane.0] - self.centre.0, point[self.plane.1] - self.centre.1);
        point[self.plane.0] = self.centre.0 + a * self.cosine - b * sine;
        point[self.plane.1] = self.centre.1 + a * sine + b * self.cosine;
    }
}

impl Transform {
    #[inline]
    pub(super) fn is_identity(&self) -> bool {
        self.mirrored_axes == 0
            && self.scaling.is_none()
            && self.rotation.is_none()
            && self.tilt.is_none()
            && self.plane_entry.is_none()
    }

    /// Returns the axes, as bits, whose work coordinates are products: scaled, or of a rotated plane.
    pub(super) fn computed_axes(&self) -> u8 {
        let rotated = self.rotation.map_or(0, |rotation| 1 << rotation.plane.0 | 1 << rotation.plane.1);
        let tilted = self.tilt.map_or(0, |tilt| tilt.axes.iter().fold(0, |axes, axis| axes | 1 << axis));
        let scaled = self.scaling.map_or(0, |scale| {
            let is_scaled = |axis: &AxisIndex| scale.factor[*axis].abs() != 1.0;
            (0..MAX_AXES).filter(is_scaled).fold(0, |axes, axis| axes | 1 << axis)
        });
        rotated | tilted | scaled
    }

    pub(super) fn work_position(&self, mut point: Position) -> Position {
        if self.is_identity() {
            return point;
        }
        self.reflect(&mut point);
        if let Some(scale) = &self.scaling {
            for axis in 0..MAX_AXES {
                point[axis] = scale.centre[axis] + (point[axis] - scale.centre[axis]) * scale.factor[axis];
            }
        }
        if let Some(rotation) = &self.rotation {
            rotation.apply(&mut point, rotation.sine);
        }
        if let Some(tilt) = &self.tilt {
            tilt.apply(&mut point);
        }
        point
    }

    pub(super) fn programmed_position(&self, mut point: Position) -> Position {
        if self.is_identity() {
            return point;
        }
        if let Some(tilt) = &self.tilt {
            tilt.revert(&mut point);
        }
        if let Some(rotation) = &self.rotation {
            rotation.apply(&mut point, -rotation.sine);
        }
        if let Some(scale) = &self.scaling {
            for axis in 0..MAX_AXES {
                point[axis] = scale.centre[axis] + (point[axis] - scale.centre[axis]) / scale.factor[axis];
            }
        }
        self.reflect(&mut point);
        point
    }

    fn reflect(&self, point: &mut Position) {
        for axis in (0..MAX_AXES).filter(|axis| self.mirrored_axes >> axis & 1 == 1) {
            point[axis] = 2.0 * self.mirror_position[axis] - point[axis];
        }
    }

    /// Returns the direction on the machine, along X, Y and Z, of a programmed axis of a tilted plane.
    pub(super) fn direction_in_plane(&self, tilt: &Tilt, axis: AxisIndex) -> Vector {
        let mut tip = Position::default();
        tip[axis] = 1.0;
        let (from, to) = (self.work_position(Position::default()), self.work_position(tip));
        let direction = tilt.axes.map(|axis| to[axis] - from[axis]);
        tilt.alignment.map_or(direction, |alignment| alignment.frame.rotation.apply(direction))
    }

    /// Returns whether arcs in a plane change their direction, and whether they stay circles.
    pub(super) fn arc_effect(&self, plane: (AxisIndex, AxisIndex)) -> (bool, bool) {
        let bit = |axis: AxisIndex| self.mirrored_axes >> axis & 1 == 1;
        let factor = |axis: AxisIndex| self.scaling.as_ref().map_or(1.0, |s| s.factor[axis]);
        let (a, b) = (factor(plane.0), factor(plane.1));
        let is_reversed = bit(plane.0) ^ bit(plane.1) ^ (a < 0.0) ^ (b < 0.0);
        (is_reversed, a.abs() == b.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_by_90_degrees_takes_x_to_y() {
        let rotation = PlaneRotation::new((0, 1), (0.0, 0.0), 90.0);
        let transform = Transform { rotation: Some(rotation), ..Transform::default() };
        let mut point = Position::default();
        point[0] = 10.0;
        let rotated = transform.work_position(point);
        assert_eq!((rotated[0], rotated[1]), (0.0, 10.0));
        assert_eq!(transform.programmed_position(rotated), point);
    }
}
