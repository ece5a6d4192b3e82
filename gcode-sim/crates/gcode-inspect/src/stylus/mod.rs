//! Motion → readings: an edge finder whose ball is fed along the part's surface.
//!
//! Feeds along the surface are passes; approach and retract cross it. A feed more than 5 mm away, or
//! across the surface, has no reading: within the path that is an error.
mod ball;
mod rapids;
#[cfg(test)]
mod tests;
mod unknown;
mod unread;

use nalgebra::{Point3, Unit};

use self::ball::{Ball, BallMove, BallUpdate};
use self::unknown::UnknownPositions;
use self::unread::{UnreadFeed, UnreadFeeds, UnreadReason};
use crate::holes::unclear_head;
use crate::holes::unknown_axes::PositionTracker;
use crate::machine::{AxisMotion, BALL_CHORD_TOLERANCE, Machine, Placement};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event, EventKind, EventSink, UnknownAxes};
use gcode_part::PartSolid;

pub use self::rapids::RapidChecker;
pub use self::unread::Gap;

/// Largest distance of the ball from the surface with a reading, mm: more than the error of a coarse alignment.
const MAX_READING_DISTANCE: f64 = 5.0;

/// Largest deviation of the path from its chords where only its length and depth count, mm.
const COARSE_CHORD_TOLERANCE: f64 = 0.01;

/// Number of readings per chord, besides the nearest point.
const READINGS_PER_CHORD: u32 = 4;

/// Largest number of readings: an endless loop must not fill the memory.
const MAX_READINGS: usize = 500_000;

/// Largest number of points on feeds without a reading: some seconds of computation.
const MAX_UNREAD_POINTS: usize = 2_000_000;

/// Sine of the largest angle to the surface of a feed along it: 30°.
const MAX_RISE: f64 = 0.5;

/// Course of a feed.
enum FeedCourse {
    /// Near the surface and along it: it has readings.
    AlongSurface,
    /// The ball does not move relative to the part.
    Stationary,
    Unread(UnreadReason),
}

/// One point of a pass; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Length of the path since the start of the pass.
    pub path_length: f64,
    /// Centre of the ball in the frame of the part at its nominal position.
    pub ball_centre: Point3<f64>,
    /// Distance from the ball to the surface; negative if the ball is deflected.
    pub value: f64,
    /// Index of the move in [`ReadingPass::backtraces`].
    pub move_index: usize,
}

/// A path along the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadingPass {
    /// Readings in order.
    pub readings: Vec<Reading>,
    /// Block of each move.
    pub backtraces: Vec<Backtrace>,
}

impl ReadingPass {
    /// Returns the least and the greatest reading; `None` for a pass without readings.
    pub fn extremes(&self) -> Option<(Reading, Reading)> {
        let order = |one: &&Reading, other: &&Reading| one.value.total_cmp(&other.value);
        Some((*self.readings.iter().min_by(order)?, *self.readings.iter().max_by(order)?))
    }

    /// Returns the length of the path, mm.
    pub fn length(&self) -> f64 {
        self.readings.last().map_or(0.0, |last| last.path_length)
    }
}

/// Readings of an edge finder during a program.
#[derive(Clone, Debug, Default)]
pub struct StylusReadings {
    /// Paths along the surface, in order.
    pub passes: Vec<ReadingPass>,
    /// Stretches of the path without readings, in order.
    pub gaps: Vec<Gap>,
    /// Number of feeds to the surface and of feeds from it; they have no readings.
    pub approach_retract_counts: [usize; 2],
    /// Findings about the path.
    pub findings: Vec<Diagnostic>,
}

/// Sink for the events of a run that reads the ball.
#[derive(Debug)]
pub struct Stylus<'m> {
    machine: &'m Machine,
    /// The same machine with the part at its nominal position.
    nominal_machine: Machine,
    part: PartSolid,
    /// Radius of the ball, mm.
    radius: f64,
    ball: Ball,
    positions: PositionTracker,
    unknown_positions: UnknownPositions,
    current_pass: Option<ReadingPass>,
    unread_feeds: UnreadFeeds,
    result: StylusReadings,
    reading_count: usize,
    /// Points of feeds without a reading.
    unread_points: usize,
}

