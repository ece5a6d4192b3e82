//! Where a stylus' ball is: the places of the axes, and what else decides where the tip stands.
use crate::machine::{HeadMessage, Machine, Setup};
use gcode_lang::motion::{Event, EventKind, PlanarArc, Position, StopKind};

/// Follows a run from machine zero on.
#[derive(Debug, Default)]
pub(super) struct Ball {
    pub axis_position: Position,
    pub setup: Setup,
}

/// What an event is to the ball.
#[derive(Clone, Copy, Debug)]
pub(super) enum BallUpdate<'e> {
    /// It has gone.
    Moved {
        from: Position,
        to: &'e Position,
        arc: Option<&'e PlanarArc>,
        by: BallMove,
    },
    /// Another tool, length offset or angle of the head: from here on it stands elsewhere.
    Changed,
    /// A message about the head from which no angle can be read: the head stays as it is.
    Unclear(&'e str),
    Unchanged,
}

/// How it has gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BallMove {
    Rapid,
    /// A move that a probe ends.
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
            EventKind::ToolChange { number } => {
                self.update_setup(Setup { tool: Some(*number), ..self.setup })
            }
            EventKind::ToolLength { offset, .. } => {
                self.update_setup(Setup { offset: *offset, ..self.setup })
            }
            EventKind::Stop { kind: StopKind::Message, text, variables: named }
                if machine.head.is_set_by_hand() =>
            {
                match HeadMessage::parse(text, named) {
                    HeadMessage::Angle(angle) => {
                        self.update_setup(Setup { head_angle: Some(angle), ..self.setup })
                    }
                    HeadMessage::Unclear => BallUpdate::Unclear(text),
                    HeadMessage::Unrelated => BallUpdate::Unchanged,
                }
            }
            EventKind::WorkZeroUnknown { .. }
            | EventKind::Stop { .. }
            | EventKind::Dwell { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. } => BallUpdate::Unchanged,
        }
    }

    fn move_to<'e>(&mut self, to: &'e Position, arc: Option<&'e PlanarArc>, by: BallMove) -> BallUpdate<'e> {
        let from = std::mem::replace(&mut self.axis_position, *to);
        BallUpdate::Moved { from, to, arc, by }
    }

    fn update_setup<'e>(&mut self, setup: Setup) -> BallUpdate<'e> {
        self.setup = setup;
        BallUpdate::Changed
    }
}
