//! The job file of the family `pin-holes`: holes on an ellipsoid of revolution.
mod tools;

use std::collections::BTreeSet;

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::json;

pub use tools::Tool;

use super::{
    CLEARANCE, Family, FileError, HoleTolerance, JobControl, Reader, Rotary, RotaryLetter, SheetInfo,
    check_retract, retract_height,
};
use crate::reader::bounds::{Azimuth, CommonVariable, Depth, Length, Radius, Retract, ToolLength};
use crate::reader::{FileKey, Items, Optional, Section, Word, WordList};

/// Pin holes in a surface of revolution: drilled along its axis or its normals.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PinHoles {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["pin-holes"]))]
    _family: String,
    /// The control of the programs.
    #[serde(with = "Section::<JobControl>")]
    pub control: JobControl,
    /// The machine.
    #[serde(with = "Section::<PinMachine>")]
    pub machine: PinMachine,
    /// The surface that the holes begin in.
    #[serde(with = "Section::<SurfaceSpec>")]
    pub surface: SurfaceSpec,
    /// Tolerances of the holes.
    #[serde(with = "Section::<HoleTolerance>")]
    pub tolerance: HoleTolerance,
    /// The holes, in the order in which they are drilled.
    #[serde(rename = "hole", with = "Items::<Section<HoleSpec>>")]
    #[schemars(length(min = 1))]
    pub holes: Vec<HoleSpec>,
    /// The tools in the order of use [default: a drill and an end mill for each diameter].
    #[serde(rename = "tool", default, with = "Items::<Section<Tool>>")]
    #[schemars(length(min = 1))]
    pub tools: Vec<Tool>,
    /// The common variables of the macros.
    #[serde(rename = "macro", default, with = "Section::<MacroSettings>")]
    pub macros: MacroSettings,
    /// Additional data for the set-up sheet.
    #[serde(default, with = "Section::<SheetInfo>")]
    pub sheet: SheetInfo,
    /// True if the job specifies the tools; those of the paper do not constrain other programs.
    #[serde(skip)]
    pub(crate) are_tools_specified: bool,
}

/// The machine of a job with a rotary table.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PinMachine {
    /// The axis that rotates the part.
    #[serde(with = "Section::<Rotary>")]
    pub rotary: Rotary,
    /// Head that inclines the tool [default: by hand].
    #[serde(default, with = "Section::<Head>")]
    pub head: Head,
    /// Distance from the surface where the feed begins, mm [default: 2].
    #[serde(default, with = "Optional::<Depth>")]
    pub(crate) clearance: Option<f64>,
    /// Retract height above the surface between holes, mm, no less than the clearance [default: 50].
    #[serde(default, with = "Optional::<Retract>")]
    pub(crate) retract: Option<f64>,
    /// What stays set while the other changes: tool, each tool makes all its holes before it is changed; head, all tools
    /// work at one angle of the head before it is set again [default: tool].
    #[serde(default = "WorkOrder::by_tool", with = "Word::<WorkOrder>")]
    pub order: WorkOrder,
}

/// A head that inclines the tool in the xy plane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = letter_goes_with_axis)]
pub struct Head {
    /// manual: an operator sets it at a stop; axis: an axis of the control.
    #[serde(rename = "kind", with = "Word::<HeadKind>")]
    is_axis: bool,
    /// The axis of a head of kind axis.
    #[serde(default, with = "Optional::<Word<RotaryLetter>>")]
    letter: Option<char>,
    /// From the head's pivot to the spindle's gauge line, mm.
    #[serde(default = "ToolLength::default", with = "ToolLength")]
    pub pivot: f64,
}

/// Order of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkOrder {
    /// Each tool makes all its holes.
    Tool,
    /// All tools work at one angle of the head.
    Head,
}

/// Setting of the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadKind {
    /// An operator sets the head by hand at a stop.
    Manual,
    /// An axis of the control; its angle counts from x towards y.
    Axis(char),
}

/// Ellipsoid of revolution about y: (x² + z²)/a² + y²/b² = 1.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceSpec {
    /// An ellipsoid of revolution.
    #[serde(rename = "kind", with = "Word::<SurfaceKind>")]
    _kind: SurfaceKind,
    /// Equatorial radius, mm.
    #[serde(with = "Length")]
    pub a: f64,
    /// Polar radius, mm.
    #[serde(with = "Length")]
    pub b: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum SurfaceKind {
    Ellipsoid,
}

