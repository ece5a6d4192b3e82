//! How much of the tolerance the control's least increment uses up by itself: half an increment of every axis, and of a
//! head's angle that is set by hand, the worst way round, at the hole's place.
use nalgebra::{Point3, Vector3};

use super::{Comparison, HolePair};
use crate::holes::DrilledHole;
use crate::machine::{Frame, HeadKind, LinkMotion, Machine};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

/// What half an increment of an axis, or of the head's angle, moves the hole's axis by, sideways, at the worse end, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AxisRounding {
    /// Of the axis; `None` of a head that is set by hand.
    letter: Option<char>,
    pub displacement: f64,
}

impl AxisRounding {
    /// `X`, or `head`.
    pub(super) fn name(&self) -> String {
        self.letter.map_or("head".to_owned(), String::from)
    }
}

/// The worst cases of all pairs.
#[derive(Debug)]
pub(super) struct RoundingDeviation<'a> {
    comparison: &'a Comparison<'a>,
    machine: &'a Machine,
    /// The axes that have to be rounded at all.
    axes: Vec<AxisIndex>,
    /// What it can make of each pair's position, in their order, as a diameter in mm.
    pub position_deviations: Vec<f64>,
}

/// How both ends of a hole's axis move sideways for half an increment of an axis; `None` of a head that is set by hand.
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

    /// The axes that move this pair at all, the largest share first.
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
        // What goes along the hole, or turns a hole on the table's own axis, moves nothing sideways.
        shares.retain(|share| 1e-7 < share.displacement);
        shares.sort_by(|a, b| b.displacement.total_cmp(&a.displacement));
        shares
    }

    /// `table` is where it stood for the last pair: all holes of a row are drilled while it stands still.
    fn axis_effects(&self, pair: &HolePair, table: &mut Option<TableFrames>, moved: &mut Vec<AxisEffect>) {
        let (wanted, found) = (&self.comparison.nominal[pair.nominal], &self.comparison.actual[pair.actual]);
        let machine = self.machine;
        if table.as_ref().is_none_or(|table| machine.table.is_moved(&table.position, &found.axis_position)) {
            *table = Some(TableFrames::at(machine, &self.axes, found.axis_position));
        }
        let Some(table) = table else { return };
        let out = Vector3::from(wanted.axis);
        let entry = Point3::from(wanted.entry);
        let aside = |v: Vector3<f64>| v - out * v.dot(&out);
        moved.clear();
        moved.extend(self.axes.iter().zip(&table.incremented).map(|(axis, beside)| {
            let move_of = |(end, above)| {
                aside(match beside {
                    Some(beside) => beside.inverse_transform_point(&(table.frame * end)) - end,
                    None => half_increment_shift(machine, *axis, found, &table.frame, above),
                })
            };
            let ends = [(entry, wanted.depth), (entry - out * wanted.depth, 0.0)];
            (Some(machine.axes.letter(*axis)), ends.map(move_of))
        }));
        let by_hand = manual_head_shift(machine, found, &table.frame);
        moved.extend(by_hand.map(|aside| (None, [Vector3::zeros(), aside * wanted.depth])));
    }
}

/// The part's place while the table stands somewhere.
struct TableFrames {
    position: Position,
    frame: Frame,
    /// With each axis half an increment further; `None` of those that don't carry the part.
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

/// An axis that stands at the same whole number of mm or degrees in every hole has nothing to round.
fn rounded_axes(comparison: &Comparison<'_>, machine: &Machine) -> Vec<AxisIndex> {
    let Some(first) = comparison.pairs.first().map(|pair| comparison.actual[pair.actual].axis_position)
    else {
        return Vec::new();
    };
    let moves = |axis: AxisIndex| {
        let varies = comparison
            .pairs
            .iter()
            .any(|pair| comparison.actual[pair.actual].axis_position[axis] != first[axis]);
        machine.is_axis_used(axis) && (varies || first[axis].fract() != 0.0)
    };
    machine.axes.iter().map(|(axis, _)| axis).filter(|axis| moves(*axis)).collect()
}

/// How a point of the hole's axis, `above` its bottom, moves on the part when `axis`, which doesn't carry the part, goes half
/// an increment; `frame` is the part's where the hole was found.
fn half_increment_shift(
    machine: &Machine,
    axis: AxisIndex,
    found: &DrilledHole,
    frame: &Frame,
    height: f64,
) -> Vector3<f64> {
    let half = machine.increment.size() / 2.0;
    if let HeadKind::Axis { axis: head, .. } = machine.head.kind
        && head == axis
    {
        let length = machine.length_of(found.tool).unwrap_or(0.0);
        let lever = machine.head.pivot + length - height;
        let across = frame.rotation * found.axis.into_inner();
        let across = Vector3::new(-across.y, across.x, 0.0) * (lever * Deg(half).to_rad());
        return frame.rotation.inverse_transform_vector(&across);
    }
    let along = machine.slides.0.iter().find(|link| link.axis == axis).map(|link| match &link.motion {
        LinkMotion::Linear { along } => along.into_inner(),
        LinkMotion::Rotary { .. } => Vector3::zeros(),
    });
    frame.rotation.inverse_transform_vector(&(along.unwrap_or_default() * half))
}

/// How far a millimetre below its entry a hole stands aside when the angle that a head is set to by hand is rounded by
/// half an increment: the feed runs along the rounded angle, through the entry. An angle of whole degrees has nothing
/// to round.
fn manual_head_shift(machine: &Machine, found: &DrilledHole, frame: &Frame) -> Option<Vector3<f64>> {
    // Of a head that nobody described the axis is the feed's, unless a message to the operator set it.
    let set = match machine.head.kind {
        HeadKind::Manual { .. } => true,
        HeadKind::Free => found.tool_axis_deviation != Deg::ZERO,
        HeadKind::Fixed(_) | HeadKind::Axis { .. } => false,
    };
    let out = frame.rotation * found.axis.into_inner();
    let angle = Deg::atan2(out.y, out.x).0;
    if !set || (angle - angle.round()).abs() < 1e-9 {
        return None;
    }
    let half = Deg(machine.increment.size() / 2.0).to_rad();
    Some(frame.rotation.inverse_transform_vector(&(Vector3::new(-out.y, out.x, 0.0) * half)))
}

/// How far one end of the axis goes with the signs of all movements that together move it farthest.
fn max_displacement(moved: &[AxisEffect]) -> f64 {
    let mut farthest = 0.0f64;
    // The first sign can stay: turning all of them round changes nothing.
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
