//! `[rapid]`: the path of a rapid of several axes.
use schemars::JsonSchema;
use serde::Deserialize;

use super::offsets::{AxisLetter, axis_of};
use crate::machine::RapidPath;
use gcode_lang::motion::{Axes, MAX_AXES};
use gcode_part::reader::bounds::RapidRate;
use gcode_part::reader::{FileError, FileKey, Optional, Reader, TableOf};

type Rates = TableOf<AxisLetter, RapidRate>;

/// The path of a rapid; without it any axis may arrive first.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileRapid {
    /// All axes arrive together, on a straight line: LRP, parameter 1401#1 [default: false].
    straight: Option<bool>,
    /// Rapid rates by axis, mm/min and degrees/min: each axis moves at its own until it arrives.
    #[serde(default, with = "Optional::<Rates>")]
    rates: Option<<Rates as FileKey>::Value>,
}

impl FileRapid {
    pub(super) fn check(&self, reader: &Reader<'_>, axes: &Axes) -> Result<RapidPath, FileError> {
        let Some(rates) = &self.rates else {
            return Ok(if self.straight == Some(true) { RapidPath::Straight } else { RapidPath::Any });
        };
        if self.straight == Some(true) {
            let message = "key 'rapid.rates' does not matter on a straight line: remove it, or 'straight'";
            return Err(reader.error_at("rapid.rates", message));
        }
        let mut by_axis = [None; MAX_AXES];
        for (letter, rate) in rates {
            by_axis[axis_of(reader, axes, "rapid.rates", *letter)?] = Some(*rate);
        }
        Ok(RapidPath::Rates(by_axis))
    }
}