/// A hole.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleSpec {
    /// Its name, unique.
    pub id: String,
    /// Distance of its entry from the axis of revolution, mm: at most the equatorial radius.
    #[serde(with = "Radius")]
    pub radius: f64,
    /// Azimuth about that axis, degrees.
    #[serde(with = "Azimuth")]
    pub azimuth: f64,
    /// axial: along the axis of revolution; normal: along the surface's normal.
    #[serde(with = "Word::<AxisDirection>")]
    pub axis: AxisDirection,
    /// Diameter, mm.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// From the surface along the axis, mm.
    #[serde(with = "Depth")]
    pub depth: f64,
    /// The numbers of the tools that make it [default: every tool that is not larger than it].
    #[serde(rename = "tools")]
    pub(crate) named_tools: Option<Vec<i64>>,
    /// Numbers of the tools in the order of use; the last one has the hole's diameter.
    #[serde(skip)]
    pub tools: Vec<u32>,
}

/// Direction of a hole's axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisDirection {
    /// Parallel to y.
    Axial,
    /// Along the surface normal.
    Normal,
}

/// Common variables of the macros.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MacroSettings {
    /// The first of two common variables: 100 to 198 or 500 to 998.
    #[serde(with = "CommonVariable")]
    pub common: u32,
}

impl Default for MacroSettings {
    fn default() -> Self {
        Self { common: CommonVariable::default() }
    }
}

impl WordList for HeadKind {
    type Value = bool;

    fn all() -> Vec<(&'static str, bool)> {
        vec![("manual", false), ("axis", true)]
    }
}

impl WorkOrder {
    fn by_tool() -> Self {
        Self::Tool
    }
}

impl WordList for WorkOrder {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        vec![("tool", Self::Tool), ("head", Self::Head)]
    }
}

impl WordList for SurfaceKind {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        vec![("ellipsoid", Self::Ellipsoid)]
    }
}

impl WordList for AxisDirection {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        vec![("axial", Self::Axial), ("normal", Self::Normal)]
    }
}

/// Adds the rule that `letter` belongs to a head of kind axis and to no other.
fn letter_goes_with_axis(schema: &mut Schema) {
    let of = |kind: &str| json!({ "kind": { "enum": [kind] } });
    let cases = json!([
        { "properties": of("axis"), "required": ["letter"] },
        { "properties": of("manual"), "not": { "required": ["letter"] } },
    ]);
    schema.insert("oneOf".to_owned(), cases);
}

impl Default for Head {
    fn default() -> Self {
        Self { is_axis: false, letter: None, pivot: ToolLength::default() }
    }
}

impl Head {
    /// Returns the setting of the head.
    pub fn kind(&self) -> HeadKind {
        self.letter.map_or(HeadKind::Manual, HeadKind::Axis)
    }
}

impl PinMachine {
    /// Returns the distance from the surface along the hole at which rapid motion becomes feed, mm.
    pub fn clearance(&self) -> f64 {
        self.clearance.unwrap_or(CLEARANCE)
    }

    /// Returns the distance from the surface along the hole to which the tool retracts before the rotary
    /// table rotates, mm.
    pub fn retract(&self) -> f64 {
        retract_height(self.retract, self.clearance())
    }

    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let key = "machine.head.letter";
        match (self.head.letter, self.head.is_axis) {
            (Some(_), false) => {
                return Err(reader.error_at(key, format!("key '{key}' is for kind = \"axis\" only")));
            }
            (None, true) => {
                let message = format!("kind = \"axis\" needs the key '{key}': A, B or C");
                return Err(reader.error_at("machine.head.kind", message));
            }
            (Some(letter), true) if letter == self.rotary.letter => {
                let message = format!("key '{key}' is {letter}, the letter of the rotary table");
                return Err(reader.error_at(key, message));
            }
            (Some(_), true) | (None, false) => {}
        }
        check_retract(reader, self.retract(), self.clearance())
    }
}

impl Family for PinHoles {
    fn check(&mut self, reader: &Reader<'_>) -> Result<(), FileError> {
        if self.holes.is_empty() {
            return Err(FileError { line: None, message: "no holes: add a [[hole]]".into() });
        }
        let mut ids = BTreeSet::new();
        if let Some(index) = self.holes.iter().position(|hole| !ids.insert(&hole.id)) {
            let message = format!("key 'hole.id': '{}' is used twice", self.holes[index].id);
            return Err(reader.error_at(&format!("hole.{index}.id"), message));
        }
        self.are_tools_specified = reader.has("tool");
        match self.are_tools_specified {
            true => self.assign_tools(reader)?,
            false => self.add_default_tools(reader)?,
        }
        for (index, hole) in self.holes.iter().enumerate() {
            self.surface.check_radius(reader, &format!("hole.{index}.radius"), hole.radius)?;
        }
        self.machine.check(reader)
    }
}

