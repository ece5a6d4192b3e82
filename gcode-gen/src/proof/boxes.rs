//! Bounds over all boxes of a case: where none is found, or a tolerance isn't kept, a box is divided.
use std::collections::BinaryHeap;

use gcode_enclosure::{Domain, Enclosures, Interval, Node, Ranked};
use gcode_part::job::AxisDirection;
use gcode_prove::{Trace, TracedEnd, TracedWay};

use super::hole_path::{HolePath, PinAxes};
use super::position::{NominalHole, PositionBound, bound};

/// Bounds over a case's ranges.
#[derive(Clone, Debug)]
pub(super) struct CaseBounds {
    /// Boxes with their bounds; `None` where none is found.
    pub(super) boxes: Vec<(Domain, Option<PositionBound>)>,
    /// What isn't followed, where that is the reason.
    pub(super) unfollowed: Vec<String>,
    whole: Domain,
}

/// Largest number of boxes.
const MAX_BOXES: usize = 3000;

/// Number of boxes at which none is divided any more for the rapid moves alone.
const MAX_BOXES_FOR_RAPIDS: usize = 400;

/// Relative width of a range that isn't divided.
const LEAST_WIDTH: f64 = 1e-9;

/// Way that drills, or that isn't followed.
type Followed<'t> = (&'t TracedWay, Result<HolePath, String>);

impl CaseBounds {
    /// Finds bounds; boxes are divided until each keeps the tolerance. `divided` are the inputs that may be divided.
    pub(super) fn find(
        trace: &mut Trace,
        axes: PinAxes,
        hole: &NominalHole,
        divided: &[usize],
        tolerance: f64,
        is_over: &dyn Fn() -> bool,
    ) -> Self {
        let ways = trace.ways.clone();
        let followed: Vec<Followed<'_>> = ways
            .iter()
            .filter_map(|way| match &way.end {
                TracedEnd::Program => Some((way, HolePath::of(trace, way, axes))),
                TracedEnd::Unfollowed(what) => Some((way, Err(what.clone()))),
                TracedEnd::Alarm(_) => None,
            })
            .collect();
        let whole = trace.domain.clone();
        let mut all = Self { boxes: Vec::new(), unfollowed: Vec::new(), whole: whole.clone() };
        // The worst box comes first.
        let mut pending = BinaryHeap::new();
        let examine = |domain: Domain, all: &mut Self| {
            let found = all.examine(trace, &followed, hole, &domain);
            let rank = all.share(&domain) * found.map_or(f64::MAX, |found| found.phi);
            Ranked { rank, item: (domain, found) }
        };
        let mut count = 0;
        for part in at_tool_radius(trace, hole, &whole) {
            count += 1;
            pending.push(examine(part, &mut all));
        }
        while let Some(Ranked { item: (domain, found), .. }) = pending.pop() {
            let is_clear = |found: PositionBound| {
                found.clearance.is_some_and(|clearance| clearance > 0.0) || count >= MAX_BOXES_FOR_RAPIDS
            };
            let is_kept = found.is_some_and(|found| found.phi <= tolerance && is_clear(found));
            let parts =
                if is_kept || count >= MAX_BOXES || is_over() { None } else { divide(&domain, divided) };
            let Some(parts) = parts else {
                all.boxes.push((domain, found));
                continue;
            };
            count += 2;
            for part in parts {
                pending.push(examine(part, &mut all));
            }
        }
        all
    }

