//! Where a stylus' ball is: the places of the axes, and what else decides where the tip stands.
use crate::machine::{HeadMessage, Machine, Setup};
use gcode_lang::motion::{Event, EventKind, PlanarArc, Position, StopKind};

/// Follows a run from machine zero on.
#[derive(Debug, Default)]
pub(super) struct Ball {
    pub at: Position,
    pub setup: Setup,
}

/// What an event is to the ball.
#[derive(Clone, Copy, Debug)]
pub(super) enum BallUpdate<'e> {
    /// It has gone.
    Gone {
        from: Position,
        to: &'e Position,
        arc: Option<&'e PlanarArc>,
        by: BallMove,
    },
    /// Another tool, length offset or angle of the head: from here on it stands elsewhere.
    Changed,
    /// A message about the head from which no angle can be read: the head stays as it is.
    Unclear(&'e str),
    Still,
}

/// How it has gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BallMove {
    Rapid,
    /// A move that a probe ends.
    Touch,
    Feed,
}

impl Ball {
    pub(super) fn apply_event<'e>(&mut self, machine: &Machine, event: &Event<'e>) -> BallUpdate<'e> {
        match event.kind {
            EventKind::Rapid { to } => self.go(to, None, BallMove::Rapid),
            EventKind::Skip { to, .. } => self.go(to, None, BallMove::Touch),
            EventKind::Feed { to, .. } => self.go(to, None, BallMove::Feed),
            EventKind::Arc { to, arc, .. } => self.go(to, Some(arc), BallMove::Feed),
            EventKind::ToolChange { number } => self.change(Setup { tool: Some(*number), ..self.setup }),
            EventKind::ToolLength { offset, .. } => self.change(Setup { offset: *offset, ..self.setup }),
            EventKind::Stop { kind: StopKind::Message, text, variables: named }
                if machine.head.is_set_by_hand() =>
            {
                match HeadMessage::of(text, named) {
                    HeadMessage::Angle(angle) => self.change(Setup { head_angle: Some(angle), ..self.setup }),
                    HeadMessage::Unclear => BallUpdate::Unclear(text),
                    HeadMessage::Other => BallUpdate::Still,
                }
            }
            EventKind::WorkZeroUnknown { .. }
            | EventKind::Stop { .. }
            | EventKind::Dwell { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. } => BallUpdate::Still,
        }
    }

    fn go<'e>(&mut self, to: &'e Position, arc: Option<&'e PlanarArc>, by: BallMove) -> BallUpdate<'e> {
        let from = std::mem::replace(&mut self.at, *to);
        BallUpdate::Gone { from, to, arc, by }
    }

    fn change<'e>(&mut self, setup: Setup) -> BallUpdate<'e> {
        self.setup = setup;
        BallUpdate::Changed
    }
}
