//! The machine file: axes, table, head, tools, offsets and the position of the part, as TOML.
//!
//! Unknown keys, missing keys and values out of range are errors that name the key, the line and the allowed
//! values.
mod errors;
mod head;
mod link;
mod offsets;
mod part;
mod probe;
mod rapid;
mod sections;
mod spread;
mod start;
mod tool;
mod wheel;

pub use errors::File as ErrorFile;
use errors::FileErrors;
pub use errors::error_file;
use head::FileHead;
use link::FileLink;
use nalgebra::Vector3;
use offsets::{FileOffsets, work_offsets};
use part::FilePart;
use probe::FileProbe;
use rapid::FileRapid;
use schemars::JsonSchema;
use serde::Deserialize;
use start::{FileStart, start_positions};
use tool::FileTool;
use wheel::FileWheel;

use super::{Chain, Head, HeadKind, Machine, Tool};
use gcode_lang::control::{Dialect, Increment};
use gcode_lang::motion::{Axes, AxisIndex};
use gcode_lang::program::modes::Unit;
use gcode_part::Stock;
use gcode_part::reader::bounds::{Bounded, KeyRange};
use gcode_part::reader::{FileError, FileKey, FixedArray, Items, Located, Optional, Reader, Section, names};

/// The machine of a program. Every section is optional; without any it has X, Y, Z and a rotary B about Y.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// The control.
    #[serde(default, with = "Optional::<Section<FileControl>>")]
    control: Option<FileControl>,
    /// The axes that carry the part, from the bed outwards.
    #[serde(default, with = "Optional::<Items<Section<FileLink>>>")]
    table: Option<Vec<FileLink>>,
    /// The head and the inclination of the tool.
    #[serde(default, with = "Optional::<Section<FileHead>>")]
    head: Option<FileHead>,
    /// A grinder's wheel, stationary while the table moves the part.
    #[serde(default, with = "Optional::<Section<FileWheel>>")]
    wheel: Option<FileWheel>,
    /// The tools.
    #[serde(default, with = "Optional::<Items<Section<FileTool>>>")]
    tool: Option<Vec<FileTool>>,
    /// The work offsets G54 to G59 and G54.1 P1… at the start of the run, by axis, mm and degrees; axes that are not named are 0.
    #[serde(default, with = "Optional::<FileOffsets>")]
    offsets: Option<<FileOffsets as FileKey>::Value>,
    /// Positions of the axes at the start of the run, by axis, mm and degrees, in the work coordinate system active then;
    /// axes that are not named are where the last job left them.
    #[serde(default, with = "Optional::<FileStart>")]
    start: Option<<FileStart as FileKey>::Value>,
    /// Nominal position of the part on the machine, and its misalignment.
    #[serde(default, with = "Optional::<Section<FilePart>>")]
    part: Option<FilePart>,
    /// A touch probe.
    #[serde(default, with = "Optional::<Section<FileProbe>>")]
    probe: Option<FileProbe>,
    /// The path of a rapid of several axes; without it any axis may arrive first.
    #[serde(default, with = "Optional::<Section<FileRapid>>")]
    rapid: Option<FileRapid>,
    /// The solid material of the part, for a reference without it.
    #[serde(default, with = "Optional::<Section<Stock>>")]
    stock: Option<Stock>,
    /// The errors of the machine.
    #[serde(default, with = "Optional::<Section<FileErrors>>")]
    errors: Option<FileErrors>,
}

/// The control.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileControl {
    /// The family of controls [default: fanuc-31i].
    #[schemars(extend("enum" = names(&Dialect::ALL)))]
    dialect: Option<Located<String>>,
    /// The least input increment: IS-A 0.01, IS-B 0.001, IS-C 0.0001 [default: IS-B].
    #[schemars(extend("enum" = names(&Increment::ALL)))]
    increment: Option<Located<String>>,
    /// The unit of programs at power-on, as INI of the setting data or setting 9 of a Haas has it [default: metric, as an
    /// assumption].
    #[schemars(extend("enum" = names(&UNITS)))]
    unit: Option<Located<String>>,
    /// Its axis table, axis 1 first: different letters [default: XYZABC].
    #[schemars(regex(pattern = "^[XYZABCUVWE]{1,8}$"))]
    axes: Option<Located<String>>,
}