impl SurfaceSpec {
    /// Returns the y of the surface over (x, 0, 0) and the x and y of its normal there.
    pub(super) fn section(&self, x: f64) -> (f64, [f64; 2]) {
        let y = self.b * (1.0 - (x / self.a) * (x / self.a)).sqrt();
        let (across, up) = (x / (self.a * self.a), y / (self.b * self.b));
        let length = (across * across + up * up).sqrt();
        (y, [across / length, up / length])
    }

    /// Checks that a point at this distance from the axis of revolution is on the surface.
    pub(super) fn check_radius(&self, reader: &Reader<'_>, key: &str, radius: f64) -> Result<(), FileError> {
        let allowed = format_args!("0 to the equatorial radius a = {} mm", self.a);
        reader.check((0.0..=self.a).contains(&radius), key, radius, allowed)
    }
}

#[cfg(test)]
mod tests {
    use super::PinHoles;
    use crate::job::Job;

    /// Parses the smallest job with one replacement and returns its error message, or "no error".
    fn message(from: &str, to: &str) -> String {
        let job = MINIMAL.replace(from, to);
        assert_ne!(job, MINIMAL, "'{from}' is not in the job");
        match Job::parse(&job) {
            Ok(_) => "no error".into(),
            Err(error) => error.to_string(),
        }
    }

    const MINIMAL: &str = r#"family = "pin-holes"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = { letter = "B", sign = 1 }
[surface]
kind = "ellipsoid"
a = 1158.8
b = 724.3
[tolerance]
position = 0.1
[[hole]]
id = "1"
radius = 420.0
azimuth = 0.0
axis = "axial"
diameter = 6.0
depth = 15.0
"#;

    #[test]
    fn every_error_names_the_key_the_line_and_what_is_allowed() {
        for (from, to, message) in [
            ("a = 1158.8\n", "", "line 7: key 'surface.a' is missing"),
            (
                "a = 1158.8",
                "a = \"wide\"",
                "line 9: key 'surface.a' is string \"wide\": a number is required",
            ),
            ("a = 1158.8", "a = inf", "line 9: key 'surface.a' is inf: 0.01 to 99999 mm"),
            ("b = 724.3", "b = 1\nc = 1", "line 11: key 'surface.c' is unknown; allowed: kind, a, b"),
            (", sign = 1", "", "line 6: key 'machine.rotary.sign' is missing"),
            ("sign = 1", "sign = 2", "line 6: key 'machine.rotary.sign' is 2: 1 or -1"),
            ("[tolerance]\nposition = 0.1\n", "", "line 1: key 'tolerance' is missing"),
            ("radius = 420.0\n", "", "line 13: key 'hole.radius' is missing"),
            (
                "420.0",
                "1158.9",
                "line 15: key 'hole.radius' is 1158.9: 0 to the equatorial radius a = 1158.8 mm",
            ),
            ("420.0", "-1", "line 15: key 'hole.radius' is -1: 0 to the equatorial radius a = 1158.8 mm"),
            ("depth = 15.0", "depth = -15.0", "line 19: key 'hole.depth' is -15: 0.01 to 9999 mm"),
            ("depth = 15.0", "depth = nan", "line 19: key 'hole.depth' is NaN: 0.01 to 9999 mm"),
            ("axial", "radial", "line 17: key 'hole.axis' is 'radial': one of axial, normal"),
            ("IS-B", "IS-Z", "line 4: key 'control.increment' is 'IS-Z': one of IS-A, IS-B, IS-C"),
            (
                "pin-holes",
                "pinholes",
                "line 1: family 'pinholes' is unknown: one of pin-holes, honeycomb, burr, alignment, pattern",
            ),
            (
                "[control]\n",
                "[contrl]\n",
                "line 2: key 'contrl' is unknown (did you mean 'control'?); allowed: family, control, machine, surface, tolerance, \
                 hole, tool, macro, sheet",
            ),
        ] {
            assert_eq!(self::message(from, to), message, "{from:?} -> {to:?}");
        }
    }

