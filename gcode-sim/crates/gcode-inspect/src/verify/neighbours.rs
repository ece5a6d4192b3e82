//! Distances of neighbouring holes: in a honeycomb every inner hole has six neighbours, all at the pitch.
use std::cmp::Ordering;

use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

use super::Comparison;
use gcode_part::PointTree;
use gcode_part::{Pattern, azimuth};

/// Largest number of neighbours of a hole.
const MAX_NEIGHBOURS: usize = 6;

/// The neighbours of all holes, lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Neighbours {
    /// The metric of distances: `arc` or `chord`.
    pub metric: &'static str,
    /// The nominal distance of all neighbours: the pitch with which the pattern closes.
    #[serde(rename = "wanted")]
    pub nominal: f64,
    /// Number of inner holes that are drilled and have all six neighbours.
    pub with_six: usize,
    /// The nominal number of inner holes.
    #[serde(rename = "with_six_wanted")]
    pub with_six_nominal: usize,
    /// The two nearest neighbours.
    pub min: Option<Distance>,
    /// The two farthest neighbours.
    pub max: Option<Distance>,
}

/// Distance of two holes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Distance {
    /// Distance in the metric of the pattern.
    pub distance: f64,
    /// The holes by their ids; an extra hole by its position.
    pub between: [String; 2],
}

/// Neighbours of one hole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HoleNeighbours {
    /// Number of neighbours.
    pub count: usize,
    /// Distance of the nearest.
    pub min: f64,
    /// Distance of the farthest.
    pub max: f64,
    #[serde(skip)]
    nearest: usize,
    #[serde(skip)]
    farthest: usize,
}

/// Returns the neighbours of each drilled hole, and the summary.
pub(super) fn neighbours(
    comparison: &Comparison<'_>,
    pattern: &Pattern,
) -> (Vec<Option<HoleNeighbours>>, Neighbours) {
    let drilled = comparison.actual.iter().map(|hole| (hole.bottom(), hole.axis.into_inner()));
    let lines: Vec<usize> = comparison.actual.iter().map(|hole| hole.first_on_line).collect();
    let (around, points) = neighbours_of(drilled, &lines, pattern);
    let nominal = comparison.nominal.iter().map(|hole| (Point3::from(hole.entry), Vector3::from(hole.axis)));
    let lines: Vec<usize> = (0..comparison.nominal.len()).collect();
    let (nominal_around, _) = neighbours_of(nominal, &lines, pattern);
    let mut names = vec![None; comparison.actual.len()];
    for pair in &comparison.pairs {
        names[pair.actual] = Some(comparison.id(pair.nominal));
    }
    let name = |index: usize| names[index].map_or_else(|| format_point(&points[index]), str::to_owned);
    let known = || around.iter().enumerate().filter_map(|(index, around)| Some((index, (*around)?)));
    let distance = |index: usize, other: usize, distance: f64| Distance {
        distance,
        between: [name(index.min(other)), name(index.max(other))],
    };
    let min = known().min_by(|a, b| a.1.min.total_cmp(&b.1.min));
    // The first of equal ones, as for the minimum.
    let max = known().rev().max_by(|a, b| a.1.max.total_cmp(&b.1.max));
    let has_six =
        |around: &Option<HoleNeighbours>| around.is_some_and(|around| around.count == MAX_NEIGHBOURS);
    let inner = comparison.pairs.iter().filter(|pair| has_six(&nominal_around[pair.nominal]));
    let summary = Neighbours {
        metric: pattern.metric.name(),
        nominal: pattern.pitch,
        with_six: inner.filter(|pair| has_six(&around[pair.actual])).count(),
        with_six_nominal: nominal_around.iter().filter(|around| has_six(around)).count(),
        min: min.map(|(index, around)| distance(index, around.nearest, around.min)),
        max: max.map(|(index, around)| distance(index, around.farthest, around.max)),
    };
    (around, summary)
}

