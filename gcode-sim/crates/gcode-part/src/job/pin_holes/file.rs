//! Reads the job file of the family `pin-holes`. Errors name the key and its line.
use std::collections::BTreeSet;

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::json;

use super::tools::{FileTool, HoleToolSpec, assign, default_tools};
use super::{AxisDirection, Head, HeadKind, HoleSpec, MacroSettings, PinHoles, PinMachine, Surface, Tool};
use crate::job::sections::{FileControl, FileRotary, FileTolerance, ROTARY_LETTERS, heights, in_range};
use crate::job::sheet::FileSheet;
use crate::job::{FileError, Reader};
use crate::reader::bounds::{Azimuth, Bounded, Depth, Length, Radius, Retract, ToolLength};
use crate::reader::{Spanned, names};

/// Pin holes in a surface of revolution: drilled along its axis or its normals.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct File {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["pin-holes"]))]
    _family: String,
    /// The control of the programs.
    control: FileControl,
    /// The machine.
    machine: FileMachine,
    /// The surface that the holes begin in.
    surface: FileSurface,
    /// Tolerances of the holes.
    tolerance: FileTolerance,
    /// The holes, in the order in which they are drilled.
    #[schemars(length(min = 1))]
    hole: Vec<FileHole>,
    /// The tools in the order of use [default: a drill and an end mill for each diameter].
    #[schemars(length(min = 1))]
    tool: Option<Vec<FileTool>>,
    /// The common variables of the macros.
    #[serde(rename = "macro")]
    macros: Option<FileMacro>,
    /// Additional data for the set-up sheet.
    sheet: Option<FileSheet>,
}

/// The machine of a job with a rotary table.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct FileMachine {
    /// The axis that rotates the part.
    rotary: FileRotary,
    /// How the tool is inclined [default: by hand].
    head: Option<FileHead>,
    /// Distance from the surface where the feed begins, mm [default: 2].
    clearance: Option<Bounded<Depth>>,
    /// Retract height above the surface between holes, mm, no less than the clearance [default: 50].
    retract: Option<Bounded<Retract>>,
}

/// How the tool is inclined.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = letter_goes_with_axis)]
struct FileHead {
    /// manual: an operator sets it at a stop; axis: an axis of the control.
    #[schemars(extend("enum" = names(&HEADS)))]
    kind: Spanned<String>,
    /// The axis of a head of kind axis.
    #[schemars(extend("enum" = names(&ROTARY_LETTERS)))]
    letter: Option<Spanned<String>>,
    /// From the head's pivot to the spindle's gauge line, mm [default: 0].
    pivot: Option<Bounded<ToolLength>>,
}

/// The surface that the holes begin in.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct FileSurface {
    /// An ellipsoid of revolution.
    #[schemars(extend("enum" = ["ellipsoid"]))]
    kind: Spanned<String>,
    /// Equatorial radius, mm.
    a: Bounded<Length>,
    /// Polar radius, mm.
    b: Bounded<Length>,
}

/// One hole.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileHole {
    /// Its name, unique.
    id: Spanned<String>,
    /// Distance of its entry from the axis of revolution, mm: at most the equatorial radius.
    radius: Bounded<Radius>,
    /// Azimuth about that axis, degrees.
    azimuth: Bounded<Azimuth>,
    /// axial: along the axis of revolution; normal: along the surface's normal.
    #[schemars(extend("enum" = names(&DIRECTIONS)))]
    axis: Spanned<String>,
    /// mm.
    diameter: Bounded<Length>,
    /// From the surface along the axis, mm.
    depth: Bounded<Depth>,
    /// The numbers of the tools that make it [default: every tool that is not larger than it].
    tools: Option<Spanned<Vec<i64>>>,
}

/// What the macros use of the control.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileMacro {
    /// The first of two common variables: 100 to 198 or 500 to 998.
    #[schemars(extend("anyOf" = [{ "minimum": 100, "maximum": 198 }, { "minimum": 500, "maximum": 998 }]))]
    common: Spanned<i64>,
}

const HEADS: [(&str, bool); 2] = [("manual", false), ("axis", true)];

const DIRECTIONS: [(&str, AxisDirection); 2] =
    [("axial", AxisDirection::Axial), ("normal", AxisDirection::Normal)];

/// Adds the rule that `letter` belongs to a head of kind axis and to no other.
fn letter_goes_with_axis(schema: &mut Schema) {
    let of = |kind: &str| json!({ "kind": { "enum": [kind] } });
    let cases = json!([
        { "properties": of("axis"), "required": ["letter"] },
        { "properties": of("manual"), "not": { "required": ["letter"] } },
    ]);
    schema.insert("oneOf".to_owned(), cases);
}

