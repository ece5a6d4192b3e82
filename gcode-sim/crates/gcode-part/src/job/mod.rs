//! Job files: the part to make, its machine and its control. Both programs read them; the formulas of neither
//! live here.
//!
//! Unknown keys, missing keys and values out of range are errors that name the key, the line and the allowed
//! values.
mod alignment;
mod burr;
pub mod control_file;
mod honeycomb;
mod pin_holes;
mod sections;
mod sheet;

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

pub use alignment::{Alignment, AlignmentLimits, Chord, EllipsePath, Runout, SineTable};
pub use burr::{
    AxisSigns, Burr, BurrProgram, BurrShape, BurrTolerance, FluteLaw, Grinder, Nose, ProgramForm,
};
pub use honeycomb::{Clamp, CombMachine, Cylinder, Drill, Honeycomb, Metric, Spacing};
pub use pin_holes::{
    AxisDirection, Head, HeadKind, HoleSpec, MacroSettings, PinHoles, PinMachine, Surface, Tool,
};
pub use sheet::FileRates;
pub use sheet::{AlternativeMachine, Minutes, Rates, SheetInfo};

use crate::reader::{FileError, Reader, Spanned};
use gcode_lang::control::{Dialect, Increment};

/// A job of one of the families.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// Pin holes on an ellipsoid.
    PinHoles(PinHoles),
    /// Radial holes in a hexagonal pattern on a cylinder.
    Honeycomb(Honeycomb),
    /// A rotary burr.
    Burr(Burr),
    /// Measurements of a part's position.
    Alignment(Alignment),
}

/// Control of a job's programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobControl {
    /// Family of controls.
    pub dialect: Dialect,
    /// Least input increment.
    pub increment: Increment,
}

/// A rotary table that brings a hole to the plane z = 0 with the command sign · azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotary {
    /// Address letter: A, B or C.
    pub letter: char,
    /// Sign of the command, 1 or −1.
    pub sign: i8,
}

#[derive(Deserialize)]
struct Family {
    family: Spanned<String>,
}

/// The job file as a schema: that of one of the families.
pub struct JobFile;

impl JsonSchema for JobFile {
    fn schema_name() -> Cow<'static, str> {
        "Job".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "The part, its machine and its control.",
            "oneOf": [
                generator.subschema_for::<pin_holes::File>(),
                generator.subschema_for::<honeycomb::File>(),
                generator.subschema_for::<burr::File>(),
                generator.subschema_for::<alignment::File>(),
            ],
        })
    }
}

/// Values of the key `family`.
pub const FAMILIES: [&str; 4] = ["pin-holes", "honeycomb", "burr", "alignment"];

impl Job {
    /// Parses the text of a job file.
    ///
    /// # Errors
    /// A syntax error, or a key that is unknown, missing or out of range, with its line and the allowed
    /// values.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let reader = Reader { text };
        let table: toml::Table = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
        if !table.contains_key("family") {
            return Err(FileError {
                line: None,
                message: format!("key 'family' is missing: one of {}", FAMILIES.join(", ")),
            });
        }
        let Family { family } = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
        match family.as_ref().as_str() {
            "pin-holes" => pin_holes::parse(&reader).map(Self::PinHoles),
            "honeycomb" => honeycomb::parse(&reader).map(Self::Honeycomb),
            "burr" => burr::parse(&reader).map(Self::Burr),
            "alignment" => alignment::parse(&reader).map(Self::Alignment),
            other => {
                Err(reader
                    .error(&family, format!("family '{other}' is unknown: one of {}", FAMILIES.join(", "))))
            }
        }
    }

    /// Returns the height above the surface at which rapid motion becomes feed, mm.
    pub fn clearance(&self) -> f64 {
        match self {
            Self::PinHoles(job) => job.machine.clearance,
            Self::Honeycomb(job) => job.machine.clearance,
            Self::Burr(job) => job.grinder.clearance,
            Self::Alignment(job) => job.machine.clearance,
        }
    }

    /// Returns the additional data for the set-up sheet.
    pub fn sheet(&self) -> &SheetInfo {
        match self {
            Self::PinHoles(job) => &job.sheet,
            Self::Honeycomb(job) => &job.sheet,
            Self::Burr(job) => &job.sheet,
            Self::Alignment(job) => &job.sheet,
        }
    }

    /// Returns the control of the programs.
    pub fn control(&self) -> JobControl {
        match self {
            Self::PinHoles(job) => job.control,
            Self::Honeycomb(job) => job.control,
            Self::Burr(job) => job.control,
            Self::Alignment(job) => job.control,
        }
    }
}