/// Returns the neighbours of each hole, `None` if it has none or misses the cylinder, and its point on the cylinder. A hole
/// is a point of its axis and the direction out of the part; `lines` is the line of each.
fn neighbours_of(
    holes: impl Iterator<Item = (Point3<f64>, Vector3<f64>)>,
    lines: &[usize],
    pattern: &Pattern,
) -> (Vec<Option<HoleNeighbours>>, Vec<Point3<f64>>) {
    let nowhere = Point3::from(Vector3::repeat(f64::INFINITY));
    let points: Vec<_> = holes.map(|(on, out)| pattern.crossing(&on, &out).unwrap_or(nowhere)).collect();
    let on_cylinder: Vec<usize> = (0..points.len()).filter(|index| points[*index] != nowhere).collect();
    let mut near = vec![NearestSix::default(); points.len()];
    let here = thin_crowded_spots(on_cylinder, lines, &points, &mut near);
    let tree = PointTree::new(here.iter().map(|index| points[*index]));
    // Halfway to the next holes after the neighbours.
    let reach = (pattern.pitch + pattern.second_neighbour_distance()) / 2.0;
    // A distance on the surface is not below the straight one: the tree finds all neighbours.
    tree.pairs(reach, &mut |one, other| {
        let (one, other) = (here[one], here[other]);
        let distance = pattern.distance(&points[one], &points[other]);
        if distance <= reach {
            near[one].add(distance, other);
            near[other].add(distance, one);
        }
    });
    (near.iter().map(NearestSix::summary).collect(), points)
}

/// Returns the holes without the eighth and later ones at one point: these are no neighbours of others, and have the first
/// six as theirs. Any number of holes at one point then takes n log n.
fn thin_crowded_spots(
    mut holes: Vec<usize>,
    lines: &[usize],
    points: &[Point3<f64>],
    nearest_six: &mut [NearestSix],
) -> Vec<usize> {
    let mut kept = Vec::with_capacity(holes.len());
    for line in holes.chunk_by_mut(|one, other| lines[*one] == lines[*other]) {
        if line.len() <= MAX_NEIGHBOURS + 1 {
            kept.extend_from_slice(line);
            continue;
        }
        line.sort_unstable_by(|one, other| {
            compare_points(&points[*one], &points[*other]).then(one.cmp(other))
        });
        for spot in line.chunk_by(|one, other| compare_points(&points[*one], &points[*other]).is_eq()) {
            let (first, others) = spot.split_at(spot.len().min(MAX_NEIGHBOURS + 1));
            kept.extend_from_slice(first);
            for one in others {
                first[..MAX_NEIGHBOURS].iter().for_each(|other| nearest_six[*one].add(0.0, *other));
            }
        }
    }
    kept
}

/// The six nearest neighbours of a hole and their distances in ascending order, the first of equal ones.
#[derive(Clone, Copy, Default)]
struct NearestSix {
    count: usize,
    nearest: [(f64, usize); MAX_NEIGHBOURS],
}

impl NearestSix {
    fn add(&mut self, distance: f64, other: usize) {
        let new = (distance, other);
        if self.count < MAX_NEIGHBOURS {
            self.count += 1;
        } else if self.nearest[MAX_NEIGHBOURS - 1] < new {
            return;
        }
        let mut index = self.count - 1;
        while 0 < index && new < self.nearest[index - 1] {
            self.nearest[index] = self.nearest[index - 1];
            index -= 1;
        }
        self.nearest[index] = new;
    }

    fn summary(&self) -> Option<HoleNeighbours> {
        let near = &self.nearest[..self.count];
        let ((min, nearest), (max, farthest)) = (*near.first()?, *near.last()?);
        Some(HoleNeighbours { count: self.count, min, max, nearest, farthest })
    }
}

/// Compares points so that equal ones are adjacent.
fn compare_points(one: &Point3<f64>, other: &Point3<f64>) -> Ordering {
    let along = |axis: usize| one[axis].total_cmp(&other[axis]);
    along(0).then_with(|| along(1)).then_with(|| along(2))
}

