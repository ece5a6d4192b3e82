//! Nominal holes that cut into each other: the distance of their axes is below the sum of their radii.
use nalgebra::{Point3, Vector3};

use super::hole::Hole;

/// Two overlapping holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Indices in the list, in ascending order.
    pub holes: [usize; 2],
    /// Least distance of the axes between entry and bottom, mm.
    pub distance: f64,
    /// Sum of the radii, mm.
    pub radius_sum: f64,
    /// Number of further holes behind the second that the first overlaps and that are not listed.
    pub further: usize,
}

/// Largest number of listed overlaps of one hole with holes behind it.
const MOST_LISTED: usize = 8;

impl Overlap {
    /// Returns one sentence with the ids of the holes.
    pub fn sentence(&self, holes: &[Hole]) -> String {
        let [one, other] = self.holes.map(|index| holes[index].id.as_deref().unwrap_or("?"));
        let further = match self.further {
            0 => String::new(),
            count => format!("; {count} more holes overlap hole {one}"),
        };
        format!(
            "holes {one} and {other} overlap: their axes come within {:.3} mm, their radii add up to {:.3} mm{further}",
            self.distance, self.radius_sum
        )
    }
}

/// A hole with a known diameter, and the box that it fills.
struct SizedHole {
    index: usize,
    radius: f64,
    low: [f64; 3],
    high: [f64; 3],
}

impl SizedHole {
    fn new(index: usize, hole: &Hole) -> Option<Self> {
        let radius = hole.widest_diameter()? / 2.0;
        let ends = [0, 1, 2].map(|axis| [hole.entry[axis], hole.entry[axis] - hole.axis[axis] * hole.depth]);
        Some(Self {
            index,
            radius,
            low: ends.map(|[a, b]| a.min(b) - radius),
            high: ends.map(|[a, b]| a.max(b) + radius),
        })
    }

    fn box_meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] < other.high[axis] && other.low[axis] < self.high[axis])
    }
}

/// Returns the pairs of overlapping holes with known diameters, in the order of the list: of each hole the first eight with
/// holes behind it, and the number of the others. A hole with features counts as wide as the widest of them.
pub fn overlaps(holes: &[Hole]) -> Vec<Overlap> {
    let mut sized: Vec<_> =
        holes.iter().enumerate().filter_map(|(index, hole)| SizedHole::new(index, hole)).collect();
    // Sorted along x: only holes that overlap in x are compared.
    sized.sort_by(|a, b| a.low[0].total_cmp(&b.low[0]));
    // A list of n holes on one spot has n² pairs.
    let mut found: Vec<Vec<Overlap>> = vec![Vec::new(); holes.len()];
    for (place, one) in sized.iter().enumerate() {
        let rest = sized[place + 1..].iter().take_while(|next| next.low[0] < one.high[0]);
        for other in rest.filter(|other| one.box_meets(other)) {
            if is_step(&holes[one.index], &holes[other.index]) {
                continue;
            }
            let distance = axis_distance(&holes[one.index], &holes[other.index]);
            let radius_sum = one.radius + other.radius;
            // Tangent holes share a single line without material between them; rounding must not report them.
            if distance < radius_sum - 1e-9 {
                let holes = [one.index.min(other.index), one.index.max(other.index)];
                list(&mut found[holes[0]], Overlap { holes, distance, radius_sum, further: 0 });
            }
        }
    }
    found.into_iter().flatten().collect()
}

/// Lists an overlap in the order of the second holes; the last of a full list counts those that are left out.
fn list(of_hole: &mut Vec<Overlap>, overlap: Overlap) {
    let further = of_hole.last_mut().map_or(0, |last| std::mem::take(&mut last.further));
    let place = of_hole.partition_point(|other| other.holes < overlap.holes);
    of_hole.insert(place, overlap);
    let left_out = of_hole.len().saturating_sub(MOST_LISTED);
    of_hole.truncate(MOST_LISTED);
    if let Some(last) = of_hole.last_mut() {
        last.further = further + left_out;
    }
}

/// Returns true if two holes are steps of one: on one axis, with different diameters.
fn is_step(one: &Hole, other: &Hole) -> bool {
    let (axis, between) = (Vector3::from(one.axis), Point3::from(one.entry) - Point3::from(other.entry));
    let is_one_axis = 1.0 - 1e-9 < axis.dot(&Vector3::from(other.axis)) && between.cross(&axis).norm() < 1e-6;
    is_one_axis && one.widest_diameter() != other.widest_diameter()
}

