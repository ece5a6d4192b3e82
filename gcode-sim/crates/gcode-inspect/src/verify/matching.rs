//! Matching of drilled and nominal holes, the nearest pairs first.
use nalgebra::{Point3, Vector3};

use super::Tolerances;
use super::position::Deviation;
use crate::holes::DrilledHole;
use gcode_part::{Hole, Pattern, PointTree};

/// Largest distance of a drilled hole's axis from a matching nominal entry and bottom, mm.
const MAX_LINE_DISTANCE: f64 = 5.0;

/// Cosine of the largest angle between the directions of a matching pair: 30°.
const MIN_DIRECTION_COSINE: f64 = 0.866_025_403_784_438_6;

/// A nominal hole and the drilled one matched with it, by their indices in the lists.
#[derive(Clone, Copy, Debug)]
pub struct HolePair {
    /// Index of the nominal hole.
    pub nominal: usize,
    /// Index of the drilled hole.
    pub actual: usize,
    /// Deviation of the drilled hole.
    pub deviation: Deviation,
}

/// Nominal and drilled holes, and their matching.
#[derive(Debug)]
pub struct Comparison<'a> {
    /// Nominal holes.
    pub nominal: &'a [Hole],
    /// Drilled holes.
    pub actual: &'a [DrilledHole],
    /// Tolerances of the inspection.
    pub tolerances: Tolerances,
    /// Pattern of the nominal holes; `None` if the reference has none.
    pub pattern: Option<&'a Pattern>,
    /// Matched holes, in the order of the nominal ones.
    pub pairs: Vec<HolePair>,
    /// Nominal holes without a drilled one.
    pub missing: Vec<usize>,
    /// Drilled holes without a nominal one.
    pub extra: Vec<usize>,
    /// The nominal hole matched with a line, by the first drilled hole of the line.
    nominal_by_line: Vec<Option<usize>>,
}

impl<'a> Comparison<'a> {
    /// Matches the holes.
    pub fn new(
        nominal: &'a [Hole],
        actual: &'a [DrilledHole],
        tolerances: Tolerances,
        pattern: Option<&'a Pattern>,
    ) -> Self {
        // Beyond half the distance to its neighbour a hole is that neighbour.
        let near = pattern.map_or(MAX_LINE_DISTANCE, |pattern| MAX_LINE_DISTANCE.min(pattern.pitch / 4.0));
        let reach = near.max(2.0 * tolerances.position);
        let tree = PointTree::new(nominal.iter().map(|hole| Point3::from(hole.entry)));
        let mut candidates = Vec::with_capacity(actual.len());
        for (index, hole) in actual.iter().enumerate() {
            let margin = Vector3::repeat(reach);
            let bottom = hole.bottom();
            let low = hole.entry.inf(&bottom) - margin;
            let high = hole.entry.sup(&bottom) + margin;
            let before = candidates.len();
            tree.in_box(&low, &high, &mut |other| {
                if hole.axis.dot(&Vector3::from(nominal[other].axis)) < MIN_DIRECTION_COSINE {
                    return;
                }
                if let Some(deviation) = Deviation::new(&nominal[other], &bottom, &hole.axis)
                    && deviation.zone_diameter() <= 2.0 * reach
                {
                    candidates.push(HolePair { nominal: other, actual: index, deviation });
                }
            });
            candidates[before..].sort_unstable_by_key(|pair| pair.nominal);
        }
        let (pair_of, is_taken) = assign_nearest(&candidates, nominal.len(), actual.len());
        let pairs: Vec<HolePair> = pair_of.iter().flatten().map(|index| candidates[*index]).collect();
        // The holes may be a part of a list, whose indices they keep.
        let lines = actual.iter().map(|hole| hole.first_on_line + 1).max().unwrap_or(0);
        let mut nominal_by_line = vec![None; lines];
        for pair in &pairs {
            nominal_by_line[actual[pair.actual].first_on_line] = Some(pair.nominal);
        }
        let missing = (0..nominal.len()).filter(|index| pair_of[*index].is_none()).collect();
        let extra = (0..actual.len()).filter(|index| !is_taken[*index]).collect();
        Self { nominal, actual, tolerances, pattern, pairs, missing, extra, nominal_by_line }
    }

    /// Returns the matched pairs with their holes.
    pub(super) fn matched(&self) -> impl Iterator<Item = (&HolePair, &'a Hole, &'a DrilledHole)> {
        let (nominal, actual) = (self.nominal, self.actual);
        self.pairs.iter().map(move |pair| (pair, &nominal[pair.nominal], &actual[pair.actual]))
    }

    /// Returns the nominal hole that an extra hole drills a second time; `None` if there is none.
    pub fn nominal_on_line_of(&self, extra: usize) -> Option<usize> {
        self.nominal_by_line[self.actual[extra].first_on_line]
    }

    /// Returns the point of the pattern's cylinder at which a drilled hole crosses it; `None` if it misses.
    pub(super) fn crossing(&self, actual: usize) -> Option<Point3<f64>> {
        let hole = &self.actual[actual];
        self.pattern?.crossing(&hole.bottom(), &hole.axis)
    }

    /// Returns true if the axis of a pair lies in its tolerance zone.
    pub(super) fn is_in_place(&self, pair: &HolePair) -> bool {
        pair.deviation.zone_diameter() <= self.tolerances.position
    }

    /// Returns true if no hole is missing or extra, and every axis lies in its zone.
    pub fn is_all_in_place(&self) -> bool {
        self.missing.is_empty()
            && self.extra.is_empty()
            && self.pairs.iter().all(|pair| self.is_in_place(pair))
    }

    /// Returns the id of a nominal hole.
    pub fn id(&self, nominal: usize) -> &str {
        self.nominal[nominal].id.as_deref().unwrap_or("?")
    }
}

/// Returns the candidate of each nominal hole, and whether each drilled hole is taken: the nearest pairs first, of
/// equally near ones the first in the list.
fn assign_nearest(candidates: &[HolePair], nominal: usize, actual: usize) -> (Vec<Option<usize>>, Vec<bool>) {
    // Non-negative numbers and their bits have the same order.
    let nearness = |(index, pair): (usize, &HolePair)| (pair.deviation.zone_diameter().to_bits(), index);
    let mut order: Vec<(u64, usize)> = candidates.iter().enumerate().map(nearness).collect();
    order.sort_unstable();
    let (mut pair_of, mut is_taken) = (vec![None; nominal], vec![false; actual]);
    for (_, index) in order {
        let pair = &candidates[index];
        if pair_of[pair.nominal].is_none() && !is_taken[pair.actual] {
            pair_of[pair.nominal] = Some(index);
            is_taken[pair.actual] = true;
        }
    }
    (pair_of, is_taken)
}
