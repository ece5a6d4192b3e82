//! Whether the wheel turns, and which way round, while it grinds.
use nalgebra::Point3;

use super::GrindingPass;
use gcode_lang::motion::{Backtrace, EventKind, SpindleDirection};
use gcode_lang::units::Rpm;

/// The first move of a pass of which something is so, and where it begins on the burr.
#[derive(Clone, Debug)]
pub struct FirstOccurrence {
    pub backtrace: Backtrace,
    pub point: Point3<f64>,
}

/// Grinding while no M03 or M04 with a speed is in force.
#[derive(Clone, Debug)]
pub struct StoppedWheel {
    pub first: FirstOccurrence,
    /// The last M code since M03, M04 or M05 that went to the machine builder's logic, which may have started the wheel.
    pub builder_code: Option<u32>,
}

/// What the program has said of the wheel so far.
#[derive(Debug, Default)]
pub(super) struct WheelState {
    direction: SpindleDirection,
    speed: Rpm,
    builder_code: Option<u32>,
}

impl WheelState {
    pub(super) fn apply_event(&mut self, kind: &EventKind) {
        match kind {
            // At S0 it stands.
            EventKind::Spindle { speed, direction: turning } => {
                self.direction = if *speed == Rpm(0.0) { SpindleDirection::Off } else { *turning };
                self.speed = *speed;
                self.builder_code = None;
            }
            EventKind::Auxiliary { code } => self.builder_code = Some(*code),
            _ => {}
        }
    }

    /// Notes on a pass how the wheel turns during one of its moves.
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
