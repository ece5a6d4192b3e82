//! A move of a path as drawings show it, alone or joined with those that follow it.
use std::ops::RangeInclusive;

use nalgebra::Point3;

/// One move in the frame of the part; of a grinder the path of the wheel's contact.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Numbers of its steps in the record: one, or several moves of one kind that are drawn together.
    pub steps: RangeInclusive<usize>,
    /// Number of moves.
    pub moves: usize,
    /// `rapid`, `feed`, `arc` or `probing move`.
    pub kind: &'static str,
    /// Feed of a cut, mm/min.
    pub feed: Option<f64>,
    /// True for a move that cuts a hole, or leaves one along the path of its cut.
    pub is_of_hole: bool,
    /// Number of its block in `Record::block_location`.
    pub block_number: usize,
    /// End whose place on the part is unknown.
    pub unplaced: Option<UnplacedEnd>,
    /// Points from start to end, mm; the known end alone if the other is unknown. If both are, the last known point, or before the
    /// first one the end at supposed coordinates.
    pub points: Vec<Point3<f64>>,
    /// Largest distance of the path from the line through `points`, mm; 0 of straight moves that are all there.
    pub deviation: f64,
    /// Points that deviate from the path by at most 0.001 mm; empty if `points` are these, or if there are too many.
    pub exact: Vec<Point3<f64>>,
}

/// End of a move whose place on the part is unknown: an axis has not been commanded before, or stands at machine coordinates
/// while the work offset is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnplacedEnd {
    /// The start.
    Start,
    /// The end.
    End,
    /// Start and end.
    Both,
}

impl Leg {
    /// Appends a move that follows.
    pub(super) fn join(&mut self, next: Leg) {
        self.steps = *self.steps.start()..=*next.steps.end();
        self.moves += next.moves;
        self.is_of_hole |= next.is_of_hole;
        if next.unplaced.is_some() {
            (self.points, self.exact, self.deviation) = (next.points, next.exact, next.deviation);
            return;
        }
        let is_exact = |leg: &Leg| !leg.exact.is_empty();
        if (is_exact(self) || self.deviation == 0.0) && (is_exact(&next) || next.deviation == 0.0) {
            if is_exact(self) || is_exact(&next) {
                if !is_exact(self) {
                    self.exact.clone_from(&self.points);
                }
                let more = if is_exact(&next) { &next.exact } else { &next.points };
                self.exact.extend(more.iter().skip(1));
            }
        } else {
            self.exact.clear();
        }
        self.deviation = self.deviation.max(next.deviation);
        self.points.extend(next.points.into_iter().skip(1));
    }

    /// Leaves out points that are no farther from the line than `tolerance`. They stay in `exact` if `room` points allow it;
    /// returns the rest of it.
    pub(super) fn simplify(&mut self, tolerance: f64, room: usize) -> usize {
        let few = simplified(&self.points, tolerance);
        if few.len() == self.points.len() {
            return room;
        }
        let all = std::mem::replace(&mut self.points, few);
        let is_complete = self.deviation == 0.0;
        self.deviation += tolerance;
        if !is_complete || room < all.len() {
            return room;
        }
        let rest = room - all.len();
        self.exact = all;
        rest
    }
}

/// Returns true if two moves have the same feed, to the rounding of a rate computed from a path and a time.
pub(super) fn is_same_feed(one: &Leg, other: &Leg) -> bool {
    match (one.feed, other.feed) {
        (Some(one), Some(other)) => (one - other).abs() <= 1e-9 * one.abs(),
        (one, other) => one == other,
    }
}

/// Returns the points of a line that are farther than `tolerance` from the line without them, and its ends (Douglas and Peucker).
fn simplified(points: &[Point3<f64>], tolerance: f64) -> Vec<Point3<f64>> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; points.len()];
    is_kept[0] = true;
    is_kept[last] = true;
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let away = |index: &usize| distance_to_line(&points[*index], &points[from], &points[to]);
        let farthest = (from + 1..to).max_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(farthest) = farthest.filter(|index| tolerance < away(index)) {
            is_kept[farthest] = true;
            open.extend([(from, farthest), (farthest, to)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(point, _)| *point).collect()
}

/// Returns the distance of a point from the line between two others, mm.
fn distance_to_line(point: &Point3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let along = to - from;
    let length = along.norm_squared();
    let part = if length == 0.0 { 0.0 } else { ((point - from).dot(&along) / length).clamp(0.0, 1.0) };
    (point - (from + along * part)).norm()
}
