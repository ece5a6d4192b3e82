//! Least straight-line distance of two polylines.
use std::ops::Range;

use nalgebra::{Point3, Vector3};

/// Returns the least distance of two polylines and the segment of the first at which it occurs, the first of equal ones;
/// `None` if one has no segment.
pub(super) fn distance(first: &[Point3<f64>], second: &[Point3<f64>]) -> Option<(f64, usize)> {
    let all = |path: &[Point3<f64>]| 0..path.len().saturating_sub(1);
    let mut search = DistanceSearch { paths: [Path::of(first), Path::of(second)], best: None };
    if !all(first).is_empty() && !all(second).is_empty() {
        search.search([all(first), all(second)]);
    }
    search.best
}

/// Branch and bound: halves the longer stretch while its lower bound is below the best distance.
struct DistanceSearch<'p> {
    paths: [Path<'p>; 2],
    best: Option<(f64, usize)>,
}

struct Path<'p> {
    points: &'p [Point3<f64>],
    /// Length of the path up to each point.
    lengths: Vec<f64>,
}

impl DistanceSearch<'_> {
    /// Searches two stretches of at least one segment each; the recursion depth is that of two halvings.
    fn search(&mut self, stretches: [Range<usize>; 2]) {
        let [one, other] = &stretches;
        if one.len() == 1 && other.len() == 1 {
            let near = (
                segment_distance(self.paths[0].segment(one.start), self.paths[1].segment(other.start)),
                one.start,
            );
            if self.best.is_none_or(|best| near < best) {
                self.best = Some(near);
            }
            return;
        }
        let reach = |path: usize| self.paths[path].reach(&stretches[path]);
        let longer = usize::from(one.len() == 1 || 1 < other.len() && reach(0) < reach(1));
        let whole = stretches[longer].clone();
        let middle = whole.start + whole.len() / 2;
        let halves = [whole.start..middle, middle..whole.end].map(|half| {
            let mut halved = stretches.clone();
            halved[longer] = half;
            (self.lower_bound(&halved), halved)
        });
        let [first, second] = halves;
        let sorted = if second.0 < first.0 { [second, first] } else { [first, second] };
        for (least, halved) in sorted {
            if self.best.is_none_or(|(best, _)| least <= best) {
                self.search(halved);
            }
        }
    }

    /// Returns a lower bound of the distance of two stretches.
    fn lower_bound(&self, [one, other]: &[Range<usize>; 2]) -> f64 {
        let [first, second] = &self.paths;
        (first.middle(one) - second.middle(other)).norm() - first.reach(one) - second.reach(other)
    }
}

impl<'p> Path<'p> {
    fn of(points: &'p [Point3<f64>]) -> Self {
        let mut length = 0.0;
        let steps = points.windows(2).map(|pair| {
            length += (pair[1] - pair[0]).norm();
            length
        });
        Self { points, lengths: std::iter::once(0.0).chain(steps).collect() }
    }

    fn segment(&self, index: usize) -> [Point3<f64>; 2] {
        [self.points[index], self.points[index + 1]]
    }

    fn middle(&self, stretch: &Range<usize>) -> Point3<f64> {
        self.points[Self::halfway(stretch)]
    }

    /// Returns an upper bound of the distance of the stretch's points from its middle.
    fn reach(&self, stretch: &Range<usize>) -> f64 {
        let middle = self.lengths[Self::halfway(stretch)];
        (middle - self.lengths[stretch.start]).max(self.lengths[stretch.end] - middle)
    }

    fn halfway(stretch: &Range<usize>) -> usize {
        stretch.start.midpoint(stretch.end)
    }
}

/// Returns the distance of two segments.
fn segment_distance(one: [Point3<f64>; 2], other: [Point3<f64>; 2]) -> f64 {
    let (u, v, between) = (one[1] - one[0], other[1] - other[0], one[0] - other[0]);
    let ends = [
        point_segment_distance(&one[0], &other),
        point_segment_distance(&one[1], &other),
        point_segment_distance(&other[0], &one),
        point_segment_distance(&other[1], &one),
    ];
    let nearest_end = ends.into_iter().fold(f64::INFINITY, f64::min);
    line_distance(&u, &v, &between).map_or(nearest_end, |apart| apart.min(nearest_end))
}

