//! `[runout]` of an alignment job: the touches of the part while the table rotates.
use schemars::JsonSchema;
use serde::Deserialize;

use super::Runout;
use crate::job::{FileError, Reader, Surface};
use crate::reader::bounds::{Bounded, PartShift};
use crate::reader::{FixedArray, Spanned};

/// An indicator on the part while the table rotates.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileRunout {
    /// Two different y of the indicator, mm.
    #[schemars(length(equal = 2))]
    heights: Spanned<Vec<f64>>,
    /// From, to, and the number of readings (3 to 100): degrees.
    #[schemars(inner(range(min = -360.0, max = 360.0)))]
    angles: Spanned<FixedArray<f64, 3>>,
    /// The largest shift of the part in y that the fit accepts, mm [default: 0.4].
    y_shift: Option<Bounded<PartShift>>,
}

impl FileRunout {
    pub(super) fn check(&self, reader: &Reader<'_>, surface: Surface) -> Result<Runout, FileError> {
        let b = surface.b;
        let all = self.heights.as_ref();
        let heights = match *all.as_slice() {
            [low, high] if low.abs() < b && high.abs() < b && low != high => Ok([low, high]),
            [low, high] if low == high => Err(format!("both are {low}")),
            [low, high] => Err(format!("{} is not", if low.abs() < b { high } else { low })),
            _ => Err(format!("it has {}", all.len())),
        };
        let heights = heights.map_err(|wrong| {
            let message = format!(
                "key 'runout.heights' needs two different y, each less than b = {b} mm from 0; {wrong}"
            );
            reader.error(&self.heights, message)
        })?;
        let [from, to, readings] = self.angles.as_ref().0;
        let beyond = [("from", from), ("to", to)]
            .into_iter()
            .find(|(_, angle)| !angle.is_finite() || 360.0 < angle.abs());
        let wrong = if let Some((which, angle)) = beyond {
            Some(format!("the angle {which} is {angle}: -360 to 360 degrees"))
        } else if from >= to {
            Some(format!("it runs from {from} to {to}: from must be less than to"))
        } else if !((3.0..=100.0).contains(&readings) && readings.fract() == 0.0) {
            Some(format!("the number of readings is {readings}: a whole number, 3 to 100"))
        } else {
            None
        };
        if let Some(wrong) = wrong {
            let message = format!("key 'runout.angles' is from, to and the number of readings; {wrong}");
            return Err(reader.error(&self.angles, message));
        }
        if from > 0.0 || to < 0.0 {
            let message = format!(
                "key 'runout.angles' runs from {from} to {to}: it must include 0, because the chord and \
                 the ellipse are touched at B0; shift the work zero of the rotary so that 0 is on the petal"
            );
            return Err(reader.error(&self.angles, message));
        }
        let y_shift = self.y_shift.as_ref().map_or(0.4, Bounded::get);
        Ok(Runout { heights, from, to, readings: readings as u32, y_shift })
    }
}
