//! Tilted working planes of G68.2: from angles, points and vectors to the plane's axes.
use super::kinematics::{Alignment, Matrix, Vector, cross, dot, scaled, sum, unit_vector};
use gcode_lang::motion::{AxisIndex, Position};

const X: Vector = [1.0, 0.0, 0.0];
const Y: Vector = [0.0, 1.0, 0.0];
const Z: Vector = [0.0, 0.0, 1.0];

/// Sine of the angle by which the two vectors of P3 may differ from a right angle: 5°.
const MAX_SKEW: f64 = 0.087_155_742_747_658_17;

/// Tilted plane: p = o + M·q in the coordinates of X, Y and Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tilt {
    pub(super) axes: [AxisIndex; 3],
    pub(super) plane: Plane,
    /// Part and tool after G53.1; `None` before it.
    pub(super) alignment: Option<Alignment>,
    /// The plane of a second G68 with I J K.
    pub(super) is_nested: bool,
}

/// Origin of a plane, and its axes as the columns of a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) origin: Vector,
    pub(super) matrix: Matrix,
}

impl Tilt {
    pub(super) fn apply(&self, point: &mut Position) {
        let rotated = self.plane.matrix.apply(self.axes.map(|axis| point[axis]));
        for (axis, value) in self.axes.into_iter().zip(sum(self.plane.origin, rotated)) {
            point[axis] = value;
        }
    }

    pub(super) fn revert(&self, point: &mut Position) {
        let from = sum(self.axes.map(|axis| point[axis]), scaled(self.plane.origin, -1.0));
        for (axis, value) in self.axes.into_iter().zip(self.plane.matrix.transposed().apply(from)) {
            point[axis] = value;
        }
    }
}

impl Plane {
    /// P0: Euler angles, about Z, the new X and the new Z: Rz(I)·Rx(J)·Rz(K).
    pub(super) fn by_euler_angles(origin: Vector, [i, j, k]: Vector) -> Self {
        let tilted = Matrix::about(X, j).after(&Matrix::about(Z, k));
        Self { origin, matrix: Matrix::about(Z, i).after(&tilted) }
    }

    /// P1: roll, pitch and yaw, I, J and K about X, Y and Z of the work system in the order of the digits of Q; `None` for
    /// another order.
    pub(super) fn by_roll_pitch_yaw(origin: Vector, angles: Vector, order: u32) -> Option<Self> {
        let digits = [order / 100, order / 10 % 10, order % 10].map(|digit| digit as usize);
        let is_order = order < 1000 && (1..=3).all(|axis| digits.contains(&axis));
        let rotation = |axis: usize| Matrix::about([X, Y, Z][axis - 1], angles[axis - 1]);
        is_order.then(|| {
            let [first, second, third] = digits.map(rotation);
            Self { origin, matrix: third.after(&second.after(&first)) }
        })
    }

    /// P2: origin, a point on +X and one on the side of +Y, then a shift and a rotation about Z in the plane; `None` for
    /// points on a line.
    fn by_points([origin, x, y]: [Vector; 3], shift: Vector, angle: f64) -> Option<Self> {
        let from_origin = |point| sum(point, scaled(origin, -1.0));
        let x = unit_vector(from_origin(x))?;
        let z = unit_vector(cross(x, from_origin(y)))?;
        let matrix = Matrix::from_columns([x, cross(z, x), z]);
        Some(Self {
            origin: sum(origin, matrix.apply(shift)),
            matrix: matrix.after(&Matrix::about(Z, angle)),
        })
    }

    /// P3: origin and the directions of X and Z; Z stays, X becomes square to it. `None` if they differ from a right angle by
    /// more than 5°.
    fn by_vectors(origin: Vector, x: Vector, z: Vector) -> Option<Self> {
        let (x, z) = (unit_vector(x)?, unit_vector(z)?);
        if dot(x, z).abs() > MAX_SKEW {
            return None;
        }
        let y = unit_vector(cross(z, x))?;
        Some(Self { origin, matrix: Matrix::from_columns([cross(y, z), y, z]) })
    }

    /// P4: projection angles. X is the work system's X turned by I about Y; Z is square to it and to Y turned by J about X;
    /// then all turn by K about Z. `None` if both directions are parallel.
    pub(super) fn by_projection(origin: Vector, [i, j, k]: Vector) -> Option<Self> {
        let x = Matrix::about(Y, i).apply(X);
        let z = unit_vector(cross(x, Matrix::about(X, j).apply(Y)))?;
        let matrix = Matrix::from_columns([x, cross(z, x), z]);
        Some(Self { origin, matrix: matrix.after(&Matrix::about(Z, k)) })
    }

