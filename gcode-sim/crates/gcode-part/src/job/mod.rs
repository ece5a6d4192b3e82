//! Job files: the part to make, its machine and its control. Both programs read them; the formulas of neither
//! live here.
//!
//! Unknown keys, missing keys and values out of range are errors that name the key, the line and the allowed
//! values.
mod alignment;
mod burr;
pub mod claims;
pub mod control_file;
mod honeycomb;
mod pattern;
mod pin_holes;
pub mod project;
mod sheet;

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::DeserializeOwned;

pub use alignment::{
    Alignment, AlignmentLimits, Chord, EllipsePath, Readings, Runout, SineTable, TouchProbe,
};
pub use burr::{
    AxisSigns, Burr, BurrProgram, BurrShape, BurrTolerance, FluteLaw, Grinder, Nose, ProgramForm,
};
pub use honeycomb::{Clamp, CombMachine, Cylinder, Drill, HolePattern, Honeycomb, Metric, Spacing};
pub use pattern::{
    HoleArc, HoleCircle, HoleGrid, HoleLayout, HoleLine, HomeReturn, Operation, PatternJob, PatternMachine,
    PatternPlace, PatternSpec, PatternStep, PatternTool, TiltedFace,
};
pub use pin_holes::{
    AxisDirection, Head, HeadKind, HoleSpec, MacroSettings, PinHoles, PinMachine, SurfaceSpec, Tool,
    WorkOrder,
};
pub use sheet::{AlternativeMachine, Minutes, Rates, SheetInfo};

use crate::reader::bounds::{DepthTolerance, KeyRange, PositionTolerance, Retract};
use crate::reader::{AxisSign, FileError, FileKey, Located, Reader, Word, WordList};
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
    /// Bolt circles, grids, lines and lists of holes.
    Pattern(PatternJob),
}

/// The control of the programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JobControl {
    /// The family of controls.
    #[serde(with = "Word::<Dialect>")]
    pub dialect: Dialect,
    /// The least input increment: IS-A 0.01, IS-B 0.001, IS-C 0.0001 (mm and degrees).
    #[serde(with = "Word::<Increment>")]
    pub increment: Increment,
}

/// The axis that rotates the part: sign · azimuth brings a hole to the plane z = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotary {
    /// Its letter.
    #[serde(with = "Word::<RotaryLetter>")]
    pub letter: char,
    /// 1, or -1 if a positive command rotates the part in the opposite direction.
    #[serde(with = "AxisSign")]
    pub sign: i8,
}

/// Letters of rotary axes.
enum RotaryLetter {}

impl WordList for RotaryLetter {
    type Value = char;

    fn all() -> Vec<(&'static str, char)> {
        vec![("A", 'A'), ("B", 'B'), ("C", 'C')]
    }
}

/// Tolerances of the holes.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleTolerance {
    /// Diameter of the tolerance zone of a hole's axis (ISO 1101), mm.
    #[serde(with = "PositionTolerance")]
    pub position: f64,
    /// Tolerance of a hole's depth, either way, mm.
    #[serde(default = "DepthTolerance::default", with = "DepthTolerance")]
    pub depth: f64,
}

/// Height above the surface at which rapid motion becomes feed, mm, unless the job specifies it.
const CLEARANCE: f64 = 2.0;

/// Returns the retract height, mm: 50, or the clearance if that is more, unless the job specifies it.
fn retract_height(specified: Option<f64>, clearance: f64) -> f64 {
    specified.unwrap_or(clearance.max(50.0))
}

/// Checks that the retract height is not below the clearance.
fn check_retract(reader: &Reader<'_>, retract: f64, clearance: f64) -> Result<(), FileError> {
    let most = Retract::MAX;
    let allowed = format_args!("{clearance} (the clearance) to {most} mm");
    reader.check((clearance..=most).contains(&retract), "machine.retract", retract, allowed)
}

/// A job as its file has it.
trait Family: DeserializeOwned {
    /// Checks the keys against each other, and completes the job.
    ///
    /// # Errors
    /// Keys that contradict each other, with the line of one of them and the allowed values.
    fn check(&mut self, reader: &Reader<'_>) -> Result<(), FileError>;

    /// Reads the text of a job.
    fn read(reader: &Reader<'_>) -> Result<Self, FileError> {
        let mut job: Self = reader.parse()?;
        job.check(reader).map(|()| job)
    }
}

#[derive(Deserialize)]
struct FamilyKey {
    family: Located<String>,
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
                generator.subschema_for::<PinHoles>(),
                generator.subschema_for::<Honeycomb>(),
                generator.subschema_for::<burr::File>(),
                generator.subschema_for::<Alignment>(),
                generator.subschema_for::<PatternJob>(),
            ],
        })
    }
}

/// Values of the key `family`.
pub const FAMILIES: [&str; 5] = ["pin-holes", "honeycomb", "burr", "alignment", "pattern"];

impl Job {
    /// Parses the text of a job file.
    ///
    /// # Errors
    /// A syntax error, or a key that is unknown, missing or out of range, with its line and the allowed
    /// values.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let reader = Reader { text };
        reader.parse::<toml::Table>()?;
        if !reader.has("family") {
            return Err(FileError {
                line: None,
                message: format!("key 'family' is missing: one of {}", FAMILIES.join(", ")),
            });
        }
        let FamilyKey { family } = reader.parse()?;
        match family.as_ref().as_str() {
            "pin-holes" => PinHoles::read(&reader).map(Self::PinHoles),
            "honeycomb" => Honeycomb::read(&reader).map(Self::Honeycomb),
            "burr" => burr::parse(&reader).map(Self::Burr),
            "alignment" => Alignment::read(&reader).map(Self::Alignment),
            "pattern" => PatternJob::read(&reader).map(Self::Pattern),
            other => {
                Err(reader
                    .error(&family, format!("family '{other}' is unknown: one of {}", FAMILIES.join(", "))))
            }
        }
    }

    /// Returns the height above the surface at which rapid motion becomes feed, mm.
    pub fn clearance(&self) -> f64 {
        match self {
            Self::PinHoles(job) => job.machine.clearance(),
            Self::Honeycomb(job) => job.machine.clearance(),
            Self::Burr(job) => job.grinder.clearance(),
            Self::Alignment(job) => job.machine.clearance(),
            Self::Pattern(job) => job.machine.clearance(),
        }
    }

    /// Returns the additional data for the set-up sheet.
    pub fn sheet(&self) -> &SheetInfo {
        match self {
            Self::PinHoles(job) => &job.sheet,
            Self::Honeycomb(job) => &job.sheet,
            Self::Burr(job) => &job.sheet,
            Self::Alignment(job) => &job.sheet,
            Self::Pattern(job) => &job.sheet,
        }
    }

    /// Returns the control of the programs.
    pub fn control(&self) -> JobControl {
        match self {
            Self::PinHoles(job) => job.control,
            Self::Honeycomb(job) => job.control,
            Self::Burr(job) => job.control,
            Self::Alignment(job) => job.control,
            Self::Pattern(job) => job.control,
        }
    }
}