/// Returns the length of the common perpendicular of two lines; `None` if it misses one of the segments.
fn line_distance(u: &Vector3<f64>, v: &Vector3<f64>, between: &Vector3<f64>) -> Option<f64> {
    let (a, b, c) = (u.dot(u), u.dot(v), v.dot(v));
    let (d, e) = (u.dot(between), v.dot(between));
    let square = a * c - b * b;
    if square <= 1e-12 * a * c {
        return None;
    }
    let (s, t) = ((b * e - c * d) / square, (a * e - b * d) / square);
    let on = |part: f64| (0.0..=1.0).contains(&part);
    (on(s) && on(t)).then(|| (between + u * s - v * t).norm())
}

fn point_segment_distance(point: &Point3<f64>, piece: &[Point3<f64>; 2]) -> f64 {
    let (along, from) = (piece[1] - piece[0], point - piece[0]);
    let square = along.norm_squared();
    let part = if square == 0.0 { 0.0 } else { (from.dot(&along) / square).clamp(0.0, 1.0) };
    (from - along * part).norm()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn path(points: &[[f64; 3]]) -> Vec<Point3<f64>> {
        points.iter().map(|at| Point3::from(*at)).collect()
    }

    /// Crossing 3 above each other; end to end 5 (3, 4) apart; parallel 2 apart.
    #[test]
    fn the_distance_counts_between_the_points_too() {
        let line = path(&[[-10.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [10.0, 0.0, 0.0]]);
        let over = path(&[[1.0, -7.0, 3.0], [1.0, 9.0, 3.0]]);
        assert_eq!(distance(&line, &over), Some((3.0, 1)));
        assert_eq!(distance(&over, &line), Some((3.0, 0)));
        let beyond = path(&[[13.0, 4.0, 0.0], [20.0, 4.0, 0.0], [20.0, 40.0, 0.0]]);
        assert_eq!(distance(&line, &beyond), Some((5.0, 1)));
        let beside = path(&[[-3.0, 2.0, 0.0], [3.0, 2.0, 0.0]]);
        assert_eq!(distance(&line, &beside), Some((2.0, 0)));
        assert_eq!(distance(&line, &line[..1]), None);
    }

    /// A path that comes near only after a long way and a bend: 0.5 at its third point.
    #[test]
    fn the_nearest_point_may_follow_a_bend() {
        let line = path(&[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]);
        let bent = path(&[[0.0, 30.0, 0.0], [30.0, 30.0, 0.0], [50.0, 0.5, 0.0], [60.0, 30.0, 0.0]]);
        assert_eq!(distance(&line, &bent), Some((0.5, 0)));
        assert_eq!(distance(&bent, &line), Some((0.5, 1)));
    }

    proptest! {
        /// Compares with all pairs of segments.
        #[test]
        fn no_pair_of_segments_is_nearer(
            one in prop::collection::vec(prop::array::uniform3(-5i32..5), 2..24),
            other in prop::collection::vec(prop::array::uniform3(-5i32..5), 2..24),
        ) {
            let [one, other] = [one, other].map(|path| {
                path.into_iter().map(|at| Point3::from(at.map(f64::from))).collect::<Vec<_>>()
            });
            let each = |path: &[Point3<f64>]| {
                path.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()
            };
            let pairs = each(&one).into_iter().enumerate().flat_map(|(index, piece)| {
                each(&other).into_iter().map(move |there| (segment_distance(piece, there), index))
            });
            let least = pairs.reduce(|best, near| if near < best { near } else { best });
            let (found, expected) = (distance(&one, &other).unwrap(), least.unwrap());
            prop_assert!((found.0 - expected.0).abs() < 1e-12, "{found:?} {expected:?}");
        }
    }
}
