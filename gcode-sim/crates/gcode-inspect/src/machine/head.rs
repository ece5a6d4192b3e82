//! The head that holds the tool: which way the tool points, and how far its pivot is from the gauge line.
use nalgebra::{Unit, Vector3};

use super::Setup;
use super::error::PeriodicError;
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    pub kind: HeadKind,
    /// From the pivot to the spindle's gauge line.
    pub pivot: f64,
    /// How far beyond its angle a head that turns stands.
    pub error: PeriodicError,
}

#[derive(Clone, Debug, PartialEq)]
pub enum HeadKind {
    /// Nothing is known: the tool is taken to point along each cutting feed.
    Free,
    /// Never moves; the direction points from the tip to the spindle.
    Fixed(Unit<Vector3<f64>>),
    /// Set by hand at an operator stop, in the plane of X and Y; `start` is how it stands before.
    Manual { start: Option<Deg> },
    /// An axis of the control, in the plane of X and Y: at 0 the tool stands at the angle `zero`.
    Axis { axis: AxisIndex, sign: f64, zero: Deg },
}

/// What a message to the operator asks of the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeadMessage {
    /// It is about something else.
    Unrelated,
    /// `SET HEAD TO #140` with one variable that has a value.
    Angle(Deg),
    /// It is about the head, and no angle can be read from it.
    Unclear,
}

impl HeadMessage {
    /// `named` are the variables that the text names, with their values.
    pub fn parse(text: &str, named: &[(u32, f64)]) -> Self {
        if !Head::is_head_message(text) {
            return Self::Unrelated;
        }
        match named {
            [(_, angle)] if angle.is_finite() => Self::Angle(Deg(*angle)),
            _ => Self::Unclear,
        }
    }
}

impl Head {
    pub fn new(kind: HeadKind, pivot: f64) -> Self {
        Self { kind, pivot, error: PeriodicError::default() }
    }

    /// From the tip to the spindle. An angle h counts from +x towards +y: (cos h, sin h, 0).
    pub fn direction(&self, at: &Position, setup: &Setup) -> Option<Unit<Vector3<f64>>> {
        match &self.kind {
            HeadKind::Free => setup.head_angle.map(|angle| self.direction_at(angle)),
            HeadKind::Fixed(direction) => Some(*direction),
            HeadKind::Manual { start } => setup.head_angle.or(*start).map(|angle| self.direction_at(angle)),
            HeadKind::Axis { axis, sign, zero } => Some(self.direction_at(Deg(sign * at[*axis]) + *zero)),
        }
    }

    fn direction_at(&self, angle: Deg) -> Unit<Vector3<f64>> {
        let angle = angle + Deg(self.error.value_at(angle.0));
        Unit::new_unchecked(Vector3::new(angle.cos(), angle.sin(), 0.0))
    }

    /// Whether a message to the operator is about the head: it has the word HEAD.
    pub fn is_head_message(text: &str) -> bool {
        let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
        words.any(|word| word.eq_ignore_ascii_case("HEAD"))
    }

    /// Whether the operator can set its angle: a head about which nothing is known might well be such a one.
    pub fn is_set_by_hand(&self) -> bool {
        matches!(self.kind, HeadKind::Free | HeadKind::Manual { .. })
    }
}
