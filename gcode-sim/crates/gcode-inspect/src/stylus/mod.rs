//! Motion → readings: what an edge finder shows whose ball is fed along the part's surface.
//!
//! Feeds along the surface are a pass; approach and retract cross it. What is farther away than [`MAX_READING_DISTANCE`] or lies across
//! has no reading: where the path should have gone on there, that is an error.
use gcode_lang::alarm::kinds::LIMIT;
mod ball;
mod rapids;
#[cfg(test)]
mod tests;
mod unread;

use nalgebra::{Point3, Unit};

use crate::holes::unclear_head;
use crate::machine::path::AxisMotion;
use crate::machine::{Machine, Placement};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event, EventSink};
use gcode_part::Surface;

use self::ball::{Ball, BallMove, BallUpdate};
use self::unread::{UnreadFeed, UnreadFeeds, UnreadReason};

pub use self::rapids::RapidChecker;
pub use self::unread::Gap;

/// From how far the ball may stand off the surface, mm: more than any part is misplaced after a coarse alignment.
pub const MAX_READING_DISTANCE: f64 = 5.0;
/// A curved way is taken as chords that stray from it by no more than this, mm.
const CHORD_TOLERANCE: f64 = 1e-5;
/// The same where nothing is read, and the way's length and depth are told.
const COARSE_CHORD_TOLERANCE: f64 = 0.01;
/// So many points of each chord are kept, besides the nearest.
const POINTS_PER_CHORD: u32 = 4;
/// More points than this aren't kept: no path has so many, but a loop that never ends makes them.
const MAX_READINGS: usize = 500_000;
/// More points than this aren't looked at on feeds that have no reading, which takes some seconds.
const MAX_UNREAD_POINTS: usize = 2_000_000;
/// The sine of the angle to the surface up to which a feed goes along it: 30°.
const MAX_RISE: f64 = 0.5;

/// How a feed goes.
enum FeedCourse {
    /// Along the surface, near to it: it is read.
    AlongSurface,
    /// The ball doesn't move against the part.
    Stationary,
    Unread(UnreadReason),
}

/// One point of a pass; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The way from where the pass begins.
    pub path_length: f64,
    /// The ball's centre, in the frame of the part as the program believes it to stand.
    pub ball_centre: Point3<f64>,
    /// From the ball to the surface: above 0 there is a gap, below 0 the ball is pushed in.
    pub value: f64,
    /// Which of [`ReadingPass::backtraces`] moved here.
    pub move_index: usize,
}

/// A way along the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadingPass {
    pub readings: Vec<Reading>,
    /// The blocks that moved, one for each move.
    pub backtraces: Vec<Backtrace>,
}

impl ReadingPass {
    /// The least and the greatest reading; `None` of a pass without any.
    pub fn extremes(&self) -> Option<(Reading, Reading)> {
        let order = |one: &&Reading, other: &&Reading| one.value.total_cmp(&other.value);
        Some((*self.readings.iter().min_by(order)?, *self.readings.iter().max_by(order)?))
    }

    /// How long the way is.
    pub fn length(&self) -> f64 {
        self.readings.last().map_or(0.0, |last| last.path_length)
    }
}

/// What a program makes an edge finder show.
#[derive(Clone, Debug, Default)]
pub struct StylusReadings {
    pub passes: Vec<ReadingPass>,
    /// Where the path has no reading though it should, in order.
    pub gaps: Vec<Gap>,
    /// How many feeds go to the surface, and how many from it; they have no reading.
    pub approach_retract_counts: [usize; 2],
    pub findings: Vec<Diagnostic>,
}

/// Listens to a run and reads the ball.
#[derive(Debug)]
pub struct Stylus<'m> {
    machine: &'m Machine,
    /// The same machine with the part where the program believes it to stand.
    nominal_machine: Machine,
    surface: Surface,
    /// Of the ball, mm.
    radius: f64,
    ball: Ball,
    current_pass: Option<ReadingPass>,
    unread_feeds: UnreadFeeds,
    result: StylusReadings,
    /// Points of passes, and of feeds that have no reading.
    reading_count: usize,
    unread_points: usize,
}

