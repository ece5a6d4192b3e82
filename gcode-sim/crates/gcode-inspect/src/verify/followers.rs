//! Holes of one axis, as in the ears of a clevis: a drill that goes through one makes the next.
use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::Tolerances;
use crate::holes::DrilledHole;
use gcode_part::Hole;

/// Cosine of the largest angle between the axes of two holes that meet.
pub(super) const MIN_ALIKE_COSINE: f64 = 0.999_999;

/// Nominal hole that follows a through hole on its axis.
pub(super) struct Follower {
    /// Index of the nominal hole.
    pub index: usize,
    /// The hole as it is seen from the upper one: if the list has it from the opposite side, it begins at its far side.
    pub hole: Hole,
    /// Depth of its far end from the entry of the upper one, mm.
    pub far: f64,
}

impl Follower {
    /// Returns the hole with its index if it follows another one.
    pub(super) fn of(upper: &Hole, (index, lower): (usize, &Hole), tolerances: Tolerances) -> Option<Self> {
        let hole = seen_along(&Vector3::from(upper.axis), lower);
        let far = follows(upper, &hole, tolerances)?;
        Some(Self { index, hole, far })
    }
}

/// Returns a hole as it is seen along a direction out of the part: from its far side, if it goes through and is listed from
/// there.
fn seen_along(out: &Vector3<f64>, hole: &Hole) -> Hole {
    let is_opposite = out.dot(&Vector3::from(hole.axis)) < 0.0;
    if is_opposite && hole.through { hole.from_far_side() } else { hole.clone() }
}

/// Returns the depth of a hole that follows another one on its axis and in its direction, from the entry of the upper one; `None` if
/// it does not.
fn follows(upper: &Hole, lower: &Hole, tolerances: Tolerances) -> Option<f64> {
    let out = Vector3::from(upper.axis);
    let offset = Point3::from(lower.entry) - Point3::from(upper.entry);
    let begins = -offset.dot(&out);
    let is_alike = MIN_ALIKE_COSINE < out.dot(&Vector3::from(lower.axis));
    let is_on_axis = offset.cross(&out).norm() <= tolerances.position / 2.0;
    (is_alike && is_on_axis && upper.depth + tolerances.depth < begins).then_some(begins + lower.depth)
}

/// Returns for each missing through hole the first of its candidates, nominal and drilled hole, that leads through it and through
/// another hole on its axis, before or behind it. `partners` has the nominal hole of each drilled one that is matched.
pub(super) fn shared_passages(
    nominal: &[Hole],
    actual: &[DrilledHole],
    missing: impl Iterator<Item = (usize, usize)>,
    partners: &BTreeMap<usize, usize>,
    tolerances: Tolerances,
) -> BTreeMap<usize, usize> {
    let mut shared = BTreeMap::new();
    for (index, drilled_index) in missing {
        let drilled = &actual[drilled_index];
        let hole = seen_along(&drilled.axis, &nominal[index]);
        let depth = |point: &Point3<f64>| (Point3::from(hole.entry) - point).dot(&Vector3::from(hole.axis));
        let leads_through = depth(&drilled.entry) <= 0.0 && hole.depth <= depth(&drilled.bottom());
        let is_same_size = |other: &Hole| {
            let other = seen_along(&drilled.axis, other);
            let is_before_or_behind = || {
                follows(&hole, &other, tolerances).is_some() || follows(&other, &hole, tolerances).is_some()
            };
            hole.widest_diameter() == other.widest_diameter() && is_before_or_behind()
        };
        let has_partner = partners.get(&drilled_index).is_some_and(|other| is_same_size(&nominal[*other]));
        if hole.through && leads_through && has_partner {
            shared.entry(index).or_insert(drilled_index);
        }
    }
    shared
}
