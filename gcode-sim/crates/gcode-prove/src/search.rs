//! Search for points at which a claim fails: special values, points spread evenly, descent towards the edge of a question.
use std::collections::BTreeMap;
use std::sync::Arc;

use gcode_enclosure::Domain;
use gcode_lang::program::Library;

use crate::leaf::{ClaimState, End};
use crate::points::{PointWay, Points};
use crate::shared::Shared;
use crate::tree::{Question, Tree};
use crate::watch::Watch;
use crate::witness::Witness;

/// Point that is nearest to the edge of a question, with its distance.
type Nearest = Option<(f64, Vec<f64>)>;

/// One thread's tree with the means to try single points.
pub(crate) struct Prober<'s, L> {
    pub(crate) tree: Tree<L>,
    pub(crate) points: Points,
    pub(crate) witness: Witness<L>,
    pub(crate) question: Arc<Question>,
    pub(crate) shared: &'s Shared,
    pub(crate) watch: &'s Watch<'s>,
    /// Points that the real control has run without need, to compare.
    compared: u32,
    /// Number of boxes that weren't decided.
    pub(crate) undecided_boxes: u64,
    /// Part of the time that joins have taken which decided nothing.
    pub(crate) joining_part: f64,
}

/// Number of points whose run by the control is compared with the tree.
const COMPARED: u32 = 60;

/// Largest number of points that are spread evenly.
const SPREAD: u32 = 6000;

/// Largest number of special points.
const SPECIAL: usize = 6000;

/// Number of blocks without a question after which the search leaves a point alone: one that never ends has many neighbours.
const PATIENCE: u64 = 200_000;

/// Largest part of the time that the search takes.
const PART: f64 = 0.15;

impl<'s, L: Library> Prober<'s, L> {
    pub(crate) fn new(
        tree: Tree<L>,
        witness: Witness<L>,
        question: Arc<Question>,
        shared: &'s Shared,
        watch: &'s Watch<'s>,
    ) -> Self {
        Self {
            tree,
            points: Points::default(),
            witness,
            question,
            shared,
            watch,
            compared: 0,
            undecided_boxes: 0,
            joining_part: 0.0,
        }
    }

    /// Tries a point; claims that fail there are refuted once the control has confirmed it.
    pub(crate) fn try_point(&mut self, point: &[f64]) {
        self.watch.count_run();
        let Some(way) = self.points.follow(&mut self.tree, point, self.watch, |_, _| {}) else { return };
        if way.leaf.end != End::Excluded {
            self.shared.include(way.leaf.end == End::Program);
        }
        let open = self.shared.open_claims();
        let suspected = (way.failed | way.unfollowed) & open;
        let is_compared = self.compared < COMPARED;
        if suspected == 0 && !is_compared {
            return;
        }
        self.compared += u32::from(is_compared);
        self.confirm(point, &way);
    }

    /// Runs a point by the control. Where it disagrees with the tree, nothing is proved.
    fn confirm(&mut self, point: &[f64], way: &PointWay) {
        let result = self.witness.run(point, self.watch);
        let leaf = &way.leaf;
        let is_same = match (&result.end, &leaf.end) {
            (_, End::Unfollowed(_)) | (None, End::Excluded) => true,
            // A loop that never ends is found after some turns.
            (Some(End::Endless | End::Unfollowed(_)), End::Endless) => true,
            (Some(End::Unfollowed(_)), _) if self.watch.is_over() => true,
            (Some(end), followed) => end == followed && result.blocks == leaf.blocks,
            (None, _) => false,
        };
        if !is_same
            || result.end.is_some()
                && (result.failed ^ way.failed) & !(way.unfollowed | result.undecided) != 0
        {
            self.shared.disagree(point);
        }
        self.shared.refute(result.failed, point);
    }

    /// Searches; `share` of `shares` is this thread's part of the points.
    pub(crate) fn search(&mut self, share: u32, shares: u32) {
        self.tree.patience = PATIENCE;
        self.search_all(share, shares);
        self.tree.patience = u64::MAX;
    }

    fn search_all(&mut self, share: u32, shares: u32) {
        let domain = self.question.domain();
        self.try_point(&domain.midpoint());
        let values = self.special_values(&domain);
        self.special_points(&domain, &values, share as usize, shares as usize);
        for index in (share..SPREAD).step_by(shares as usize) {
            if self.is_enough() {
                return;
            }
            self.try_point(&spread_point(&domain, index + 1));
            self.try_point(&face_point(&domain, &values, index));
        }
        self.descend(&domain, share, shares);
    }

