//! Work of one thread: the largest box is examined and divided until every claim is decided.
use gcode_enclosure::{Domain, Enclosures, Interval};
use gcode_lang::program::Library;

use crate::division::divide;
use crate::joined::prove_joined;
use crate::leaf::End;
use crate::region::{ClaimSet, Finding, examine};
use crate::search::Prober;
use crate::shared::{Pending, Shared};
use crate::tree::Tree;
use crate::watch::Watch;

/// Boxes with at most this many doubles are run double by double.
const MAX_DOUBLES: u64 = 48;

/// Largest number of boxes of whole numbers with which the work begins.
const MAX_WHOLE: f64 = 4096.0;

/// Largest part of the time for joins that decide nothing.
const JOINING_PART: f64 = 0.15;

/// Largest number of divisions down to single points.
const MAX_DIVE: u32 = 300;

/// Work on one box; it ends even by a fault, after which the other threads stop.
struct BoxWork<'s> {
    shared: &'s Shared,
    watch: &'s Watch<'s>,
}

impl Drop for BoxWork<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.watch.stop();
        }
        self.shared.finish();
    }
}

impl<L: Library> Prober<'_, L> {
    /// Examines boxes until none is left or the time is over.
    pub(crate) fn work(&mut self) {
        let (shared, watch) = (self.shared, self.watch);
        while let Some(pending) = shared.take(|| watch.is_over()) {
            let _work = BoxWork { shared, watch };
            self.examine(pending);
        }
    }

    fn examine(&mut self, pending: Pending) {
        self.watch.count_box();
        let claims = pending.claims & self.shared.open_claims();
        if claims == 0 {
            return;
        }
        // Runs of the control prove nothing of other arithmetic.
        if self.question.widening == 0.0
            && let Some(points) = doubles(&pending.domain)
        {
            return self.run_points(&points, &Pending { claims, ..pending });
        }
        let ranges = Enclosures::with_degree(pending.domain.clone(), 0);
        let mut finding = examine(&mut self.tree, ranges, claims, self.watch);
        if finding.proved != claims && !finding.is_final && !finding.is_stopped && finding.refuted == 0 {
            let models = Enclosures::new(pending.domain.clone());
            let closer = examine(&mut self.tree, models, claims & !finding.proved, self.watch);
            finding = Finding { proved: finding.proved | closer.proved, ..closer };
        }
        if finding.is_included {
            self.shared.include(finding.has_end);
        }
        if finding.has_many_ways && self.joining_part < JOINING_PART {
            let begin = self.watch.part();
            let open = claims & !finding.proved & self.shared.open_claims();
            let joined = prove_joined(&mut self.tree, &pending.domain, open, self.watch);
            if joined != 0 {
                finding.proved |= joined;
            } else {
                self.joining_part += self.watch.part() - begin;
            }
        }
        let left = claims & !finding.proved;
        if left != 0 {
            self.try_point(&pending.domain.midpoint());
        }
        let left = left & self.shared.open_claims();
        if left == 0 {
            return;
        }
        let pending = Pending { claims: left, ..pending };
        self.undecided_boxes += 1;
        if self.undecided_boxes >= 64 && self.undecided_boxes.is_power_of_two() {
            self.dive(&pending);
        }
        self.divide(&pending, &finding);
    }

    /// Divides a box down to single points, as long as a part isn't decided: a search that the boxes lead.
    fn dive(&mut self, pending: &Pending) {
        let (mut domain, mut claims) = (pending.domain.clone(), pending.claims);
        for step in 0..MAX_DIVE {
            claims &= self.shared.open_claims();
            if claims == 0 || self.watch.is_over() {
                return;
            }
            if let Some(points) = doubles(&domain) {
                points.iter().for_each(|point| self.try_point(point));
                return;
            }
            let finding = examine(&mut self.tree, Enclosures::new(domain.clone()), claims, self.watch);
            if finding.proved == claims || finding.is_final || finding.is_stopped {
                return;
            }
            self.try_point(&domain.midpoint());
            let mut parts = divide(self.tree.nodes.arena(), &domain, &finding);
            if step % 2 == 1 {
                parts.reverse();
            }
            let is_open = |prober: &mut Self, part: &Domain| {
                let ranges = Enclosures::with_degree(part.clone(), 0);
                examine(&mut prober.tree, ranges, claims, prober.watch).proved != claims
            };
            let Some(next) = parts.into_iter().find(|part| is_open(self, part)) else { return };
            domain = next;
        }
    }

    fn divide(&self, pending: &Pending, finding: &Finding) {
        if let Some(what) = &finding.unfollowed {
            self.shared.note_unfollowed(what);
        }
        let parts = if finding.is_final || finding.is_stopped {
            Vec::new()
        } else {
            divide(self.tree.nodes.arena(), &pending.domain, finding)
        };
        if parts.is_empty() {
            self.shared.park(Pending { domain: pending.domain.clone(), ..*pending });
            return;
        }
        let whole = self.question.domain();
        let part = |domain: Domain| {
            let volume = pending.volume * part_of(&domain, &pending.domain);
            Pending { volume, ..pending_box(domain, &whole, pending.claims) }
        };
        self.shared.push(parts.into_iter().map(part));
    }

    /// Decides claims at single points, by runs of the control.
    fn run_points(&mut self, points: &[Vec<f64>], pending: &Pending) {
        let claims = pending.claims;
        for point in points {
            if self.watch.is_over() {
                self.shared.park(Pending { domain: pending.domain.clone(), ..*pending });
                return;
            }
            self.watch.count_run();
            let result = self.witness.run(point, self.watch);
            if let Some(end) = &result.end {
                self.shared.include(*end == End::Program);
            }
            self.shared.refute(result.failed & claims, point);
            let undecided = result.undecided & claims;
            if undecided != 0 {
                if let Some(End::Unfollowed(what)) = &result.end {
                    self.shared.note_unfollowed(what);
                }
                let domain = Domain::new(point.iter().map(|value| Interval::point(*value)).collect());
                let volume = pending.volume / points.len() as f64;
                let single = pending_box(domain, &self.question.domain(), undecided);
                self.shared.park(Pending { volume, ..single });
            }
        }
    }
}

