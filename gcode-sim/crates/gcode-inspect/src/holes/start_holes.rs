//! Start holes: drilled or milled, and later removed whole by feeds across them, such as those of a pocket.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::arc_run::PartArc;
use super::axis_box::directions_across;
use super::drill_pass::DrillPass;
use crate::machine::{Machine, TOUCH_DEPTH};
use gcode_lang::units::Deg;

/// Largest number of holes that are followed; a pocket has one or two.
const MAX_FOLLOWED: usize = 16;

/// Rings of points on the bottom of a hole, its wall included, and the points of each.
const RINGS: u32 = 12;
const RING_POINTS: u32 = 48;

/// Cosine of the largest angle between the tool and a hole that it removes: 0.05°.
const MIN_PARALLEL_COSINE: f64 = 0.999_999_6;

/// Largest height of a level feed's end above its start, and of the feed above the bottom of a hole that it removes, mm: rounding.
const MAX_RISE: f64 = 0.003;

/// Largest angle between two points of an arc, degrees: a radius of 50 mm deviates by 0.005 mm.
const MAX_STEP: f64 = 1.6;

/// Hole at which the reference has none, with the points of its bottom that no later feed has reached.
#[derive(Debug)]
struct StartHole {
    /// Place of its pass.
    order: usize,
    centre: Point3<f64>,
    axis: Unit<Vector3<f64>>,
    radius: f64,
    points: Vec<Point3<f64>>,
}

/// Holes that later feeds may remove.
#[derive(Debug, Default)]
pub(super) struct StartHoles {
    followed: Vec<StartHole>,
    /// Places of the passes of removed holes, in their order.
    removed: Vec<usize>,
    /// Number of passes that have been looked through.
    seen: usize,
}

/// Level feed of a mill with a flat end.
struct FlatFeed {
    path: Vec<Point3<f64>>,
    axis: Unit<Vector3<f64>>,
    radius: f64,
}

impl StartHoles {
    /// Returns true if the pass made at a place is removed.
    pub(super) fn is_removed(&self, order: usize) -> bool {
        self.removed.binary_search(&order).is_ok()
    }

    /// Follows the new ones of some passes that make no nominal hole. Returns false if none is followed.
    pub(super) fn follow(
        &mut self,
        passes: &[DrillPass],
        machine: &Machine,
        is_nominal: impl Fn(&DrillPass) -> bool,
    ) -> bool {
        for pass in passes.get(self.seen..).unwrap_or_default() {
            if self.followed.len() == MAX_FOLLOWED {
                break;
            }
            let diameter = pass.diameter(machine).filter(|_| !is_nominal(pass));
            self.followed.extend(diameter.map(|diameter| StartHole::new(pass, diameter / 2.0)));
        }
        self.seen = passes.len();
        !self.followed.is_empty()
    }

    /// Removes what a feed reaches of the holes.
    fn remove(&mut self, feed: &FlatFeed) {
        let Self { followed, removed, .. } = self;
        for chord in feed.path.windows(2) {
            for hole in followed.iter_mut().filter(|hole| hole.is_near(chord, feed)) {
                hole.points.retain(|point| !feed.reaches(chord, point));
            }
        }
        for hole in followed.extract_if(.., |hole| hole.points.is_empty()) {
            let place = removed.partition_point(|order| *order < hole.order);
            removed.insert(place, hole.order);
        }
    }
}

impl StartHole {
    fn new(pass: &DrillPass, radius: f64) -> Self {
        let (centre, axis) = (pass.cut.bottom, pass.axis);
        let [u, v] = directions_across(&axis);
        let ring = |ring: u32| {
            let radius = radius * f64::from(ring) / f64::from(RINGS);
            (0..RING_POINTS).map(move |point| {
                let angle = Deg(360.0 * f64::from(point) / f64::from(RING_POINTS));
                centre + (u * angle.cos() + v * angle.sin()) * radius
            })
        };
        let points = (1..=RINGS).flat_map(ring).chain([centre]).collect();
        Self { order: pass.cut.order, centre, axis, radius, points }
    }

    /// Returns true if a feed may reach the hole at its bottom.
    fn is_near(&self, chord: &[Point3<f64>], feed: &FlatFeed) -> bool {
        let is_parallel = MIN_PARALLEL_COSINE <= self.axis.dot(&feed.axis);
        let is_as_deep = (chord[0] - self.centre).dot(&self.axis) <= MAX_RISE;
        is_parallel && is_as_deep && distance(chord, &self.centre, &feed.axis) <= self.radius + feed.radius
    }
}

impl FlatFeed {
    fn reaches(&self, chord: &[Point3<f64>], point: &Point3<f64>) -> bool {
        distance(chord, point, &self.axis) <= self.radius + TOUCH_DEPTH
    }
}

/// Returns the distance of a point from a chord, seen along an axis.
fn distance(chord: &[Point3<f64>], point: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> f64 {
    let across = |v: Vector3<f64>| v - axis.into_inner() * v.dot(axis);
    let (along, to) = (across(chord[1] - chord[0]), across(point - chord[0]));
    let share = if along.norm_squared() < 1e-18 { 0.0 } else { to.dot(&along) / along.norm_squared() };
    (to - along * share.clamp(0.0, 1.0)).norm()
}

impl HoleExtractor<'_> {
    /// Removes what a feed across the tool, straight or on an arc, takes of start holes.
    pub(super) fn remove_start_holes(&mut self, from: &Point3<f64>, arc: Option<&PartArc>) {
        if !self.strokes.follow_start_holes(self.machine) {
            return;
        }
        let (Some(axis), Some(end)) =
            (self.pose.axis, self.machine.tool_end(self.setup.tool).first().copied())
        else {
            return;
        };
        let to = self.pose.tip;
        let is_level = ((to - from).dot(&axis)).abs() <= MAX_RISE;
        if !is_level || TOUCH_DEPTH < end.from {
            return;
        }
        let path = match arc {
            None => vec![*from, to],
            Some(arc) => {
                let steps = (arc.sweep.0.abs() / MAX_STEP).ceil().max(1.0) as u32;
                (0..=steps).map(|step| arc.point(f64::from(step) / f64::from(steps))).collect()
            }
        };
        let feed = FlatFeed { path, axis, radius: end.radius() };
        self.strokes.start_holes.remove(&feed);
    }
}