impl<'m> Stylus<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine, part: impl Into<PartSolid>, radius: f64) -> Self {
        let nominal = Placement { origin: machine.part.origin, ..Placement::default() };
        Self {
            machine,
            nominal_machine: Machine { part: nominal, ..machine.clone() },
            part: part.into(),
            radius,
            ball: Ball::default(),
            positions: PositionTracker::default(),
            unknown_positions: UnknownPositions::default(),
            current_pass: None,
            unread_feeds: UnreadFeeds::default(),
            result: StylusReadings::default(),
            reading_count: 0,
            unread_points: 0,
        }
    }

    /// Ends the run and returns its readings.
    pub fn finish(mut self) -> StylusReadings {
        self.end_pass();
        self.unread_feeds.finish(self.result.passes.len());
        let UnreadFeeds { gaps, approach_retract_counts, mut findings, .. } = self.unread_feeds;
        findings.extend(self.unknown_positions.finish().chain(self.result.findings));
        StylusReadings { gaps, approach_retract_counts, findings, ..self.result }
    }

    fn end_pass(&mut self) {
        self.result.passes.extend(self.current_pass.take());
    }

    /// Reads a motion; `unknown` are the axes of unknown position at its start or its end.
    fn motion(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, kind: BallMove, unknown: UnknownAxes) {
        if self.is_full() || (travel.from == travel.to && travel.arc.is_none()) {
            return;
        }
        if kind != BallMove::Feed {
            self.end_pass();
            return self.unread_feeds.end_path(self.result.passes.len());
        }
        match self.feed_course(travel) {
            FeedCourse::AlongSurface => {}
            FeedCourse::Stationary => return,
            FeedCourse::Unread(reason) => {
                self.end_pass();
                let unread = self.measure_unread(event, travel, reason);
                self.unread_feeds.push(unread);
                return self.report_limit(event);
            }
        }
        self.unknown_positions.report(self.machine, event, unknown, "the part's surface is read");
        if self.current_pass.is_none() {
            self.unread_feeds.begin_reading(self.result.passes.len());
        }
        let mut pass = self.current_pass.take().unwrap_or_default();
        let before = pass.readings.len();
        pass.backtraces.push(event.backtrace());
        let first = pass.readings.is_empty().then_some(0.0);
        for t in first.into_iter().chain(self.stations(travel)) {
            let reading = self.reading_at(travel, t, &pass);
            pass.readings.push(reading);
        }
        self.reading_count += pass.readings.len() - before;
        self.current_pass = Some(pass);
        self.report_limit(event);
    }

    fn is_full(&self) -> bool {
        self.reading_count > MAX_READINGS || self.unread_points > MAX_UNREAD_POINTS
    }

    /// Reports a limit once it is exceeded.
    fn report_limit(&mut self, event: &Event<'_>) {
        let points = if self.reading_count > MAX_READINGS {
            format!("{MAX_READINGS} points along the surface")
        } else if self.unread_points > MAX_UNREAD_POINTS {
            format!("{MAX_UNREAD_POINTS} points of feeds without a reading")
        } else {
            return;
        };
        let finding = Diagnostic::new(&LIMIT, format!("more than {points}: no readings after this"))
            .with_backtrace(event.backtrace())
            .help("check for a loop that never ends; otherwise split the program");
        self.result.findings.push(finding);
    }

    /// Returns the centre of the ball after the fraction `t` of a motion, in the part's frame.
    fn tip(&self, travel: &AxisMotion<'_>, t: f64) -> Point3<f64> {
        self.machine.forward(&travel.position(t), &self.ball.setup).tip
    }

    /// Returns the distance of the ball from the surface; negative if it is deflected.
    fn distance(&self, tip: &Point3<f64>) -> f64 {
        self.part.nearest(tip).distance - self.radius
    }

    /// Returns the course of a feed from its start, middle and end.
    fn feed_course(&self, travel: &AxisMotion<'_>) -> FeedCourse {
        let tip = |t: f64| self.tip(travel, t);
        // Whether the ball is near, and the sine of the angle at which it leaves the surface.
        let samples = [0.0, 0.5, 1.0].map(|t| {
            let (step, here) = (1e-3, tip(t));
            let direction = if t < 1.0 { tip(t + step) - here } else { here - tip(t - step) };
            let nearest = self.part.nearest(&here);
            let rise = Unit::try_new(direction, 1e-12).map(|direction| direction.dot(&nearest.normal));
            ((nearest.distance - self.radius).abs() <= MAX_READING_DISTANCE, rise)
        });
        let all = |holds: fn(f64) -> bool| samples.iter().all(|(_, rise)| rise.is_some_and(holds));
        if samples.iter().all(|(_, rise)| rise.is_none()) {
            FeedCourse::Stationary
        } else if samples.iter().all(|(near, _)| *near) && all(|rise| rise.abs() <= MAX_RISE) {
            FeedCourse::AlongSurface
        } else if all(|rise| rise < -MAX_RISE) {
            FeedCourse::Unread(UnreadReason::Approach)
        } else if all(|rise| rise > MAX_RISE) {
            FeedCourse::Unread(UnreadReason::Retract)
        } else {
            FeedCourse::Unread(UnreadReason::Stray)
        }
    }

    /// Returns the length of a feed without readings, and its least and largest distance from the surface.
    fn measure_unread(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        reason: UnreadReason,
    ) -> UnreadFeed {
        let mut last = self.tip(travel, 0.0);
        let distance = self.distance(&last);
        let mut feed = UnreadFeed {
            backtrace: event.backtrace(),
            reason,
            length: 0.0,
            min_distance: distance,
            max_distance: distance,
        };
        for chord in self.ball.chords(self.machine, travel, COARSE_CHORD_TOLERANCE) {
            let here = self.tip(travel, chord(1.0));
            let nearest = last + (here - last) * self.part.nearest_between(&last, &here);
            let distance = self.distance(&here);
            feed.length += (here - last).norm();
            feed.min_distance = feed.min_distance.min(self.distance(&nearest)).min(distance);
            feed.max_distance = feed.max_distance.max(distance);
            last = here;
            self.unread_points += 1;
        }
        feed
    }

    /// Returns the fractions of a motion at which the ball is read, beyond 0 up to 1.
    fn stations(&self, travel: &AxisMotion<'_>) -> Vec<f64> {
        let mut stations = Vec::new();
        for chord in self.ball.chords(self.machine, travel, BALL_CHORD_TOLERANCE) {
            let [start, end] = [0.0, 1.0].map(|t| self.tip(travel, chord(t)));
            let nearest = self.part.nearest_between(&start, &end);
            let even = (1..=READINGS_PER_CHORD).map(|n| f64::from(n) / f64::from(READINGS_PER_CHORD));
            let mut inside: Vec<f64> =
                even.chain((0.0 < nearest && nearest < 1.0).then_some(nearest)).collect();
            inside.sort_by(f64::total_cmp);
            stations.extend(inside.into_iter().map(chord));
        }
        stations
    }

    fn reading_at(&self, travel: &AxisMotion<'_>, t: f64, pass: &ReadingPass) -> Reading {
        let ball_centre = self.nominal_machine.forward(&travel.position(t), &self.ball.setup).tip;
        let step = |last: &Reading| last.path_length + (ball_centre - last.ball_centre).norm();
        Reading {
            path_length: pass.readings.last().map_or(0.0, step),
            ball_centre,
            value: self.distance(&self.tip(travel, t)),
            move_index: pass.backtraces.len() - 1,
        }
    }
}

impl EventSink for Stylus<'_> {
    fn event(&mut self, event: &Event<'_>) {
        if let EventKind::Start { unknown: axes, .. } | EventKind::PositionUnknown { axes } = event.kind {
            self.positions.apply_event(self.machine, *axes);
        }
        match self.ball.apply_event(self.machine, event) {
            BallUpdate::Moved { from, to, arc, kind } => {
                let (was, is) = self.positions.advance(self.machine);
                self.motion(event, &AxisMotion { from: &from, to, arc }, kind, was.union(is));
            }
            BallUpdate::Changed => self.end_pass(),
            BallUpdate::Unclear(text) => {
                self.result.findings.push(unclear_head(text).with_backtrace(event.backtrace()));
            }
            BallUpdate::Unchanged => {}
        }
    }
}
