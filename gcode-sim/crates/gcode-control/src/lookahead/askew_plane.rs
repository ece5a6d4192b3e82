//! Plane askew to the machine's axes: lookahead computes in its coordinates and emits events of the machine.
use crate::contour::Point;
use crate::kinematics::{Matrix, Vector, remove_noise};
use crate::plane_arc::{chord_count, point_of_arc};
use gcode_lang::motion::{AxisIndex, EventKind, Position};

/// Directions of a plane and its normal, in coordinates that are turned about the machine's zero.
///
/// X, Y and Z are there along the plane's own X, Y and Z; all other axes keep their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AskewPlane {
    axes: [AxisIndex; 3],
    /// From coordinates of the plane to those of the machine.
    rotation: Matrix,
}

impl AskewPlane {
    /// Creates the plane of these machine axes whose own directions are the columns of a rotation.
    pub(crate) fn new(axes: [AxisIndex; 3], rotation: Matrix) -> Self {
        Self { axes, rotation }
    }

    /// Returns the coordinates in the plane of a machine position.
    pub(crate) fn in_plane(&self, machine: &Position) -> Position {
        self.turned(machine, |at| self.rotation.transposed().apply(at))
    }

    /// Returns the machine position of coordinates in the plane.
    pub(crate) fn on_machine(&self, position: &Position) -> Position {
        self.turned(position, |at| self.rotation.apply(at))
    }

    fn turned(&self, position: &Position, turn: impl Fn(Vector) -> Vector) -> Position {
        let mut turned = *position;
        let values = turn(self.axes.map(|axis| position[axis]));
        for (axis, value) in self.axes.into_iter().zip(values) {
            turned[axis] = remove_noise(value);
        }
        turned
    }

    /// Returns a move with its end in the plane; an arc already is one of the plane.
    pub(super) fn move_in_plane(&self, kind: &EventKind) -> EventKind {
        let mut kind = kind.clone();
        if let EventKind::Rapid { to }
        | EventKind::Feed { to, .. }
        | EventKind::Arc { to, .. }
        | EventKind::Skip { to, .. } = &mut kind
        {
            *to = self.in_plane(to);
        }
        kind
    }

    /// Emits a move of the plane as moves of the machine: an arc in chords that deviate from it by at most `tolerance`.
    pub(super) fn emit(
        &self,
        from: &Position,
        kind: EventKind,
        seconds: f64,
        tolerance: f64,
        mut emit: impl FnMut(EventKind, f64),
    ) {
        match kind {
            EventKind::Arc { to, arc, rate } => {
                let end = Point::new(to[arc.plane.0], to[arc.plane.1]);
                let radius = (end - Point::new(arc.centre.0, arc.centre.1)).norm();
                let chords = chord_count(radius, arc.sweep, tolerance);
                for chord in 1..=chords {
                    let point = point_of_arc(from, &to, &arc, f64::from(chord) / f64::from(chords));
                    let to = self.on_machine(&point);
                    emit(EventKind::Feed { to, rate }, seconds / f64::from(chords));
                }
            }
            EventKind::Feed { to, rate } => emit(EventKind::Feed { to: self.on_machine(&to), rate }, seconds),
            EventKind::Rapid { to } => emit(EventKind::Rapid { to: self.on_machine(&to) }, seconds),
            EventKind::Skip { to, rate, has_signal } => {
                emit(EventKind::Skip { to: self.on_machine(&to), rate, has_signal }, seconds);
            }
            other => emit(other, seconds),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::motion::PlanarArc;
    use gcode_lang::units::{Deg, MmPerMin};

    /// X stays, the plane's Y points along +Y and +Z: 45° about X.
    fn plane() -> AskewPlane {
        AskewPlane::new([0, 1, 2], Matrix::about([1.0, 0.0, 0.0], 45.0))
    }

    fn at(x: f64, y: f64, z: f64) -> Position {
        let mut position = Position::default();
        (position[0], position[1], position[2]) = (x, y, z);
        position
    }

    #[test]
    fn a_point_comes_back_from_the_plane() {
        // 5·√2 along the plane's Y is 5 along Y and 5 along Z.
        assert_eq!(plane().on_machine(&at(3.0, 50.0_f64.sqrt(), 0.0)), at(3.0, 5.0, 5.0));
        assert_eq!(plane().in_plane(&at(3.0, 5.0, 5.0)), at(3.0, 7.071_067_812, 0.0));
    }

    #[test]
    fn the_chords_of_an_arc_are_on_its_circle() {
        let arc = PlanarArc { plane: (0, 1), centre: (0.0, 0.0), sweep: Deg(90.0) };
        let kind = EventKind::Arc { to: at(0.0, 10.0, 0.0), arc, rate: MmPerMin(100.0) };
        let (mut ends, mut total) = (Vec::new(), 0.0);
        plane().emit(&at(10.0, 0.0, 0.0), kind, 9.0, 0.001, |kind, seconds| {
            ends.extend(kind.end().copied());
            total += seconds;
        });
        assert_eq!(ends.last(), Some(&at(0.0, 7.071_067_812, 7.071_067_812)));
        assert!((total - 9.0).abs() < 1e-9);
        assert!(ends.iter().all(|end| (end[1] - end[2]).abs() < 1e-9), "the points are in the plane");
        let radius = |end: &Position| (end[0] * end[0] + end[1] * end[1] + end[2] * end[2]).sqrt();
        assert!(ends.iter().all(|end| (radius(end) - 10.0).abs() < 1e-8));
    }
}
