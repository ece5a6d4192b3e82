//! Patterns of holes on a plate, round a cylinder or on a tilted face: a main program with a call for each tool and pattern,
//! and resident macros that compute the points.
//!
//! See `docs/methods/pattern.md`. The main program has the numbers of the drawing alone: changing one of them moves the holes to
//! their correct places.
use gcode_lang::control::Dialect;
use gcode_part::job::{
    HoleLayout, HomeReturn, Operation, PatternJob, PatternPlace, PatternSpec, PatternStep, PatternTool,
    Rotary,
};

use super::start::Start;
use super::{Family, Macro, control, package};
use crate::nc::{Block, ProgramText, number};
use crate::package::{Package, Program};

/// O-number of the main program.
const MAIN: u32 = 8500;
/// O-number of the macro for circles and arcs.
const CIRCLE: u32 = 8501;
/// O-number of the macro for grids and lines.
const GRID: u32 = 8502;
/// O-number of the macro for one hole: approach, operation, retract.
const HOLE: u32 = 8503;

/// π with as many digits as all three dialects accept in one number.
const PI: &str = "3.14159265";

/// Argument M of a left-hand tap.
const LEFT_TAP: f64 = 74.0;

const MACROS: &[&[Macro]] = &[&[
    Macro { number: CIRCLE, file: "O8501_circle.nc", text: include_str!("circle.nc") },
    Macro { number: GRID, file: "O8502_grid.nc", text: include_str!("grid.nc") },
    Macro { number: HOLE, file: "O8503_pattern_hole.nc", text: include_str!("hole.nc") },
]];

pub(super) const FAMILY: Family =
    Family { name: "pattern", new_job: include_str!("new.toml"), macros: MACROS };

/// Emits the main program, the resident macros and the machine file of a job.
pub(super) fn emit(job: &PatternJob) -> Package {
    let code = |code: Option<u32>| code.map_or_else(String::new, |code| format!("\nM{code}"));
    let clamp = job.machine.clamp;
    // A program for a plate or a face turns no rotary by itself.
    let rotary = match job.place() {
        PatternPlace::Cylinder { rotary, .. } => rotary.letter,
        PatternPlace::Plate | PatternPlace::Face { .. } => 'A',
    };
    let marks = [
        ("{pi}", PI.to_owned()),
        ("{hole}", HOLE.to_string()),
        ("{rotary}", rotary.to_string()),
        ("{unclamp}", code(clamp.map(|clamp| clamp.off))),
        ("{clamp}", code(clamp.map(|clamp| clamp.on))),
        ("{twisted}", twisted(job.control.dialect).to_owned()),
        ("{rigid}", if job.control.dialect == Dialect::HaasNgc { " " } else { " M29 S#4119\n" }.to_owned()),
    ];
    let main = Program { number: MAIN, text: main(job) };
    package(job.control, vec![main], MACROS, &marks, machine_file(job))
}

/// Returns the condition for scaled, mirrored, rotated or polar coordinates: a plane by G68.2 is none of them.
fn twisted(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::HaasNgc => "[#4011 EQ 51]OR[#4016 EQ 68]",
        Dialect::Fanuc31i | Dialect::Fanuc0iF => "[#4011 EQ 51]OR[#4016 EQ 68]OR[#4017 EQ 16]OR[#4022 GT 51]",
    }
}

fn main(job: &PatternJob) -> String {
    let mut text = ProgramText::new(MAIN, "PATTERNS OF HOLES", job.control.dialect);
    let start = Start {
        control: job.control,
        changed_alarm: 184,
        shifted_alarm: 196,
        axes: "XYZ",
        cancelled_rotaries: String::new(),
    };
    text.remarks(header(job));
    text.remarks(start.remarks());
    start.blocks(&mut text);
    text.block("G98");
    job.tools.iter().for_each(|tool| tool_blocks(job, tool, &mut text));
    home(job, &mut text);
    text.blocks(["G49", "M30"]);
    text.finish()
}

