//! The job file of the family `pattern`: bolt circles, arcs, grids, lines and lists of holes on a plate, round a cylinder or on
//! a tilted face.
mod layout;
mod operation;

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::Deserialize;

pub use layout::{HoleArc, HoleCircle, HoleGrid, HoleLayout, HoleLine, PatternSpec};
pub use operation::{Operation, PatternStep, PatternTool};

use super::{
    CLEARANCE, Clamp, Family, FileError, HoleTolerance, JobControl, Reader, Rotary, SheetInfo, check_retract,
    retract_height,
};
use crate::reader::bounds::{Angle, Depth, Length, MachinePoint, Retract};
use crate::reader::{FileKey, FixedArray, Items, Optional, Section, Word, WordList};
use gcode_lang::control::Dialect;

/// Patterns of holes whose points the control computes from the numbers of the drawing.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatternJob {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["pattern"]))]
    _family: String,
    /// The control of the programs.
    #[serde(with = "Section::<JobControl>")]
    pub control: JobControl,
    /// The machine [default: three axes].
    #[serde(default, with = "Section::<PatternMachine>")]
    pub machine: PatternMachine,
    /// Tolerances of the holes.
    #[serde(with = "Section::<HoleTolerance>")]
    pub tolerance: HoleTolerance,
    /// The cylinder about x round which the patterns lie [default: none, a plate].
    #[serde(default, with = "Optional::<Section<PatternCylinder>>")]
    cylinder: Option<PatternCylinder>,
    /// The tilted face on which the patterns lie [default: none, a plate].
    #[serde(default, with = "Optional::<Section<TiltedFace>>")]
    face: Option<TiltedFace>,
    /// The tools in the order of use.
    #[serde(rename = "tool", with = "Items::<Section<PatternTool>>")]
    #[schemars(length(min = 1))]
    pub tools: Vec<PatternTool>,
    /// The patterns, in the order in which each tool makes them.
    #[serde(rename = "pattern", with = "Items::<Section<PatternSpec>>")]
    #[schemars(length(min = 1))]
    pub patterns: Vec<PatternSpec>,
    /// Additional data for the set-up sheet.
    #[serde(default, with = "Section::<SheetInfo>")]
    pub sheet: SheetInfo,
}

/// The machine of a pattern job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatternMachine {
    /// The axis that rotates the part: about x for a cylinder, about z for a tilted face.
    #[serde(default, with = "Optional::<Section<Rotary>>")]
    rotary: Option<Rotary>,
    /// The axis that tilts the table of `rotary` about x, for a tilted face.
    #[serde(default, with = "Optional::<Section<Rotary>>")]
    tilt: Option<Rotary>,
    /// Height above the surface where the feed begins, mm [default: 2].
    #[serde(default, with = "Optional::<Depth>")]
    pub(crate) clearance: Option<f64>,
    /// Retract height above the surface between holes, mm, no less than the clearance [default: 50].
    #[serde(default, with = "Optional::<Retract>")]
    pub(crate) retract: Option<f64>,
    /// The M codes that clamp and release the rotary, for a cylinder [default: none].
    #[serde(default, with = "Optional::<Section<Clamp>>")]
    pub clamp: Option<Clamp>,
    /// How Z goes home before a tool change, before G53.1 turns a table, and at the end: G28, G53, or none where M06 does it
    /// and the retract is enough for the rest [default: G28].
    #[serde(default, with = "Word::<HomeReturn>")]
    pub home: HomeReturn,
}

/// Way in which Z goes home.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HomeReturn {
    /// To the reference position, by G91 G28 Z0.
    #[default]
    G28,
    /// To machine zero, by G53 Z0.
    G53,
    /// Not by the program.
    None,
}

impl WordList for HomeReturn {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        vec![("G28", Self::G28), ("G53", Self::G53), ("none", Self::None)]
    }
}

/// The cylinder round which patterns lie.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PatternCylinder {
    /// Diameter, mm.
    #[serde(with = "Length")]
    diameter: f64,
}

/// The plane of a tilted face.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TiltedFace {
    /// Its zero point, in the part's frame, mm.
    #[serde(with = "FixedArray::<MachinePoint, 3>")]
    pub origin: [f64; 3],
    /// I, J and K of G68.2: rotations about z, then the new x, then the new z, degrees.
    #[serde(with = "FixedArray::<Angle, 3>")]
    pub angles: [f64; 3],
}

/// Where the patterns lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PatternPlace {
    /// On the plane z = 0.
    Plate,
    /// Round a cylinder about x: y of a pattern is an angle.
    Cylinder {
        /// Diameter of the cylinder, mm.
        diameter: f64,
        /// The axis that rotates it.
        rotary: Rotary,
    },
    /// On a tilted face.
    Face {
        /// The plane.
        face: TiltedFace,
        /// The axis that tilts the table about x.
        tilt: Rotary,
        /// The axis that rotates the part about z.
        rotary: Rotary,
    },
}

impl PatternMachine {
    /// Returns the height above the surface at which rapid motion becomes feed, mm.
    pub fn clearance(&self) -> f64 {
        self.clearance.unwrap_or(CLEARANCE)
    }

    /// Returns the height above the surface between holes, mm.
    pub fn retract(&self) -> f64 {
        retract_height(self.retract, self.clearance())
    }
}

impl PatternJob {
    /// Returns where the patterns lie. The check has found the axes that it needs.
    pub fn place(&self) -> PatternPlace {
        let PatternMachine { rotary, tilt, .. } = self.machine;
        match (self.cylinder, self.face, rotary, tilt) {
            (Some(PatternCylinder { diameter }), _, Some(rotary), _) => {
                PatternPlace::Cylinder { diameter, rotary }
            }
            (_, Some(face), Some(rotary), Some(tilt)) => PatternPlace::Face { face, tilt, rotary },
            _ => PatternPlace::Plate,
        }
    }

