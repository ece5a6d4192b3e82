//! Nominal holes on the axis of another one, and what is drilled there.
use nalgebra::{Point3, Vector3};

use super::followers::{Follower, MIN_ALIKE_COSINE};
use super::matching::Comparison;
use crate::holes::DrilledHole;
use gcode_part::{Hole, PointTree};

/// Length of a part within which holes of one axis are looked for, mm.
const MAX_PART_LENGTH: f64 = 10_000.0;

impl Comparison<'_> {
    /// Returns the nominal holes that follow a through hole on its axis; none of another hole.
    pub(super) fn followers(&self, hole: &Hole) -> Vec<Follower> {
        let mut followers = Vec::new();
        if !hole.through {
            return followers;
        }
        let (entry, out) = (Point3::from(hole.entry), Vector3::from(hole.axis));
        self.entries_between(&entry, &(entry - out * MAX_PART_LENGTH), &mut |index| {
            let other = &self.nominal[index];
            if !std::ptr::eq(other, hole) {
                followers.extend(Follower::of(hole, (index, other), self.tolerances));
            }
        });
        followers
    }

    /// Calls `each` with the nominal holes whose entry is in the box of two points, or no farther from it than the tolerance of the
    /// position.
    pub(super) fn entries_between(&self, from: &Point3<f64>, to: &Point3<f64>, each: &mut impl FnMut(usize)) {
        let margin = Vector3::repeat(self.tolerances.position);
        let entries = || PointTree::new(self.nominal.iter().map(|hole| Point3::from(hole.entry)));
        let (low, high) = (from.inf(to) - margin, from.sup(to) + margin);
        self.entries.get_or_init(entries).in_box(&low, &high, each);
    }
}

impl<'a> Comparison<'a> {
    /// Iterates over the drilled holes of other nominal holes on the axis of a hole: those with the same direction, and those that go
    /// through from the opposite one.
    pub(super) fn drilled_on_axis(&self, hole: &Hole) -> impl Iterator<Item = &'a DrilledHole> {
        let (entry, out) = (Point3::from(hole.entry), Vector3::from(hole.axis));
        let mut found = Vec::new();
        let reach = out * MAX_PART_LENGTH;
        self.entries_between(&(entry + reach), &(entry - reach), &mut |index| {
            let other = &self.nominal[index];
            let to = Point3::from(other.entry) - entry;
            let aside = (to - out * to.dot(&out)).norm();
            let cosine = Vector3::from(other.axis).dot(&out);
            let is_open = MIN_ALIKE_COSINE < cosine || other.through && cosine < -MIN_ALIKE_COSINE;
            if !std::ptr::eq(other, hole) && is_open && aside <= self.tolerances.position {
                found.extend(self.pair_of(index).map(|pair| &self.actual[pair.actual]));
            }
        });
        found.into_iter()
    }
}
