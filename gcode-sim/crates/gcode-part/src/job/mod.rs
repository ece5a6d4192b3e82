//! Job files: what to make, on which machine and control. Read by both programs; neither's formulas live here.
//!
//! Unknown keys, missing keys and values out of range are errors that name the key, the line and what is allowed.
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

/// A job, by its family.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    PinHoles(PinHoles),
    Honeycomb(Honeycomb),
    Burr(Burr),
    Alignment(Alignment),
}

/// The control a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobControl {
    pub dialect: Dialect,
    pub increment: Increment,
}

/// A rotary table: its letter, and the sign in B = sign · azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotary {
    pub letter: char,
    pub sign: i8,
}

#[derive(Deserialize)]
struct Family {
    family: Spanned<String>,
}

/// A job file as it is written: the schema of one of the families.
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

pub const FAMILIES: [&str; 4] = ["pin-holes", "honeycomb", "burr", "alignment"];

impl Job {
    /// Reads a job file's text.
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

    /// How far above the surface rapid becomes feed, mm.
    pub fn clearance(&self) -> f64 {
        match self {
            Self::PinHoles(job) => job.machine.clearance,
            Self::Honeycomb(job) => job.machine.clearance,
            Self::Burr(job) => job.grinder.clearance,
            Self::Alignment(job) => job.machine.clearance,
        }
    }

    /// What the set-up sheet says beside what follows from the job.
    pub fn sheet(&self) -> &SheetInfo {
        match self {
            Self::PinHoles(job) => &job.sheet,
            Self::Honeycomb(job) => &job.sheet,
            Self::Burr(job) => &job.sheet,
            Self::Alignment(job) => &job.sheet,
        }
    }

    pub fn control(&self) -> JobControl {
        match self {
            Self::PinHoles(job) => job.control,
            Self::Honeycomb(job) => job.control,
            Self::Burr(job) => job.control,
            Self::Alignment(job) => job.control,
        }
    }
}
