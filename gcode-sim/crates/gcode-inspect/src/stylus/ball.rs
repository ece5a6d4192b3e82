//! The ball of a stylus: its axes and set-up during a run.
use crate::machine::{AxisMotion, HeadMessage, Machine, Setup};
use gcode_lang::motion::{Event, EventKind, PlanarArc, Position, StopKind};

/// State of the ball, from machine zero.
#[derive(Debug, Default)]
pub(super) struct Ball {
    pub axis_position: Position,
    pub setup: Setup,
}

/// Effect of an event on the ball.
#[derive(Clone, Copy, Debug)]
pub(super) enum BallUpdate<'e> {
    /// The ball moves.
    Moved {
        from: Position,
        to: &'e Position,
        arc: Option<&'e PlanarArc>,
        kind: BallMove,
    },
    /// Another tool, length offset or head angle displaces the ball.
    Changed,
    /// A message about the head without an angle: the head is unchanged.
    Unclear(&'e str),
    Unchanged,
}

/// Kind of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BallMove {
    Rapid,
    /// A motion that ends with the probe's signal.
    Probe,
    Feed,
}

impl Ball {
    pub(super) fn apply_event<'e>(&mut self, machine: &Machine, event: &Event<'e>) -> BallUpdate<'e> {
        match event.kind {
            EventKind::Rapid { to } => self.move_to(to, None, BallMove::Rapid),
            EventKind::Skip { to, .. } => self.move_to(to, None, BallMove::Probe),
            EventKind::Feed { to, .. } => self.move_to(to, None, BallMove::Feed),
            EventKind::Arc { to, arc, .. } => self.move_to(to, Some(arc), BallMove::Feed),
            EventKind::ToolChange { number } => self.update_setup(|setup| setup.tool = Some(*number)),
            EventKind::ToolLength { offset, wear, .. } => {
                self.update_setup(|setup| (setup.offset, setup.wear) = (*offset, *wear))
            }
            EventKind::Stop { kind: StopKind::Message, text, variables } if machine.head.is_set_by_hand() => {
                match HeadMessage::parse(text, variables) {
                    HeadMessage::Angle(angle) => self.update_setup(|setup| setup.head_angle = Some(angle)),
                    HeadMessage::Unclear => BallUpdate::Unclear(text),
                    HeadMessage::Unrelated => BallUpdate::Unchanged,
                }
            }
            EventKind::Start { at, .. } => {
                self.axis_position = *at;
                BallUpdate::Unchanged
            }
            EventKind::PositionUnknown { .. }
            | EventKind::Stop { .. }
            | EventKind::Dwell { .. }
            | EventKind::Spindle { .. }
            | EventKind::ToolSelected { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. } => BallUpdate::Unchanged,
        }
    }

    fn move_to<'e>(
        &mut self,
        to: &'e Position,
        arc: Option<&'e PlanarArc>,
        kind: BallMove,
    ) -> BallUpdate<'e> {
        let from = std::mem::replace(&mut self.axis_position, *to);
        BallUpdate::Moved { from, to, arc, kind }
    }

    fn update_setup<'e>(&mut self, change: impl FnOnce(&mut Setup)) -> BallUpdate<'e> {
        change(&mut self.setup);
        BallUpdate::Changed
    }

    /// Returns the chords of a motion from which the ball deviates by at most `tolerance` mm. Each is a function from the
    /// fraction of the chord to that of the motion.
    pub(super) fn chords(
        &self,
        machine: &Machine,
        travel: &AxisMotion<'_>,
        tolerance: f64,
    ) -> impl Iterator<Item = impl Fn(f64) -> f64 + use<>> + use<> {
        let steps = machine.chord_count(travel, &self.setup, tolerance);
        (0..steps).map(move |step| move |t: f64| (f64::from(step) + t) / f64::from(steps))
    }
}
