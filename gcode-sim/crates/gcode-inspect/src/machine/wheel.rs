//! A stationary grinding wheel, against which the table moves the part.
use nalgebra::Point3;

use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

use super::Machine;

/// A grinding wheel as its one contact point; shape, radius and tilt are not modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Contact point, machine coordinates.
    pub contact: Point3<f64>,
    /// Axis that swivels the wheel about this point, and the direction of a positive command, 1 or −1.
    pub swivel_axis: Option<(AxisIndex, f64)>,
}

impl Wheel {
    /// Returns the swivel angle; `None` if no axis swivels the wheel.
    pub fn angle(&self, at: &Position) -> Option<Deg> {
        self.swivel_axis.map(|(axis, sign)| Deg(sign * at[axis]))
    }
}

impl Machine {
    /// Returns the wheel's contact point in the part's frame with the axes at `at`.
    pub fn contact(&self, wheel: &Wheel, at: &Position) -> Point3<f64> {
        let carried = self.slides.frame(at) * wheel.contact;
        self.part_frame(at).inverse_transform_point(&carried)
    }
}