/// Returns a box with its place in the queue.
pub(crate) fn pending_box(domain: Domain, whole: &Domain, claims: ClaimSet) -> Pending {
    let (mut volume, mut size) = (1.0, 0.0);
    for (range, all) in domain.ranges().iter().zip(whole.ranges()) {
        if all.lo() < all.hi() {
            let part = (range.hi() - range.lo()) / (all.hi() - all.lo());
            volume *= part;
            size += libm::log2(part.max(1e-12));
        }
    }
    Pending { domain, claims, volume, size }
}

/// Returns the part of a box's volume that a box in it has.
fn part_of(domain: &Domain, whole: &Domain) -> f64 {
    let ranges = domain.ranges().iter().zip(whole.ranges()).filter(|(_, all)| all.lo() < all.hi());
    ranges.map(|(range, all)| (range.hi() - range.lo()) / (all.hi() - all.lo())).product()
}

/// Returns the boxes with which the work begins: one for each of the whole numbers that inputs can have.
pub(crate) fn starting_boxes<L: Library>(tree: &mut Tree<L>, whole: &Domain) -> Vec<Domain> {
    let mut boxes = vec![whole.clone()];
    for (input, is_whole) in tree.whole_inputs().into_iter().enumerate() {
        let (low, high) = (whole.range(input).lo().ceil(), whole.range(input).hi().floor());
        let count = high - low + 1.0;
        if !is_whole || count * boxes.len() as f64 > MAX_WHOLE {
            continue;
        }
        let numbers = (0..count.max(0.0) as u32).map(|index| low + f64::from(index));
        let with = |domain: &Domain, number: f64| domain.with(input, Interval::point(number));
        let all = boxes.iter();
        boxes = all.flat_map(|domain| numbers.clone().map(move |number| with(domain, number))).collect();
    }
    boxes
}

/// Returns all points of a box with few doubles.
fn doubles(domain: &Domain) -> Option<Vec<Vec<f64>>> {
    let mut points = vec![Vec::new()];
    for range in domain.ranges() {
        let values = few_doubles(*range)?;
        if (points.len() * values.len()) as u64 > MAX_DOUBLES {
            return None;
        }
        let with = |point: &Vec<f64>, value: f64| point.iter().copied().chain([value]).collect();
        points =
            points.iter().flat_map(|point| values.iter().map(move |value| with(point, *value))).collect();
    }
    Some(points)
}

fn few_doubles(range: Interval) -> Option<Vec<f64>> {
    let mut values = vec![range.lo()];
    let mut value = range.lo();
    while value < range.hi() {
        if values.len() as u64 > MAX_DOUBLES {
            return None;
        }
        value = value.next_up();
        values.push(value);
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_of_few_doubles_is_its_points() {
        let one = Interval::point(1.0);
        let domain = Domain::new(vec![Interval::new(1.0, 1.0_f64.next_up().next_up()), one]);
        assert_eq!(doubles(&domain).map(|points| points.len()), Some(3));
        assert_eq!(doubles(&domain.with(1, Interval::new(0.0, 1.0))), None);
    }

    #[test]
    fn a_volume_counts_inputs_with_a_range() {
        let whole = Domain::new(vec![Interval::new(0.0, 4.0), Interval::point(3.0)]);
        let part = whole.with(0, Interval::new(1.0, 2.0));
        assert_eq!(pending_box(part, &whole, 1).volume, 0.25);
    }
}
