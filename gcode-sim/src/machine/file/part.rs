//! `[part]`: where the part lies on the machine, and how far off.
use nalgebra::Point3;
use serde::Deserialize;
use toml::Spanned;

use super::lengths;
use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::Placement;
use crate::units::Deg;

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePart {
    origin: Option<[Spanned<f64>; 3]>,
    shift: Option<[Spanned<f64>; 3]>,
    tilt: Option<[Spanned<f64>; 3]>,
}

impl FilePart {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<Placement, JobError> {
        let mut part = Placement::default();
        if let Some(origin) = &self.origin {
            part.origin = Point3::from(lengths(reader, "part.origin", origin)?);
        }
        if let Some(shift) = &self.shift {
            part.shift = lengths(reader, "part.shift", shift)?;
        }
        if let Some(tilt) = &self.tilt {
            for (angle, value) in part.tilt.iter_mut().zip(tilt) {
                let allowed = "degrees from -360 to 360";
                *angle = Deg(reader.number("part.tilt", value, allowed, |v| v.abs() <= 360.0)?);
            }
        }
        Ok(part)
    }
}
