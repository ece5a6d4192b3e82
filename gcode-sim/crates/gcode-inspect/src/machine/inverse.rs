//! Inverse kinematics in closed form, for the arrangements that have one: from a tip and a direction on the
//! part to the axes.
use nalgebra::{Point3, Unit, Vector3};

use super::{HeadKind, LinkMotion, Machine, Setup};
use gcode_lang::motion::Position;
use gcode_lang::units::Deg;

impl Machine {
    /// Returns every position at which a tool pointing out of the part along `axis` has its tip at `tip`, on
    /// a machine without errors.
    ///
    /// The closed form covers one rotary table under three slides, and a head that tilts in the plane of X
    /// and Y. The table has to rotate `axis` into that plane, which has two solutions. If `axis` is the
    /// table's own axis, any angle fits; the solution then rotates the tip itself into the plane z of the
    /// table's centre. Empty if no solution exists.
    pub fn inverse(&self, tip: Point3<f64>, axis: Unit<Vector3<f64>>, setup: &Setup) -> Vec<Position> {
        let [table] = self.table.0.as_slice() else { return Vec::new() };
        let LinkMotion::Rotary { about, centre } = &table.motion else { return Vec::new() };
        let placed = self.part.frame();
        let (tip, axis) = (placed * tip, placed.rotation * axis.into_inner());
        let arm = tip - centre;
        let mut angles = match &self.head.kind {
            HeadKind::Fixed(direction) => angle_between(about, axis, direction.into_inner()),
            HeadKind::Free | HeadKind::Manual { .. } | HeadKind::Axis { .. } => angles_to_plane(about, axis),
            HeadKind::Axes { .. } => return Vec::new(),
        };
        if angles.is_empty() {
            angles = angles_to_plane(about, arm);
        }
        if angles.is_empty() && about.cross(&axis).norm() < 1e-12 {
            angles = vec![Deg::ZERO];
        }
        let positions = angles.into_iter().filter_map(|angle| {
            let mut at = Position::default();
            at[table.axis] = table.sign * angle.0;
            self.solve_slides(tip, axis, at, setup)
        });
        positions.collect()
    }

    /// Solves the slides and the head for a table position in `at`; `None` if the tip cannot be reached.
    fn solve_slides(
        &self,
        tip: Point3<f64>,
        axis: Vector3<f64>,
        mut at: Position,
        setup: &Setup,
    ) -> Option<Position> {
        let table = self.table.frame(&at);
        let (tip, axis) = (table * tip, table.rotation * axis);
        let angle = Deg::atan2(axis.y, axis.x);
        let mut setup = *setup;
        match self.head.kind {
            HeadKind::Axes { .. } => return None,
            HeadKind::Free | HeadKind::Manual { .. } => setup.head_angle = Some(angle),
            HeadKind::Axis { axis: head, sign, zero } => at[head] = sign * (angle - zero).0,
            HeadKind::Fixed(direction) => {
                if (direction.into_inner() - axis).norm() > 1e-9 {
                    return None;
                }
            }
        }
        let there = self.tool_pose(&at, &setup).tip;
        let missing = tip - there;
        for link in &self.slides.0 {
            if let LinkMotion::Linear { along } = &link.motion {
                at[link.axis] += link.sign * along.dot(&missing);
            }
        }
        ((self.tool_pose(&at, &setup).tip - tip).norm() < 1e-6).then_some(at)
    }
}

/// Returns the rotations about `about` that make the z of `v` 0; empty if rotation does not change its z.
fn angles_to_plane(about: &Unit<Vector3<f64>>, v: Vector3<f64>) -> Vec<Deg> {
    // The z of the rotated vector is m + p·cos γ + q·sin γ (Rodrigues).
    let along = about.into_inner() * about.dot(&v);
    let across = v - along;
    let (m, p, q) = (along.z, across.z, about.cross(&across).z);
    let size = (p * p + q * q).sqrt();
    if size < 1e-12 || size < m.abs() {
        return Vec::new();
    }
    let (middle, half) = (Deg::atan2(q, p), Deg::acos(-m / size));
    vec![middle + half, middle - half]
}