    fn is_enough(&self) -> bool {
        self.watch.is_over() || self.watch.part() > PART || self.shared.open_claims() == 0
    }

    /// Returns values of each input at which a program may turn: ends, whole numbers, numbers of the program and their
    /// neighbours.
    fn special_values(&self, domain: &Domain) -> Vec<Vec<f64>> {
        let constants = self.tree.nodes.constants();
        let of_range = |range: &gcode_enclosure::Interval| {
            let mut values = vec![range.lo(), range.hi(), range.midpoint()];
            let neighbours = |value: f64| {
                [
                    value,
                    -value,
                    value.next_up(),
                    value.next_down(),
                    value + 0.001,
                    value - 0.001,
                    value + 0.0005,
                ]
            };
            let ends = [range.lo(), range.hi()].into_iter().flat_map(neighbours);
            let numbers = constants.iter().copied().flat_map(neighbours);
            let whole = (-10..=20).map(f64::from).chain([30.0, 45.0, 60.0, 90.0, 100.0, 180.0, 270.0, 360.0]);
            values.extend(
                ends.chain(numbers)
                    .chain(whole.flat_map(|value| [value, value.next_up(), value.next_down()])),
            );
            values.retain(|value| range.contains(*value));
            let mut seen = BTreeMap::new();
            values.retain(|value| seen.insert((value + 0.0).to_bits(), ()).is_none());
            values.truncate(400);
            values
        };
        domain.ranges().iter().map(of_range).collect()
    }

    /// Tries corners, special values one and two at a time.
    fn special_points(&mut self, domain: &Domain, values: &[Vec<f64>], share: usize, shares: usize) {
        let middle = domain.midpoint();
        let inputs = domain.ranges().len();
        let mut count = 0;
        let mut is_own = || {
            count += 1;
            count % shares == share % shares
        };
        for corner in 0..1_usize << inputs.min(10) {
            let ends = domain.ranges().iter().enumerate();
            let point: Vec<f64> = ends
                .map(|(index, range)| if corner >> index.min(9) & 1 == 1 { range.hi() } else { range.lo() })
                .collect();
            if is_own() {
                self.try_point(&point);
            }
        }
        let mut tried = 0;
        for base in [
            middle,
            domain.ranges().iter().map(|range| range.lo()).collect(),
            domain.ranges().iter().map(|range| range.hi()).collect(),
        ] {
            for (input, of_input) in values.iter().enumerate() {
                for value in of_input {
                    if self.is_enough() {
                        return;
                    }
                    let mut point: Vec<f64> = base.clone();
                    point[input] = *value;
                    if is_own() {
                        self.try_point(&point);
                    }
                }
            }
            for (first, of_first) in values.iter().enumerate() {
                for (second, of_second) in values.iter().enumerate().skip(first + 1) {
                    for pair in
                        of_first.iter().flat_map(|a| of_second.iter().map(move |b| (*a, *b))).take(600)
                    {
                        tried += 1;
                        if self.is_enough() || tried > SPECIAL {
                            break;
                        }
                        let mut point: Vec<f64> = base.clone();
                        (point[first], point[second]) = pair;
                        if is_own() {
                            self.try_point(&point);
                        }
                    }
                }
            }
        }
    }

    /// Moves points towards the edge of each question that all points have answered alike, and of each claim.
    fn descend(&mut self, domain: &Domain, share: u32, shares: u32) {
        // For each question, the points on either side that are nearest to its edge.
        let mut sides: BTreeMap<usize, [Nearest; 2]> = BTreeMap::new();
        for index in (share..800).step_by(shares as usize) {
            if self.is_enough() {
                return;
            }
            let point = spread_point(domain, index + 1);
            self.points.follow(&mut self.tree, &point, self.watch, |id, margin| {
                let side = &mut sides.entry(id).or_default()[usize::from(margin > 0.0)];
                if side.as_ref().is_none_or(|(best, _)| margin.abs() < *best) {
                    *side = Some((margin.abs(), point.clone()));
                }
            });
        }
        let one_sided = sides.into_iter().filter_map(|(id, sides)| match sides {
            [Some((_, point)), None] | [None, Some((_, point))] => Some((Some(id), point)),
            _ => None,
        });
        let claims = (0..6).map(|index| (None, spread_point(domain, 1 + index * 7 + share)));
        for (target, start) in claims.chain(one_sided).take(60).collect::<Vec<_>>() {
            self.descend_from(domain, target, start);
        }
    }

