//! A honeycomb of radial holes on a cylinder: a main program with one call, and a resident macro that
//! computes the rows.
//!
//! See `docs/methods/honeycomb.md`. The main program contains no number that follows from diameter, pitch and
//! length: changing D, B or X gives another closed pattern.
use gcode_part::job::{Honeycomb, Metric, Spacing};

use super::start::Start;
use super::{Family, Macro, control, package};
use crate::nc::{Block, ProgramText, number};
use crate::package::{Package, Program};

/// O-number of the main program.
const MAIN: u32 = 8300;
/// O-number of the macro for the whole pattern: rows, angles, pitch.
const COMB: u32 = 8301;

/// π with as many digits as all three dialects accept in one number: the error on a metre of circumference is
/// 1 nm.
const PI: &str = "3.14159265";

const MACROS: &[&[Macro]] =
    &[&[Macro { number: COMB, file: "O8301_honeycomb.nc", text: include_str!("comb.nc") }]];

pub(super) const FAMILY: Family =
    Family { name: "honeycomb", new_job: include_str!("new.toml"), macros: MACROS };

/// Emits the main program, the resident macro and the machine file of a job.
pub(super) fn emit(job: &Honeycomb) -> Package {
    let clamp_code = |code: Option<u32>| code.map_or_else(String::new, |code| format!("\nM{code}"));
    let marks = [
        ("{pi}", PI.to_owned()),
        ("{rotary}", job.machine.rotary.letter.to_string()),
        ("{unclamp}", clamp_code(job.machine.clamp.map(|clamp| clamp.off))),
        ("{clamp}", clamp_code(job.machine.clamp.map(|clamp| clamp.on))),
    ];
    let main = Program { number: MAIN, text: main(job) };
    package(job.control, vec![main], MACROS, &marks, machine_file(job))
}

fn main(job: &Honeycomb) -> String {
    let mut text = ProgramText::new(MAIN, "HONEYCOMB OF RADIAL HOLES ON A CYLINDER", job.control.dialect);
    // The operator chooses the angle of the first row: a shift of the rotary axis rotates the whole pattern.
    let start = Start {
        control: job.control,
        changed_alarm: 51,
        shifted_alarm: 52,
        axes: "XYZ",
        cancelled_rotaries: String::new(),
    };
    text.remarks(header(job));
    text.remarks(start.remarks());
    start.blocks(&mut text);
    let drill = &job.drill;
    text.blocks([
        format!("T{} M06", drill.number()),
        format!("S{:.0} M03", drill.speed()),
        format!("G43 H{} Z{}", drill.number(), number(job.machine.retract())),
        "M08".to_owned(),
    ]);
    text.block(call(job));
    text.blocks(["M09", "M05", "M30"]);
    text.finish()
}

/// Returns the remarks at the head: conditions for the run.
fn header(job: &Honeycomb) -> Vec<String> {
    let cylinder = job.cylinder;
    let [diameter, outer, length] = [cylinder.diameter, cylinder.outer(), cylinder.length].map(number);
    let rotary = job.machine.rotary;
    let (nominal, letter) = match job.pattern.spacing() {
        Spacing::Pitch(pitch) => (format!("PITCH {} SPECIFIED", number(pitch)), 'B'),
        Spacing::Divisions(divisions) => (format!("{divisions} ROWS OF EACH OF TWO GROUPS"), 'E'),
    };
    let measured = match job.pattern.metric {
        Metric::Arc => "ON THE DEVELOPED SURFACE",
        Metric::Chord => "STRAIGHT",
    };
    let clamp = job
        .machine
        .clamp
        .map(|clamp| format!("M{} RELEASES THE ROTARY BEFORE IT TURNS, M{} CLAMPS IT", clamp.off, clamp.on));
    let k = control::alarm_thousands(job.control.dialect);
    let mut lines = vec![
        format!("DIAMETER {outer}, LENGTH {length}, DRILL {}", number(job.drill.diameter)),
        format!("{nominal} ON DIAMETER {diameter}, {measured}"),
        "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
        control::machine_remark(job.control),
        "WORK ZERO G54 X AT THE FIRST HOLE, Y ON THE AXIS, Z ON THE SURFACE".to_owned(),
        format!("ROTARY {} TURNS ABOUT X, {}", rotary.letter, control::rotary_command(rotary, "ROW*180/N")),
        format!("CALLS O{COMB}, WHICH COMPUTES ROWS, ANGLES AND PITCH FROM {letter} AND D"),
        format!("CHANGE D, {letter} OR X IN ITS CALL AND THE PATTERN CLOSES AGAIN"),
        "A DRILL, B PITCH, C CLEARANCE, D DIAMETER OF THE PITCH, E DIVISIONS".to_owned(),
        "F FEED, H 0. DEVELOPED 1. STRAIGHT, I OUTER DIAMETER, J BORE, Q PECK".to_owned(),
        format!("U SIGN OF {}, V RETRACT, X LENGTH, Z DEPTH", rotary.letter),
        format!("ALARMS {k}031-{k}051 BY O{COMB}"),
        "START WITH THE TOOL CLEAR OF THE PART".to_owned(),
    ];
    lines.extend(clamp);
    lines
}

fn call(job: &Honeycomb) -> Block {
    let cylinder = job.cylinder;
    let (drill, machine) = (&job.drill, &job.machine);
    let (pitch, divisions) = match job.pattern.spacing() {
        Spacing::Pitch(pitch) => (pitch, 0.0),
        Spacing::Divisions(divisions) => (0.0, f64::from(divisions)),
    };
    let metric = match job.pattern.metric {
        Metric::Arc => 0.0,
        Metric::Chord => 1.0,
    };
    let arguments = [
        ('D', cylinder.diameter),
        ('B', pitch),
        ('E', divisions),
        ('H', metric),
        ('X', cylinder.length),
        ('I', cylinder.outer()),
        ('J', cylinder.bore),
        ('A', drill.diameter),
        ('Z', drill.depth),
        ('C', machine.clearance()),
        ('V', machine.retract()),
        ('F', drill.feed()),
        ('Q', drill.peck()),
        ('U', f64::from(machine.rotary.sign)),
    ];
    Block::call(COMB, arguments)
}

/// Returns the text of `machine.toml`.
fn machine_file(job: &Honeycomb) -> String {
    format!(
        "{}{}\n\
         # The spindle is along z.\n\
         [head]\n\
         kind = \"fixed\"\n\
         direction = [0.0, 0.0, 1.0]\n\
         \n\
         # The part's origin is on the cylinder's axis, the programs' Z0 on its surface.\n\
         [part]\n\
         origin = [0.0, 0.0, {:?}]\n\
         \n\
         [[tool]]\n\
         number = {}\n\
         diameter = {:?}\n",
        control::machine_file(job.control),
        control::rotary_table(job.machine.rotary, 'x', "its axis is the cylinder's"),
        -job.cylinder.outer() / 2.0,
        job.drill.number(),
        job.drill.diameter
    )
}
