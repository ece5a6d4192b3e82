//! Passes of a hole that end elsewhere though the hole is finished as before, or otherwise than it: a pilot's, a spot drilling's.
use super::hole_groups::deeper;
use super::passes::Passes;
use super::record::Record;
use super::steps::{Step, difference, goes_with, near};
use super::words::coordinates;
use crate::motion::{Axes, MAX_AXES, Position};

/// Such a pass.
#[derive(Clone, Debug)]
pub(super) struct Strayed {
    /// Its feed, before and now, by their numbers in either run.
    pub steps: (usize, usize),
    /// How far the feed ends from where it ended, in machine coordinates.
    shift: Position,
    /// How much of that is along the feed, mm.
    pub deeper: f64,
    /// Nothing of it is aside.
    is_along: bool,
    /// Of how many passes which it is, counted from 1, and its tool now.
    number: (usize, usize),
    tool: Option<u32>,
}

/// Of a hole that is there before and now, and is `hole_deeper` mm deeper. Where it is made by more passes or fewer, that is told.
pub(super) fn strayed(
    old: &Record,
    new: &Record,
    (hole, other): (usize, usize),
    passes: &(Passes, Passes),
    hole_deeper: f64,
    tolerance: f64,
) -> Vec<Strayed> {
    let (was, is) = (&passes.0.steps[hole], &passes.1.steps[other]);
    let last = old.feeds[hole].last().zip(new.feeds[other].last());
    let Some((i, j)) = last.filter(|_| was.len() == is.len()) else { return Vec::new() };
    let finish = (&old.steps[*i], &new.steps[*j]);
    let stays = |a: &Step, b: &Step| near(&a.to, &b.to, tolerance);
    let is_finished_as_before = stays(finish.0, finish.1);
    let finish_shift = difference(&finish.1.to, &finish.0.to);
    let mut all = Vec::new();
    for (place, (i, j)) in was.iter().zip(is).enumerate() {
        let (before, now) = (&old.steps[*i], &new.steps[*j]);
        let is_with_hole = || {
            let shift = difference(&now.to, &before.to);
            near(&shift, &finish_shift, tolerance)
                || !is_finished_as_before
                    && goes_with((before, finish.0), (now, finish.1), hole_deeper, tolerance)
        };
        if stays(before, now) || std::ptr::eq(before, finish.0) || is_with_hole() {
            continue;
        }
        let (shift, way) = (difference(&now.to, &before.to), before.way());
        let dot = |a: &Position, b: &Position| (0..MAX_AXES).map(|axis| a[axis] * b[axis]).sum::<f64>();
        let along = dot(&shift, &way) / before.length().max(f64::MIN_POSITIVE);
        all.push(Strayed {
            steps: (*i, *j),
            shift,
            deeper: along,
            is_along: dot(&shift, &shift) - along * along <= tolerance * tolerance,
            number: (place + 1, was.len()),
            tool: passes.1.tools[other].get(place).copied(),
        });
    }
    all
}

impl Strayed {
    /// Which of how many.
    pub(super) fn pass(&self) -> (usize, usize) {
        self.number
    }

    fn name(&self) -> String {
        let (number, all) = self.number;
        let by = self.tool.map(|tool| format!(", by T{tool}")).unwrap_or_default();
        format!("pass {number} of {all}{by},")
    }

    pub(super) fn text(&self, axes: &Axes, tolerance: f64) -> String {
        if self.is_along {
            return format!("{} {:.4} mm {}", self.name(), self.deeper.abs(), deeper(self.deeper));
        }
        format!("{} ends elsewhere, by {}", self.name(), coordinates(&self.shift, axes, tolerance, true))
    }

    /// The same pass of several holes.
    pub(super) fn up_to<'a>(
        &self,
        alike: impl Iterator<Item = &'a Self>,
        axes: &Axes,
        tolerance: f64,
    ) -> String {
        let mut most = Position::default();
        for pass in alike {
            for axis in 0..MAX_AXES {
                most[axis] = most[axis].max(pass.shift[axis].abs());
            }
        }
        format!("{} ends elsewhere, by up to {}", self.name(), coordinates(&most, axes, tolerance, false))
    }
}
