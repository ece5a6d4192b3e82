//! A grinding wheel that stays where it is while the table moves the part against it.
use nalgebra::Point3;

use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::units::Deg;

use super::Machine;

/// Taken as the one point with which it touches; its form, its radius and how it leans are not modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Where it touches, machine coordinates.
    pub contact: Point3<f64>,
    /// The axis that swivels it about this point, and 1 or −1: which way a positive command goes.
    pub swivel_axis: Option<(AxisIndex, f64)>,
}

impl Wheel {
    /// The angle it is swivelled to; `None` where no axis does that.
    pub fn angle(&self, at: &Position) -> Option<Deg> {
        self.swivel_axis.map(|(axis, sign)| Deg(sign * at[axis]))
    }
}

impl Machine {
    /// The wheel's contact in the part's frame while the axes stand at `at`.
    pub fn contact(&self, wheel: &Wheel, at: &Position) -> Point3<f64> {
        let carried = self.slides.frame(at) * wheel.contact;
        self.part_frame(at).inverse_transform_point(&carried)
    }
}
