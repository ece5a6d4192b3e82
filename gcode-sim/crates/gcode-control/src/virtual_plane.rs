//! Virtual planes of polar and cylindrical interpolation: the control computes in lengths, and a rotary axis turns on the
//! machine.
use super::kinematics::remove_noise;
use super::plane_arc::point_of_arc;
use gcode_lang::motion::{AxisIndex, EventKind, Position};
use gcode_lang::program::modes::Plane;
use gcode_lang::units::Deg;

/// Pieces of a path that halving can make at most.
const MAX_DEPTH: u32 = 20;

/// Pieces that an arc is divided into before the halving, so that none begins and ends at one point.
const FIRST_PIECES: u32 = 8;

/// Surface of the machine that a virtual plane represents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum VirtualSurface {
    /// G12.1: the plane square to the rotary axis, with the linear axis as its radius.
    Disc {
        /// −1 where the mode began on the minus side of the linear axis.
        side: f64,
    },
    /// G07.1: the developed cylinder; the rotary axis is its virtual axis.
    Cylinder {
        /// Length on the circumference, mm for each degree.
        mm_per_degree: f64,
    },
    /// G107 of a Haas: the developed cylinder; the linear axis is its virtual axis and stands still.
    WrappedAxis {
        /// Length on the circumference, mm for each degree.
        mm_per_degree: f64,
        /// Machine coordinate at which the linear axis stands.
        rest: f64,
    },
}

/// Mode in which machine positions of the control are those of a virtual plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VirtualPlane {
    pub(super) surface: VirtualSurface,
    /// Axis that stays linear.
    pub(super) linear: AxisIndex,
    pub(super) rotary: AxisIndex,
    /// Machine coordinates of both axes at which the coordinates of the plane are 0.
    pub(super) origin: (f64, f64),
    /// Machine position of the rotary axis there, degrees.
    pub(super) start_angle: f64,
    /// Last position that was emitted: in the plane, and on the machine.
    pub(super) virtual_position: Position,
    pub(super) machine_position: Position,
    /// Plane that was selected before.
    pub(super) selected: Plane,
}

impl VirtualPlane {
    /// Returns the axis whose coordinate is a length in the plane and an angle on the machine.
    pub(super) fn virtual_axis(&self) -> AxisIndex {
        match self.surface {
            VirtualSurface::Disc { .. } | VirtualSurface::Cylinder { .. } => self.rotary,
            VirtualSurface::WrappedAxis { .. } => self.linear,
        }
    }

    /// Returns the factor from a programmed number of the rotary axis to a coordinate of the plane.
    pub(super) fn scale(&self) -> f64 {
        match self.surface {
            VirtualSurface::Cylinder { mm_per_degree } => mm_per_degree,
            VirtualSurface::Disc { .. } | VirtualSurface::WrappedAxis { .. } => 1.0,
        }
    }

    /// Returns the machine position of a point of the plane; of several angles the one next to `near`.
    pub(super) fn on_machine(&self, point: &Position, near: f64) -> Position {
        let mut machine = *point;
        let (x, y) = (point[self.linear] - self.origin.0, point[self.rotary] - self.origin.1);
        match self.surface {
            VirtualSurface::Disc { side } => {
                let radius = libm::hypot(x, y);
                machine[self.linear] = remove_noise(self.origin.0 + side * radius);
                let angle = match radius < 1e-9 {
                    true => near,
                    false => self.start_angle + Deg::atan2(side * y, side * x).0,
                };
                machine[self.rotary] = remove_noise(angle + 360.0 * ((near - angle) / 360.0).round());
            }
            VirtualSurface::Cylinder { mm_per_degree } => {
                machine[self.rotary] = remove_noise(self.start_angle + y / mm_per_degree);
            }
            VirtualSurface::WrappedAxis { mm_per_degree, rest } => {
                machine[self.linear] = rest;
                machine[self.rotary] = remove_noise(self.start_angle + x / mm_per_degree);
            }
        }
        machine
    }

