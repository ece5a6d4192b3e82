//! Rapids on which a stylus' ball meets the part: no probe is asked there, and nothing gives.
use crate::holes::per_block::PerBlock;
use crate::holes::work_zero::WorkZeroTracker;
use crate::machine::Machine;
use crate::machine::path::AxisMotion;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_part::Surface;

use super::ball::{Ball, BallMove, BallUpdate};

/// A curved way is taken as chords that stray from it by no more than this, mm; nor is less than this told.
const STRAY: f64 = 0.001;

/// Listens to a run and tells of rapids into the part.
#[derive(Debug)]
pub struct Rapids<'m> {
    machine: &'m Machine,
    surface: Surface,
    /// Of the ball, mm.
    radius: f64,
    ball: Ball,
    /// Whether the ball has been outside: a run begins at machine zero, where no ball is.
    outside: bool,
    placing: WorkZeroTracker,
    findings: PerBlock<(), Diagnostic>,
}

impl<'m> Rapids<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine, surface: Surface, radius: f64) -> Self {
        Self {
            machine,
            surface,
            radius,
            ball: Ball::default(),
            outside: false,
            placing: WorkZeroTracker::default(),
            findings: PerBlock::default(),
        }
    }

    /// One for each block, the first time.
    pub fn finish(self) -> Vec<Diagnostic> {
        self.findings.into_entries().map(|entry| entry.value).collect()
    }

    fn rapid(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>) {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let pushed = |t: f64| self.radius - self.surface.nearest(&tip(t)).distance;
        let steps = self.machine.steps(travel, &self.ball.setup, STRAY);
        let deepest = (0..steps)
            .map(|step| {
                let part = |t: f64| (f64::from(step) + t) / f64::from(steps);
                let nearest = self.surface.nearest_between(&tip(part(0.0)), &tip(part(1.0)));
                pushed(part(nearest))
            })
            .fold(f64::NEG_INFINITY, f64::max);
        // A retract begins where a feed has pushed the ball in.
        let begins = pushed(0.0);
        self.outside |= begins <= 0.0;
        if self.outside && begins.max(0.0) + STRAY < deepest {
            self.tell(event, deepest);
        }
    }

    /// A rapid from or to where nobody knows: only an end that is known is looked at.
    fn jump(&mut self, event: &Event<'_>, to: &Position, is_known: bool) {
        let tip = self.machine.forward(to, &self.ball.setup).tip;
        let pushed = self.radius - self.surface.nearest(&tip).distance;
        if is_known && self.outside && STRAY < pushed {
            self.tell(event, pushed);
        }
    }

    fn tell(&mut self, event: &Event<'_>, deepest: f64) {
        self.findings.count(event.block, (), || {
            let message = format!(
                "rapid motion with the stylus ball {deepest:.3} mm in the part, which a probe does not detect"
            );
            Diagnostic::error("rapid-into-part", message).with_backtrace(event.backtrace()).help(
                "begin the touch farther away and check the first touch: the part is farther out than the \
                 touch allows",
            )
        });
    }
}

impl EventSink for Rapids<'_> {
    fn event(&mut self, event: &Event<'_>) {
        if let EventKind::WorkZeroUnknown { axes } = event.kind {
            self.placing.apply_event(self.machine, *axes);
        }
        let BallUpdate::Gone { from, to, arc, by } = self.ball.apply_event(self.machine, event) else {
            return;
        };
        let (was, is) = self.placing.advance();
        match by {
            BallMove::Rapid if was | is != 0 => self.jump(event, to, is == 0),
            BallMove::Rapid => self.rapid(event, &AxisMotion { from: &from, to, arc }),
            BallMove::Touch | BallMove::Feed => {}
        }
    }
}