    /// Returns the bound over a box.
    fn examine(
        &mut self,
        trace: &Trace,
        followed: &[Followed<'_>],
        hole: &NominalHole,
        domain: &Domain,
    ) -> Option<PositionBound> {
        let arena = trace.arena();
        let mut worst = PositionBound { phi: 0.0, depth: 0.0, clearance: Some(f64::INFINITY) };
        for (way, path) in followed {
            let mut enclosures = Enclosures::with_degree(domain.clone(), 0);
            if !way.conditions.iter().all(|condition| enclosures.assume(arena, *condition)) {
                continue;
            }
            match path {
                Ok(path) => {
                    let zeroes = arena.semantics().zeroes_residues;
                    let found = bound(arena, &mut enclosures, path, hole, zeroes, &way.conditions)?;
                    worst.phi = worst.phi.max(found.phi);
                    worst.depth = worst.depth.max(found.depth);
                    worst.clearance = worst.clearance.zip(found.clearance).map(|(a, b)| a.min(b));
                }
                Err(what) => {
                    if !self.unfollowed.contains(what) {
                        self.unfollowed.push(what.clone());
                    }
                    return None;
                }
            }
        }
        Some(worst)
    }

    /// Returns the share of a box in the whole.
    fn share(&self, domain: &Domain) -> f64 {
        let parts = domain.ranges().iter().zip(self.whole.ranges());
        let share = |(part, all): (&Interval, &Interval)| match is_range(*all) {
            true => (part.hi() - part.lo()) / (all.hi() - all.lo()),
            false => 1.0,
        };
        parts.map(share).product()
    }

    /// Returns the share of the ranges in which a tolerance is kept.
    pub(super) fn share_within(&self, tolerance: f64) -> f64 {
        let others =
            self.boxes.iter().filter(|(_, found)| !found.is_some_and(|found| found.phi <= tolerance));
        let missing: f64 = others.map(|(domain, _)| self.share(domain)).sum();
        (1.0 - missing).max(0.0)
    }

    /// Returns true if a tolerance is kept everywhere.
    pub(super) fn is_within(&self, tolerance: f64) -> bool {
        self.boxes.iter().all(|(_, found)| found.is_some_and(|found| found.phi <= tolerance))
    }

    /// Returns the box with the largest bound, if all have one.
    pub(super) fn worst(&self) -> Option<(&Domain, PositionBound)> {
        let all: Option<Vec<_>> =
            self.boxes.iter().map(|(domain, found)| found.map(|found| (domain, found))).collect();
        all?.into_iter().max_by(|a, b| a.1.phi.total_cmp(&b.1.phi))
    }

    /// Returns the least clearance of rapids, and the share of the ranges in which one is known.
    pub(super) fn clearance(&self) -> (Option<f64>, f64) {
        let of = |found: &Option<PositionBound>| found.and_then(|found| found.clearance);
        let known = self.boxes.iter().filter_map(|(domain, found)| Some((domain, of(found)?)));
        let share = known.clone().fold(0.0, |sum, (domain, _)| sum + self.share(domain)).min(1.0);
        let is_known = self.boxes.iter().all(|(_, found)| of(found).is_some());
        let least = known.map(|(_, clearance)| clearance).fold(f64::INFINITY, f64::min);
        (Some(least).filter(|least| is_known && least.is_finite()), share)
    }

    /// Returns the largest box without a bound within a tolerance.
    pub(super) fn largest_left(&self, tolerance: f64) -> Option<&Domain> {
        let left = self.boxes.iter().filter(|(_, found)| !found.is_some_and(|found| found.phi <= tolerance));
        left.map(|(domain, _)| domain).max_by(|a, b| self.share(a).total_cmp(&self.share(b)))
    }
}

/// Returns true for a range of more than a few doubles.
pub(super) fn is_range(range: Interval) -> bool {
    range.width() > range.magnitude() * 1e-12 + 1e-300
}

/// Returns the whole, divided where an axial tool reaches the axis.
fn at_tool_radius(trace: &Trace, hole: &NominalHole, whole: &Domain) -> Vec<Domain> {
    match (hole.axis, trace.arena().node(hole.radius)) {
        (AxisDirection::Axial, Node::Input(input)) => {
            let range = whole.range(input);
            let inside = Interval::new(range.lo(), range.hi().min(hole.tool_radius));
            let outside = Interval::new(range.lo().max(hole.tool_radius.next_up()), range.hi());
            let parts = [inside, outside].into_iter().filter(|part| !part.is_empty());
            parts.map(|part| whole.with(input, part)).collect()
        }
        _ => vec![whole.clone()],
    }
}

/// Divides a box at the input with the largest ratio of its ends.
fn divide(domain: &Domain, divided: &[usize]) -> Option<Vec<Domain>> {
    let ratio = |input: usize| {
        let range = domain.range(input);
        if !is_range(range) || range.width() <= range.magnitude() * LEAST_WIDTH {
            return 0.0;
        }
        match range.lo() > 0.0 {
            true => libm::log(range.hi() / range.lo()),
            // A range from 0 is cut once or twice near 0.
            false if range.hi() > 1e-12 => 1e3,
            false => 0.0,
        }
    };
    let rated = divided.iter().map(|input| (ratio(*input), *input));
    let (ratio, input): (f64, usize) =
        rated.max_by(|a: &(f64, usize), b| a.0.total_cmp(&b.0)).filter(|(ratio, _)| *ratio > 0.0)?;
    let range = domain.range(input);
    let middle = if ratio >= 1e3 {
        range.hi() * 1e-6
    } else if ratio > 2.0 {
        libm::sqrt(range.lo() * range.hi())
    } else {
        range.midpoint()
    };
    let parts = [Interval::new(range.lo(), middle), Interval::new(middle.next_up(), range.hi())];
    Some(parts.into_iter().filter(|part| !part.is_empty()).map(|part| domain.with(input, part)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_every_double_once() {
        let domain = Domain::new(vec![Interval::new(0.0, 8.0), Interval::new(2.0, 3.0)]);
        let parts = divide(&domain, &[0, 1]).unwrap();
        assert_eq!(parts[0].range(0), Interval::new(0.0, 8e-6));
        assert_eq!(parts[1].range(0).lo(), 8e-6_f64.next_up());
        let parts = divide(&parts[1], &[1]).unwrap();
        assert_eq!((parts[0].range(1).hi(), parts[1].range(1).lo()), (2.5, 2.5_f64.next_up()));
        let narrow = Domain::new(vec![Interval::new(5.0, 5.0_f64.next_up())]);
        assert!(divide(&narrow, &[0]).is_none());
    }

    #[test]
    fn shares_count_only_ranges() {
        let whole = Domain::new(vec![Interval::new(0.0, 8.0), Interval::new(5.0, 5.0_f64.next_up())]);
        let half = whole.with(0, Interval::new(0.0, 4.0));
        let found = |phi| Some(PositionBound { phi, depth: 0.0, clearance: None });
        let boxes = vec![(half, found(0.01)), (whole.with(0, Interval::new(4.0, 8.0)), found(0.02))];
        let mut all = CaseBounds { boxes, unfollowed: Vec::new(), whole };
        assert_eq!((all.share_within(0.015), all.is_within(0.015)), (0.5, false));
        assert_eq!((all.share_within(0.02), all.is_within(0.02)), (1.0, true));
        assert_eq!(all.worst().unwrap().1.phi, 0.02);
        all.boxes[0].1 = None;
        assert!(all.worst().is_none() && !all.is_within(1.0));
        assert_eq!(all.largest_left(1.0).unwrap().range(0).hi(), 4.0);
    }
}