/// Units of programs.
const UNITS: [(&str, Unit); 2] = [("metric", Unit::Metric), ("inch", Unit::Inch)];

/// Letters of axes.
const AXES: [&str; 9] = ["X", "Y", "Z", "A", "B", "C", "U", "V", "W"];
/// Letters of rotary axes.
const ROTARY_LETTERS: [&str; 3] = ["A", "B", "C"];

impl Machine {
    /// Parses the text of a machine file.
    ///
    /// # Errors
    /// A syntax error, or a key that is unknown, missing or out of range, with its line and the allowed
    /// values.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let reader = Reader { text };
        let file: File = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
        let control = file.control.unwrap_or_default();
        let axes = control.axes(&reader)?;
        let part = file.part.unwrap_or_default().placement();
        let table = match &file.table {
            Some(links) => {
                let mut table = Chain::default();
                for link in links {
                    let link = link.check(&reader, &axes, &table, part.origin, "table")?;
                    table.0.push(link);
                }
                table
            }
            None if file.head.as_ref().is_some_and(|head| head.has_letter("B")) => Chain::default(),
            None => Chain::default_table(&axes, part.origin),
        };
        let head = match &file.head {
            Some(head) => head.check(&reader, &axes, &table)?,
            None => Head::new(HeadKind::Free, 0.0),
        };
        let mut tools: Vec<Tool> = Vec::new();
        for tool in file.tool.iter().flatten() {
            let checked = tool.check(&reader, &head)?;
            if tools.iter().any(|other| other.number == checked.number) {
                let message = format!("key 'tool.number': {} is used twice", checked.number);
                return Err(reader.error(&tool.number, message));
            }
            tools.push(checked);
        }
        if let Some(fault) = file.stock.as_ref().and_then(Stock::fault) {
            return Err(reader.error_at("stock", format!("key 'stock': {fault}")));
        }
        let mut machine = Self {
            rapid: file.rapid.unwrap_or_default().check(&reader, &axes)?,
            stock: file.stock,
            dialect: match &control.dialect {
                Some(dialect) => reader.choice("control.dialect", dialect, &Dialect::ALL)?,
                None => Dialect::default(),
            },
            increment: match &control.increment {
                Some(increment) => reader.choice("control.increment", increment, &Increment::ALL)?,
                None => Increment::default(),
            },
            unit: control
                .unit
                .as_ref()
                .map(|unit| reader.choice("control.unit", unit, &UNITS))
                .transpose()?,
            slides: Chain::default_slides(&axes, &table),
            wheel: file.wheel.map(|wheel| wheel.check(&reader, &axes, &table, &head)).transpose()?,
            offsets: file.offsets.map_or(Ok(Vec::new()), |offsets| work_offsets(&reader, &axes, offsets))?,
            start: file.start.map_or(Ok(Vec::new()), |start| start_positions(&reader, &axes, start))?,
            has_default_table: file.table.is_none(),
            axes,
            table,
            head,
            tools,
            part,
            probe: file.probe.as_ref().map(FileProbe::probe),
        };
        if let Some(errors) = &file.errors {
            errors.apply(&reader, &mut machine)?;
        }
        Ok(machine)
    }
}

fn vector<R: KeyRange<Number = f64>>(FixedArray([x, y, z]): &FixedArray<Bounded<R>, 3>) -> Vector3<f64> {
    Vector3::new(x.get(), y.get(), z.get())
}

fn letter(
    reader: &Reader<'_>,
    key: &str,
    value: &Located<String>,
    axes: &Axes,
) -> Result<AxisIndex, FileError> {
    let found = match value.as_ref().as_bytes() {
        [letter] => axes.find(*letter),
        _ => None,
    };
    found.ok_or_else(|| {
        let letters: String = axes.iter().map(|(_, letter)| letter).collect();
        reader
            .error(value, format!("key '{key}' is '{}': one of the control's axes {letters}", value.as_ref()))
    })
}

/// Returns what a control reads at an address that names no axis.
fn other_meaning(letter: char) -> Option<&'static str> {
    Some(match letter {
        'D' => "the number of the cutter radius offset",
        'F' => "the feed",
        'G' | 'M' => "a code",
        'H' => "the number of the tool length offset",
        'I' | 'J' | 'K' => "a centre of an arc",
        'L' => "a number of repeats",
        'N' => "a sequence number",
        'O' | 'P' => "the number of a program",
        'Q' => "the depth of a peck",
        'R' => "a radius or the R level",
        'S' => "the spindle speed",
        'T' => "the number of a tool",
        _ => return None,
    })
}

