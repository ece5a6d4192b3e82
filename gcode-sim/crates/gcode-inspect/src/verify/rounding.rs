//! Largest deviation of a hole due to the control's least increment: half an increment of each axis, and of the angle of a
//! head set by hand, with the worst signs.
use nalgebra::{Point3, Unit, Vector3};

use super::{Comparison, HolePair, bottom};
use crate::holes::DrilledHole;
use crate::machine::{Frame, HeadKind, Machine};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::shares;
use gcode_lang::units::Deg;

/// The largest effect of rounding on each pair.
#[derive(Debug)]
pub(super) struct RoundingDeviation<'a> {
    comparison: &'a Comparison<'a>,
    machine: &'a Machine,
    /// The axes whose positions are rounded.
    axes: Vec<AxisIndex>,
    /// Largest position deviation of each pair, a diameter, mm.
    pub position_deviations: Vec<f64>,
}

/// Sideways displacement of both ends of a hole's axis, with the letter of the axis; `None` for a head set by hand.
type AxisEffect = (Option<char>, [Vector3<f64>; 2]);

impl<'a> RoundingDeviation<'a> {
    pub(super) fn of(comparison: &'a Comparison<'a>, machine: &'a Machine) -> Self {
        let axes = rounded_axes(comparison, machine);
        let mut rounding = Self { comparison, machine, axes, position_deviations: Vec::new() };
        let deviation = |pair: &HolePair| 2.0 * max_displacement(&rounding.axis_effects(pair));
        rounding.position_deviations = shares::map(&comparison.pairs, deviation);
        rounding
    }

    /// Returns the name of each axis that displaces a pair, `X` or `head`, with the displacement at the worse end, mm; the
    /// largest first.
    pub(super) fn axis_shares(&self, pair: usize) -> Vec<(String, f64)> {
        let effects = self.axis_effects(&self.comparison.pairs[pair]).into_iter();
        let share = |(letter, [entry, bottom]): AxisEffect| {
            (letter.map_or("head".to_owned(), String::from), entry.norm().max(bottom.norm()))
        };
        // Motion along the hole, or a rotation about its own axis, has no effect.
        let mut shares: Vec<_> =
            effects.map(share).filter(|(_, displacement)| 1e-7 < *displacement).collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }

    fn axis_effects(&self, pair: &HolePair) -> Vec<AxisEffect> {
        let (nominal, drilled) =
            (&self.comparison.nominal[pair.nominal], &self.comparison.actual[pair.actual]);
        let frame = self.machine.part_frame(&drilled.axis_position);
        let out = Vector3::from(nominal.axis);
        let ends = [(Point3::from(nominal.entry), nominal.depth), (bottom(nominal), 0.0)];
        let of_axis = |axis: &AxisIndex| {
            let moved = half_increment_frame(self.machine, *axis, drilled);
            let effects = ends.map(|(point, height)| {
                let shift = match &moved {
                    Some(moved) => moved.inverse_transform_point(&(frame * point)) - point,
                    None => half_increment_shift(self.machine, *axis, drilled, &frame, height),
                };
                shift - out * shift.dot(&out)
            });
            (Some(self.machine.axes.letter(*axis)), effects)
        };
        let by_hand = manual_head_shift(self.machine, drilled, &frame);
        let by_hand = by_hand.map(|shift| (None, [Vector3::zeros(), shift * nominal.depth]));
        self.axes.iter().map(of_axis).chain(by_hand).collect()
    }
}

/// Returns the axes in use, without those at one whole number of mm or degrees in every hole.
fn rounded_axes(comparison: &Comparison<'_>, machine: &Machine) -> Vec<AxisIndex> {
    let positions = || comparison.matched().map(|(.., drilled)| drilled.axis_position);
    let Some(first) = positions().next() else { return Vec::new() };
    let is_rounded = |axis: &AxisIndex| {
        let varies = positions().any(|position| position[*axis] != first[*axis]);
        machine.is_axis_used(*axis) && (varies || first[*axis].fract() != 0.0)
    };
    machine.axes.iter().map(|(axis, _)| axis).filter(is_rounded).collect()
}

/// Returns the part's frame with an axis half an increment farther; `None` for an axis that does not carry the part.
fn half_increment_frame(machine: &Machine, axis: AxisIndex, drilled: &DrilledHole) -> Option<Frame> {
    let mut next = drilled.axis_position;
    next[axis] += machine.increment.size() / 2.0;
    machine.table.has_axis(axis).then(|| machine.part_frame(&next))
}

/// Returns the displacement on the part of a point of the hole's axis, at `height` above the bottom, by half an increment of
/// an axis that carries the tool; `frame` is the part's.
fn half_increment_shift(
    machine: &Machine,
    axis: AxisIndex,
    drilled: &DrilledHole,
    frame: &Frame,
    height: f64,
) -> Vector3<f64> {
    let mut half = Position::default();
    half[axis] = machine.increment.size() / 2.0;
    let shift = match machine.head.kind {
        HeadKind::Axis { axis: head, .. } if head == axis => {
            let lever = machine.head.pivot + machine.length_of(drilled.tool).unwrap_or(0.0) - height;
            let out = frame.rotation * drilled.axis.into_inner();
            Vector3::new(-out.y, out.x, 0.0) * (lever * Deg(half[axis]).to_rad())
        }
        HeadKind::Axes { .. } if machine.head.has_axis(axis) => {
            let reach = machine.head.pivot + machine.length_of(drilled.tool).unwrap_or(0.0) - height;
            let mut next = drilled.axis_position;
            next[axis] += half[axis];
            let out = Unit::new_normalize(frame.rotation * drilled.axis.into_inner());
            machine.head.tip_displacement(&next, &out, reach)
                - machine.head.tip_displacement(&drilled.axis_position, &out, reach)
        }
        _ => machine.slides.displacement(&half),
    };
    frame.rotation.inverse_transform_vector(&shift)
}

/// Returns the displacement of a hole per mm of depth by half an increment of a head angle set by hand: the feed runs through
/// the entry at the rounded angle. `None` for other heads, and for an angle of whole degrees.
fn manual_head_shift(machine: &Machine, drilled: &DrilledHole, frame: &Frame) -> Option<Vector3<f64>> {
    // The axis of an unknown head is that of the feed, unless a message to the operator sets it.
    let set = match machine.head.kind {
        HeadKind::Manual { .. } => true,
        HeadKind::Free => drilled.is_tool_axis_known,
        HeadKind::Fixed(_) | HeadKind::Axis { .. } | HeadKind::Axes { .. } => false,
    };
    let out = frame.rotation * drilled.axis.into_inner();
    let angle = Deg::atan2(out.y, out.x).0;
    if !set || (angle - angle.round()).abs() < 1e-9 {
        return None;
    }
    let half = Deg(machine.increment.size() / 2.0).to_rad();
    Some(frame.rotation.inverse_transform_vector(&(Vector3::new(-out.y, out.x, 0.0) * half)))
}

/// Returns the largest displacement of an end over all combinations of signs.
fn max_displacement(moved: &[AxisEffect]) -> f64 {
    let mut farthest = 0.0f64;
    // The first sign is fixed: reversing all of them changes nothing.
    for signs in 0..1u32 << moved.len().saturating_sub(1) {
        for end in 0..2 {
            let sum = moved.iter().enumerate().fold(Vector3::zeros(), |sum, (i, (_, ends))| {
                if signs >> i & 1 == 1 { sum - ends[end] } else { sum + ends[end] }
            });
            farthest = farthest.max(sum.norm_squared());
        }
    }
    farthest.sqrt()
}
