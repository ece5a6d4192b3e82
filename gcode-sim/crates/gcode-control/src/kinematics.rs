//! The control's kinematics: frames that its rotary axes carry, and the angles that point the tool along a direction.
use gcode_lang::control::{Kinematics, RotaryAxis, ToolAxisChoice};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

/// Vector along X, Y and Z.
pub(super) type Vector = [f64; 3];

/// Returns a coordinate that kinematics computes, to 1e-9: finer than any increment, coarser than rounding errors.
pub(super) fn remove_noise(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

/// Sines of angles below this count as 0.
const PARALLEL: f64 = 1e-9;

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn sum(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|value| value * factor)
}

/// Returns the vector with length 1; `None` for one without a direction.
pub(super) fn unit_vector(a: Vector) -> Option<Vector> {
    let length = dot(a, a).sqrt();
    (length > PARALLEL).then(|| scaled(a, 1.0 / length))
}

/// Returns sine and cosine; exact for multiples of 90°, as on a control.
pub(super) fn sine_cosine(angle: f64) -> (f64, f64) {
    match angle.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => (Deg(angle).sin(), Deg(angle).cos()),
    }
}

/// Shift of the part and its rotation about the work zero, with the axes of the table at machine position 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PartError {
    pub(super) shift: Vector,
    pub(super) rotation: Matrix,
}

/// Rotation by its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Matrix(pub(super) [Vector; 3]);

impl Matrix {
    pub(super) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// Returns the right-handed rotation by an angle in degrees about a direction of length 1 (Rodrigues).
    pub(super) fn about(direction: Vector, angle: f64) -> Self {
        let (sine, cosine) = sine_cosine(angle);
        let [x, y, z] = direction;
        let skew = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let entry = |i: usize, k: usize| {
            let same = if i == k { cosine } else { 0.0 };
            same + sine * skew[i][k] + (1.0 - cosine) * direction[i] * direction[k]
        };
        Self(std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k))))
    }

    pub(super) fn from_columns(columns: [Vector; 3]) -> Self {
        Self(columns).transposed()
    }

    pub(super) fn column(&self, k: usize) -> Vector {
        self.0.map(|row| row[k])
    }

    pub(super) fn apply(&self, to: Vector) -> Vector {
        self.0.map(|row| dot(row, to))
    }

    pub(super) fn transposed(&self) -> Self {
        Self(std::array::from_fn(|i| self.column(i)))
    }

    /// Returns the rotation that acts after `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self::from_columns(std::array::from_fn(|k| self.apply(first.column(k))))
    }
}

/// Rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) rotation: Matrix,
    pub(super) shift: Vector,
}

impl Frame {
    pub(super) fn apply(&self, point: Vector) -> Vector {
        sum(self.rotation.apply(point), self.shift)
    }

    pub(super) fn revert(&self, point: Vector) -> Vector {
        self.rotation.transposed().apply(sum(point, scaled(self.shift, -1.0)))
    }

    pub(super) fn inverse(&self) -> Self {
        let rotation = self.rotation.transposed();
        Self { rotation, shift: scaled(rotation.apply(self.shift), -1.0) }
    }

    pub(super) fn after(&self, first: &Self) -> Self {
        Self { rotation: self.rotation.after(&first.rotation), shift: self.apply(first.shift) }
    }

    /// Returns the frame that a chain of axes carries, from its base.
    fn of_chain(axes: &[RotaryAxis], at: &Position) -> Self {
        let base = Self { rotation: Matrix::IDENTITY, shift: [0.0; 3] };
        axes.iter().fold(base, |frame, axis| {
            let rotation = Matrix::about(axis.direction, axis.sign * at[axis.axis]);
            let shift = sum(axis.point, scaled(rotation.apply(axis.point), -1.0));
            frame.after(&Self { rotation, shift })
        })
    }
}

/// Part and tool with the rotary axes at fixed angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Alignment {
    /// From machine coordinates with the rotary axes at their work zeros to those at the angles, without the tool's length.
    pub(super) frame: Frame,
    /// Rotation of the tool from the head's position 0.
    pub(super) tool: Matrix,
    /// Positions of all axes when the rotary axes took their angles.
    pub(super) at: Position,
}

impl Alignment {
    /// Returns the frame that the table carries with its axes at `at`.
    pub(super) fn of_table(kinematics: &Kinematics, at: &Position) -> Frame {
        Frame::of_chain(&kinematics.table, at)
    }

    /// Returns the alignment with the rotary axes at `at`; the work zeros count with those of the table at `zero` and those of
    /// the head at 0.
    ///
    /// The tip t of a tool of length L lies at t = p − H·d·(s + L) + h, with the position p of X, Y and Z, the head's rotation
    /// H and shift h, the tool's direction d and the pivot's distance s. A point m of the part, in machine coordinates that
    /// contain d·s, has its tip at T(at)·T(zero)⁻¹·(m − d·s).
    pub(super) fn new(kinematics: &Kinematics, at: &Position, zero: &Position) -> Self {
        let table = Frame::of_chain(&kinematics.table, at);
        let part = table.after(&Frame::of_chain(&kinematics.table, zero).inverse());
        let head = Frame::of_chain(&kinematics.head, at);
        let pivot = scaled(kinematics.direction, kinematics.pivot);
        let out = sum(head.rotation.apply(pivot), scaled(head.shift, -1.0));
        let frame = Frame { rotation: part.rotation, shift: sum(part.apply(scaled(pivot, -1.0)), out) };
        Self { frame, tool: head.rotation, at: *at }
    }