/// Reads the text of a job of this family.
pub(in crate::job) fn parse(reader: &Reader<'_>) -> Result<PinHoles, FileError> {
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
        position_tolerance: file.tolerance.position(),
        depth_tolerance: file.tolerance.depth(),
        tools,
        are_tools_specified: file.tool.is_some(),
        macros: MacroSettings { common },
        holes,
        sheet: file.sheet.map(FileSheet::info).unwrap_or_default(),
    })
}

impl File {
    /// Returns the tools in the order of use, and for each hole the numbers of its tools.
    fn tools(&self, reader: &Reader<'_>) -> Result<(Vec<Tool>, Vec<Vec<u32>>), FileError> {
        let Some(first) = self.hole.first() else {
            return Err(FileError { line: None, message: "no holes: add a [[hole]]".into() });
        };
        let mut ids = BTreeSet::new();
        for hole in &self.hole {
            if !ids.insert(hole.id.as_ref().as_str()) {
                let message = format!("key 'hole.id': '{}' is used twice", hole.id.as_ref());
                return Err(reader.error(&hole.id, message));
            }
        }
        let wanted: Vec<_> = self.hole.iter().map(FileHole::tool_spec).collect();
        let Some(tools) = &self.tool else { return default_tools(reader, &wanted) };
        if tools.is_empty() {
            return Err(reader.error(&first.id, "'tool' is empty: remove it, or add a [[tool]]"));
        }
        let mut numbers = BTreeSet::new();
        for tool in tools {
            if !numbers.insert(*tool.number().as_ref()) {
                let message = format!("key 'tool.number': {} is used twice", tool.number().as_ref());
                return Err(reader.error(tool.number(), message));
            }
        }
        let tools: Vec<Tool> = tools.iter().map(FileTool::tool).collect();
        let of_holes = assign(reader, &tools, &wanted)?;
        Ok((tools, of_holes))
    }
}

impl FileSurface {
    pub(in crate::job) fn check(&self, reader: &Reader<'_>) -> Result<Surface, FileError> {
        reader.choice("surface.kind", &self.kind, &[("ellipsoid", ())])?;
        Ok(Surface { a: self.a.get(), b: self.b.get() })
    }
}

impl FileMachine {
    pub(in crate::job) fn check(&self, reader: &Reader<'_>) -> Result<PinMachine, FileError> {
        let rotary = self.rotary.check(reader)?;
        let head = match &self.head {
            Some(head) => head.check(reader, rotary.letter)?,
            None => Head { kind: HeadKind::Manual, pivot: 0.0 },
        };
        let (clearance, retract) = heights(reader, self.clearance.as_ref(), self.retract.as_ref())?;
        Ok(PinMachine {
            rotary,
            head,
            clearance,
            retract,
            is_retract_specified: self.retract.is_some(),
            is_clearance_specified: self.clearance.is_some(),
        })
    }
}

impl FileHead {
    fn check(&self, reader: &Reader<'_>, rotary: char) -> Result<Head, FileError> {
        let pivot = self.pivot.as_ref().map_or(0.0, Bounded::get);
        let by_axis = reader.choice("machine.head.kind", &self.kind, &HEADS)?;
        let kind = match (&self.letter, by_axis) {
            (None, false) => HeadKind::Manual,
            (Some(letter), false) => {
                return Err(reader.error(letter, "key 'machine.head.letter' is for kind = \"axis\" only"));
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
                        format!("key 'machine.head.letter' is {chosen}, the letter of the rotary table"),
                    ));
                }
                HeadKind::Axis(chosen)
            }
        };
        Ok(Head { kind, pivot })
    }
}

impl FileHole {
    fn tool_spec(&self) -> HoleToolSpec<'_> {
        HoleToolSpec { id: self.id.as_ref(), diameter: &self.diameter, tools: self.tools.as_ref() }
    }

    fn check(&self, reader: &Reader<'_>, surface: Surface, tools: Vec<u32>) -> Result<HoleSpec, FileError> {
        let a = surface.a;
        let radii = format!("0 to the equatorial radius a = {a} mm");
        Ok(HoleSpec {
            id: self.id.as_ref().clone(),
            radius: reader.number("hole.radius", &self.radius, &radii, in_range(0.0, a))?,
            azimuth: self.azimuth.get(),
            axis: reader.choice("hole.axis", &self.axis, &DIRECTIONS)?,
            diameter: self.diameter.get(),
            depth: self.depth.get(),
            tools,
        })
    }
}

impl FileMacro {
    fn check(&self, reader: &Reader<'_>) -> Result<u32, FileError> {
        let common = *self.common.as_ref();
        if (100..=198).contains(&common) || (500..=998).contains(&common) {
            return Ok(common as u32);
        }
        Err(reader.error(
            &self.common,
            format!(
                "key 'macro.common' is {common}: 100 to 198 or 500 to 998, because it and the next are used"
            ),
        ))
    }
}
