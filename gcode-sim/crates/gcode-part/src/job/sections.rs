//! Sections that job files of several families have: `[control]`, `[tolerance]`, the rotary table, and bounds of lengths.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{JobControl, Rotary};
use crate::reader::{FileError, Reader, Spanned, names};
use gcode_lang::control::{Dialect, Increment};

/// What lengths may be: within what nine digits can say to a tenth of an increment.
pub(super) const LENGTH: &str = "0.01 to 99999 mm";

const TOLERANCE: &str = "0.0001 to 1000 mm";

/// Letters a rotary axis may have.
pub(super) const ROTARY_LETTERS: [(&str, char); 3] = [("A", 'A'), ("B", 'B'), ("C", 'C')];

/// Whether a number is within bounds, the bounds included.
pub(super) fn in_range(low: f64, high: f64) -> impl Fn(f64) -> bool {
    move |value| (low..=high).contains(&value)
}

/// A length of [`LENGTH`].
pub(super) fn length(reader: &Reader<'_>, key: &str, value: &Spanned<f64>) -> Result<f64, FileError> {
    reader.number(key, value, LENGTH, in_range(0.01, 99_999.0))
}

/// `machine.clearance` and `machine.retract`: how far above the surface the tool feeds from, and how far it goes away. mm.
pub(super) fn heights(
    reader: &Reader<'_>,
    clearance: Option<&Spanned<f64>>,
    retract: Option<&Spanned<f64>>,
) -> Result<(f64, f64), FileError> {
    let clearance =
        reader.number_or("machine.clearance", clearance, "0.01 to 9999 mm", in_range(0.01, 9_999.0), 2.0)?;
    let allowed = format!("{clearance} (the clearance) to 9999 mm");
    let within = in_range(clearance, 9_999.0);
    let retract = reader.number_or("machine.retract", retract, &allowed, within, clearance.max(50.0))?;
    Ok((clearance, retract))
}

/// 1 or −1.
pub(super) fn sign(reader: &Reader<'_>, key: &str, value: &Spanned<i64>) -> Result<i8, FileError> {
    match *value.as_ref() {
        1 => Ok(1),
        -1 => Ok(-1),
        other => Err(reader.error(value, format!("key '{key}' is {other}: 1 or -1"))),
    }
}

/// The control of the programs.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileControl {
    /// The family of controls.
    #[schemars(extend("enum" = names(&Dialect::ALL)))]
    dialect: Spanned<String>,
    /// The least input increment: IS-A 0.01, IS-B 0.001, IS-C 0.0001 (mm and degrees).
    #[schemars(extend("enum" = names(&Increment::ALL)))]
    increment: Spanned<String>,
}

impl FileControl {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<JobControl, FileError> {
        Ok(JobControl {
            dialect: reader.choice("control.dialect", &self.dialect, &Dialect::ALL)?,
            increment: reader.choice("control.increment", &self.increment, &Increment::ALL)?,
        })
    }
}

/// `[machine] rotary`: the axis that turns the part. sign · azimuth brings a hole to the plane z = 0.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileRotary {
    /// Its letter.
    #[schemars(extend("enum" = names(&ROTARY_LETTERS)))]
    letter: Spanned<String>,
    /// 1, or -1 if a positive command rotates the part in the opposite direction.
    #[schemars(extend("enum" = [1, -1]))]
    sign: Spanned<i64>,
}

impl FileRotary {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<Rotary, FileError> {
        Ok(Rotary {
            letter: reader.choice("machine.rotary.letter", &self.letter, &ROTARY_LETTERS)?,
            sign: sign(reader, "machine.rotary.sign", &self.sign)?,
        })
    }
}

/// `[tolerance]` of a part with holes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTolerance {
    /// Diameter of the tolerance zone of a hole's axis (ISO 1101), mm.
    #[schemars(range(min = 0.000_1, max = 1000.0))]
    position: Spanned<f64>,
    /// Tolerance of a hole's depth, either way, mm [default: 0.1].
    #[schemars(range(min = 0.000_1, max = 1000.0))]
    depth: Option<Spanned<f64>>,
}

impl FileTolerance {
    /// Diameter of the zone, mm.
    pub(super) fn position(&self, reader: &Reader<'_>) -> Result<f64, FileError> {
        reader.number("tolerance.position", &self.position, TOLERANCE, in_range(1e-4, 1e3))
    }

    /// Either way, mm.
    pub(super) fn depth(&self, reader: &Reader<'_>) -> Result<f64, FileError> {
        match &self.depth {
            Some(depth) => reader.number("tolerance.depth", depth, TOLERANCE, in_range(1e-4, 1e3)),
            None => Ok(0.1),
        }
    }
}