    /// Returns the coordinates in the plane of a machine position.
    fn in_plane(&self, machine: &Position) -> (f64, f64) {
        let angle = machine[self.rotary] - self.start_angle;
        match self.surface {
            VirtualSurface::Disc { .. } => {
                let radius = machine[self.linear] - self.origin.0;
                (self.origin.0 + radius * Deg(angle).cos(), self.origin.1 + radius * Deg(angle).sin())
            }
            VirtualSurface::Cylinder { mm_per_degree } => {
                (machine[self.linear], self.origin.1 + angle * mm_per_degree)
            }
            VirtualSurface::WrappedAxis { mm_per_degree, .. } => (self.origin.0 + angle * mm_per_degree, 0.0),
        }
    }

    /// Emits an event of the plane as events of the machine: a path in pieces that deviate from it by `tolerance` at most.
    pub(super) fn emit(
        &mut self,
        kind: &EventKind,
        seconds: f64,
        tolerance: f64,
        emit: &mut impl FnMut(EventKind, f64),
    ) {
        let from = self.virtual_position;
        let Some(to) = kind.end().copied() else { return emit(kind.clone(), seconds) };
        match kind {
            EventKind::Feed { rate, .. } => {
                let between = |fraction: f64| {
                    Position(std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * fraction))
                };
                let pieces = if matches!(self.surface, VirtualSurface::Disc { .. }) {
                    self.pieces(&between, 1, tolerance)
                } else {
                    vec![1.0]
                };
                self.emit_pieces(&between, &pieces, seconds, |to| EventKind::Feed { to, rate: *rate }, emit);
            }
            EventKind::Arc { arc, rate, .. } => {
                let on_arc = |fraction: f64| point_of_arc(&from, &to, arc, fraction);
                let pieces = self.pieces(&on_arc, FIRST_PIECES, tolerance);
                self.emit_pieces(&on_arc, &pieces, seconds, |to| EventKind::Feed { to, rate: *rate }, emit);
            }
            _ => {
                let machine = self.on_machine(&to, self.machine_position[self.rotary]);
                if machine != self.machine_position {
                    emit(EventKind::Rapid { to: machine }, seconds);
                }
                self.machine_position = machine;
            }
        }
        self.virtual_position = to;
    }

    fn emit_pieces(
        &mut self,
        path: &impl Fn(f64) -> Position,
        pieces: &[f64],
        seconds: f64,
        feed: impl Fn(Position) -> EventKind,
        emit: &mut impl FnMut(EventKind, f64),
    ) {
        let mut before = 0.0;
        for fraction in pieces {
            let machine = self.on_machine(&path(*fraction), self.machine_position[self.rotary]);
            if machine != self.machine_position {
                emit(feed(machine), seconds * (fraction - before));
            }
            (self.machine_position, before) = (machine, *fraction);
        }
    }

    /// Returns the ends of the pieces of a path, as fractions of it: even motion of the axes between them stays within the
    /// tolerance.
    fn pieces(&self, path: &impl Fn(f64) -> Position, first: u32, tolerance: f64) -> Vec<f64> {
        let mut ends = Vec::new();
        let mut at = self.machine_position;
        for piece in 0..first {
            let part = |number: u32| f64::from(number) / f64::from(first);
            at = self.divide(path, (part(piece), part(piece + 1)), at, (tolerance, MAX_DEPTH), &mut ends);
        }
        ends
    }

    /// Halves a piece of a path until its tests are within the tolerance; returns the machine position at its end.
    fn divide(
        &self,
        path: &impl Fn(f64) -> Position,
        (start, end): (f64, f64),
        from: Position,
        (tolerance, depth): (f64, u32),
        ends: &mut Vec<f64>,
    ) -> Position {
        let to = self.on_machine(&path(end), from[self.rotary]);
        let is_close = |share: f64| {
            let at = Position(std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share));
            let (x, y) = self.in_plane(&at);
            let nominal = path(start + (end - start) * share);
            let across = match self.surface {
                VirtualSurface::Disc { .. } => {
                    libm::hypot(x - nominal[self.linear], y - nominal[self.rotary])
                }
                VirtualSurface::Cylinder { .. } => {
                    libm::hypot(x - nominal[self.linear], y - nominal[self.rotary])
                }
                VirtualSurface::WrappedAxis { .. } => (x - nominal[self.linear]).abs(),
            };
            let other = (0..at.0.len()).filter(|axis| *axis != self.linear && *axis != self.rotary);
            let along = other.map(|axis| (at[axis] - nominal[axis]).abs()).fold(0.0, f64::max);
            across.max(along) <= tolerance
        };
        if depth == 0 || [0.25, 0.5, 0.75].into_iter().all(is_close) {
            ends.push(end);
            return to;
        }
        let middle = (start + end) / 2.0;
        let at = self.divide(path, (start, middle), from, (tolerance, depth - 1), ends);
        self.divide(path, (middle, end), at, (tolerance, depth - 1), ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::motion::PlanarArc;
    use gcode_lang::units::MmPerMin;

    /// X and C with the centre at X 0, at X 10 and C 0.
    fn disc() -> VirtualPlane {
        let mut at = Position::default();
        at[0] = 10.0;
        VirtualPlane {
            surface: VirtualSurface::Disc { side: 1.0 },
            linear: 0,
            rotary: 5,
            origin: (0.0, 0.0),
            start_angle: 0.0,
            virtual_position: at,
            machine_position: at,
            selected: Plane::Xy,
        }
    }

    fn run(plane: &mut VirtualPlane, kind: &EventKind) -> Vec<(f64, f64)> {
        let mut ends = Vec::new();
        plane.emit(kind, 1.0, 0.001, &mut |kind, _| {
            let to = *kind.end().unwrap();
            ends.push((to[0], to[5]));
        });
        ends
    }

    fn feed(x: f64, c: f64) -> EventKind {
        let mut to = Position::default();
        (to[0], to[5]) = (x, c);
        EventKind::Feed { to, rate: MmPerMin(100.0) }
    }

    #[test]
    fn a_straight_line_in_the_plane_stays_one_on_the_part() {
        let mut plane = disc();
        let ends = run(&mut plane, &feed(10.0, 10.0));
        assert_eq!(ends.last(), Some(&(remove_noise(200.0_f64.sqrt()), 45.0)));
        let mut before: (f64, f64) = (10.0, 0.0);
        for (x, c) in ends {
            // The line is X = 10: r·cos C is 10 at the ends, and between them to a micron.
            for share in [0.0, 0.3, 0.5, 0.7] {
                let (r, angle) = (before.0 + (x - before.0) * share, before.1 + (c - before.1) * share);
                assert!((r * Deg(angle).cos() - 10.0).abs() < 0.001, "{r} {angle}");
            }
            before = (x, c);
        }
    }

    #[test]
    fn a_line_through_the_centre_turns_the_table_there() {
        let mut plane = disc();
        let ends = run(&mut plane, &feed(-10.0, 0.0));
        assert!(ends.iter().all(|(x, _)| *x >= 0.0), "the radius keeps its side");
        let (x, c) = *ends.last().unwrap();
        assert_eq!((x, c.abs()), (10.0, 180.0));
    }

    #[test]
    fn a_circle_round_the_centre_is_one_turn_of_the_table() {
        let mut plane = disc();
        let arc = PlanarArc { plane: (0, 5), centre: (0.0, 0.0), sweep: Deg(360.0) };
        let to = plane.virtual_position;
        let ends = run(&mut plane, &EventKind::Arc { to, arc, rate: MmPerMin(100.0) });
        assert_eq!(ends.last(), Some(&(10.0, 360.0)));
        assert!(ends.iter().all(|(x, _)| (x - 10.0).abs() < 1e-9));
    }
}