/// Returns the rotation about `about` that brings `v` towards `goal`; empty if one of them is along `about`.
fn angle_between(about: &Unit<Vector3<f64>>, v: Vector3<f64>, goal: Vector3<f64>) -> Vec<Deg> {
    let (from, to) = (about.cross(&v), about.cross(&goal));
    if from.norm() < 1e-12 || to.norm() < 1e-12 {
        return Vec::new();
    }
    vec![Deg::atan2(about.dot(&from.cross(&to)), from.dot(&to))]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::machine::{AxisLink, Head, Placement};

    proptest! {
        /// Forward kinematics is the definition: the solution must bring the tool there.
        #[test]
        fn forward_of_inverse_is_where_it_should_be(
            (x, y, z) in (-900.0..900.0, 1.0..900.0, -900.0..900.0),
            (polar, azimuth) in (0.5..89.5, -720.0..720.0),
            (sign, cx, cz) in (prop_oneof![Just(1.0), Just(-1.0)], -50.0..50.0, -50.0..50.0),
            (pivot, length, by_axis) in (0.0..300.0, 0.0..200.0, any::<bool>()),
            tilt in -2.0..2.0,
        ) {
            let mut machine = Machine::default();
            machine.table.0 = vec![AxisLink::rotary(4, Vector3::y_axis(), Point3::new(cx, 3.0, cz), sign)];
            machine.part = Placement {
                origin: Point3::new(cx, 7.0, cz),
                shift: Vector3::new(0.1, -0.2, 0.3),
                tilt: [Deg(tilt), Deg(0.5), Deg(-tilt)],
            };
            let kind = if by_axis {
                HeadKind::Axis { axis: 3, sign, zero: Deg(90.0) }
            } else {
                HeadKind::Manual { start: None }
            };
            machine.head = Head::new(kind, pivot);
            let out = Vector3::new(
                Deg(polar).sin() * Deg(azimuth).cos(),
                Deg(polar).cos(),
                Deg(polar).sin() * Deg(azimuth).sin(),
            );
            let axis = Unit::new_normalize(out);
            let mut setup = Setup::default();
            setup.offset[2] = length;
            let found = machine.inverse(Point3::new(x, y, z), axis, &setup);
            prop_assert_eq!(found.len(), 2);
            for at in found {
                // A head set by hand is set to the direction in the plane, which forward kinematics gives.
                let here = machine.part_frame(&at).rotation * axis.into_inner();
                prop_assert!(here.z.abs() < 1e-12);
                setup.head_angle = Some(Deg::atan2(here.y, here.x));
                let pose = machine.forward(&at, &setup);
                prop_assert!((pose.tip - Point3::new(x, y, z)).norm() < 1e-9);
                prop_assert!((pose.axis.unwrap().into_inner() - axis.into_inner()).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn an_axial_hole_is_brought_into_the_plane_by_its_position() {
        let machine = Machine::default();
        let found = machine.inverse(Point3::new(0.0, 50.0, 80.0), Vector3::y_axis(), &Setup::default());
        let b: Vec<f64> = found.iter().map(|at| at[4]).collect();
        assert!(b.iter().any(|b| (b - 90.0).abs() < 1e-9), "{b:?}");
        assert!(found.iter().all(|at| at[2].abs() < 1e-9 && (at[0].abs() - 80.0).abs() < 1e-9));
    }

    #[test]
    fn a_fixed_head_reaches_only_its_own_direction() {
        let mut machine = Machine::default();
        machine.head.kind = HeadKind::Fixed(Vector3::y_axis());
        let sideways = Unit::new_normalize(Vector3::new(1.0, 1.0, 0.0));
        assert!(machine.inverse(Point3::new(5.0, 5.0, 0.0), sideways, &Setup::default()).is_empty());
    }

    /// A honeycomb hole: radial in a part that rotates about X, drilled along Z.
    #[test]
    fn a_fixed_head_needs_the_table_alone_for_a_radial_hole() {
        let mut machine = Machine::default();
        machine.head.kind = HeadKind::Fixed(Vector3::z_axis());
        machine.table.0 = vec![AxisLink::rotary(3, Vector3::x_axis(), Point3::origin(), 1.0)];
        let out = Unit::new_unchecked(Vector3::new(0.0, Deg(50.0).sin(), Deg(50.0).cos()));
        let tip = Point3::from(out.into_inner() * 250.0 + Vector3::x() * 20.0);
        let found = machine.inverse(tip, out, &Setup::default());
        // Rotating (y, z) about +x by 50° takes (sin 50°, cos 50°) to (0, 1).
        let expected = [20.0, 0.0, 250.0, 50.0];
        assert_eq!(found.len(), 1);
        assert!(expected.iter().enumerate().all(|(i, v)| (found[0][i] - v).abs() < 1e-9), "{found:?}");
    }
}