/// Writes the return of Z before the tool or the table changes.
fn home(job: &PatternJob, text: &mut ProgramText) {
    match job.machine.home {
        HomeReturn::G28 => {
            text.block(Block::of("G91 G28 Z0.").comment("HOME, CLEAR OF THE PART"));
            text.block("G90");
        }
        HomeReturn::G53 => text.block(Block::of("G53 G00 Z0.").comment("HOME, CLEAR OF THE PART")),
        HomeReturn::None => {}
    }
}

/// Writes the blocks of one tool.
fn tool_blocks(job: &PatternJob, tool: &PatternTool, text: &mut ProgramText) {
    text.remark(format!("T{} {} DIAMETER {}", tool.number, tool.name(), number(tool.diameter)));
    home(job, text);
    text.block(format!("T{} M06", tool.number));
    // A left-hand tap goes in counterclockwise; a mill cuts clockwise whatever the thread.
    let spindle = if operation_code(tool) == LEFT_TAP { "M04" } else { "M03" };
    text.block(format!("S{:.0} {spindle}", tool.speed));
    let face = match job.place() {
        PatternPlace::Face { face, .. } => Some(face),
        PatternPlace::Plate | PatternPlace::Cylinder { .. } => None,
    };
    if let Some(face) = face {
        let ([x, y, z], [i, j, k]) = (face.origin, face.angles);
        let plane = [('X', x), ('Y', y), ('Z', z), ('I', i), ('J', j), ('K', k)];
        text.block(Block::of("G68.2").numbers(plane).comment("THE FACE"));
        text.block(Block::of("G53.1").comment("TURNS THE TABLE, TOOL CLEAR"));
    }
    text.block(format!("G43 H{} Z{}", tool.number, number(job.machine.retract())));
    text.block("M08");
    for pattern in &job.patterns {
        let steps = pattern.steps.iter().filter(|step| step.tool == tool.number);
        steps.for_each(|step| text.blocks(calls(job, pattern, step, tool)));
    }
    text.blocks(["M09", "M05"]);
    if face.is_some() {
        text.block("G69");
    }
}

/// Returns the remarks at the head: conditions for the run.
fn header(job: &PatternJob) -> Vec<String> {
    let k = control::alarm_thousands(job.control.dialect);
    let place = match job.place() {
        PatternPlace::Plate => vec!["WORK ZERO G54 IS THAT OF THE DRAWING, Z ON THE SURFACE".to_owned()],
        PatternPlace::Cylinder { diameter, rotary } => vec![
            format!("ROUND A CYLINDER ABOUT X, DIAMETER {}", number(diameter)),
            "WORK ZERO G54 X AT THAT OF THE DRAWING, Y ON THE AXIS, Z ON TOP".to_owned(),
            format!("Y IS AN ANGLE, {}", control::rotary_command(rotary, "Y")),
        ],
        PatternPlace::Face { tilt, rotary, .. } => vec![
            format!("ON A FACE TILTED BY G68.2, {} AND {} TURN AT G53.1", tilt.letter, rotary.letter),
            "WORK ZERO G54 IS THAT OF THE PART".to_owned(),
        ],
    };
    let mut lines = vec![
        "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
        control::machine_remark(job.control),
    ];
    lines.extend(place);
    lines.extend([
        format!("CALLS O{CIRCLE} CIRCLE OR ARC, O{GRID} GRID OR LINE, O{HOLE} ONE HOLE"),
        "CHANGE A NUMBER OF THE DRAWING IN ITS CALL AND ITS HOLES FOLLOW".to_owned(),
        format!("O{CIRCLE} A ANGLE OF HOLE 1, B STEP OR 360., D DIAMETER, H HOLES"),
        format!("O{GRID} A ROTATION, E ROWS, H COLUMNS, I AND J PITCHES"),
        "S AND K HOLES LEFT OUT, TWO DIGITS EACH, R RADIUS OF A CYLINDER".to_owned(),
        "C CLEARANCE, F FEED, Q PECK OR PITCH, T TOOL, U SIGN OF THE ROTARY".to_owned(),
        "V RETRACT, W DIAMETER TO MILL, X Y PLACE, Z DEPTH, M OPERATION".to_owned(),
        "M81. DRILL, 83. PECK, 84. TAP, 74. LEFT-HAND TAP, 85. BORE".to_owned(),
        "M12. MILLED CIRCLE, 33. MILLED THREAD, 34. LEFT-HAND".to_owned(),
        format!("ALARMS {k}175-{k}195 BY THE MACROS"),
        "START WITH THE TOOL CLEAR OF THE PART".to_owned(),
    ]);
    lines.push(match job.machine.home {
        HomeReturn::G28 => "M06 COMES AT THE REFERENCE POSITION OF Z".to_owned(),
        HomeReturn::G53 => "M06 COMES AT MACHINE ZERO OF Z".to_owned(),
        HomeReturn::None => "M06 MUST RETRACT Z BY ITSELF".to_owned(),
    });
    if let Some(clamp) = job.machine.clamp {
        lines.push(format!("M{} RELEASES THE ROTARY BEFORE IT TURNS, M{} CLAMPS IT", clamp.off, clamp.on));
    }
    lines
}

