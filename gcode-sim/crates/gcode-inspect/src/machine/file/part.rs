//! `[part]`: position of the part on the machine, and its misalignment.
use nalgebra::Point3;
use schemars::JsonSchema;
use serde::Deserialize;

use super::vector;
use crate::machine::Placement;
use gcode_lang::units::Deg;
use gcode_part::reader::FixedArray;
use gcode_part::reader::bounds::{Angle, Bounded, MachinePoint};

/// Nominal position of the part on the machine, and its misalignment.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePart {
    /// The part's origin in machine coordinates with the table at 0, mm.
    origin: Option<FixedArray<Bounded<MachinePoint>, 3>>,
    /// Shift of the actual part from its nominal position, mm.
    shift: Option<FixedArray<Bounded<MachinePoint>, 3>>,
    /// Tilt of the actual part about x, then y, then z, degrees.
    tilt: Option<FixedArray<Bounded<Angle>, 3>>,
}

impl FilePart {
    pub(super) fn placement(&self) -> Placement {
        let mut part = Placement::default();
        if let Some(origin) = &self.origin {
            part.origin = Point3::from(vector(origin));
        }
        if let Some(shift) = &self.shift {
            part.shift = vector(shift);
        }
        if let Some(tilt) = &self.tilt {
            part.tilt = tilt.0.each_ref().map(|angle| Deg(angle.get()));
        }
        part
    }
}
