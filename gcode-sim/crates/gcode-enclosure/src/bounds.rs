//! Bounds of a node over a box by subdivision, the worst boxes first.
use std::collections::BinaryHeap;
use std::panic::resume_unwind;

use crate::arena::Arena;
use crate::domain::Domain;
use crate::enclosures::Enclosures;
use crate::interval::Interval;
use crate::node::NodeId;
use crate::ranked::Ranked;

/// When a search for bounds ends.
pub struct BoundsSearch<'a> {
    /// Distance between a bound and a value found that is close enough.
    pub tolerance: f64,
    /// The same as a share of the width between the values found; the larger of both counts.
    pub relative_tolerance: f64,
    /// Largest number of boxes.
    pub max_boxes: usize,
    /// Number of threads. It doesn't change the result.
    pub threads: usize,
    /// Returns true when the time is over; asked between rounds.
    pub is_over: &'a (dyn Fn() -> bool + Sync),
}

/// Bounds of a node and the values found inside them.
#[derive(Clone, Debug)]
pub struct Bounds {
    /// A range that has every double of the node.
    pub range: Interval,
    /// The least value found and its point.
    pub least: Option<(f64, Vec<f64>)>,
    /// The greatest value found and its point.
    pub greatest: Option<(f64, Vec<f64>)>,
    /// Number of boxes.
    pub boxes: usize,
    /// True if both bounds are within the tolerance of a value found.
    pub is_complete: bool,
}

/// A box with the range of the node over it.
struct Part {
    range: Interval,
    domain: Domain,
    split: Option<usize>,
    /// True if the node is a polynomial of inputs over the box.
    is_modelled: bool,
}

/// Boxes that are divided in one round.
const ROUND: usize = 64;

/// Returns bounds of a node over a box. The box is divided where the bounds are worst.
pub fn bounds(arena: &Arena, node: NodeId, domain: &Domain, search: &BoundsSearch<'_>) -> Bounds {
    let whole = examine(arena, node, domain.clone());
    let mut state = State {
        found: Bounds { range: Interval::EMPTY, least: None, greatest: None, boxes: 1, is_complete: false },
        parts: BinaryHeap::new(),
        closed: Interval::EMPTY,
    };
    state.add(whole);
    let mut left = Vec::new();
    loop {
        let tolerance = state.tolerance(search);
        let mut round = Vec::new();
        while round.len() < ROUND
            && let Some(Ranked { item: part, .. }) = state.parts.pop()
        {
            let excess = state.excess(part.range);
            if excess <= tolerance || part.split.is_none() {
                state.closed = state.closed.hull(part.range);
            } else if state.parts.peek().is_some_and(|next| next.rank > excess) {
                // Its place was that of values found earlier.
                state.parts.push(Ranked { rank: excess, item: part });
            } else {
                round.push(part);
            }
        }
        if round.is_empty() || state.found.boxes >= search.max_boxes || (search.is_over)() {
            left.extend(round.iter().map(|part| part.range));
            break;
        }
        for examined in divide(arena, node, &round, state.found_range(), search.threads) {
            state.found.boxes += 1;
            state.add(examined);
        }
    }
    left.extend(state.parts.iter().map(|part| part.item.range));
    let left = left.into_iter().fold(state.closed, Interval::hull);
    let is_complete = state.excess(left) <= state.tolerance(search);
    Bounds { range: left, is_complete, ..state.found }
}

struct State {
    found: Bounds,
    /// Boxes that are left, ranked by how far they reach beyond the values found when they were added.
    parts: BinaryHeap<Ranked<Part>>,
    /// Range of the boxes that aren't divided further.
    closed: Interval,
}

impl State {
    fn add(&mut self, (part, samples): Examined) {
        for sample in samples {
            if self.found.least.as_ref().is_none_or(|least| sample.0 < least.0) {
                self.found.least = Some(sample.clone());
            }
            if self.found.greatest.as_ref().is_none_or(|greatest| sample.0 > greatest.0) {
                self.found.greatest = Some(sample);
            }
        }
        if !part.range.is_empty() {
            self.parts.push(Ranked { rank: self.excess(part.range), item: part });
        }
    }

