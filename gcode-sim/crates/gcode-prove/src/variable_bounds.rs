//! Bounds of a variable at the end of all runs: the box with the worst bound is divided until the bound is close to a value
//! that a run gives.
use std::collections::BinaryHeap;

use gcode_enclosure::{Condition, Domain, Enclosures, Interval, Ranked, Relation};
use gcode_lang::program::Library;

use crate::division::divide;
use crate::points::Points;
use crate::region::{Finding, examine};
use crate::search::spread_point;
use crate::tree::Tree;
use crate::watch::Watch;

/// Side of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Lower,
    Upper,
}

/// Gap between a bound and a value, of the width of all values, at which the work ends.
const GAP: f64 = 0.004;

/// Number of points that are tried first.
const POINTS: u32 = 3000;

/// Largest number of rounds over all inputs that improve a value.
const MAX_CLIMBS: usize = 200;

/// Boxes, each ranked by its bound, which is negated on the lower side.
type RankedBoxes = BinaryHeap<Ranked<Domain>>;

/// Result of one side.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Bound {
    /// No run gives the variable a value.
    None,
    /// The conditions exclude all values.
    Excluded,
    Value(f64),
    /// Something isn't followed.
    Unfollowed(String),
}

/// Search for one side of one variable.
struct BoundSearch<'a, L> {
    tree: &'a mut Tree<L>,
    points: Points,
    index: usize,
    side: Side,
    watch: &'a Watch<'a>,
    /// Least and largest value that a run gives.
    values: Option<(f64, f64)>,
    unfollowed: Option<String>,
    /// The conditions may include some values.
    is_included: bool,
}

/// Returns one bound of a variable over some boxes.
pub(crate) fn bound<L: Library>(
    tree: &mut Tree<L>,
    starts: &[Domain],
    index: usize,
    side: Side,
    watch: &Watch<'_>,
) -> Bound {
    let points = Points::default();
    let (values, unfollowed, is_included) = (None, None, false);
    let mut search = BoundSearch { tree, points, index, side, watch, values, unfollowed, is_included };
    let mut best: Option<(f64, &Domain, Vec<f64>)> = None;
    for point in 1..=POINTS {
        if watch.is_over() {
            break;
        }
        let domain = point as usize % starts.len().max(1);
        if let Some(domain) = starts.get(domain) {
            let point = spread_point(domain, point);
            let value = search.value_at(&point).map(|value| search.signed(value));
            if let Some(value) = value
                && best.as_ref().is_none_or(|(best, ..)| value > *best)
            {
                best = Some((value, domain, point));
            }
        }
    }
    if let Some((value, domain, point)) = best {
        search.climb(value, domain, point);
    }
    search.run(starts)
}