    /// Returns what is to become small at a point: the margin of a question, or of the claims that are open.
    fn objective(&mut self, target: Option<usize>, point: &[f64]) -> f64 {
        let mut at_target = f64::INFINITY;
        self.watch.count_run();
        let way = self.points.follow(&mut self.tree, point, self.watch, |id, margin| {
            if Some(id) == target {
                at_target = margin.abs();
            }
        });
        let Some(way) = way else { return f64::INFINITY };
        let open = self.shared.open_claims();
        if (way.failed | way.unfollowed) & open != 0 {
            self.confirm(point, &way);
        }
        if target.is_some() {
            return at_target;
        }
        let mut least = f64::INFINITY;
        let is_open = |(index, _): &(usize, _)| open >> index & 1 == 1;
        for (_, state) in way.leaf.claims.iter().enumerate().filter(is_open) {
            if let ClaimState::Depends(formula) = state {
                least = least.min(self.points.margin(self.tree.nodes.arena(), formula, point));
            }
        }
        least
    }

    fn descend_from(&mut self, domain: &Domain, target: Option<usize>, mut point: Vec<f64>) {
        let mut best = self.objective(target, &point);
        let mut steps: Vec<f64> = domain.ranges().iter().map(|range| range.width() / 8.0).collect();
        for _ in 0..60 {
            let mut has_moved = false;
            for input in 0..point.len() {
                let range = domain.range(input);
                if range.lo() == range.hi() {
                    continue;
                }
                for step in [steps[input], -steps[input]] {
                    if self.is_enough() {
                        return;
                    }
                    let mut next = point.clone();
                    next[input] = (next[input] + step).clamp(range.lo(), range.hi());
                    let value = self.objective(target, &next);
                    if value < best {
                        (best, point, has_moved) = (value, next, true);
                        break;
                    }
                }
            }
            if !has_moved {
                steps.iter_mut().for_each(|step| *step /= 4.0);
            }
        }
    }
}

/// Returns a number from 0 to 1 whose digits in a base are those of an index, mirrored at the point (Halton 1960, On the
/// efficiency of certain quasi-random sequences of points): successive indices fill the range evenly.
pub fn radical_inverse(index: u32, base: u32) -> f64 {
    let (mut rest, mut value, mut digit) = (index, 0.0, 1.0 / f64::from(base));
    while rest > 0 {
        value += f64::from(rest % base) * digit;
        rest /= base;
        digit /= f64::from(base);
    }
    value
}

/// Returns a point of a sequence that fills a box evenly, after Halton.
pub(crate) fn spread_point(domain: &Domain, index: u32) -> Vec<f64> {
    const PRIMES: [u32; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];
    let ranges = domain.ranges().iter().zip(PRIMES.iter().cycle());
    ranges
        .map(|(range, base)| {
            (range.lo() + (range.hi() - range.lo()) * radical_inverse(index, *base))
                .clamp(range.lo(), range.hi())
        })
        .collect()
}

/// Returns a point whose coordinates have all their digits, but for one input, or for none, which has a special value: what
/// rounds only of such numbers fails at no corner and at no short number.
fn face_point(domain: &Domain, special: &[Vec<f64>], index: u32) -> Vec<f64> {
    // A generator of evenly distributed bits (Steele and others, Fast splittable pseudorandom number generators).
    let mut state = u64::from(index);
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (state ^ state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    };
    next();
    let ranges = domain.ranges();
    let mut point: Vec<f64> = ranges
        .iter()
        .map(|range| {
            let part = (next() >> 11) as f64 / (1_u64 << 53) as f64;
            (range.lo() + (range.hi() - range.lo()) * part).clamp(range.lo(), range.hi())
        })
        .collect();
    let input = next() as usize % (ranges.len() + 1);
    if let Some(values) = special.get(input).filter(|values| !values.is_empty()) {
        // Half of them an end or its neighbour.
        let count = if next() % 2 == 0 { values.len() } else { values.len().min(6) };
        point[input] = values[next() as usize % count];
    }
    point
}
