//! Sections shared by job files of several families: `[control]`, `[tolerance]`, the rotary table and heights
//! above the part.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{JobControl, Rotary};
use crate::reader::bounds::{Bounded, Depth, KeyRange, PositionTolerance, Retract, Sign};
use crate::reader::{FileError, Reader, Spanned, names};
use gcode_lang::control::{Dialect, Increment};

/// Letters of rotary axes.
pub(super) const ROTARY_LETTERS: [(&str, char); 3] = [("A", 'A'), ("B", 'B'), ("C", 'C')];

/// Returns a predicate that is true from `low` to `high`, both included.
pub(super) fn in_range(low: f64, high: f64) -> impl Fn(f64) -> bool {
    move |value| (low..=high).contains(&value)
}

/// Returns `machine.clearance` and `machine.retract`, mm: the height at which the feed begins, and the
/// retract height.
pub(super) fn heights(
    reader: &Reader<'_>,
    clearance: Option<&Bounded<Depth>>,
    retract: Option<&Bounded<Retract>>,
) -> Result<(f64, f64), FileError> {
    let clearance = clearance.map_or(2.0, Bounded::get);
    let allowed = format!("{clearance} (the clearance) to {} mm", Retract::MAX);
    let within = in_range(clearance, Retract::MAX);
    let retract = match retract {
        Some(retract) => reader.number("machine.retract", retract, &allowed, within)?,
        None => clearance.max(50.0),
    };
    Ok((clearance, retract))
}

/// The control the programs are for.
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
    sign: Sign,
}

impl FileRotary {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<Rotary, FileError> {
        Ok(Rotary {
            letter: reader.choice("machine.rotary.letter", &self.letter, &ROTARY_LETTERS)?,
            sign: self.sign.get(),
        })
    }
}

/// `[tolerance]` of a part with holes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTolerance {
    /// Diameter of the tolerance zone of a hole's axis (ISO 1101), mm.
    position: Bounded<PositionTolerance>,
    /// Tolerance of a hole's depth, either way, mm [default: 0.1].
    depth: Option<Bounded<PositionTolerance>>,
}

impl FileTolerance {
    /// Returns the diameter of the tolerance zone, mm.
    pub(super) fn position(&self) -> f64 {
        self.position.get()
    }

    /// Returns the tolerance of a depth, either way, mm.
    pub(super) fn depth(&self) -> f64 {
        self.depth.as_ref().map_or(0.1, Bounded::get)
    }
}