    /// Returns the tool with this number.
    pub fn tool(&self, number: u32) -> Option<&PatternTool> {
        self.tools.iter().find(|tool| tool.number == number)
    }

    fn check_place(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let PatternMachine { rotary, tilt, clamp, .. } = self.machine;
        let needs = |key: &str, section: &str, example: &str| {
            let message = format!("key 'machine.{key}' is missing: [{section}] needs it; write {example}");
            reader.error_at(section, message)
        };
        let excess = |key: &str, why: &str| {
            let key = format!("machine.{key}");
            reader.error_at(&key, format!("key '{key}' is for {why} only"))
        };
        let is_face = self.face.is_some();
        if is_face && self.cylinder.is_some() {
            let message = "[face] excludes [cylinder]: a job has one place; write a job for each";
            return Err(reader.error_at("face", message));
        }
        if let (Some(rotary), Some(tilt)) = (rotary, tilt)
            && rotary.letter == tilt.letter
        {
            let message = format!("key 'machine.tilt.letter' is {}, the letter of 'rotary'", tilt.letter);
            return Err(reader.error_at("machine.tilt.letter", message));
        }
        if tilt.is_some() && !is_face {
            return Err(excess("tilt", "a tilted [face]"));
        }
        if rotary.is_some() && !is_face && self.cylinder.is_none() {
            return Err(excess("rotary", "a [cylinder] or a tilted [face]"));
        }
        if clamp.is_some() && self.cylinder.is_none() {
            return Err(excess("clamp", "a [cylinder]"));
        }
        if let Some(Clamp { on, off }) = clamp
            && on == off
        {
            let message = format!("key 'machine.clamp.off' is {off}, the same as 'on'");
            return Err(reader.error_at("machine.clamp.off", message));
        }
        if self.cylinder.is_some() && rotary.is_none() {
            return Err(needs("rotary", "cylinder", "rotary = { letter = \"A\", sign = 1 }"));
        }
        if is_face && rotary.is_none() {
            return Err(needs("rotary", "face", "rotary = { letter = \"C\", sign = -1 }"));
        }
        if is_face && tilt.is_none() {
            return Err(needs("tilt", "face", "tilt = { letter = \"A\", sign = -1 }"));
        }
        if is_face && self.control.dialect == Dialect::HaasNgc {
            let message = "[face] needs G68.2, which this dialect of the simulator lacks: \
                           use fanuc-31i or fanuc-0i-f";
            return Err(reader.error_at("face", message));
        }
        Ok(())
    }

    fn check_names(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let mut numbers = BTreeSet::new();
        if let Some(index) = self.tools.iter().position(|tool| !numbers.insert(tool.number)) {
            let message = format!("key 'tool.number': {} is used twice", self.tools[index].number);
            return Err(reader.error_at(&format!("tool.{index}.number"), message));
        }
        let mut ids = BTreeSet::new();
        if let Some(index) = self.patterns.iter().position(|pattern| !ids.insert(&pattern.id)) {
            let message = format!("key 'pattern.id': '{}' is used twice", self.patterns[index].id);
            return Err(reader.error_at(&format!("pattern.{index}.id"), message));
        }
        Ok(())
    }

    /// Checks that a pattern names each tool.
    fn check_use(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let is_used = |tool: &PatternTool| {
            self.patterns.iter().flat_map(|pattern| &pattern.steps).any(|step| step.tool == tool.number)
        };
        if let Some(index) = self.tools.iter().position(|tool| !is_used(tool)) {
            let number = self.tools[index].number;
            let message =
                format!("key 'tool.number': no pattern names tool {number}: remove it, or add it to 'make'");
            return Err(reader.error_at(&format!("tool.{index}.number"), message));
        }
        Ok(())
    }
}

impl Family for PatternJob {
    fn check(&mut self, reader: &Reader<'_>) -> Result<(), FileError> {
        for (list, key) in [(self.patterns.is_empty(), "pattern"), (self.tools.is_empty(), "tool")] {
            if list {
                return Err(FileError { line: None, message: format!("no {key}s: add a [[{key}]]") });
            }
        }
        check_retract(reader, self.machine.retract(), self.machine.clearance())?;
        self.check_place(reader)?;
        self.check_names(reader)?;
        for (index, tool) in self.tools.iter().enumerate() {
            tool.check(reader, &format!("tool.{index}"))?;
        }
        let is_cylinder = self.cylinder.is_some();
        for (index, pattern) in self.patterns.iter().enumerate() {
            let key = format!("pattern.{index}");
            pattern.check(reader, &key, is_cylinder)?;
            for (place, step) in pattern.steps.iter().enumerate() {
                step.check(reader, &format!("{key}.make.{place}"), self)?;
            }
            if pattern.steps.iter().all(|step| self.tool(step.tool).is_some_and(PatternTool::only_spots)) {
                let message =
                    "key 'pattern.make' has spot drills alone, which make no hole: add the drill".to_owned();
                return Err(reader.error_at(&format!("{key}.make"), message));
            }
            if let Some(cylinder) = self.cylinder {
                for (place, step) in pattern.steps.iter().enumerate() {
                    let (radius, depth) = (cylinder.diameter / 2.0, step.depth);
                    let allowed = format_args!("below the radius of {radius} mm");
                    reader.check(depth < radius, &format!("{key}.make.{place}.depth"), depth, allowed)?;
                }
            }
        }
        self.check_use(reader)
    }
}

#[cfg(test)]
mod tests;