    /// G68.3: Z along the tool, X square to it and to the vertical direction, then all turn by an angle about Z. Where both are
    /// parallel, X is the axis after the vertical one: Y after X, Z after Y, X after Z.
    pub(super) fn along_tool(origin: Vector, tool: Vector, vertical: Vector, angle: f64) -> Self {
        let [x, y, z] = vertical.map(f64::abs);
        let next = if x > y && x > z {
            Y
        } else if y > z {
            Z
        } else {
            X
        };
        let x = unit_vector(cross(vertical, tool)).unwrap_or(next);
        let matrix = Matrix::from_columns([x, cross(tool, x), tool]);
        Self { origin, matrix: matrix.after(&Matrix::about(Z, angle)) }
    }

    /// Returns the plane whose numbers count in `base`.
    pub(super) fn within(&self, base: &Self) -> Self {
        Self {
            origin: sum(base.origin, base.matrix.apply(self.origin)),
            matrix: base.matrix.after(&self.matrix),
        }
    }
}

/// Blocks of P2 or P3 that have been commanded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PlaneEntry {
    /// P of the first block.
    pub(super) form: u32,
    /// P2: shift and rotation of Q0; P3: none.
    pub(super) shift: (Vector, f64),
    /// P2: points of Q1 and Q2; P3: origin and the direction of X.
    pub(super) given: [Vector; 2],
    /// Q of the next block.
    pub(super) next: u32,
}

impl PlaneEntry {
    /// Adds a block with its point, and with its vector for P3; returns the plane if it is complete, `None` if the block is out
    /// of order or the plane impossible.
    pub(super) fn add(&mut self, q: u32, point: Vector, vector: Vector, angle: f64) -> Option<Option<Plane>> {
        let is_shift = self.form == 2 && q == 0 && self.next == 0;
        if !is_shift && q != self.next.max(1) {
            return None;
        }
        match (self.form, q) {
            (2, 0) => self.shift = (point, angle),
            (2, 3) => {
                let [origin, x] = self.given;
                return Plane::by_points([origin, x, point], self.shift.0, self.shift.1).map(Some);
            }
            (2, _) => self.given[q as usize - 1] = point,
            (_, 1) => self.given = [point, vector],
            _ => return Plane::by_vectors(self.given[0], self.given[1], vector).map(Some),
        }
        self.next = q + 1;
        Some(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: Vector, expected: Vector) {
        let same = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12);
        assert!(same, "{found:?} is not {expected:?}");
    }

    /// The plane of the block's face towards +x that leans back by 30°: X along +y, Z along (cos 30°, 0, sin 30°).
    const LEANING: [Vector; 3] =
        [[0.0, 1.0, 0.0], [-0.5, 0.0, 0.866_025_403_784_438_6], [0.866_025_403_784_438_6, 0.0, 0.5]];

    fn is_leaning(plane: &Plane) {
        (0..3).for_each(|k| near(plane.matrix.column(k), LEANING[k]));
    }

    #[test]
    fn all_forms_give_the_same_leaning_face() {
        let o = [10.0, 0.0, 5.0];
        // About Z by 90°, then about the new X, which is +y, by 60°.
        is_leaning(&Plane::by_euler_angles(o, [90.0, 60.0, 0.0]));
        // About X by 60°, then about Z by 90°.
        is_leaning(&Plane::by_roll_pitch_yaw(o, [60.0, 0.0, 90.0], 123).unwrap());
        is_leaning(&Plane::by_vectors(o, [0.0, 2.0, 0.0], LEANING[2]).unwrap());
        let points = [o, sum(o, [0.0, 7.0, 0.0]), sum(o, scaled(LEANING[1], 3.0))];
        is_leaning(&Plane::by_points(points, [0.0; 3], 0.0).unwrap());
        // X turned by 60° about Y is (0.5, 0, −0.866); Z is square to it and to Y; K = 90° brings X to +y.
        is_leaning(&Plane::by_projection(o, [60.0, 0.0, 90.0]).unwrap());
    }

    #[test]
    fn a_shift_counts_in_the_plane() {
        let points = [[10.0, 0.0, 5.0], [10.0, 7.0, 5.0], [9.0, 0.0, 5.0 + 3.0_f64.sqrt()]];
        let plane = Plane::by_points(points, [1.0, 2.0, 3.0], 90.0).unwrap();
        // o + (0, 1, 0) + 2·(−½, 0, √3/2) + 3·(√3/2, 0, ½).
        near(plane.origin, [10.0 - 1.0 + 1.5 * 3.0_f64.sqrt(), 1.0, 5.0 + 3.0_f64.sqrt() + 1.5]);
        near(plane.matrix.column(0), LEANING[1]);
    }

    #[test]
    fn impossible_planes_are_none() {
        assert_eq!(Plane::by_roll_pitch_yaw([0.0; 3], [0.0; 3], 122), None);
        assert_eq!(Plane::by_points([[0.0; 3], X, [3.0, 0.0, 0.0]], [0.0; 3], 0.0), None);
        assert_eq!(Plane::by_vectors([0.0; 3], X, [0.1, 0.0, 1.0]), None);
        assert!(Plane::by_vectors([0.0; 3], X, [0.08, 0.0, 1.0]).is_some());
        assert_eq!(Plane::by_projection([0.0; 3], [90.0, 90.0, 0.0]), None);
    }
}
