//! Rapids on which a stylus' ball meets the part: no probe is asked there, and nothing gives.
use crate::holes::per_block::PerBlock;
use crate::holes::work_zero::WorkZeroTracker;
use crate::machine::Machine;
use crate::machine::path::AxisMotion;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_part::Surface;

use super::ball::{Ball, BallMove, BallUpdate};
use crate::findings::RAPID_INTO_PART;

/// A curved way is taken as chords that stray from it by no more than this, mm; nor is less than this told.
const CHORD_TOLERANCE: f64 = 0.001;

/// Listens to a run and tells of rapids into the part.
#[derive(Debug)]
pub struct RapidChecker<'m> {
    machine: &'m Machine,
    surface: Surface,
    /// Of the ball, mm.
    radius: f64,
    ball: Ball,
    /// Whether the ball has been outside: a run begins at machine zero, where no ball is.
    has_been_outside: bool,
    work_zero: WorkZeroTracker,
    findings: PerBlock<(), Diagnostic>,
}

impl<'m> RapidChecker<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine, surface: Surface, radius: f64) -> Self {
        Self {
            machine,
            surface,
            radius,
            ball: Ball::default(),
            has_been_outside: false,
            work_zero: WorkZeroTracker::default(),
            findings: PerBlock::default(),
        }
    }

    /// One for each block, the first time.
    pub fn finish(self) -> Vec<Diagnostic> {
        self.findings.into_entries().map(|entry| entry.value).collect()
    }

    fn check_rapid(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>) {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let pushed = |t: f64| self.radius - self.surface.nearest(&tip(t)).distance;
        let steps = self.machine.chord_count(travel, &self.ball.setup, CHORD_TOLERANCE);
        let deepest = (0..steps)
            .map(|step| {
                let part = |t: f64| (f64::from(step) + t) / f64::from(steps);
                let nearest = self.surface.nearest_between(&tip(part(0.0)), &tip(part(1.0)));
                pushed(part(nearest))
            })
            .fold(f64::NEG_INFINITY, f64::max);
        // A retract begins where a feed has pushed the ball in.
        let begins = pushed(0.0);
        self.has_been_outside |= begins <= 0.0;
        if self.has_been_outside && begins.max(0.0) + CHORD_TOLERANCE < deepest {
            self.report_rapid(event, deepest);
        }
    }

    /// A rapid from or to where nobody knows: only an end that is known is looked at.
    fn check_unknown_rapid(&mut self, event: &Event<'_>, to: &Position, is_known: bool) {
        let tip = self.machine.forward(to, &self.ball.setup).tip;
        let pushed = self.radius - self.surface.nearest(&tip).distance;
        if is_known && self.has_been_outside && CHORD_TOLERANCE < pushed {
            self.report_rapid(event, pushed);
        }
    }

    fn report_rapid(&mut self, event: &Event<'_>, deepest: f64) {
        self.findings.count(event.block, (), || {
            let message = format!(
                "rapid motion with the stylus ball {deepest:.3} mm in the part, which a probe does not detect"
            );
            Diagnostic::new(&RAPID_INTO_PART, message).with_backtrace(event.backtrace()).help(
                "begin the touch farther away and check the first touch: the part is farther out than the \
                 touch allows",
            )
        });
    }
}

impl EventSink for RapidChecker<'_> {
    fn event(&mut self, event: &Event<'_>) {
        if let EventKind::WorkZeroUnknown { axes } = event.kind {
            self.work_zero.apply_event(self.machine, *axes);
        }
        let BallUpdate::Moved { from, to, arc, by } = self.ball.apply_event(self.machine, event) else {
            return;
        };
        let (was, is) = self.work_zero.advance();
        match by {
            BallMove::Rapid if was | is != 0 => self.check_unknown_rapid(event, to, is == 0),
            BallMove::Rapid => self.check_rapid(event, &AxisMotion { from: &from, to, arc }),
            BallMove::Probe | BallMove::Feed => {}
        }
    }
}
