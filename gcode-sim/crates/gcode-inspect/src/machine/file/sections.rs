//! Sections of errors shared by the machine file and the error file of a budget, and their error sources.
use schemars::JsonSchema;
use serde::Deserialize;

use super::spread::{Angle, ErrorRanges, ErrorSpread, FileVector, Length};
use crate::machine::sources::SampleParameters;
use crate::machine::{ErrorSource, HeadKind, Machine, Quantity};
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::{Bounded, Wavelength};
use gcode_part::reader::{FileKey, Optional, Reader, Section, Spanned};

/// The set-up of the part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePart {
    /// Its shift, mm.
    #[serde(default, with = "Optional::<Section<FileVector<Length>>>")]
    shift: Option<FileVector<Length>>,
    /// Its tilt, degrees.
    #[serde(default, with = "Optional::<Section<FileVector<Angle>>>")]
    tilt: Option<FileVector<Angle>>,
    /// Offset of its axis from the table's, mm, in any direction.
    runout: Option<Bounded<ErrorSpread<Length>>>,
}

/// Errors of the linear axes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLinear {
    /// Position error of X, mm.
    x: Option<Bounded<ErrorSpread<Length>>>,
    /// Position error of Y, mm.
    y: Option<Bounded<ErrorSpread<Length>>>,
    /// Position error of Z, mm.
    z: Option<Bounded<ErrorSpread<Length>>>,
    /// Wavelength of the error along the axis, mm [default: 500].
    pub(super) wave: Option<Bounded<Wavelength>>,
    /// Seed of the random errors: another seed is another machine of the same type [default: 0].
    pub(super) seed: Option<Spanned<u64>>,
}

/// Errors of the axis that rotates the part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileRotary {
    /// Error of its commanded angle, degrees.
    index: Option<Bounded<ErrorSpread<Angle>>>,
    /// Offset of the axis from its centre, mm.
    #[serde(default, with = "Optional::<Section<FileVector<Length>>>")]
    centre: Option<FileVector<Length>>,
    /// Tilt of its direction, degrees.
    #[serde(default, with = "Optional::<Section<FileVector<Angle>>>")]
    tilt: Option<FileVector<Angle>>,
    /// Seed of the random errors: another seed is another machine of the same type [default: 0].
    pub(super) seed: Option<Spanned<u64>>,
}

/// Errors of a head of kind manual or axis.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileHead {
    /// Error of its angle, degrees.
    angle: Option<Bounded<ErrorSpread<Angle>>>,
    /// Seed of the random errors: another seed is another machine of the same type [default: 0].
    pub(super) seed: Option<Spanned<u64>>,
}

/// Collects error sources, and checks that the machine has the parts that they concern.
pub(super) struct Collector<'r, 'm> {
    reader: &'r Reader<'r>,
    machine: &'m Machine,
    /// Prefix of keys in messages: `errors.` in a machine file.
    prefix: &'static str,
    /// Parameters of the current section.
    parameters: SampleParameters,
    pub(super) sources: Vec<(ErrorSource, SampleParameters)>,
}

/// Returns the seed of a section.
pub(super) fn seed(seed: &Option<Spanned<u64>>) -> u64 {
    seed.as_ref().map_or(0, |seed| *seed.as_ref())
}

impl<'r, 'm> Collector<'r, 'm> {
    pub(super) fn new(reader: &'r Reader<'r>, machine: &'m Machine, prefix: &'static str) -> Self {
        let parameters = SampleParameters { seed: 0, wave: 500.0 };
        Self { reader, machine, prefix, parameters, sources: Vec::new() }
    }

    fn add<R: ErrorRanges>(
        &mut self,
        key: &str,
        spread: &Option<Bounded<ErrorSpread<R>>>,
        quantity: Quantity,
    ) -> Result<(), FileError> {
        let Some(spread) = spread else { return Ok(()) };
        let key = format!("{}{key}", self.prefix);
        let distribution = spread.get();
        if let Some(lacking) = self.missing_part(quantity) {
            return Err(self.reader.error(spread, format!("key '{key}': {lacking}")));
        }
        self.sources.push((ErrorSource { quantity, distribution }, self.parameters));
        Ok(())
    }

    fn add_vector<R: ErrorRanges>(
        &mut self,
        key: &str,
        vector: &Option<FileVector<R>>,
        quantity: impl Fn(usize) -> Quantity,
    ) -> Result<(), FileError> {
        let Some(vector) = vector else { return Ok(()) };
        for (direction, spread) in [&vector.x, &vector.y, &vector.z].into_iter().enumerate() {
            let letter = ["x", "y", "z"][direction];
            self.add(&format!("{key}.{letter}"), spread, quantity(direction))?;
        }
        Ok(())
    }

    pub(super) fn part(&mut self, part: Option<&FilePart>) -> Result<(), FileError> {
        let Some(part) = part else { return Ok(()) };
        self.add_vector("part.shift", &part.shift, Quantity::Shift)?;
        self.add_vector("part.tilt", &part.tilt, Quantity::Tilt)?;
        self.add("part.runout", &part.runout, Quantity::RunOut)
    }

    pub(super) fn linear(&mut self, linear: Option<&FileLinear>) -> Result<(), FileError> {
        let Some(linear) = linear else { return Ok(()) };
        let wave = linear.wave.as_ref().map_or(self.parameters.wave, Bounded::get);
        self.parameters = SampleParameters { seed: seed(&linear.seed), wave };
        for (name, spread) in [("x", &linear.x), ("y", &linear.y), ("z", &linear.z)] {
            let Some(written) = spread else { continue };
            let axis = self.machine.axes.find(name.as_bytes()[0].to_ascii_uppercase());
            let Some(axis) = axis.filter(|axis| self.machine.is_axis_used(*axis)) else {
                let message = format!(
                    "key '{}linear.{name}': no linear axis with this letter moves the tool or the part",
                    self.prefix
                );
                return Err(self.reader.error(written, message));
            };
            self.add(&format!("linear.{name}"), spread, Quantity::Linear(axis))?;
        }
        Ok(())
    }

    pub(super) fn rotary(&mut self, rotary: Option<&FileRotary>) -> Result<(), FileError> {
        let Some(rotary) = rotary else { return Ok(()) };
        self.parameters.seed = seed(&rotary.seed);
        self.add("rotary.index", &rotary.index, Quantity::Index)?;
        self.add_vector("rotary.centre", &rotary.centre, Quantity::Centre)?;
        self.add_vector("rotary.tilt", &rotary.tilt, Quantity::AxisTilt)
    }

    pub(super) fn head(&mut self, head: Option<&FileHead>) -> Result<(), FileError> {
        let Some(head) = head else { return Ok(()) };
        self.parameters.seed = seed(&head.seed);
        self.add("head.angle", &head.angle, Quantity::Head)
    }

    /// Returns a message about the part that an error needs and the machine lacks.
    fn missing_part(&self, quantity: Quantity) -> Option<&'static str> {
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