impl<'m> Stylus<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine, surface: Surface, radius: f64) -> Self {
        let part = Placement { origin: machine.part.origin, ..Placement::default() };
        Self {
            machine,
            nominal_machine: Machine { part, ..machine.clone() },
            surface,
            radius,
            ball: Ball::default(),
            current_pass: None,
            unread_feeds: UnreadFeeds::default(),
            result: StylusReadings::default(),
            reading_count: 0,
            unread_points: 0,
        }
    }

    pub fn finish(mut self) -> StylusReadings {
        self.end_pass();
        self.unread_feeds.finish(self.result.passes.len());
        let UnreadFeeds { gaps, approach_retract_counts: ways, mut findings, .. } = self.unread_feeds;
        findings.extend(self.result.findings);
        StylusReadings { gaps, approach_retract_counts: ways, findings, ..self.result }
    }

    fn end_pass(&mut self) {
        self.result.passes.extend(self.current_pass.take());
    }

    fn motion(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, by: BallMove) {
        if self.is_full() || (travel.from == travel.to && travel.arc.is_none()) {
            return;
        }
        if by != BallMove::Feed {
            self.end_pass();
            return self.unread_feeds.end_path(self.result.passes.len());
        }
        match self.feed_course(travel) {
            FeedCourse::AlongSurface => {}
            FeedCourse::Stationary => return,
            FeedCourse::Unread(way) => {
                self.end_pass();
                let unread = self.measure_unread(event, travel, way);
                self.unread_feeds.push(unread);
                return self.report_limit(event);
            }
        }
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
        let added = pass.readings.len() - before;
        self.reading_count += added;
        self.current_pass = Some(pass);
        self.report_limit(event);
    }

    fn is_full(&self) -> bool {
        self.reading_count > MAX_READINGS || self.unread_points > MAX_UNREAD_POINTS
    }

    /// Tells it where nothing more is read.
    fn report_limit(&mut self, event: &Event<'_>) {
        let message = if self.reading_count > MAX_READINGS {
            format!("more than {MAX_READINGS} points along the surface: no readings after this")
        } else if self.unread_points > MAX_UNREAD_POINTS {
            format!("more than {MAX_UNREAD_POINTS} points of feeds without a reading: no readings after this")
        } else {
            return;
        };
        let finding = Diagnostic::new(&LIMIT, message).with_backtrace(event.backtrace());
        let finding = finding.help("check for a loop that never ends; otherwise split the program");
        self.result.findings.push(finding);
    }

    /// How the ball goes, all the way.
    fn feed_course(&self, travel: &AxisMotion<'_>) -> FeedCourse {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        // The distance from the surface where it is looked at, and the sine of the angle at which the way leaves it.
        let samples = [0.0, 0.5, 1.0].map(|t| {
            let (near, here) = (1e-3, tip(t));
            let back = if t < 1.0 { tip(t + near) - here } else { here - tip(t - near) };
            let nearest = self.surface.nearest(&here);
            let rise = Unit::try_new(back, 1e-12).map(|direction| direction.dot(&nearest.normal));
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

    /// A feed on which the dial isn't read.
    fn measure_unread(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        reason: UnreadReason,
    ) -> UnreadFeed {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let far = |tip: &Point3<f64>| self.surface.nearest(tip).distance - self.radius;
        let steps = self.machine.chord_count(travel, &self.ball.setup, COARSE_CHORD_TOLERANCE);
        let (mut length, mut last) = (0.0, tip(0.0));
        let (mut least, mut greatest) = (far(&last), far(&last));
        for step in 1..=steps {
            let here = tip(f64::from(step) / f64::from(steps));
            let between = last + (here - last) * self.surface.nearest_between(&last, &here);
            length += (here - last).norm();
            (least, greatest) = (least.min(far(&between)).min(far(&here)), greatest.max(far(&here)));
            last = here;
        }
        self.unread_points += steps as usize;
        UnreadFeed {
            backtrace: event.backtrace(),
            reason,
            length,
            min_distance: least,
            max_distance: greatest,
        }
    }

    /// Where along a motion the ball is read: beyond 0, up to 1.
    fn stations(&self, travel: &AxisMotion<'_>) -> Vec<f64> {
        let steps = self.machine.chord_count(travel, &self.ball.setup, CHORD_TOLERANCE);
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let mut stations = Vec::new();
        for step in 0..steps {
            let part = |t: f64| (f64::from(step) + t) / f64::from(steps);
            let nearest = self.surface.nearest_between(&tip(part(0.0)), &tip(part(1.0)));
            let mut inside: Vec<f64> =
                (1..=POINTS_PER_CHORD).map(|n| f64::from(n) / f64::from(POINTS_PER_CHORD)).collect();
            inside.extend((0.0 < nearest && nearest < 1.0).then_some(nearest));
            inside.sort_by(f64::total_cmp);
            stations.extend(inside.into_iter().map(part));
        }
        stations
    }

    fn reading_at(&self, travel: &AxisMotion<'_>, t: f64, pass: &ReadingPass) -> Reading {
        let position = travel.position(t);
        let tip = self.machine.forward(&position, &self.ball.setup).tip;
        let at = self.nominal_machine.forward(&position, &self.ball.setup).tip;
        let along =
            pass.readings.last().map_or(0.0, |last| last.path_length + (at - last.ball_centre).norm());
        let value = self.surface.nearest(&tip).distance - self.radius;
        Reading { path_length: along, ball_centre: at, value, move_index: pass.backtraces.len() - 1 }
    }
}

impl EventSink for Stylus<'_> {
    fn event(&mut self, event: &Event<'_>) {
        match self.ball.apply_event(self.machine, event) {
            BallUpdate::Moved { from, to, arc, by } => {
                self.motion(event, &AxisMotion { from: &from, to, arc }, by);
            }
            BallUpdate::Changed => self.end_pass(),
            BallUpdate::Unclear(text) => {
                self.result.findings.push(unclear_head(text).with_backtrace(event.backtrace()));
            }
            BallUpdate::Unchanged => {}
        }
    }
}