/// Returns the calls that make one step of a pattern.
fn calls(job: &PatternJob, pattern: &PatternSpec, step: &PatternStep, tool: &PatternTool) -> Vec<Block> {
    let (cylinder, sign) = match job.place() {
        PatternPlace::Cylinder { diameter, rotary: Rotary { sign, .. } } => (diameter / 2.0, f64::from(sign)),
        PatternPlace::Plate | PatternPlace::Face { .. } => (0.0, 0.0),
    };
    let [skip, more] = skip_codes(&pattern.skip);
    let width = if tool.operation.is_milling() { step.diameter(tool) } else { 0.0 };
    let operation = [
        ('M', operation_code(tool)),
        ('Z', step.depth),
        ('C', job.machine.clearance()),
        ('V', job.machine.retract()),
        ('F', tool.feed().unwrap_or(0.0)),
        ('Q', tool.increment()),
        ('T', tool.diameter),
        ('W', width),
        ('U', sign),
    ];
    let call =
        |program: u32, place: &[(char, f64)]| Block::call(program, place.iter().chain(&operation).copied());
    let (x, y) = (pattern.x, pattern.y);
    let zero = [('X', x), ('Y', y)];
    let skips = [('S', skip), ('K', more)];
    let round = |diameter: f64, holes: u32, angle: f64, step: f64| {
        let numbers = [('D', diameter), ('H', f64::from(holes)), ('A', angle), ('B', step), ('R', cylinder)];
        call(CIRCLE, &[zero.as_slice(), &numbers, &skips].concat())
    };
    let rows = |columns: u32, rows: u32, [along, across]: [f64; 2], angle: f64| {
        let counts = [('H', f64::from(columns)), ('E', f64::from(rows))];
        let numbers = [('I', along), ('J', across), ('A', angle)];
        call(GRID, &[zero.as_slice(), &counts, &numbers, &skips].concat())
    };
    let block = match pattern.layout() {
        HoleLayout::Circle(circle) => {
            let round_angle = if circle.clockwise { -360.0 } else { 360.0 };
            round(circle.diameter, circle.holes, circle.angle, round_angle)
        }
        HoleLayout::Arc(arc) => round(arc.diameter, arc.holes, arc.angle, arc.step),
        HoleLayout::Grid(grid) => rows(grid.columns, grid.rows, grid.pitch, grid.angle),
        // On a cylinder a line round it is a grid of one column.
        HoleLayout::Line(line) if sign != 0.0 && line.angle == 90.0 => {
            rows(1, line.holes, [0.0, line.pitch], 0.0)
        }
        HoleLayout::Line(line) => rows(line.holes, 1, [line.pitch, 0.0], line.angle),
        HoleLayout::Points(points) => {
            let numbered = points.iter().zip(1u32..).filter(|(_, number)| !pattern.skip.contains(number));
            let of = |([along, across], number): (&[f64; 2], u32)| {
                let place = [('X', x + along), ('Y', y + across)];
                call(HOLE, &place).comment(format!("{}-{number}", pattern.id))
            };
            return numbered.map(of).collect();
        }
    };
    vec![block.comment(format!("PATTERN {}", pattern.id))]
}

