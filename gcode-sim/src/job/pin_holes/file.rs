//! Reads the job file of the family `pin-holes`: every key checked, its line named.
use std::collections::BTreeSet;

use serde::Deserialize;
use toml::Spanned;

use super::tools::{FileTool, ToolsWanted, assign, default_tools};
use super::{AxisDirection, Head, HeadKind, HoleWanted, MacroSettings, PinHoles, PinMachine, Surface, Tool};
use crate::job::sections::{FileControl, FileRotary, FileTolerance, ROTARY_LETTERS, heights, length, within};
use crate::job::sheet::FileSheet;
use crate::job::{JobError, Reader};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "family")]
    _family: String,
    control: FileControl,
    machine: FileMachine,
    surface: FileSurface,
    tolerance: FileTolerance,
    hole: Vec<FileHole>,
    tool: Option<Vec<FileTool>>,
    #[serde(rename = "macro")]
    macros: Option<FileMacro>,
    sheet: Option<FileSheet>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct FileMachine {
    rotary: FileRotary,
    head: Option<FileHead>,
    clearance: Option<Spanned<f64>>,
    retract: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileHead {
    kind: Spanned<String>,
    letter: Option<Spanned<String>>,
    pivot: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct FileSurface {
    kind: Spanned<String>,
    a: Spanned<f64>,
    b: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileHole {
    id: Spanned<String>,
    radius: Spanned<f64>,
    azimuth: Spanned<f64>,
    axis: Spanned<String>,
    diameter: Spanned<f64>,
    depth: Spanned<f64>,
    tools: Option<Spanned<Vec<i64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileMacro {
    common: Spanned<i64>,
}

/// Reads the text of a job of this family.
pub(in crate::job) fn parse(reader: &Reader<'_>) -> Result<PinHoles, JobError> {
    let file: File = toml::from_str(reader.text).map_err(|e| reader.syntax(&e))?;
    let surface = file.surface.check(reader)?;
    let (tools, tools_of_holes) = file.tools(reader)?;
    let mut holes = Vec::new();
    for (hole, tools) in file.hole.iter().zip(tools_of_holes) {
        holes.push(hole.check(reader, surface, tools)?);
    }
    let common = match &file.macros {
        Some(macros) => macros.check(reader)?,
        None => 140,
    };
    Ok(PinHoles {
        control: file.control.check(reader)?,
        machine: file.machine.check(reader)?,
        surface,
        position_tolerance: file.tolerance.position(reader)?,
        depth_tolerance: file.tolerance.depth(reader)?,
        tools,
        macros: MacroSettings { common },
        holes,
        sheet: FileSheet::of(file.sheet, reader)?,
    })
}

impl File {
    /// The tools in the order of use, and for each hole the numbers of those that make it.
    fn tools(&self, reader: &Reader<'_>) -> Result<(Vec<Tool>, Vec<Vec<u32>>), JobError> {
        let Some(first) = self.hole.first() else {
            return Err(JobError { line: None, message: "there is no hole: add a [[hole]]".into() });
        };
        let mut ids = BTreeSet::new();
        for hole in &self.hole {
            if !ids.insert(hole.id.as_ref().as_str()) {
                let message = format!("key 'hole.id': '{}' is there twice", hole.id.as_ref());
                return Err(reader.error(&hole.id, message));
            }
            length(reader, "hole.diameter", &hole.diameter)?;
        }
        let wanted: Vec<_> = self.hole.iter().map(FileHole::tools_wanted).collect();
        let Some(tools) = &self.tool else { return default_tools(reader, &wanted) };
        if tools.is_empty() {
            return Err(reader.error(&first.id, "'tool' is empty: leave it out, or add a [[tool]]"));
        }
        let mut numbers = BTreeSet::new();
        for tool in tools {
            if !numbers.insert(*tool.number().as_ref()) {
                let message = format!("key 'tool.number': {} is there twice", tool.number().as_ref());
                return Err(reader.error(tool.number(), message));
            }
        }
        let tools = tools.iter().map(|tool| tool.check(reader)).collect::<Result<Vec<_>, _>>()?;
        let of_holes = assign(reader, &tools, &wanted)?;
        Ok((tools, of_holes))
    }
}

impl FileSurface {
    pub(in crate::job) fn check(&self, reader: &Reader<'_>) -> Result<Surface, JobError> {
        reader.choice("surface.kind", &self.kind, &[("ellipsoid", ())])?;
        Ok(Surface { a: length(reader, "surface.a", &self.a)?, b: length(reader, "surface.b", &self.b)? })
    }
}

impl FileMachine {
    pub(in crate::job) fn check(&self, reader: &Reader<'_>) -> Result<PinMachine, JobError> {
        let rotary = self.rotary.check(reader)?;
        let head = match &self.head {
            Some(head) => head.check(reader, rotary.letter)?,
            None => Head { kind: HeadKind::Manual, pivot: 0.0 },
        };
        let (clearance, retract) = heights(reader, self.clearance.as_ref(), self.retract.as_ref())?;
        Ok(PinMachine { rotary, head, clearance, retract })
    }
}

impl FileHead {
    fn check(&self, reader: &Reader<'_>, rotary: char) -> Result<Head, JobError> {
        let pivot = match &self.pivot {
            Some(pivot) => {
                reader.number("machine.head.pivot", pivot, "0 to 9999 mm", within(0.0, 9_999.0))?
            }
            None => 0.0,
        };
        let by_axis = reader.choice("machine.head.kind", &self.kind, &[("manual", false), ("axis", true)])?;
        let kind = match (&self.letter, by_axis) {
            (None, false) => HeadKind::Manual,
            (Some(letter), false) => {
                return Err(reader.error(letter, "key 'machine.head.letter' goes with kind = \"axis\" only"));
            }
            (None, true) => {
                return Err(reader
                    .error(&self.kind, "kind = \"axis\" needs the key 'machine.head.letter': A, B or C"));
            }
            (Some(letter), true) => {
                let chosen = reader.choice("machine.head.letter", letter, &ROTARY_LETTERS)?;
                if chosen == rotary {
                    return Err(reader.error(
                        letter,
                        format!("key 'machine.head.letter' is {chosen}, which is the rotary table's"),
                    ));
                }
                HeadKind::Axis(chosen)
            }
        };
        Ok(Head { kind, pivot })
    }
}

impl FileHole {
    fn tools_wanted(&self) -> ToolsWanted<'_> {
        ToolsWanted { id: self.id.as_ref(), diameter: &self.diameter, tools: self.tools.as_ref() }
    }

    fn check(&self, reader: &Reader<'_>, surface: Surface, tools: Vec<u32>) -> Result<HoleWanted, JobError> {
        let a = surface.a;
        let radii = format!("0 to the equatorial radius a = {a} mm");
        Ok(HoleWanted {
            id: self.id.as_ref().clone(),
            radius: reader.number("hole.radius", &self.radius, &radii, within(0.0, a))?,
            azimuth: reader.number(
                "hole.azimuth",
                &self.azimuth,
                "-3600 to 3600 degrees",
                within(-3600.0, 3600.0),
            )?,
            axis: reader.choice(
                "hole.axis",
                &self.axis,
                &[("axial", AxisDirection::Axial), ("normal", AxisDirection::Normal)],
            )?,
            diameter: *self.diameter.as_ref(),
            depth: reader.number("hole.depth", &self.depth, "0.01 to 9999 mm", within(0.01, 9_999.0))?,
            tools,
        })
    }
}

impl FileMacro {
    fn check(&self, reader: &Reader<'_>) -> Result<u32, JobError> {
        let common = *self.common.as_ref();
        if (100..=198).contains(&common) || (500..=998).contains(&common) {
            return Ok(common as u32);
        }
        Err(reader.error(
            &self.common,
            format!("key 'macro.common' is {common}: 100 to 198 or 500 to 998, for it and the next are used"),
        ))
    }
}