    /// Returns how far a range reaches beyond the values found.
    fn excess(&self, range: Interval) -> f64 {
        match (&self.found.least, &self.found.greatest) {
            _ if range.is_empty() => 0.0,
            (Some((least, _)), Some((greatest, _))) => (least - range.lo()).max(range.hi() - greatest),
            _ => f64::INFINITY,
        }
    }

    /// Returns the range of the values found.
    fn found_range(&self) -> Interval {
        match (&self.found.least, &self.found.greatest) {
            (Some((least, _)), Some((greatest, _))) => Interval::new(*least, *greatest),
            _ => Interval::point(0.0),
        }
    }

    fn tolerance(&self, search: &BoundsSearch<'_>) -> f64 {
        let width = match (&self.found.least, &self.found.greatest) {
            (Some((least, _)), Some((greatest, _))) => greatest - least,
            _ => 0.0,
        };
        search.tolerance.max(search.relative_tolerance * width)
    }
}

/// A box with its values at points that are likely to be extreme.
type Examined = (Part, Vec<(f64, Vec<f64>)>);

/// Divides boxes, on several threads.
fn divide(arena: &Arena, node: NodeId, parts: &[Part], found: Interval, threads: usize) -> Vec<Examined> {
    let of_part = |part: &Part| best_halves(arena, node, part, found);
    let size = parts.len().div_ceil(threads.max(1)).max(1);
    if threads <= 1 || parts.len() < 2 {
        return parts.iter().flat_map(of_part).collect();
    }
    std::thread::scope(|scope| {
        let workers: Vec<_> = parts
            .chunks(size)
            .map(|chunk| scope.spawn(move || chunk.iter().flat_map(of_part).collect::<Vec<_>>()))
            .collect();
        // A box that is lost would make the bounds wrong: a panic goes on.
        let results =
            workers.into_iter().map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)));
        results.flatten().collect()
    })
}

/// Returns the halves of a box, divided at the input for which they reach least beyond the values found.
fn best_halves(arena: &Arena, node: NodeId, part: &Part, found: Interval) -> Vec<Examined> {
    let excess = |range: Interval| {
        if range.is_empty() {
            0.0
        } else {
            (found.lo() - range.lo()).max(0.0) + (range.hi() - found.hi()).max(0.0)
        }
    };
    let mut best: Option<(f64, Vec<Examined>)> = None;
    // A polynomial says which input matters; without one, every input is tried.
    let inputs = if part.is_modelled { 0 } else { part.domain.ranges().len() };
    let others = (0..inputs).filter(|input| Some(*input) != part.split);
    for input in part.split.into_iter().chain(others) {
        let Some(halves) = part.domain.split(input) else { continue };
        let halves: Vec<_> = halves.into_iter().map(|half| examine(arena, node, half)).collect();
        let score = halves.iter().map(|(half, _)| excess(half.range)).sum();
        if best.as_ref().is_none_or(|(least, _)| score < *least * 0.9) {
            best = Some((score, halves));
        }
        if score == 0.0 {
            break;
        }
    }
    best.map(|(_, halves)| halves).unwrap_or_default()
}

/// Returns a box with its range, and values at points that are likely to be extreme.
fn examine(arena: &Arena, node: NodeId, domain: Domain) -> Examined {
    let mut enclosures = Enclosures::new(domain);
    let range = enclosures.enclose_tightly(arena, node);
    let points =
        [enclosures.domain().midpoint(), enclosures.corner(node, -1.0), enclosures.corner(node, 1.0)];
    let samples = points.into_iter().filter_map(|point| Some((arena.evaluate(node, &point).ok()?, point)));
    let samples = samples.collect();
    let split = enclosures.widest_effect(arena, node);
    let is_modelled = enclosures.is_modelled(node);
    let domain = enclosures.domain().clone();
    (Part { range, domain, split, is_modelled }, samples)
}