/// Returns the values of S and K: two digits for each hole that is left out, four holes in each.
fn skip_codes(skip: &[u32]) -> [f64; 2] {
    let code = |holes: &[u32]| holes.iter().fold(0.0, |code, hole| code * 100.0 + f64::from(*hole));
    let (first, rest) = skip.split_at(skip.len().min(4));
    [code(first), code(rest)]
}

/// Returns the argument M.
fn operation_code(tool: &PatternTool) -> f64 {
    match tool.operation {
        Operation::Tap if tool.is_left_hand() => LEFT_TAP,
        Operation::ThreadMill if tool.is_left_hand() => 34.0,
        Operation::SpotDrill | Operation::Drill => 81.0,
        Operation::Peck => 83.0,
        Operation::Tap => 84.0,
        Operation::Bore => 85.0,
        Operation::MillCircle => 12.0,
        Operation::ThreadMill => 33.0,
    }
}

/// Returns the text of `machine.toml`.
fn machine_file(job: &PatternJob) -> String {
    let (tables, origin) = match job.place() {
        PatternPlace::Plate => (String::new(), 0.0),
        PatternPlace::Cylinder { diameter, rotary } => {
            (control::rotary_table(rotary, 'x', "its axis is the cylinder's"), -diameter / 2.0)
        }
        PatternPlace::Face { tilt, rotary, .. } => {
            let through = "its axis goes through the part's origin";
            (control::rotary_table(tilt, 'x', through) + &control::rotary_table(rotary, 'z', through), 0.0)
        }
    };
    let part = match origin {
        0.0 => String::new(),
        z => format!(
            "\n# The part's origin is on the cylinder's axis, the programs' Z0 on its surface.\n\
             [part]\norigin = [0.0, 0.0, {z:?}]\n"
        ),
    };
    let tool = |tool: &PatternTool| {
        let kind = match tool.operation {
            Operation::SpotDrill => "kind = \"spot-drill\"\n",
            Operation::Drill | Operation::Peck => "kind = \"drill\"\n",
            Operation::Tap => "kind = \"tap\"\n",
            Operation::Bore => "kind = \"boring-bar\"\n",
            Operation::MillCircle => "kind = \"end-mill\"\n",
            Operation::ThreadMill => "kind = \"end-mill\"\n",
        };
        let hand = if operation_code(tool) == LEFT_TAP { "hand = \"left\"\n" } else { "" };
        let point = tool.point_angle().map(|angle| format!("point_angle = {angle:?}\n")).unwrap_or_default();
        format!("\n[[tool]]\nnumber = {}\n{kind}{hand}diameter = {:?}\n{point}", tool.number, tool.diameter)
    };
    // Without the axes that the machine lacks, nothing of them is left unchecked.
    let axes = match job.place() {
        PatternPlace::Plate => "XYZ".to_owned(),
        PatternPlace::Cylinder { rotary, .. } => format!("XYZ{}", rotary.letter),
        PatternPlace::Face { tilt, rotary, .. } => format!("XYZ{}{}", tilt.letter, rotary.letter),
    };
    format!(
        "{}axes = \"{axes}\"\n{tables}\n\
         # The spindle is along z.\n\
         [head]\n\
         kind = \"fixed\"\n\
         direction = [0.0, 0.0, 1.0]\n\
         {part}{}",
        control::machine_file(job.control),
        job.tools.iter().map(tool).collect::<String>()
    )
}