    /// Returns the alignment that turns a plane level about its origin, in machine coordinates, as a table does; for a machine
    /// that nothing describes.
    pub(super) fn level(plane: &Matrix, origin: Vector) -> Self {
        let rotation = plane.transposed();
        let shift = sum(origin, scaled(rotation.apply(origin), -1.0));
        Self { frame: Frame { rotation, shift }, tool: Matrix::IDENTITY, at: Position::default() }
    }

    /// Returns the alignment of a table that doesn't turn with its axes.
    pub(super) fn of_head(kinematics: &Kinematics, at: &Position) -> Self {
        let table = Vec::new();
        let head = Kinematics { table, head: kinematics.head.clone(), ..*kinematics };
        Self::new(&head, at, at)
    }
}

/// Rotation of a part's direction relative to the spindle by one axis.
struct AxisRotation<'k> {
    axis: &'k RotaryAxis,
    /// Effect of a positive command about the axis's direction: that of a head turns the tool, not the part.
    sense: f64,
}

impl AxisRotation<'_> {
    /// Returns the position of the axis for an angle in degrees; the current one if any will do.
    fn position(&self, angle: Option<f64>, current: &Position) -> f64 {
        angle.map_or(current[self.axis.axis], |angle| (angle * self.sense * 1e9).round() / 1e9)
    }
}

/// Returns the positions, in `current` with other rotary axes, at which the tool points along a direction of the table: `normal`
/// with the table's axes at 0. Subproblem 2 of Paden and Kahan: the turned normal lies on the cones about both axes. `None` if
/// the arrangement isn't covered: more than two rotary axes.
pub(super) fn pointing_positions(
    kinematics: &Kinematics,
    normal: Vector,
    current: &Position,
) -> Option<Vec<Position>> {
    let on_table = kinematics.table.iter().rev().map(|axis| AxisRotation { axis, sense: axis.sign });
    let on_head = kinematics.head.iter().map(|axis| AxisRotation { axis, sense: -axis.sign });
    let rotations: Vec<_> = on_table.chain(on_head).collect();
    let goal = kinematics.direction;
    let is_same = |a: Vector, b: Vector| {
        let difference = sum(a, scaled(b, -1.0));
        dot(difference, difference).sqrt() < 1e-7
    };
    let mut found = Vec::new();
    match rotations.as_slice() {
        [] => found.extend(is_same(normal, goal).then_some(*current)),
        [only] => {
            let angle = angle_about(only.axis.direction, normal, goal);
            let turned = Matrix::about(only.axis.direction, angle.unwrap_or(0.0)).apply(normal);
            if is_same(turned, goal) {
                let mut at = *current;
                at[only.axis.axis] = only.position(angle, current);
                found.push(at);
            }
        }
        [inner, outer] => {
            for between in cone_intersections((outer.axis.direction, goal), (inner.axis.direction, normal)) {
                let mut at = *current;
                let first = angle_about(inner.axis.direction, normal, between);
                let second = angle_about(outer.axis.direction, between, goal);
                at[inner.axis.axis] = inner.position(first, current);
                at[outer.axis.axis] = outer.position(second, current);
                found.push(at);
            }
        }
        _ => return None,
    }
    Some(found)
}

/// Returns the directions that make the same angle with each axis as the direction beside it; two, one or none.
fn cone_intersections((u, a): (Vector, Vector), (v, b): (Vector, Vector)) -> Vec<Vector> {
    let (c, along_u, along_v) = (dot(u, v), dot(u, a), dot(v, b));
    let square = 1.0 - c * c;
    if square < PARALLEL {
        return Vec::new();
    }
    let (x, y) = ((along_u - c * along_v) / square, (along_v - c * along_u) / square);
    let height = (1.0 - x * x - y * y - 2.0 * x * y * c) / square;
    if height < -1e-9 {
        return Vec::new();
    }
    let middle = sum(scaled(u, x), scaled(v, y));
    if height < 1e-14 {
        return vec![middle];
    }
    let aside = scaled(cross(u, v), height.sqrt());
    vec![sum(middle, aside), sum(middle, scaled(aside, -1.0))]
}

/// Returns the angle about a direction from one vector to another, degrees; `None` if rotation leaves one of them as it is.
fn angle_about(direction: Vector, from: Vector, to: Vector) -> Option<f64> {
    let across = |v: Vector| sum(v, scaled(direction, -dot(direction, v)));
    let (from, to) = (across(from), across(to));
    if dot(from, from).sqrt() < 1e-8 || dot(to, to).sqrt() < 1e-8 {
        return None;
    }
    Some(Deg::atan2(dot(direction, cross(from, to)), dot(from, to)).0)
}

/// Returns the axis whose sign P1 and P2 of G53.1 choose.
pub(super) fn choosing_axis(kinematics: &Kinematics, choice: ToolAxisChoice) -> Option<AxisIndex> {
    let tilts = |axis: &&RotaryAxis| {
        let aside = cross(axis.direction, kinematics.direction);
        dot(aside, aside).sqrt() > PARALLEL
    };
    let axis = match choice {
        ToolAxisChoice::Tilting => kinematics.axes().find(tilts),
        ToolAxisChoice::First => kinematics.axes().next(),
        ToolAxisChoice::Second => kinematics.axes().nth(1),
    };
    axis.map(|axis| axis.axis)
}
