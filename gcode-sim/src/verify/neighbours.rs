//! How far each hole's neighbours stand: in a honeycomb every hole inside has six, all at the pitch.
use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::Serialize;

use super::Comparison;
use crate::holes::near::PointTree;
use crate::part::honeycomb::{Pattern, azimuth};

/// A hole has so many at most.
const SIX: usize = 6;

/// The neighbours of all holes, lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Neighbours {
    /// How distances count: `arc` or `chord`.
    pub metric: &'static str,
    /// The distance wanted of all neighbours: the pitch with which the pattern closes.
    pub wanted: f64,
    /// Of the holes wanted inside the pattern, those that are drilled and have all six; how many are wanted there.
    pub with_six: usize,
    pub with_six_wanted: usize,
    /// The two neighbours that are nearest to one another, and those that are farthest apart.
    pub min: Option<Distance>,
    pub max: Option<Distance>,
}

/// Between two holes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Distance {
    pub distance: f64,
    /// The holes by their ids; one nobody asked for by its place.
    pub between: [String; 2],
}

/// Of one hole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Around {
    pub count: usize,
    pub min: f64,
    pub max: f64,
    #[serde(skip)]
    nearest: usize,
    #[serde(skip)]
    farthest: usize,
}

/// For every drilled hole what is round it, in the order of the holes; the summary.
pub(super) fn neighbours(
    comparison: &Comparison<'_>,
    pattern: &Pattern,
) -> (Vec<Option<Around>>, Neighbours) {
    let found = comparison.found.iter().map(|hole| (hole.bottom(), hole.axis.into_inner()));
    let (around, places) = around(found, pattern);
    let wanted = comparison.wanted.iter().map(|hole| (Point3::from(hole.entry), Vector3::from(hole.axis)));
    let (around_wanted, _) = self::around(wanted, pattern);
    let mut names = vec![None; comparison.found.len()];
    for pair in &comparison.pairs {
        names[pair.found] = Some(comparison.id(pair.wanted));
    }
    let name = |index: usize| names[index].map_or_else(|| place(&places[index]), str::to_owned);
    let known = || around.iter().enumerate().filter_map(|(index, around)| Some((index, (*around)?)));
    let distance = |index: usize, other: usize, distance: f64| Distance {
        distance,
        between: [name(index.min(other)), name(index.max(other))],
    };
    let min = known().min_by(|a, b| a.1.min.total_cmp(&b.1.min));
    // Of equal ones the first, as for the smallest.
    let max = known().rev().max_by(|a, b| a.1.max.total_cmp(&b.1.max));
    let six = |around: &Option<Around>| around.is_some_and(|around| around.count == SIX);
    let inner = comparison.pairs.iter().filter(|pair| six(&around_wanted[pair.wanted]));
    let summary = Neighbours {
        metric: pattern.metric.name(),
        wanted: pattern.pitch,
        with_six: inner.filter(|pair| six(&around[pair.found])).count(),
        with_six_wanted: around_wanted.iter().filter(|around| six(around)).count(),
        min: min.map(|(index, around)| distance(index, around.nearest, around.min)),
        max: max.map(|(index, around)| distance(index, around.farthest, around.max)),
    };
    (around, summary)
}

/// What is round each of the holes, given by a point of the axis and its direction out of the part; `None` for one that
/// stands alone or misses the cylinder. And where they cross the cylinder.
fn around(
    holes: impl Iterator<Item = (Point3<f64>, Vector3<f64>)>,
    pattern: &Pattern,
) -> (Vec<Option<Around>>, Vec<Point3<f64>>) {
    let nowhere = Point3::from(Vector3::repeat(f64::INFINITY));
    let places: Vec<_> = holes.map(|(on, out)| pattern.crossing(&on, &out).unwrap_or(nowhere)).collect();
    let here: Vec<usize> = (0..places.len()).filter(|index| places[*index] != nowhere).collect();
    let tree = PointTree::new(here.iter().map(|index| places[*index]));
    // Halfway to those that are no neighbours any more.
    let reach = (pattern.pitch + pattern.abreast()) / 2.0;
    let mut near = vec![Near::default(); places.len()];
    // No way on the surface is shorter than the straight one: all neighbours are told.
    tree.pairs(reach, &mut |one, other| {
        let (one, other) = (here[one], here[other]);
        let distance = pattern.distance(&places[one], &places[other]);
        if distance <= reach {
            near[one].add(distance, other);
            near[other].add(distance, one);
        }
    });
    (near.iter().map(Near::around).collect(), places)
}

/// The neighbours of a hole with their distances: the six nearest, the nearest first, of equally near ones the first.
#[derive(Clone, Copy, Default)]
struct Near {
    count: usize,
    near: [(f64, usize); SIX],
}

impl Near {
    fn add(&mut self, distance: f64, other: usize) {
        let new = (distance, other);
        if self.count < SIX {
            self.count += 1;
        } else if self.near[SIX - 1] < new {
            return;
        }
        let mut place = self.count - 1;
        while 0 < place && new < self.near[place - 1] {
            self.near[place] = self.near[place - 1];
            place -= 1;
        }
        self.near[place] = new;
    }

    fn around(&self) -> Option<Around> {
        let near = &self.near[..self.count];
        let ((min, nearest), (max, farthest)) = (*near.first()?, *near.last()?);
        Some(Around { count: self.count, min, max, nearest, farthest })
    }
}

fn place(p: &Point3<f64>) -> String {
    format!("x {:.3} at {:.3}°", p.x, azimuth(p).0)
}
