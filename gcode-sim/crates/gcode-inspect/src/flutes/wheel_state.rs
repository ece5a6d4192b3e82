//! Rotation of the wheel while it grinds.
use nalgebra::Point3;

use super::GrindingPass;
use gcode_lang::motion::{Backtrace, EventKind, SpindleDirection};
use gcode_lang::units::Rpm;

/// The first move of a pass with some property, and its start on the burr.
#[derive(Clone, Debug)]
pub(crate) struct FirstOccurrence {
    pub backtrace: Backtrace,
    pub point: Point3<f64>,
}

/// Grinding without M03 or M04 and a speed in force.
#[derive(Clone, Debug)]
pub(crate) struct StoppedWheel {
    pub first: FirstOccurrence,
    /// Last M code of the machine builder since M03, M04 or M05: it may have started the wheel.
    pub builder_code: Option<u32>,
}

/// Modal state of the wheel.
#[derive(Debug, Default)]
pub(super) struct WheelState {
    direction: SpindleDirection,
    speed: Rpm,
    builder_code: Option<u32>,
}

impl WheelState {
    pub(super) fn apply_event(&mut self, kind: &EventKind) {
        match kind {
            // S0 stops the wheel.
            EventKind::Spindle { speed, direction, .. } => {
                self.direction = if *speed == Rpm(0.0) { SpindleDirection::Off } else { *direction };
                self.speed = *speed;
                self.builder_code = None;
            }
            EventKind::Auxiliary { code } => self.builder_code = Some(*code),
            EventKind::Rapid { .. }
            | EventKind::Feed { .. }
            | EventKind::Arc { .. }
            | EventKind::Skip { .. }
            | EventKind::Dwell { .. }
            | EventKind::ToolChange { .. }
            | EventKind::ToolLength { .. }
            | EventKind::Start { .. }
            | EventKind::PositionUnknown { .. }
            | EventKind::ToolSelected { .. }
            | EventKind::Coolant { .. }
            | EventKind::Stop { .. } => {}
        }
    }

    /// Records the rotation of the wheel during a move of a pass.
    pub(super) fn record(&self, pass: &mut GrindingPass, begun: impl Fn() -> FirstOccurrence) {
        if self.direction != SpindleDirection::Off
            && pass.speeds.last().is_none_or(|(last, _)| *last != self.speed)
        {
            pass.speeds.push((self.speed, begun()));
        }
        match self.direction {
            SpindleDirection::Off if pass.stopped_wheel.is_none() => {
                pass.stopped_wheel = Some(StoppedWheel { first: begun(), builder_code: self.builder_code });
            }
            SpindleDirection::Counterclockwise if pass.reversed_wheel.is_none() => {
                pass.reversed_wheel = Some(begun())
            }
            SpindleDirection::Off | SpindleDirection::Clockwise | SpindleDirection::Counterclockwise => {}
        }
    }
}
