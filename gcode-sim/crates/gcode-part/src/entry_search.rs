//! Searches of the metal round holes, most of them one near the other: several at each hole, and one hole after the next.
use std::cell::RefCell;
use std::ops::Deref;
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::entry_planes::EntryPlanes;
use super::local_search::LocalSearch;

/// Metal round holes, with the holes about the last search.
#[derive(Debug)]
pub struct EntrySearch {
    planes: Arc<EntryPlanes>,
    recent: RefCell<LocalSearch>,
}

impl From<Arc<EntryPlanes>> for EntrySearch {
    fn from(planes: Arc<EntryPlanes>) -> Self {
        Self { planes, recent: RefCell::default() }
    }
}

impl Deref for EntrySearch {
    type Target = EntryPlanes;

    fn deref(&self) -> &EntryPlanes {
        &self.planes
    }
}

impl EntrySearch {
    /// Calls `each` with the holes whose metal may reach into the box from `low` to `high`.
    pub fn near(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        if !self.is_above_all(low, high) {
            self.around(low, high, each);
        }
    }

    /// Calls `each` with the same holes, in the same order, as [`EntryPlanes::around`] does.
    pub fn around(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        // A callback may search too: it has points of its own.
        let mut recent = self.recent.take();
        recent.in_box(&self.middles, &(low - self.extent), &(high + self.extent), each);
        self.recent.replace(recent);
    }

    /// Calls `each` with the holes whose room, or the space up to a height above it, may be nearer than `margin` to the box from
    /// `low` to `high`.
    pub fn below(
        &self,
        low: &Point3<f64>,
        high: &Point3<f64>,
        (margin, height): (f64, f64),
        each: &mut impl FnMut(usize),
    ) {
        let margin = Vector3::repeat(margin.max(self.room));
        // Without a common direction the space may be on any side.
        let [before, behind] = match self.top {
            Some((out, _)) => [height, -height].map(|height| out.map(|out| (out * height).max(0.0))),
            None => [Vector3::repeat(height); 2],
        };
        self.around(&(low - margin - before), &(high + margin + behind), each);
    }
}