impl<L: Library> BoundSearch<'_, L> {
    /// Notes the value of a run.
    fn value_at(&mut self, point: &[f64]) -> Option<f64> {
        self.watch.count_run();
        let way = self.points.follow(self.tree, point, self.watch, |_, _| {})?;
        let state = way.leaf.bounds.get(self.index)?;
        let value =
            self.points.bound(self.tree.nodes.arena(), state, point).filter(|value| value.is_finite())?;
        let (low, high) = self.values.unwrap_or((value, value));
        self.values = Some((low.min(value), high.max(value)));
        Some(value)
    }

    /// Improves the value at a point, one input at a time: to the ends of its range, then by steps that become smaller.
    fn climb(&mut self, mut best: f64, domain: &Domain, mut point: Vec<f64>) {
        let mut step = 1.0;
        for _ in 0..MAX_CLIMBS {
            let before = best;
            for (input, range) in domain.ranges().iter().enumerate().filter(|(_, range)| range.width() > 0.0)
            {
                let places = [-1.0, 1.0].map(|sign| {
                    let place = point[input] + sign * step * (range.hi() - range.lo());
                    if place.is_nan() { range.midpoint() } else { place.clamp(range.lo(), range.hi()) }
                });
                for place in places {
                    let known = std::mem::replace(&mut point[input], place);
                    match self.value_at(&point).map(|value| self.signed(value)) {
                        Some(value) if value > best => best = value,
                        _ => point[input] = known,
                    }
                }
            }
            if best == before {
                step /= 2.0;
            }
            if step < 1e-6 || self.watch.is_over() {
                break;
            }
        }
    }

    /// Returns a number with the sign of the side: larger is worse.
    fn signed(&self, value: f64) -> f64 {
        if self.side == Side::Upper { value } else { -value }
    }

    fn run(&mut self, starts: &[Domain]) -> Bound {
        let mut boxes = BinaryHeap::new();
        // Bounds of boxes that aren't divided further.
        let mut settled = f64::NEG_INFINITY;
        for domain in starts {
            let (first, finding) = self.examine(domain);
            self.add(&mut boxes, &mut settled, domain.clone(), first, f64::INFINITY, &finding);
        }
        let mut findings_left = 2_000_000_u64;
        while let Some(Ranked { rank: of_whole, item: domain }) = boxes.pop() {
            if self.is_close(of_whole) || of_whole <= settled || self.watch.is_over() || findings_left == 0 {
                settled = settled.max(of_whole);
                break;
            }
            findings_left -= 1;
            let (_, finding) = self.examine(&domain);
            let parts = self.parts(&domain, &finding);
            if parts.is_empty() {
                settled = settled.max(of_whole);
                continue;
            }
            for part in parts {
                let (range, finding) = self.examine(&part);
                self.add(&mut boxes, &mut settled, part, range, of_whole, &finding);
            }
        }
        if let Some(what) = self.unfollowed.take() {
            return Bound::Unfollowed(what);
        }
        match settled {
            f64::NEG_INFINITY if self.is_included => Bound::None,
            f64::NEG_INFINITY => Bound::Excluded,
            settled => Bound::Value(self.signed(settled)),
        }
    }

    /// Adds a part of a box, whose bound isn't worse than that of the whole.
    fn add(
        &mut self,
        boxes: &mut RankedBoxes,
        settled: &mut f64,
        domain: Domain,
        range: Interval,
        of_whole: f64,
        finding: &Finding,
    ) {
        if let Some(what) = &finding.unfollowed {
            self.unfollowed.get_or_insert_with(|| what.clone());
        }
        self.is_included |= range.is_empty() && finding.is_included;
        if range.is_empty() {
            return;
        }
        self.value_at(&domain.midpoint());
        let bound = self.signed(if self.side == Side::Upper { range.hi() } else { range.lo() }).min(of_whole);
        if domain.ranges().iter().all(|range| range.lo() == range.hi()) {
            *settled = settled.max(bound);
        } else {
            boxes.push(Ranked { rank: bound, item: domain });
        }
    }

    /// Returns true if a bound is close enough to a value of a run.
    fn is_close(&self, bound: f64) -> bool {
        let Some((low, high)) = self.values else { return false };
        let value = self.signed(if self.side == Side::Upper { high } else { low });
        let width = high - low;
        bound - value <= (width * GAP).max(value.abs() * 1e-15)
    }

    fn examine(&mut self, domain: &Domain) -> (Interval, Finding) {
        self.watch.count_box();
        let mut finding = examine(self.tree, Enclosures::with_degree(domain.clone(), 0), 0, self.watch);
        let mut range = finding.bounds[self.index];
        if !range.is_empty() {
            let closer = examine(self.tree, Enclosures::new(domain.clone()), 0, self.watch);
            range = range.intersect(closer.bounds[self.index]);
            finding = closer;
        }
        (range, finding)
    }

    /// Divides a box by what the variable depends on most.
    fn parts(&self, domain: &Domain, finding: &Finding) -> Vec<Domain> {
        let zero = gcode_enclosure::Arena::ZERO;
        // The value decides more often than where a way divides.
        let own = finding.bound_nodes[self.index].map(|node| Condition::new(Relation::Ge, node, zero));
        let undecided = own.into_iter().chain(finding.undecided.iter().copied()).collect();
        divide(self.tree.nodes.arena(), domain, &Finding { undecided, ..Finding::default() })
    }
}
