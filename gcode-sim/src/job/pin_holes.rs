//! The job file of the family `pin-holes`: holes on an ellipsoid of revolution.
use serde::Deserialize;
use toml::Spanned;

use super::{JobControl, JobError, Reader, Rotary};
use crate::control::{Dialect, Increment};

/// Pin holes on an ellipsoid of revolution; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct PinHoles {
    pub control: JobControl,
    pub machine: PinMachine,
    pub surface: Surface,
    /// Diameter of the tolerance zone.
    pub position_tolerance: f64,
    /// How far a hole's depth may be off.
    pub depth_tolerance: f64,
    pub tools: Vec<Tool>,
    pub macros: MacroSettings,
    pub holes: Vec<HoleWanted>,
}

/// (x² + z²)/a² + y²/b² = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Equatorial radius.
    pub a: f64,
    /// Polar radius, along the axis of revolution y.
    pub b: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct PinMachine {
    pub rotary: Rotary,
    pub head: Head,
    /// How far from the surface, along the hole, rapid becomes feed.
    pub clearance: f64,
    /// The radius beyond which the tool may go anywhere: how far from the surface, along the hole, it retracts
    /// before B turns.
    pub retract: f64,
}

/// The head that tilts the tool in the xy plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    pub kind: HeadKind,
    /// From the pivot to the gauge line of the spindle. With `pivot = 0` and tools of length 0 the programmed
    /// point is the tool's tip, which is then set again after each turn of the head.
    pub pivot: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadKind {
    /// Set by hand at an operator stop.
    Manual,
    /// An axis of the control; its angle counts from x towards y.
    Axis(char),
}

