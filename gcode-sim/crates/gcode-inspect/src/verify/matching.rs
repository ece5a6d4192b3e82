//! Which drilled hole is which wanted one: the pairs that lie nearest to one another first.
use nalgebra::{Point3, Vector3};

use super::Tolerances;
use super::position::Deviation;
use crate::holes::DrilledHole;
use gcode_part::Hole;
use gcode_part::Pattern;
use gcode_part::PointTree;

/// A drilled hole can be a wanted one when its axis passes the wanted entry and bottom this near, in mm.
const MAX_LINE_DISTANCE: f64 = 5.0;

/// … and its direction is within this of the wanted one: 30°.
const MIN_DIRECTION_COSINE: f64 = 0.866_025_403_784_438_6;

/// A wanted hole and the drilled one taken for it, by their numbers in the lists.
#[derive(Clone, Copy, Debug)]
pub struct HolePair {
    pub nominal: usize,
    pub actual: usize,
    pub deviation: Deviation,
}

/// Both lists, and what belongs together.
#[derive(Debug)]
pub struct Comparison<'a> {
    pub nominal: &'a [Hole],
    pub actual: &'a [DrilledHole],
    pub tolerances: Tolerances,
    /// What the neighbours must be like, where the reference says it.
    pub pattern: Option<&'a Pattern>,
    /// In the order of the wanted holes.
    pub pairs: Vec<HolePair>,
    /// Wanted and not there.
    pub missing: Vec<usize>,
    /// There and not wanted.
    pub extra: Vec<usize>,
    /// The wanted hole that a line was taken for, by the first hole found on the line.
    nominal_by_line: Vec<Option<usize>>,
}

impl<'a> Comparison<'a> {
    pub fn new(
        wanted: &'a [Hole],
        found: &'a [DrilledHole],
        tolerances: Tolerances,
        pattern: Option<&'a Pattern>,
    ) -> Self {
        // Beyond half the way to its neighbour a hole is another one.
        let near = pattern.map_or(MAX_LINE_DISTANCE, |pattern| MAX_LINE_DISTANCE.min(pattern.pitch / 4.0));
        let reach = near.max(2.0 * tolerances.position);
        let tree = PointTree::new(wanted.iter().map(|hole| Point3::from(hole.entry)));
        let mut candidates = Vec::with_capacity(found.len());
        for (index, hole) in found.iter().enumerate() {
            let margin = Vector3::repeat(reach);
            let bottom = hole.bottom();
            let low = hole.entry.inf(&bottom) - margin;
            let high = hole.entry.sup(&bottom) + margin;
            let before = candidates.len();
            tree.in_box(&low, &high, &mut |other| {
                if hole.axis.dot(&Vector3::from(wanted[other].axis)) < MIN_DIRECTION_COSINE {
                    return;
                }
                if let Some(deviation) = Deviation::new(&wanted[other], &bottom, &hole.axis)
                    && deviation.zone_diameter() <= 2.0 * reach
                {
                    candidates.push(HolePair { nominal: other, actual: index, deviation });
                }
            });
            candidates[before..].sort_unstable_by_key(|pair| pair.nominal);
        }
        let (taken_for, is_taken) = assign_nearest(&candidates, wanted.len(), found.len());
        let pairs: Vec<HolePair> = taken_for.iter().flatten().map(|index| candidates[*index]).collect();
        // Holes that are a part of a list keep the numbers that they have there.
        let lines = found.iter().map(|hole| hole.first_on_line + 1).max().unwrap_or(0);
        let mut on_line = vec![None; lines];
        for pair in &pairs {
            on_line[found[pair.actual].first_on_line] = Some(pair.nominal);
        }
        let missing = (0..wanted.len()).filter(|index| taken_for[*index].is_none()).collect();
        let extra = (0..found.len()).filter(|index| !is_taken[*index]).collect();
        Self {
            nominal: wanted,
            actual: found,
            tolerances,
            pattern,
            pairs,
            missing,
            extra,
            nominal_by_line: on_line,
        }
    }

    /// The wanted hole that was drilled already on the line of one that nobody asked for.
    pub fn nominal_on_line_of(&self, extra: usize) -> Option<usize> {
        self.nominal_by_line[self.actual[extra].first_on_line]
    }

    /// Nothing is missing, nothing too many, and every axis lies in its zone.
    pub fn is_all_in_place(&self) -> bool {
        let in_zone = |pair: &HolePair| pair.deviation.zone_diameter() <= self.tolerances.position;
        self.missing.is_empty() && self.extra.is_empty() && self.pairs.iter().all(in_zone)
    }

    /// A wanted hole's name.
    pub fn id(&self, wanted: usize) -> &str {
        self.nominal[wanted].id.as_deref().unwrap_or("?")
    }
}

/// Which of the candidates each wanted hole is taken for, and which of the drilled ones are taken: the nearest first, of
/// equally near ones the first in the list.
fn assign_nearest(candidates: &[HolePair], wanted: usize, found: usize) -> (Vec<Option<usize>>, Vec<bool>) {
    // The bits of numbers that aren't negative are in the order of the numbers.
    let nearness = |(index, pair): (usize, &HolePair)| (pair.deviation.zone_diameter().to_bits(), index);
    let mut order: Vec<(u64, usize)> = candidates.iter().enumerate().map(nearness).collect();
    order.sort_unstable();
    let (mut taken_for, mut is_taken) = (vec![None; wanted], vec![false; found]);
    for (_, index) in order {
        let pair = &candidates[index];
        if taken_for[pair.nominal].is_none() && !is_taken[pair.actual] {
            taken_for[pair.nominal] = Some(index);
            is_taken[pair.actual] = true;
        }
    }
    (taken_for, is_taken)
}

impl DrilledHole {
    /// The deepest point any tool reached, on the hole's axis.
    pub fn bottom(&self) -> Point3<f64> {
        self.entry - self.axis.into_inner() * self.depth
    }
}
