//! Rapids with the ball of a stylus in the part: no probe detects that contact.
use super::ball::{Ball, BallMove, BallUpdate};
use super::unknown::UnknownPositions;
use crate::findings::RAPID_INTO_PART;
use crate::holes::per_block::PerBlock;
use crate::holes::unknown_axes::PositionTracker;
use crate::machine::{AxisMotion, Machine, ToolKind};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_part::PartSolid;

/// Largest deviation of a path from its chords, and largest depth that is not reported, mm.
const CHORD_TOLERANCE: f64 = 0.001;

/// Sink for the events of a run that reports rapids into the part.
#[derive(Debug)]
pub struct RapidChecker<'m> {
    machine: &'m Machine,
    part: PartSolid,
    /// Radius of the ball, mm.
    radius: f64,
    ball: Ball,
    /// True once the ball has been outside: a run starts at machine zero, where no ball is.
    has_been_outside: bool,
    positions: PositionTracker,
    unknown_positions: UnknownPositions,
    findings: PerBlock<(), Diagnostic>,
}

impl<'m> RapidChecker<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine, part: impl Into<PartSolid>, radius: f64) -> Self {
        Self {
            machine,
            part: part.into(),
            radius,
            ball: Ball::default(),
            has_been_outside: false,
            positions: PositionTracker::default(),
            unknown_positions: UnknownPositions::default(),
            findings: PerBlock::default(),
        }
    }

    /// Returns the findings: one of each block, and one for each combination of axes with which the part is touched while
    /// their position is unknown.
    pub fn finish(self) -> Vec<Diagnostic> {
        let rapids = self.findings.into_entries().map(|entry| entry.value);
        self.unknown_positions.finish().chain(rapids).collect()
    }

    /// Returns the depth of the ball in the part.
    fn depth(&self, at: &Position) -> f64 {
        self.radius - self.part.nearest(&self.machine.forward(at, &self.ball.setup).tip).distance
    }

    /// Returns true unless the tool is known to be no probe: by its kind, or because another tool is one.
    fn may_be_probe(&self) -> bool {
        match self.machine.kind_of(self.ball.setup.tool) {
            Some(kind) => kind == ToolKind::Probe,
            None => !self.machine.has_probe_tool(),
        }
    }

    fn check_rapid(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>) {
        let tip = |t: f64| self.machine.forward(&travel.position(t), &self.ball.setup).tip;
        let chords = self.ball.chords(self.machine, travel, CHORD_TOLERANCE);
        let depths = chords.map(|chord| {
            let (from, to) = (tip(chord(0.0)), tip(chord(1.0)));
            // From the contact on the steps are shorter.
            let contact = self.part.contact_between(&from, &to, self.radius).unwrap_or(0.0);
            let nearest = self.part.nearest_between(&(from + (to - from) * contact), &to);
            self.depth(&travel.position(chord(contact + (1.0 - contact) * nearest)))
        });
        let deepest = depths.fold(f64::NEG_INFINITY, f64::max);
        // A retract starts where a feed has deflected the stylus.
        let start = self.depth(travel.from);
        self.has_been_outside |= start <= 0.0;
        self.report_rapid(event, deepest, start.max(0.0));
    }

    /// Reports a rapid whose depth exceeds that of its start.
    fn report_rapid(&mut self, event: &Event<'_>, depth: f64, start: f64) {
        if !self.has_been_outside || depth <= start + CHORD_TOLERANCE {
            return;
        }
        self.findings.count(event.block, (), || {
            let message = format!(
                "rapid motion with the stylus ball {depth:.3} mm in the part, which a probe does not detect"
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
        if let EventKind::Start { unknown: axes, .. } | EventKind::PositionUnknown { axes } = event.kind {
            self.positions.apply_event(self.machine, *axes);
        }
        let BallUpdate::Moved { from, to, arc, kind } = self.ball.apply_event(self.machine, event) else {
            return;
        };
        let (was, is) = self.positions.advance(self.machine);
        match kind {
            BallMove::Rapid if !self.may_be_probe() => {}
            // Only the end of a rapid from an unknown position can be checked.
            BallMove::Rapid if !is.is_none() => {}
            BallMove::Rapid if !was.is_none() => self.report_rapid(event, self.depth(to), 0.0),
            BallMove::Rapid => self.check_rapid(event, &AxisMotion { from: &from, to, arc }),
            // A touch that ends in a known plane is where that is, whatever its start.
            BallMove::Probe => {
                self.unknown_positions.report(self.machine, event, is, "the part is touched");
            }
            BallMove::Feed => {}
        }
    }
}