/// A tool in the order of use.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    pub number: u32,
    pub diameter: f64,
    /// From the gauge line of the spindle to the tip.
    pub length: f64,
    /// r/min.
    pub speed: f64,
    /// mm/min along the hole.
    pub feed: f64,
    pub name: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MacroSettings {
    /// The first of the common variables that the macros use.
    pub common: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisDirection {
    /// Parallel to y.
    Axial,
    /// Along the surface normal.
    Normal,
}

#[derive(Clone, Debug, PartialEq)]
pub struct HoleWanted {
    pub id: String,
    /// From the axis of revolution.
    pub radius: f64,
    pub azimuth: f64,
    pub axis: AxisDirection,
    pub diameter: f64,
    pub depth: f64,
}

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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileControl {
    dialect: Spanned<String>,
    increment: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileMachine {
    rotary: FileRotary,
    head: Option<FileHead>,
    clearance: Option<Spanned<f64>>,
    retract: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileRotary {
    letter: Spanned<String>,
    sign: Spanned<i64>,
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
struct FileSurface {
    kind: Spanned<String>,
    a: Spanned<f64>,
    b: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileTolerance {
    position: Spanned<f64>,
    depth: Option<Spanned<f64>>,
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileTool {
    number: Spanned<i64>,
    diameter: Spanned<f64>,
    length: Option<Spanned<f64>>,
    speed: Spanned<f64>,
    feed: Spanned<f64>,
    name: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileMacro {
    common: Spanned<i64>,
}

const POSITIVE: &str = "a number above 0";

pub(super) fn parse(reader: &Reader<'_>) -> Result<PinHoles, JobError> {
    let file: File = toml::from_str(reader.text).map_err(|e| reader.syntax(&e))?;
    reader.choice("surface.kind", &file.surface.kind, &[("ellipsoid", ())])?;
    let surface = Surface {
        a: reader.number("surface.a", &file.surface.a, POSITIVE, |v| v > 0.0)?,
        b: reader.number("surface.b", &file.surface.b, POSITIVE, |v| v > 0.0)?,
    };
    let holes = file.hole.iter().map(|hole| hole.check(reader, surface)).collect::<Result<Vec<_>, _>>()?;
    for (index, hole) in file.hole.iter().enumerate() {
        if file.hole[..index].iter().any(|other| other.id.as_ref() == hole.id.as_ref()) {
            return Err(
                reader.error(&hole.id, format!("key 'hole.id': '{}' is there twice", hole.id.as_ref()))
            );
        }
    }
    let tools = match &file.tool {
        Some(tools) => tools.iter().map(|tool| tool.check(reader)).collect::<Result<_, _>>()?,
        None => paper_tools(),
    };
    let common = match &file.macros {
        Some(macros) => macros.check(reader)?,
        None => 140,
    };
    Ok(PinHoles {
        control: JobControl {
            dialect: reader.choice("control.dialect", &file.control.dialect, &Dialect::ALL)?,
            increment: reader.choice("control.increment", &file.control.increment, &Increment::ALL)?,
        },
        machine: file.machine.check(reader)?,
        surface,
        position_tolerance: reader
            .number("tolerance.position", &file.tolerance.position, POSITIVE, |v| v > 0.0)?,
        depth_tolerance: match &file.tolerance.depth {
            Some(depth) => reader.number("tolerance.depth", depth, POSITIVE, |v| v > 0.0)?,
            None => 0.1,
        },
        tools,
        macros: MacroSettings { common },
        holes,
    })
}

/// The tools of the paper: drill Φ5.9, then a three-flute end mill Φ6; 1500 r/min, 10 mm/min along the axis.
fn paper_tools() -> Vec<Tool> {
    let tool = |number, diameter, name: &str| Tool {
        number,
        diameter,
        length: 0.0,
        speed: 1500.0,
        feed: 10.0,
        name: name.to_owned(),
    };
    vec![tool(1, 5.9, "DRILL"), tool(2, 6.0, "END MILL")]
}

impl FileMachine {
    fn check(&self, reader: &Reader<'_>) -> Result<PinMachine, JobError> {
        let letter = reader.choice(
            "machine.rotary.letter",
            &self.rotary.letter,
            &[("A", 'A'), ("B", 'B'), ("C", 'C')],
        )?;
        let sign = match *self.rotary.sign.as_ref() {
            1 => 1,
            -1 => -1,
            other => {
                return Err(
                    reader.error(&self.rotary.sign, format!("key 'machine.rotary.sign' is {other}: 1 or -1"))
                );
            }
        };
        let head = match &self.head {
            Some(head) => head.check(reader, letter)?,
            None => Head { kind: HeadKind::Manual, pivot: 0.0 },
        };
        let clearance = match &self.clearance {
            Some(value) => reader.number("machine.clearance", value, POSITIVE, |v| v > 0.0)?,
            None => 2.0,
        };
        let retract = match &self.retract {
            Some(value) => {
                let allowed = format!("at least the clearance, {clearance}");
                reader.number("machine.retract", value, &allowed, |v| v >= clearance)?
            }
            None => clearance.max(50.0),
        };
        Ok(PinMachine { rotary: Rotary { letter, sign }, head, clearance, retract })
    }
}

impl FileHead {
    fn check(&self, reader: &Reader<'_>, rotary: char) -> Result<Head, JobError> {
        let pivot = match &self.pivot {
            Some(pivot) => reader.number("machine.head.pivot", pivot, "0 or more", |v| v >= 0.0)?,
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
                let chosen =
                    reader.choice("machine.head.letter", letter, &[("A", 'A'), ("B", 'B'), ("C", 'C')])?;
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
    fn check(&self, reader: &Reader<'_>, surface: Surface) -> Result<HoleWanted, JobError> {
        let a = surface.a;
        let allowed = format!("0 up to the equatorial radius a = {a}");
        Ok(HoleWanted {
            id: self.id.as_ref().clone(),
            radius: reader.number("hole.radius", &self.radius, &allowed, |v| (0.0..=a).contains(&v))?,
            azimuth: reader
                .number("hole.azimuth", &self.azimuth, "degrees from -3600 to 3600", |v| v.abs() <= 3600.0)?,
            axis: reader.choice(
                "hole.axis",
                &self.axis,
                &[("axial", AxisDirection::Axial), ("normal", AxisDirection::Normal)],
            )?,
            diameter: reader.number("hole.diameter", &self.diameter, POSITIVE, |v| v > 0.0)?,
            depth: reader.number("hole.depth", &self.depth, POSITIVE, |v| v > 0.0)?,
        })
    }
}

impl FileTool {
    fn check(&self, reader: &Reader<'_>) -> Result<Tool, JobError> {
        let number = *self.number.as_ref();
        if !(1..=9999).contains(&number) {
            return Err(reader.error(&self.number, format!("key 'tool.number' is {number}: 1 to 9999")));
        }
        Ok(Tool {
            number: number as u32,
            diameter: reader.number("tool.diameter", &self.diameter, POSITIVE, |v| v > 0.0)?,
            length: match &self.length {
                Some(length) => reader.number("tool.length", length, "0 or more", |v| v >= 0.0)?,
                None => 0.0,
            },
            speed: reader.number("tool.speed", &self.speed, POSITIVE, |v| v > 0.0)?,
            feed: reader.number("tool.feed", &self.feed, POSITIVE, |v| v > 0.0)?,
            name: self.name.clone().unwrap_or_else(|| format!("TOOL {number}")),
        })
    }
}

impl FileMacro {
    fn check(&self, reader: &Reader<'_>) -> Result<u32, JobError> {
        let common = *self.common.as_ref();
        if (100..=190).contains(&common) || (500..=990).contains(&common) {
            return Ok(common as u32);
        }
        Err(reader.error(&self.common, format!("key 'macro.common' is {common}: 100 to 190 or 500 to 990")))
    }
}
