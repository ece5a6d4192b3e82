//! Motion → readings: what an edge finder shows whose ball is fed along the part's surface.
//!
//! Feeds along the surface are a pass; approach and retract cross it. What is farther away than [`REACH`] or lies across
//! has no reading: where the path should have gone on there, that is an error.
mod ball;
mod rapids;
#[cfg(test)]
mod tests;
mod unread;

use nalgebra::{Point3, Unit};

use crate::holes::unclear_head;
use crate::machine::path::AxisMotion;
use crate::machine::{Machine, Placement};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, Event, EventSink};
use gcode_part::Surface;

use self::ball::{Ball, BallMove, BallUpdate};
use self::unread::{Unread, UnreadFeeds, UnreadReason};

pub use self::rapids::Rapids;
pub use self::unread::Gap;

/// From how far the ball may stand off the surface, mm: more than any part is misplaced after a coarse alignment.
pub const REACH: f64 = 5.0;
/// A curved way is taken as chords that stray from it by no more than this, mm.
const STRAY: f64 = 1e-5;
/// The same where nothing is read, and the way's length and depth are told.
const ROUGH: f64 = 0.01;
/// So many points of each chord are kept, besides the nearest.
const PARTS: u32 = 4;
/// More points than this aren't kept: no path has so many, but a loop that never ends makes them.
const KEPT: usize = 500_000;
/// More points than this aren't looked at on feeds that have no reading, which takes some seconds.
const LOOKED_AT: usize = 2_000_000;
/// The sine of the angle to the surface up to which a feed goes along it: 30°.
const ALONG: f64 = 0.5;

/// How a feed goes.
enum FeedCourse {
    /// Along the surface, near to it: it is read.
    Along,
    /// The ball doesn't move against the part.
    Still,
    Off(UnreadReason),
}

/// One point of a pass; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The way from where the pass begins.
    pub along: f64,
    /// The ball's centre, in the frame of the part as the program believes it to stand.
    pub at: Point3<f64>,
    /// From the ball to the surface: above 0 there is a gap, below 0 the ball is pushed in.
    pub value: f64,
    /// Which of [`ReadingPass::places`] moved here.
    pub place: usize,
}

/// A way along the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadingPass {
    pub readings: Vec<Reading>,
    /// The blocks that moved, one for each move.
    pub places: Vec<Backtrace>,
}

impl ReadingPass {
    /// The least and the greatest reading; `None` of a pass without any.
    pub fn extremes(&self) -> Option<(Reading, Reading)> {
        let order = |one: &&Reading, other: &&Reading| one.value.total_cmp(&other.value);
        Some((*self.readings.iter().min_by(order)?, *self.readings.iter().max_by(order)?))
    }

