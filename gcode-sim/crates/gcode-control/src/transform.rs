//! Transform from programmed to work coordinates: mirror (G51.1), scaling (G51), then rotation (G68) or tilt (G68.2).
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};
use gcode_lang::units::Deg;

/// Transform from programmed to work coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Transform {
    /// Mirrored axes, as bits.
    pub(super) mirrored_axes: u8,
    pub(super) mirror_position: Position,
    pub(super) scaling: Option<Scale>,
    pub(super) rotation: Option<Rotation>,
    pub(super) tilt: Option<Tilt>,
}

/// G68.2: p = o + Rz(I)·Rx(J)·Rz(K)·q in the coordinates of X, Y and Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tilt {
    axes: [AxisIndex; 3],
    origin: [f64; 3],
    rows: [[f64; 3]; 3],
}

impl Tilt {
    pub(super) fn new(axes: [AxisIndex; 3], origin: [f64; 3], angles: [f64; 3]) -> Self {
        let [(si, ci), (sj, cj), (sk, ck)] = angles.map(sine_cosine);
        let rows = [
            [ci * ck - si * cj * sk, -ci * sk - si * cj * ck, si * sj],
            [si * ck + ci * cj * sk, -si * sk + ci * cj * ck, -ci * sj],
            [sj * sk, sj * ck, cj],
        ];
        Self { axes, origin, rows }
    }

    fn forward(&self, point: &mut Position) {
        let feature = self.axes.map(|axis| point[axis]);
        for (i, axis) in self.axes.into_iter().enumerate() {
            let rotated: f64 = (0..3).map(|k| self.rows[i][k] * feature[k]).sum();
            point[axis] = self.origin[i] + rotated;
        }
    }

    fn backward(&self, point: &mut Position) {
        let from = [0, 1, 2].map(|i| point[self.axes[i]] - self.origin[i]);
        for (i, axis) in self.axes.into_iter().enumerate() {
            point[axis] = (0..3).map(|k| self.rows[k][i] * from[k]).sum();
        }
    }
}

/// Returns sine and cosine; exact for multiples of 90°, as on a control.
fn sine_cosine(angle: f64) -> (f64, f64) {
    match angle.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => (Deg(angle).sin(), Deg(angle).cos()),
    }
}

/// Scaling of G51.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) centre: Position,
    pub(super) factor: Position,
}

/// Rotation of G68 in the plane of two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rotation {
    pub(super) plane: (AxisIndex, AxisIndex),
    pub(super) centre: (f64, f64),
    pub(super) angle: f64,
    sine: f64,
    cosine: f64,
}

impl Rotation {
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
    pub(super) fn is_none(&self) -> bool {
        self.mirrored_axes == 0 && self.scaling.is_none() && self.rotation.is_none() && self.tilt.is_none()
    }

    pub(super) fn forward(&self, mut point: Position) -> Position {
        if self.is_none() {
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
            tilt.forward(&mut point);
        }
        point
    }

    pub(super) fn backward(&self, mut point: Position) -> Position {
        if self.is_none() {
            return point;
        }
        if let Some(tilt) = &self.tilt {
            tilt.backward(&mut point);
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
        let rotation = Rotation::new((0, 1), (0.0, 0.0), 90.0);
        let transform = Transform { rotation: Some(rotation), ..Transform::default() };
        let mut point = Position::default();
        point[0] = 10.0;
        let rotated = transform.forward(point);
        assert_eq!((rotated[0], rotated[1]), (0.0, 10.0));
        assert_eq!(transform.backward(rotated), point);
    }
}