impl FileControl {
    fn axes(&self, reader: &Reader<'_>) -> Result<Axes, FileError> {
        let Some(letters) = &self.axes else { return Ok(Axes::default()) };
        Axes::new(letters.as_ref()).filter(|axes| !axes.is_empty()).ok_or_else(|| {
            let required = "1 to 8 different letters of X Y Z A B C U V W E are required, axis 1 first";
            let other = letters.as_ref().chars().find_map(|letter| Some((letter, other_meaning(letter)?)));
            let reason =
                other.map(|(letter, meaning)| format!("; {letter} can't be an axis: it is {meaning}"));
            let reason = reason.unwrap_or_default();
            reader.error(letters, format!("key 'control.axes' is '{}': {required}{reason}", letters.as_ref()))
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::super::{AxisLink, LinkMotion, Placement};
    use super::*;
    use gcode_lang::units::Deg;

    #[test]
    fn e_is_an_axis_and_a_letter_with_another_meaning_is_not() {
        let of = |axes: &str| Machine::parse(&format!("[control]\naxes = \"{axes}\"\n"));
        assert!(of("XYZE").is_ok());
        for (axes, reason) in [
            ("XYZD", "; D can't be an axis: it is the number of the cutter radius offset"),
            ("XYZH", "; H can't be an axis: it is the number of the tool length offset"),
            ("XYZX", "axis 1 first"),
        ] {
            let message = of(axes).unwrap_err().to_string();
            assert!(message.ends_with(reason), "{message}");
        }
    }

    const PAPER: &str = "[[table]]\nletter = \"B\"\nturns = \"y\"\nsign = 1\n";

    #[test]
    fn the_shortest_file_is_the_machine_of_the_paper() {
        let paper = Machine { has_default_table: false, ..Machine::default() };
        assert_eq!(Machine::parse(PAPER).unwrap(), paper);
    }

    #[test]
    fn a_head_that_has_b_stands_on_a_machine_without_a_table() {
        let file = |head: &str| Machine::parse(&format!("[head]\nkind = {head}")).unwrap();
        let fork = file("\"axes\"\n[[head.axis]]\nletter = \"B\"\nturns = \"y\"\nsign = 1\n");
        assert!(fork.table.0.is_empty());
        assert!(file("\"axis\"\nletter = \"B\"\n").table.0.is_empty());
        assert_eq!(file("\"axis\"\nletter = \"C\"\n").table.0.len(), 1);
    }

    #[test]
    fn every_section_reaches_the_machine() {
        let text = r#"
[control]
dialect = "haas-ngc"
increment = "IS-C"
axes = "XYZAB"
[[table]]
letter = "A"
turns = "x"
sign = -1
centre = [1, 2.5, 3.0]
[head]
kind = "axis"
letter = "B"
sign = -1
zero = 90.0
pivot = 120.0
[[tool]]
number = 12
length = 80.5
diameter = 6.0
[offsets]
G54 = { X = 500.0, B = -3 }
[start]
Z = 250.0
B = -90
[part]
origin = [500.0, 0.0, -200.0]
shift = [0.1, 0.0, 0.0]
tilt = [0.0, 0.0, 1.0]
"#;
        let machine = Machine::parse(text).unwrap();
        assert_eq!(machine.axes.len(), 5);
        let centre = Point3::new(1.0, 2.5, 3.0);
        assert_eq!(machine.table.0, [AxisLink::rotary(3, Vector3::x_axis(), centre, -1.0)]);
        assert_eq!(machine.head.kind, HeadKind::Axis { axis: 4, sign: -1.0, zero: Deg(90.0) });
        assert_eq!(machine.head.pivot, 120.0);
        assert_eq!(
            machine.tools,
            [Tool { number: 12, length: Some(80.5), diameter: Some(6.0), ..Tool::default() }]
        );
        assert_eq!(machine.offsets[0].values, [(4, -3.0), (0, 500.0)]);
        assert_eq!(machine.start, [(4, -90.0), (2, 250.0)]);
        assert_eq!(machine.part.origin.z, -200.0);
        assert_eq!(machine.part.tilt[2], Deg(1.0));
    }

    #[test]
    fn a_table_rotates_about_the_parts_origin_by_default() {
        let machine = Machine::parse(&format!("{PAPER}[part]\norigin = [5.0, 6.0, 7.0]\n")).unwrap();
        let LinkMotion::Rotary { centre, .. } = &machine.table.0[0].motion else { panic!("a rotary axis") };
        assert_eq!(*centre, Point3::new(5.0, 6.0, 7.0));
    }

    #[test]
    fn keys_left_out_are_those_of_the_machine_of_the_paper() {
        let machine = Machine::parse("[part]\nshift = [0.3, 0, 0]\n").unwrap();
        let part = Placement { shift: Vector3::new(0.3, 0.0, 0.0), ..Placement::default() };
        assert_eq!(machine, Machine { part, ..Machine::default() });
        assert_eq!(Machine::parse("").unwrap(), Machine::default());
    }

    #[test]
    fn an_unusable_key_is_named_with_its_line() {
        let cases = r#"
tables = []
=> line 1: key 'tables' is unknown (did you mean 'table'?); allowed: control, table, head, wheel, tool, offsets, start, part, probe, rapid, stock, errors

[[table]]
letter = "B"
turns = "y"
=> line 1: key 'table.sign' is missing

[[table]]
letter = "B"
turns = "q"
sign = 1
=> line 3: key 'table.turns' is 'q': one of x, y, z, or a vector [x, y, z] that is not all 0

[[table]]
letter = "B"
turns = "y"
sign = 2
=> line 4: key 'table.sign' is 2: 1 or -1

[[table]]
letter = "V"
turns = "y"
sign = 1
=> line 2: key 'table.letter' is 'V': one of the control's axes XYZABC

head = { kind = "manual", pivot = -1.0 }
=> line 1: key 'head.pivot' is -1: 0 to 100000 mm

[head]
kind = "axis"
=> line 2: kind = "axis" needs the key 'head.letter'

[part]
origin = [1, 2, 3, 4]
=> line 2: key 'part.origin' has 4 values: 3 are required

[part]
origin = [-300,5, 200,0, -400,0]
=> line 2: key 'part.origin' has 6 values: 3 are required; a number has a point, not a comma

[head]
kind = "fixed"
direction = [0, 1]
=> line 3: key 'head.direction' has 2 values: 3 are required

[head]
kind = "manual"
direction = [0.0, 1.0, 0.0]
=> line 3: key 'head.direction' is for kind fixed, axes only

[[table]]
letter = "B"
turns = [0, 0, 0]
sign = 1
=> line 3: key 'table.turns' is [0.0, 0.0, 0.0]: one of x, y, z, or a vector [x, y, z] that is not all 0

[head]
kind = "axes"
=> line 2: kind = "axes" needs the key 'head.axis'

[offsets]
G53 = { X = 1.0 }
=> line 2: key 'offsets.G53' is unknown; allowed: G54, G55, G56, G57, G58, G59

[offsets]
G54 = { V = 1.0 }
=> line 2: key 'offsets.G54.V': the control has no axis V

[offsets]
G54.X = 100001
=> line 2: key 'offsets.G54.X' is 100001: -100000 to 100000 (mm and degrees)

[start]
V = 1.0
=> line 2: key 'start.V': the control has no axis V

[part]
tilt = [0.0, nan, 0.0]
=> line 2: key 'part.tilt' is NaN: -360 to 360 degrees

[[tool]]
number = 1
length = -412.35
=> line 3: key 'tool.length' is -412.35: 0 to 10000 mm from the gauge line to the tip; of a tool touched off at the part write length_offset, its H

tool = [{ number = 1, length = 100.0, length_offset = -412.35 }]
head = { kind = "manual" }
=> line 1: key 'tool.length_offset': the tool has a length, which is its H; state one of them

tool = [{ number = 1, length = 5.0 }]
=> line 1: key 'tool.length' acts along the tool"#;
        for case in cases.trim().split("\n\n") {
            let (text, expected) = case.split_once("=> ").unwrap();
            let error = Machine::parse(text).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{text}{error}\n{expected}");
        }
    }
}
