//! `[part]`: where the part lies on the machine, and how far off.
use nalgebra::Point3;
use schemars::JsonSchema;
use serde::Deserialize;

use super::lengths;
use crate::machine::Placement;
use gcode_lang::units::Deg;
use gcode_part::reader::FileError;
use gcode_part::reader::{FixedArray, Reader, Spanned};

/// Nominal position of the part on the machine, and its misalignment.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePart {
    /// The part's origin in machine coordinates with the table at 0, mm.
    #[schemars(inner(range(min = -100_000.0, max = 100_000.0)))]
    origin: Option<FixedArray<Spanned<f64>, 3>>,
    /// Shift of the actual part from its nominal position, mm.
    #[schemars(inner(range(min = -100_000.0, max = 100_000.0)))]
    shift: Option<FixedArray<Spanned<f64>, 3>>,
    /// Tilt of the actual part about x, then y, then z, degrees.
    #[schemars(inner(range(min = -360.0, max = 360.0)))]
    tilt: Option<FixedArray<Spanned<f64>, 3>>,
}

impl FilePart {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<Placement, FileError> {
        let mut part = Placement::default();
        if let Some(origin) = &self.origin {
            part.origin = Point3::from(lengths(reader, "part.origin", origin)?);
        }
        if let Some(shift) = &self.shift {
            part.shift = lengths(reader, "part.shift", shift)?;
        }
        if let Some(tilt) = &self.tilt {
            for (angle, value) in part.tilt.iter_mut().zip(&tilt.0) {
                let allowed = "degrees from -360 to 360";
                *angle = Deg(reader.number("part.tilt", value, allowed, |v| v.abs() <= 360.0)?);
            }
        }
        Ok(part)
    }
}
