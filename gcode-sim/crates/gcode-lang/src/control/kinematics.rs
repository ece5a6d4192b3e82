//! Rotary axes of a five-axis machine as numbers: the parameters 19680 to 19714 of a Fanuc.
use crate::motion::AxisIndex;

/// Rotary axes of a machine and its tool, for tilted planes and control of the tool's tip. X, Y and Z move along their own
/// directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics {
    /// Axes that turn the part, from the bed outwards (19681 to 19690).
    pub table: Vec<RotaryAxis>,
    /// Axes that turn the tool, from the slides outwards (19681 to 19690).
    pub head: Vec<RotaryAxis>,
    /// Direction from the tip to the spindle with the axes of the head at 0, of length 1 (19697).
    pub direction: [f64; 3],
    /// Distance from the head's pivot to the spindle's gauge line, mm (19666).
    pub pivot: f64,
}

/// A rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotaryAxis {
    /// Axis of the control.
    pub axis: AxisIndex,
    /// Direction with all axes at 0, of length 1 (19682 to 19693).
    pub direction: [f64; 3],
    /// Point on the axis with all axes at 0: machine coordinates of a table, relative to the pivot of a head (19700 to 19714).
    pub point: [f64; 3],
    /// 1 if a positive command turns right-handed about the direction, otherwise −1 (19684, 19689).
    pub sign: f64,
}

impl Kinematics {
    /// Returns the axes in the order in which the control counts them: those of the head first, each chain from its base.
    pub fn axes(&self) -> impl Iterator<Item = &RotaryAxis> {
        self.head.iter().chain(&self.table)
    }
}