fn format_point(p: &Point3<f64>) -> String {
    format!("x {:.3} at {:.3}°", p.x, azimuth(p).0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use gcode_lang::units::Deg;
    use gcode_part::job::Metric;

    const PATTERN: Pattern = Pattern {
        metric: Metric::Arc,
        diameter: 100.0,
        rows: 30,
        pitch: 12.0,
        specified_pitch: None,
        length: 90.0,
        outer: 100.0,
        bore: 0.0,
    };

    /// Returns a hole of the cylinder: x in mm, azimuth in degrees.
    fn hole(x: f64, azimuth: f64) -> (Point3<f64>, Vector3<f64>) {
        let out = Vector3::new(0.0, Deg(azimuth).sin(), Deg(azimuth).cos());
        (Point3::new(x, 0.0, 0.0) + out * 38.0, out)
    }

    /// Returns the neighbours by sorting all distances.
    fn by_comparing_all(points: &[Point3<f64>], pattern: &Pattern) -> Vec<Option<HoleNeighbours>> {
        let reach = (pattern.pitch + pattern.second_neighbour_distance()) / 2.0;
        let round = |index: usize| {
            let others = (0..points.len()).filter(|other| *other != index);
            let mut all: Vec<_> =
                others.map(|other| (pattern.distance(&points[index], &points[other]), other)).collect();
            all.retain(|(distance, _)| *distance <= reach);
            all.sort_by(|a, b| a.partial_cmp(b).unwrap());
            all.truncate(6);
            let ((min, nearest), (max, farthest)) = (*all.first()?, *all.last()?);
            Some(HoleNeighbours { count: all.len(), min, max, nearest, farthest })
        };
        (0..points.len()).map(round).collect()
    }

    /// Each of ten holes at one point has six neighbours at 0; one 5 mm beside them has six of them at 5.
    #[test]
    fn ten_holes_at_one_point_are_six_neighbours() {
        let holes = std::iter::repeat_n(hole(20.0, 30.0), 10).chain([hole(25.0, 30.0), hole(80.0, 30.0)]);
        let (around, _) = neighbours_of(holes, &[[7; 10].as_slice(), &[17, 18]].concat(), &PATTERN);
        let seen: Vec<_> = around.iter().map(|one| one.map(|one| (one.count, one.min, one.max))).collect();
        assert_eq!(seen[..10], [Some((6, 0.0, 0.0)); 10]);
        assert_eq!(seen[10..], [Some((6, 5.0, 5.0)), None]);
        let beside = around[10].unwrap();
        assert_eq!((beside.nearest, beside.farthest), (0, 5), "the first six of equal ones");
    }

    /// These are 5·10⁹ pairs.
    #[test]
    fn a_hundred_thousand_holes_at_one_point_take_no_pairwise_search() {
        let (around, _) =
            neighbours_of(std::iter::repeat_n(hole(20.0, 30.0), 100_000), &[0; 100_000], &PATTERN);
        assert_eq!(around.len(), 100_000);
        assert!(around.iter().all(|one| one.is_some_and(|one| (one.count, one.max) == (6, 0.0))));
    }

    proptest! {
        #[test]
        fn neighbours_are_those_of_a_comparison_with_all_holes(
            spots in prop::collection::btree_map((0i32..5, -3i32..4), 1usize..12, 1..14)
                .prop_map(Vec::from_iter)
                .prop_shuffle(),
            chord in any::<bool>(),
        ) {
            let metric = if chord { Metric::Chord } else { Metric::Arc };
            let pattern = Pattern { metric, ..PATTERN };
            let lines: Vec<usize> = (0..spots.len()).flat_map(|line| vec![line; spots[line].1]).collect();
            let holes = lines.iter().map(|line| {
                let ((x, row), _) = spots[*line];
                hole(f64::from(x) * 4.0, f64::from(row) * 6.0)
            });
            let (around, points) = neighbours_of(holes, &lines, &pattern);
            prop_assert_eq!(around, by_comparing_all(&points, &pattern));
        }
    }
}