    /// How long the way is.
    pub fn length(&self) -> f64 {
        self.readings.last().map_or(0.0, |last| last.along)
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
    believed: Machine,
    surface: Surface,
    /// Of the ball, mm.
    radius: f64,
    ball: Ball,
    open: Option<ReadingPass>,
    missed: UnreadFeeds,
    followed: StylusReadings,
    /// Points of passes, and of feeds that have no reading.
    kept: usize,
    looked_at: usize,
}

impl<'m> Stylus<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine, surface: Surface, radius: f64) -> Self {
        let part = Placement { origin: machine.part.origin, ..Placement::default() };
        Self {
            machine,
            believed: Machine { part, ..machine.clone() },
            surface,
            radius,
            ball: Ball::default(),
            open: None,
            missed: UnreadFeeds::default(),
            followed: StylusReadings::default(),
            kept: 0,
            looked_at: 0,
        }
    }

    pub fn finish(mut self) -> StylusReadings {
        self.close();
        self.missed.end(self.followed.passes.len());
        let UnreadFeeds { gaps, ways, mut findings, .. } = self.missed;
        findings.extend(self.followed.findings);
        StylusReadings { gaps, approach_retract_counts: ways, findings, ..self.followed }
    }

    fn close(&mut self) {
        self.followed.passes.extend(self.open.take());
    }

    fn motion(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, by: BallMove) {
        if self.is_full() || (travel.from == travel.to && travel.arc.is_none()) {
            return;
        }
        if by != BallMove::Feed {
            self.close();
            return self.missed.leave(self.followed.passes.len());
        }
        match self.course(travel) {
            FeedCourse::Along => {}
            FeedCourse::Still => return,
            FeedCourse::Off(way) => {
                self.close();
                let unread = self.unread(event, travel, way);
                self.missed.feed(unread);
                return self.stop_where_full(event);
            }
        }
        if self.open.is_none() {
            self.missed.read(self.followed.passes.len());
        }
        let mut pass = self.open.take().unwrap_or_default();
        let before = pass.readings.len();
        pass.places.push(event.backtrace());
        let first = pass.readings.is_empty().then_some(0.0);
        for t in first.into_iter().chain(self.stations(travel)) {
            let reading = self.read(travel, t, &pass);
            pass.readings.push(reading);
        }
        let added = pass.readings.len() - before;
        self.kept += added;
        self.open = Some(pass);
        self.stop_where_full(event);
    }

    fn is_full(&self) -> bool {
        self.kept > KEPT || self.looked_at > LOOKED_AT
    }

    /// Tells it where nothing more is read.
    fn stop_where_full(&mut self, event: &Event<'_>) {
        let message = if self.kept > KEPT {
            format!("more than {KEPT} points along the surface: no readings after this")
        } else if self.looked_at > LOOKED_AT {
            format!("more than {LOOKED_AT} points of feeds without a reading: no readings after this")
        } else {
            return;
        };
        let finding = Diagnostic::new(Severity::Alarm, "limit", message).with_backtrace(event.backtrace());
        let finding = finding.help("check for a loop that never ends; otherwise split the program");
        self.followed.findings.push(finding);
    }

    /// How the ball goes, all the way.
    fn course(&self, travel: &AxisMotion<'_>) -> FeedCourse {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        // The distance from the surface where it is looked at, and the sine of the angle at which the way leaves it.
        let looks = [0.0, 0.5, 1.0].map(|t| {
            let (near, here) = (1e-3, tip(t));
            let back = if t < 1.0 { tip(t + near) - here } else { here - tip(t - near) };
            let nearest = self.surface.nearest(&here);
            let rise = Unit::try_new(back, 1e-12).map(|direction| direction.dot(&nearest.normal));
            ((nearest.distance - self.radius).abs() <= REACH, rise)
        });
        let all = |holds: fn(f64) -> bool| looks.iter().all(|(_, rise)| rise.is_some_and(holds));
        if looks.iter().all(|(_, rise)| rise.is_none()) {
            FeedCourse::Still
        } else if looks.iter().all(|(near, _)| *near) && all(|rise| rise.abs() <= ALONG) {
            FeedCourse::Along
        } else if all(|rise| rise < -ALONG) {
            FeedCourse::Off(UnreadReason::Nearer)
        } else if all(|rise| rise > ALONG) {
            FeedCourse::Off(UnreadReason::Farther)
        } else {
            FeedCourse::Off(UnreadReason::Astray)
        }
    }

    /// A feed on which the dial isn't read.
    fn unread(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, way: UnreadReason) -> Unread {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let far = |tip: &Point3<f64>| self.surface.nearest(tip).distance - self.radius;
        let steps = self.machine.steps(travel, &self.ball.setup, ROUGH);
        let (mut length, mut last) = (0.0, tip(0.0));
        let (mut least, mut greatest) = (far(&last), far(&last));
        for step in 1..=steps {
            let here = tip(f64::from(step) / f64::from(steps));
            let between = last + (here - last) * self.surface.nearest_between(&last, &here);
            length += (here - last).norm();
            (least, greatest) = (least.min(far(&between)).min(far(&here)), greatest.max(far(&here)));
            last = here;
        }
        self.looked_at += steps as usize;
        Unread { place: event.backtrace(), way, length, least, greatest }
    }

    /// Where along a motion the ball is read: beyond 0, up to 1.
    fn stations(&self, travel: &AxisMotion<'_>) -> Vec<f64> {
        let steps = self.machine.steps(travel, &self.ball.setup, STRAY);
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let mut stations = Vec::new();
        for step in 0..steps {
            let part = |t: f64| (f64::from(step) + t) / f64::from(steps);
            let nearest = self.surface.nearest_between(&tip(part(0.0)), &tip(part(1.0)));
            let mut inside: Vec<f64> = (1..=PARTS).map(|n| f64::from(n) / f64::from(PARTS)).collect();
            inside.extend((0.0 < nearest && nearest < 1.0).then_some(nearest));
            inside.sort_by(f64::total_cmp);
            stations.extend(inside.into_iter().map(part));
        }
        stations
    }

    fn read(&self, travel: &AxisMotion<'_>, t: f64, pass: &ReadingPass) -> Reading {
        let position = travel.position(t);
        let tip = self.machine.forward(&position, &self.ball.setup).tip;
        let at = self.believed.forward(&position, &self.ball.setup).tip;
        let along = pass.readings.last().map_or(0.0, |last| last.along + (at - last.at).norm());
        let value = self.surface.nearest(&tip).distance - self.radius;
        Reading { along, at, value, place: pass.places.len() - 1 }
    }
}

impl EventSink for Stylus<'_> {
    fn event(&mut self, event: &Event<'_>) {
        match self.ball.apply_event(self.machine, event) {
            BallUpdate::Gone { from, to, arc, by } => {
                self.motion(event, &AxisMotion { from: &from, to, arc }, by);
            }
            BallUpdate::Changed => self.close(),
            BallUpdate::Unclear(text) => {
                self.followed.findings.push(unclear_head(text).with_backtrace(event.backtrace()));
            }
            BallUpdate::Still => {}
        }
    }
}
