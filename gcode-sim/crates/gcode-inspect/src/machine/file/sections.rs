//! The sections of errors that a machine file and the error file of a budget share, and the sources in them.
use schemars::JsonSchema;
use serde::Deserialize;

use super::spread::{ANGLE, FileSpread, FileVector, Kind, LENGTH};
use crate::machine::sources::{ErrorSource, Quantity};
use crate::machine::{HeadKind, Machine};
use gcode_lang::motion::AxisIndex;
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::{Bounded, Wavelength};
use gcode_part::reader::{Reader, Spanned};

/// The set-up of the part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePart {
    /// How far it is shifted, mm.
    #[schemars(transform = LENGTH.bounds())]
    pub(super) shift: Option<FileVector>,
    /// How far it is tilted, degrees.
    #[schemars(transform = ANGLE.bounds())]
    pub(super) tilt: Option<FileVector>,
    /// How far its axis stands aside of the table's, mm, in any direction.
    #[schemars(transform = LENGTH.bounds())]
    pub(super) runout: Option<Spanned<FileSpread>>,
}

/// Of the axes that slide.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLinear {
    /// How far X stands beyond its commanded place, mm.
    #[schemars(transform = LENGTH.bounds())]
    pub(super) x: Option<Spanned<FileSpread>>,
    /// How far Y stands beyond its commanded place, mm.
    #[schemars(transform = LENGTH.bounds())]
    pub(super) y: Option<Spanned<FileSpread>>,
    /// How far Z stands beyond its commanded place, mm.
    #[schemars(transform = LENGTH.bounds())]
    pub(super) z: Option<Spanned<FileSpread>>,
    /// The error swings once on so many mm of the axis [default: 500].
    pub(super) wave: Option<Bounded<Wavelength>>,
    /// Another seed is another machine of the same make [default: 0].
    pub(super) seed: Option<Spanned<u64>>,
}

/// Of the axis that turns the part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileRotary {
    /// How far it stands beyond its commanded angle, degrees.
    #[schemars(transform = ANGLE.bounds())]
    pub(super) index: Option<Spanned<FileSpread>>,
    /// Where it is against its centre, mm.
    #[schemars(transform = LENGTH.bounds())]
    pub(super) centre: Option<FileVector>,
    /// How its direction is turned, degrees.
    #[schemars(transform = ANGLE.bounds())]
    pub(super) tilt: Option<FileVector>,
    /// Another seed is another machine of the same make [default: 0].
    pub(super) seed: Option<Spanned<u64>>,
}

/// Of a head of kind manual or axis.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileHead {
    /// How far it stands beyond its angle, degrees.
    #[schemars(transform = ANGLE.bounds())]
    pub(super) angle: Option<Spanned<FileSpread>>,
    /// Another seed is another machine of the same make [default: 0].
    pub(super) seed: Option<Spanned<u64>>,
}

/// Collects sources, and checks that the machine has what they are about.
pub(super) struct Collector<'r, 'm> {
    pub(super) reader: &'r Reader<'r>,
    pub(super) machine: &'m Machine,
    /// `errors.` in a machine file.
    pub(super) before: &'static str,
    pub(super) found: Vec<ErrorSource>,
}

impl Collector<'_, '_> {
    fn one(
        &mut self,
        key: &str,
        spread: &Option<Spanned<FileSpread>>,
        quantity: Quantity,
        kind: Kind,
    ) -> Result<(), FileError> {
        let Some(spread) = spread else { return Ok(()) };
        let key = format!("{}{key}", self.before);
        let spread_checked = spread.as_ref().check(self.reader, &key, spread.span().start, kind)?;
        if let Some(lacking) = self.lacking(quantity) {
            return Err(self.reader.error(spread, format!("key '{key}': {lacking}")));
        }
        self.found.push(ErrorSource { quantity, spread: spread_checked });
        Ok(())
    }

    fn vector(
        &mut self,
        key: &str,
        vector: &Option<FileVector>,
        quantity: impl Fn(usize) -> Quantity,
        kind: Kind,
    ) -> Result<(), FileError> {
        let Some(vector) = vector else { return Ok(()) };
        for (direction, spread) in [&vector.x, &vector.y, &vector.z].into_iter().enumerate() {
            let letter = ["x", "y", "z"][direction];
            self.one(&format!("{key}.{letter}"), spread, quantity(direction), kind)?;
        }
        Ok(())
    }

    pub(super) fn part(&mut self, part: &FilePart) -> Result<(), FileError> {
        self.vector("part.shift", &part.shift, Quantity::Shift, LENGTH)?;
        self.vector("part.tilt", &part.tilt, Quantity::Tilt, ANGLE)?;
        self.one("part.runout", &part.runout, Quantity::RunOut, LENGTH)
    }

    pub(super) fn linear(&mut self, linear: &FileLinear) -> Result<(), FileError> {
        for (letter, spread) in [(b'X', &linear.x), (b'Y', &linear.y), (b'Z', &linear.z)] {
            let Some(written) = spread else { continue };
            let name = char::from(letter).to_ascii_lowercase();
            let axis: Option<AxisIndex> =
                self.machine.axes.find(letter).filter(|axis| self.machine.carries(*axis));
            let Some(axis) = axis else {
                let message = format!(
                    "key '{}linear.{name}': no linear axis with this letter moves the tool or the part",
                    self.before
                );
                return Err(self.reader.error(written, message));
            };
            self.one(&format!("linear.{name}"), spread, Quantity::Linear(axis), LENGTH)?;
        }
        Ok(())
    }

    pub(super) fn rotary(&mut self, rotary: &FileRotary) -> Result<(), FileError> {
        self.one("rotary.index", &rotary.index, Quantity::Index, ANGLE)?;
        self.vector("rotary.centre", &rotary.centre, Quantity::Centre, LENGTH)?;
        self.vector("rotary.tilt", &rotary.tilt, Quantity::AxisTilt, ANGLE)
    }

    pub(super) fn head(&mut self, head: &FileHead) -> Result<(), FileError> {
        self.one("head.angle", &head.angle, Quantity::Head, ANGLE)
    }

    /// What an error needs that the machine hasn't got.
    fn lacking(&self, quantity: Quantity) -> Option<&'static str> {
        match quantity {
            Quantity::RunOut | Quantity::Index | Quantity::Centre(_) | Quantity::AxisTilt(_) => {
                let one = self.machine.rotary_axis().is_some();
                (!one).then_some(
                    "needs exactly one axis that rotates the part; this machine has none, or several",
                )
            }
            Quantity::Head => {
                let turns = matches!(self.machine.head.kind, HeadKind::Manual { .. } | HeadKind::Axis { .. });
                (!turns).then_some("needs a [head] of kind manual or axis")
            }
            Quantity::Shift(_) | Quantity::Tilt(_) | Quantity::Linear(_) => None,
        }
    }
}