    proptest::proptest! {
        /// A mistyped job is an error with a message, or a job; never a panic.
        #[test]
        fn a_mistyped_job_is_refused_or_read(place in 0usize..270, gone in 0usize..9, typed in "[ -~\n]{0,4}") {
            let start = place.min(MINIMAL.len());
            let end = (start + gone).min(MINIMAL.len());
            let text = format!("{}{typed}{}", &MINIMAL[..start], &MINIMAL[end..]);
            if let Err(error) = Job::parse(&text) {
                proptest::prop_assert!(!error.to_string().is_empty());
                proptest::prop_assert!(error.line.is_none_or(|line| line <= text.lines().count() + 1));
            }
        }

        /// Radii, azimuths and depths are read exactly.
        #[test]
        fn numbers_are_read_exactly(radius in 0.0..1158.8f64, azimuth in -720.0..720.0f64, depth in 0.01..99.0f64) {
            let text = MINIMAL
                .replace("radius = 420.0", &format!("radius = {radius:?}"))
                .replace("azimuth = 0.0", &format!("azimuth = {azimuth:?}"))
                .replace("depth = 15.0", &format!("depth = {depth:?}"));
            let hole = &job(&text).holes[0];
            proptest::prop_assert_eq!((hole.radius, hole.azimuth, hole.depth), (radius, azimuth, depth));
        }
    }

    fn job(text: &str) -> PinHoles {
        match Job::parse(text) {
            Ok(Job::PinHoles(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn whole_numbers_are_numbers() {
        let whole = MINIMAL.replace("420.0", "420").replace("724.3", "724").replace("= 0.0", "= -720");
        assert_eq!(job(&whole).holes[0].azimuth, -720.0);
    }

    #[test]
    fn each_diameter_has_its_drill_and_its_end_mill() {
        let hole =
            "[[hole]]\nid = \"2\"\nradius = 1\nazimuth = 2\naxis = \"normal\"\ndiameter = 8\ndepth = 9\n";
        let job = job(&format!("{MINIMAL}{hole}"));
        let diameters: Vec<_> = job.tools.iter().map(|tool| (tool.number, tool.diameter)).collect();
        assert_eq!(diameters, [(1, 5.9), (2, 6.0), (3, 7.9), (4, 8.0)]);
        assert_eq!(job.holes[0].tools, [1, 2]);
        assert_eq!(job.holes[1].tools, [3, 4]);
    }

    #[test]
    fn a_depth_of_a_tool_is_above_the_bottom_of_its_holes() {
        let tool = |number: u32, diameter: f64, more: &str| {
            format!("[[tool]]\nnumber = {number}\ndiameter = {diameter}\nspeed = 900\nfeed = 20\n{more}\n")
        };
        let job =
            |centre: &str, last: &str| format!("{MINIMAL}{}{}", tool(7, 3.0, centre), tool(3, 6.0, last));
        let read = self::job(&job("depth = 2.5\npeck = 1", ""));
        assert_eq!(read.tools[0].depth_in(&read.holes[0]), 2.5);
        assert_eq!(read.tools[1].depth_in(&read.holes[0]), 15.0);
        assert!(Job::parse(&job("depth = 14.99", "")).is_ok());
        for (centre, last, expected) in [
            ("depth = 15", "", "line 25: key 'tool.depth' is 15: below the depth 15 mm of hole '1'"),
            (
                "",
                "depth = 14",
                "line 31: key 'tool.depth' is for tools before the last one of a hole: tool 3 finishes",
            ),
            ("peck = 0", "", "line 25: key 'tool.peck' is 0: 0.01 to 9999 mm"),
        ] {
            let found = Job::parse(&job(centre, last)).unwrap_err().to_string();
            assert!(found.starts_with(expected), "{found}");
        }
        let order = MINIMAL.replace("sign = 1 }", "sign = 1 }\norder = \"radius\"");
        assert_eq!(
            Job::parse(&order).unwrap_err().to_string(),
            "line 7: key 'machine.order' is 'radius': one of tool, head"
        );
    }

    #[test]
    fn a_hole_gets_every_tool_that_is_not_larger_and_the_last_one_fits() {
        let tool = |number: u32, diameter: f64| {
            format!("[[tool]]\nnumber = {number}\ndiameter = {diameter}\nspeed = 900\nfeed = 20\n")
        };
        let fits = format!("{MINIMAL}{}{}{}", tool(7, 5.0), tool(3, 6.0), tool(4, 8.0));
        assert_eq!(job(&fits).holes[0].tools, [7, 3]);
        let small = format!("{MINIMAL}{}", tool(7, 5.0));
        assert_eq!(
            Job::parse(&small).unwrap_err().to_string(),
            "line 18: key 'hole.diameter' is 6: the last tool of hole '1' is tool 7 of diameter 5; add a [[tool]] of \
             diameter 6 as the last one"
        );
        let large = format!("{MINIMAL}{}", tool(7, 9.0));
        assert!(Job::parse(&large).unwrap_err().to_string().contains("every [[tool]] is larger"));
        let twice = format!("{MINIMAL}{}{}", tool(7, 6.0), tool(7, 6.0));
        assert_eq!(
            Job::parse(&twice).unwrap_err().to_string(),
            "line 26: key 'tool.number': 7 is used twice"
        );
    }
}