/// Returns the least distance of two holes' axes between entry and bottom.
///
/// The nearest pair of points is either inside both, on the common perpendicular, or contains an end of one
/// of them.
fn axis_distance(one: &Hole, other: &Hole) -> f64 {
    let [(p, u), (q, v)] =
        [one, other].map(|hole| (Point3::from(hole.entry), Vector3::from(hole.axis) * -hole.depth));
    let foot = |point: &Point3<f64>, from: &Point3<f64>, along: &Vector3<f64>| {
        let part = (point - from).dot(along) / along.norm_squared().max(f64::MIN_POSITIVE);
        (from + along * part.clamp(0.0, 1.0) - point).norm()
    };
    let ends = [foot(&p, &q, &v), foot(&(p + u), &q, &v), foot(&q, &p, &u), foot(&(q + v), &p, &u)];
    let nearest = ends.into_iter().fold(f64::INFINITY, f64::min);
    let (uu, uv, vv, w) = (u.norm_squared(), u.dot(&v), v.norm_squared(), q - p);
    let sine = uu * vv - uv * uv;
    if sine <= 1e-12 * uu * vv {
        return nearest;
    }
    let along = (w.dot(&u) * vv - w.dot(&v) * uv) / sine;
    let across = (w.dot(&u) * uv - w.dot(&v) * uu) / sine;
    match [along, across].iter().all(|part| (0.0..=1.0).contains(part)) {
        true => nearest.min((w - u * along + v * across).norm()),
        false => nearest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hole(entry: [f64; 3], axis: [f64; 3], depth: f64, diameter: f64) -> Hole {
        Hole { id: None, entry, axis, depth, diameter: Some(diameter), ..Hole::default() }
    }

    #[test]
    fn parallel_holes_overlap_below_the_sum_of_their_radii() {
        let at = |x: f64, diameter: f64| hole([x, 0.0, 0.0], [0.0, 1.0, 0.0], 15.0, diameter);
        // 3 + 2 = 5: at 5 mm they touch, at 4.9 they overlap, and the third is far away.
        assert_eq!(overlaps(&[at(0.0, 6.0), at(5.0, 4.0), at(40.0, 6.0)]), []);
        let found = overlaps(&[at(4.9, 4.0), at(40.0, 6.0), at(0.0, 6.0)]);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].holes, found[0].radius_sum), ([0, 2], 5.0));
        assert!((found[0].distance - 4.9).abs() < 1e-12);
    }

    /// Twelve holes of 6 at pitch 0.1: the first overlaps eleven behind it, of which eight are listed, the fourth exactly eight.
    #[test]
    fn of_many_overlaps_eight_a_hole_are_listed_and_the_others_counted() {
        let at = |index: u32| hole([f64::from(index) * 0.1, 0.0, 0.0], [0.0, 0.0, 1.0], 10.0, 6.0);
        for order in [(0..12).collect::<Vec<_>>(), (0..12).rev().collect()] {
            let found = overlaps(&order.into_iter().map(at).collect::<Vec<_>>());
            let of = |first: usize| found.iter().filter(move |overlap| overlap.holes[0] == first);
            assert_eq!(of(0).map(|overlap| overlap.holes[1]).collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6, 7, 8]);
            let further = |first: usize| of(first).map(|overlap| overlap.further).collect::<Vec<_>>();
            assert_eq!(further(0), [0, 0, 0, 0, 0, 0, 0, 3]);
            assert_eq!(further(3), [0; 8]);
            assert_eq!(further(10), [0]);
            assert_eq!(found.len(), 8 * 4 + 7 + 6 + 5 + 4 + 3 + 2 + 1);
        }
    }

    #[test]
    fn steps_of_one_hole_do_not_overlap() {
        let at = |z: f64, diameter: f64| hole([0.0, 0.0, z], [0.0, 0.0, 1.0], 10.0, diameter);
        assert_eq!(overlaps(&[at(0.0, 12.0), at(-5.0, 6.0)]), []);
        assert_eq!(overlaps(&[at(0.0, 12.0), at(-5.0, 12.0)]).len(), 1, "one diameter");
        let upwards = hole([0.0, 0.0, -20.0], [0.0, 0.0, -1.0], 12.0, 6.0);
        assert_eq!(overlaps(&[at(0.0, 12.0), upwards]).len(), 1, "from the far side");
    }

    /// Entries 20 mm apart, the axes tilted towards each other by 45°: they meet 10 mm below the surface.
    #[test]
    fn leaning_holes_overlap_where_they_are_deep_enough() {
        let s = 0.5f64.sqrt();
        let pair = |depth: f64| {
            [
                hole([-10.0, 0.0, 0.0], [-s, s, 0.0], depth, 2.0),
                hole([10.0, 0.0, 0.0], [s, s, 0.0], depth, 2.0),
            ]
        };
        // The bottoms are 20 − 2·depth·s apart: 2 mm at 12.73.
        assert_eq!(overlaps(&pair(12.7)).len(), 0);
        assert_eq!(overlaps(&pair(12.8)).len(), 1);
        // At this depth the axes cross.
        assert!(overlaps(&pair(20.0))[0].distance < 1e-9);
    }

    /// Crossing at right angles with 3 mm between them, in the middle of both.
    #[test]
    fn crossing_holes_are_as_far_apart_as_their_common_perpendicular() {
        let down = hole([0.0, 10.0, 0.0], [0.0, 1.0, 0.0], 20.0, 4.0);
        let across = hole([10.0, 0.0, 3.0], [1.0, 0.0, 0.0], 20.0, 3.0);
        assert!((overlaps(&[down.clone(), across])[0].distance - 3.0).abs() < 1e-12);
        let farther = hole([10.0, 0.0, 3.5], [1.0, 0.0, 0.0], 20.0, 3.0);
        assert_eq!(overlaps(&[down, farther]), []);
    }
}
