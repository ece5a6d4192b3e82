//! How much of the tolerance the control's least increment uses up by itself: half an increment of every axis, and of a
//! head's angle that is set by hand, the worst way round, at the hole's place.
use nalgebra::{Point3, Vector3};

use super::Comparison;
use crate::holes::Found;
use crate::machine::{Frame, HeadKind, LinkMotion, Machine};
use crate::motion::Axis;
use crate::units::Deg;

/// What half an increment of an axis, or of the head's angle, moves the hole's axis by, sideways, at the worse end, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Of the axis; `None` of a head that is set by hand.
    pub letter: Option<char>,
    pub moves: f64,
}

impl Share {
    /// `X`, or `head`.
    pub fn name(&self) -> String {
        self.letter.map_or("head".to_owned(), String::from)
    }
}

/// The worst case for one hole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rounding {
    /// Of the position, as a diameter in mm.
    pub phi: f64,
    /// The axes that have to be rounded at all, the largest share first.
    pub shares: Vec<Share>,
}

/// For every pair, in order.
pub(super) fn shares(comparison: &Comparison<'_>, machine: &Machine) -> Vec<Rounding> {
    let axes = rounded_axes(comparison, machine);
    let each = comparison.pairs.iter().map(|pair| {
        let wanted = &comparison.wanted[pair.wanted];
        let out = Vector3::from(wanted.axis);
        let entry = Point3::from(wanted.entry);
        let found = &comparison.found[pair.found];
        let frame = machine.part_frame(&found.at);
        let moved = axes.iter().map(|axis| {
            let aside = |v: Vector3<f64>| v - out * v.dot(&out);
            let ends = [(entry, wanted.depth), (entry - out * wanted.depth, 0.0)];
            let move_of = |(end, above)| aside(half_increment(machine, *axis, found, &frame, &end, above));
            (Some(machine.axes.letter(*axis)), ends.map(move_of))
        });
        let by_hand = head_by_hand(machine, found, &frame)
            .map(|aside| (None, [Vector3::zeros(), aside * wanted.depth]));
        worst_case(moved.chain(by_hand).collect())
    });
    each.collect()
}

/// An axis that stands at the same whole number of mm or degrees in every hole has nothing to round.
fn rounded_axes(comparison: &Comparison<'_>, machine: &Machine) -> Vec<Axis> {
    let Some(first) = comparison.pairs.first().map(|pair| comparison.found[pair.found].at) else {
        return Vec::new();
    };
    let moves = |axis: Axis| {
        let varies = comparison.pairs.iter().any(|pair| comparison.found[pair.found].at[axis] != first[axis]);
        machine.carries(axis) && (varies || first[axis].fract() != 0.0)
    };
    machine.axes.iter().map(|(axis, _)| axis).filter(|axis| moves(*axis)).collect()
}

/// How a point of the hole's axis, `above` its bottom, moves on the part when `axis` goes half an increment; `frame` is
/// the part's where the hole was found.
fn half_increment(
    machine: &Machine,
    axis: Axis,
    found: &Found,
    frame: &Frame,
    point: &Point3<f64>,
    above: f64,
) -> Vector3<f64> {
    let half = machine.increment.size() / 2.0;
    if machine.table.has(axis) {
        let mut next = found.at;
        next[axis] += half;
        let there = frame * point;
        return machine.part_frame(&next).inverse_transform_point(&there) - point;
    }
    if let HeadKind::Axis { axis: head, .. } = machine.head.kind
        && head == axis
    {
        let length = machine.length_of(found.tool).unwrap_or(0.0);
        let lever = machine.head.pivot + length - above;
        let across = frame.rotation * found.axis.into_inner();
        let across = Vector3::new(-across.y, across.x, 0.0) * (lever * Deg(half).to_rad());
        return frame.rotation.inverse_transform_vector(&across);
    }
    let along = machine.slides.0.iter().find(|link| link.axis == axis).map(|link| match &link.motion {
        LinkMotion::Slide { along } => along.into_inner(),
        LinkMotion::Turn { .. } => Vector3::zeros(),
    });
    frame.rotation.inverse_transform_vector(&(along.unwrap_or_default() * half))
}

/// How far a millimetre below its entry a hole stands aside when the angle that a head is set to by hand is rounded by
/// half an increment: the feed runs along the rounded angle, through the entry. An angle of whole degrees has nothing
/// to round.
fn head_by_hand(machine: &Machine, found: &Found, frame: &Frame) -> Option<Vector3<f64>> {
    // Of a head that nobody described the axis is the feed's, unless a message to the operator set it.
    let set = match machine.head.kind {
        HeadKind::Manual { .. } => true,
        HeadKind::Free => found.off_tool != Deg::ZERO,
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

/// The signs of all movements that together move one end of the axis farthest.
fn worst_case(moved: Vec<(Option<char>, [Vector3<f64>; 2])>) -> Rounding {
    let mut worst = 0.0f64;
    // The first sign can stay: turning all of them round changes nothing.
    for signs in 0..1u32 << moved.len().saturating_sub(1) {
        for end in 0..2 {
            let sum = moved.iter().enumerate().fold(Vector3::zeros(), |sum, (i, (_, ends))| {
                if signs >> i & 1 == 1 { sum - ends[end] } else { sum + ends[end] }
            });
            worst = worst.max(sum.norm());
        }
    }
    let mut shares: Vec<Share> = moved
        .iter()
        .map(|(letter, [entry, bottom])| Share { letter: *letter, moves: entry.norm().max(bottom.norm()) })
        .collect();
    // What goes along the hole, or turns a hole on the table's own axis, moves nothing sideways.
    shares.retain(|share| 1e-7 < share.moves);
    shares.sort_by(|a, b| b.moves.total_cmp(&a.moves));
    Rounding { phi: 2.0 * worst, shares }
}
