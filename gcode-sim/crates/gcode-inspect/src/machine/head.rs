//! The head that holds the tool: the direction of the tool, and the distance of the pivot from the gauge
//! line.
use nalgebra::{Point3, Unit, Vector3};

use super::Setup;
use super::chain::Chain;
use super::error::PeriodicError;
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

/// Head of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Kind of head.
    pub kind: HeadKind,
    /// Distance from the pivot to the spindle's gauge line, mm.
    pub pivot: f64,
    /// Actual minus nominal angle of a head that rotates, degrees.
    pub error: PeriodicError,
}

/// Kind of head and its setting.
#[derive(Clone, Debug, PartialEq)]
pub enum HeadKind {
    /// Unknown: the tool is assumed to point along each cutting feed.
    Free,
    /// Fixed direction, from the tip to the spindle.
    Fixed(Unit<Vector3<f64>>),
    /// Set by hand at an operator stop, in the plane of X and Y.
    Manual {
        /// Angle before the first stop.
        start: Option<Deg>,
    },
    /// Rotary axes of the control.
    Axes {
        /// The axes, from the slides outwards; their centres count from the pivot.
        chain: Chain,
        /// Direction from the tip to the spindle with the axes at 0.
        direction: Unit<Vector3<f64>>,
    },
    /// An axis of the control that tilts the tool in the plane of X and Y.
    Axis {
        /// Axis of the control.
        axis: AxisIndex,
        /// Direction of a positive command, 1 or −1.
        sign: f64,
        /// Angle of the tool with the axis at 0.
        zero: Deg,
    },
}

/// Meaning of a message to the operator for the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeadMessage {
    /// The message does not concern the head.
    Unrelated,
    /// The message, such as `SET HEAD TO #140`, names one variable with a value.
    Angle(Deg),
    /// The message concerns the head, but gives no angle.
    Unclear,
}

impl HeadMessage {
    /// Interprets a message; `named` are the variables in its text, with their values.
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
    /// Returns a head without errors.
    pub fn new(kind: HeadKind, pivot: f64) -> Self {
        Self { kind, pivot, error: PeriodicError::default() }
    }

    /// Returns the direction from the tip to the spindle; `None` if it is unknown. The angle h counts from +x
    /// towards +y: (cos h, sin h, 0).
    pub fn direction(&self, at: &Position, setup: &Setup) -> Option<Unit<Vector3<f64>>> {
        match &self.kind {
            HeadKind::Free => setup.head_angle.map(|angle| self.direction_at(angle)),
            HeadKind::Fixed(direction) => Some(*direction),
            HeadKind::Axes { chain, direction } => Some(chain.frame(at).rotation * *direction),
            HeadKind::Manual { start } => setup.head_angle.or(*start).map(|angle| self.direction_at(angle)),
            HeadKind::Axis { axis, sign, zero } => Some(self.direction_at(Deg(sign * at[*axis]) + *zero)),
        }
    }

    /// Returns the tip's displacement from the pivot of a tool that reaches `reach` beyond it against `axis`.
    pub(crate) fn tip_displacement(
        &self,
        at: &Position,
        axis: &Unit<Vector3<f64>>,
        reach: f64,
    ) -> Vector3<f64> {
        match &self.kind {
            HeadKind::Axes { chain, direction } => {
                (chain.frame(at) * Point3::from(direction.into_inner() * -reach)).coords
            }
            HeadKind::Free | HeadKind::Fixed(_) | HeadKind::Manual { .. } | HeadKind::Axis { .. } => {
                axis.into_inner() * -reach
            }
        }
    }

    /// Returns true if an axis of the control moves the head.
    pub(crate) fn has_axis(&self, moved: AxisIndex) -> bool {
        match &self.kind {
            HeadKind::Axes { chain, .. } => chain.has_axis(moved),
            HeadKind::Axis { axis, .. } => *axis == moved,
            HeadKind::Free | HeadKind::Fixed(_) | HeadKind::Manual { .. } => false,
        }
    }

    /// Returns the sum of the rotations of the head's axes between two positions.
    pub(super) fn total_rotation(&self, a: &Position, b: &Position) -> Deg {
        match &self.kind {
            HeadKind::Axes { chain, .. } => chain.total_rotation(a, b),
            HeadKind::Axis { axis, .. } => Deg(b[*axis] - a[*axis]).abs(),
            HeadKind::Free | HeadKind::Fixed(_) | HeadKind::Manual { .. } => Deg::ZERO,
        }
    }

    fn direction_at(&self, angle: Deg) -> Unit<Vector3<f64>> {
        let angle = angle + Deg(self.error.value_at(angle.0));
        Unit::new_unchecked(Vector3::new(angle.cos(), angle.sin(), 0.0))
    }

    /// Returns true if a message to the operator contains the word HEAD.
    fn is_head_message(text: &str) -> bool {
        let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
        words.any(|word| word.eq_ignore_ascii_case("HEAD"))
    }

    /// Returns true if the operator can set the angle; a head of kind free may be such a head.
    pub(crate) fn is_set_by_hand(&self) -> bool {
        matches!(self.kind, HeadKind::Free | HeadKind::Manual { .. })
    }
}
