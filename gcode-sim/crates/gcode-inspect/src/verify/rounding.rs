//! Largest deviation of a hole due to the control's least increment: half an increment of each axis, and of the angle of a
//! head set by hand, with the worst signs.
use nalgebra::{Point3, Vector3};

use super::{Comparison, HolePair};
use crate::holes::DrilledHole;
use crate::machine::{Frame, HeadKind, LinkMotion, Machine};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

/// Sideways displacement of a hole's axis by half an increment of one axis, at the worse end, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AxisRounding {
    /// `None` for a head set by hand.
    letter: Option<char>,
    pub displacement: f64,
}

impl AxisRounding {
    /// Returns the letter, or `head`.
    pub(super) fn name(&self) -> String {
        self.letter.map_or("head".to_owned(), String::from)
    }
}

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
        let (mut table, mut moved) = (None, Vec::new());
        let phi = |pair: &HolePair| {
            rounding.axis_effects(pair, &mut table, &mut moved);
            2.0 * max_displacement(&moved)
        };
        rounding.position_deviations = comparison.pairs.iter().map(phi).collect();
        rounding
    }

    /// Returns the effects on one pair, the largest first.
    pub(super) fn axis_shares(&self, pair: usize) -> Vec<AxisRounding> {
        let mut moved = Vec::new();
        self.axis_effects(&self.comparison.pairs[pair], &mut None, &mut moved);
        let mut shares: Vec<AxisRounding> = moved
            .iter()
            .map(|(letter, [entry, bottom])| AxisRounding {
                letter: *letter,
                displacement: entry.norm().max(bottom.norm()),
            })
            .collect();
        // Motion along the hole, or a rotation about its own axis, has no effect.
        shares.retain(|share| 1e-7 < share.displacement);
        shares.sort_by(|a, b| b.displacement.total_cmp(&a.displacement));
        shares
    }

    /// Computes the effects on a pair. `table` holds the frames of the last pair: all holes of a row share them.
    fn axis_effects(&self, pair: &HolePair, table: &mut Option<TableFrames>, moved: &mut Vec<AxisEffect>) {
        let (nominal, drilled) =
            (&self.comparison.nominal[pair.nominal], &self.comparison.actual[pair.actual]);
        let machine = self.machine;
        if table.as_ref().is_none_or(|table| machine.table.is_moved(&table.position, &drilled.axis_position))
        {
            *table = Some(TableFrames::at(machine, &self.axes, drilled.axis_position));
        }
        let Some(table) = table else { return };
        let out = Vector3::from(nominal.axis);
        let entry = Point3::from(nominal.entry);
        let aside = |v: Vector3<f64>| v - out * v.dot(&out);
        moved.clear();
        moved.extend(self.axes.iter().zip(&table.incremented).map(|(axis, beside)| {
            let move_of = |(end, above)| {
                aside(match beside {
                    Some(beside) => beside.inverse_transform_point(&(table.frame * end)) - end,
                    None => half_increment_shift(machine, *axis, drilled, &table.frame, above),
                })
            };
            let ends = [(entry, nominal.depth), (entry - out * nominal.depth, 0.0)];
            (Some(machine.axes.letter(*axis)), ends.map(move_of))
        }));
        let by_hand = manual_head_shift(machine, drilled, &table.frame);
        moved.extend(by_hand.map(|aside| (None, [Vector3::zeros(), aside * nominal.depth])));
    }
}

/// Frames of the part at one position of the table.
struct TableFrames {
    position: Position,
    frame: Frame,
    /// The frame with each axis half an increment further; `None` for axes that do not carry the part.
    incremented: Vec<Option<Frame>>,
}

impl TableFrames {
    fn at(machine: &Machine, axes: &[AxisIndex], at: Position) -> Self {
        let beside = |axis: &AxisIndex| {
            machine.table.has_axis(*axis).then(|| {
                let mut next = at;
                next[*axis] += machine.increment.size() / 2.0;
                machine.part_frame(&next)
            })
        };
        Self { position: at, frame: machine.part_frame(&at), incremented: axes.iter().map(beside).collect() }
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

/// Returns the displacement on the part of the point at `height` above the hole's bottom by half an increment of an axis that
/// does not carry the part; `frame` is the part's.
fn half_increment_shift(
    machine: &Machine,
    axis: AxisIndex,
    drilled: &DrilledHole,
    frame: &Frame,
    height: f64,
) -> Vector3<f64> {
    let half = machine.increment.size() / 2.0;
    if let HeadKind::Axis { axis: head, .. } = machine.head.kind
        && head == axis
    {
        let length = machine.length_of(drilled.tool).unwrap_or(0.0);
        let lever = machine.head.pivot + length - height;
        let across = frame.rotation * drilled.axis.into_inner();
        let across = Vector3::new(-across.y, across.x, 0.0) * (lever * Deg(half).to_rad());
        return frame.rotation.inverse_transform_vector(&across);
    }
    let along = machine.slides.0.iter().find(|link| link.axis == axis).map(|link| match &link.motion {
        LinkMotion::Linear { along } => along.into_inner(),
        LinkMotion::Rotary { .. } => Vector3::zeros(),
    });
    frame.rotation.inverse_transform_vector(&(along.unwrap_or_default() * half))
}

/// Returns the displacement of a hole per mm of depth by half an increment of a head angle set by hand: the feed runs through
/// the entry at the rounded angle. `None` for other heads, and for an angle of whole degrees.
fn manual_head_shift(machine: &Machine, drilled: &DrilledHole, frame: &Frame) -> Option<Vector3<f64>> {
    // The axis of an unknown head is that of the feed, unless a message to the operator sets it.
    let set = match machine.head.kind {
        HeadKind::Manual { .. } => true,
        HeadKind::Free => drilled.tool_axis_deviation != Deg::ZERO,
        HeadKind::Fixed(_) | HeadKind::Axis { .. } => false,
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
