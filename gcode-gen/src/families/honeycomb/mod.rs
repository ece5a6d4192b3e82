//! A honeycomb of radial holes on a cylinder: a main program with one call, and a resident macro that
//! computes the rows.
//!
//! See `docs/methods/honeycomb.md`. The main program contains no number that follows from diameter, pitch and
//! length: changing D, B or X gives another closed pattern.
mod machine_file;
pub mod macros;

use gcode_part::job::{Honeycomb, Metric, Spacing};

use self::macros::{COMB, Resident};
use super::start::Start;
use super::{Family, control};
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;
use crate::package::{Package, Program};

/// O-number of the main program.
pub const MAIN: u32 = 8300;

pub const FAMILY: Family =
    Family { name: "honeycomb", new_job: include_str!("new.toml"), resident: macros::of_the_defaults };

/// Emits the main program, the resident macro and the machine file of a job.
pub fn emit(job: &Honeycomb) -> Package {
    let programs = vec![Program { number: MAIN, text: main(job) }, Resident::of(job).program()];
    Package { mains: vec![MAIN], programs, machine: machine_file::machine_file(job) }
}

fn main(job: &Honeycomb) -> String {
    let mut text = Text::new(MAIN, "HONEYCOMB OF RADIAL HOLES ON A CYLINDER", job.control.dialect);
    // The operator chooses the angle of the first row: a shift of the rotary axis rotates the whole pattern.
    let start = Start {
        control: job.control,
        changed_alarm: 51,
        shifted_alarm: 52,
        axes: "XYZ",
        cancelled_rotaries: String::new(),
    };
    header(job).into_iter().chain(start.remarks()).for_each(|line| text.remark(line));
    let drill = &job.drill;
    let retract = number(job.machine.retract());
    start.blocks(&mut text);
    text.block(Block::of(format!("T{} M06", drill.number())));
    text.block(Block::of(format!("S{:.0} M03", drill.speed())));
    text.block(Block::of(format!("G43 H{} Z{retract}", drill.number())));
    text.block(Block::of("M08"));
    text.block(call(job));
    text.block(Block::of("M09"));
    text.block(Block::of("M05"));
    text.block(Block::of("M30"));
    text.finish()
}

/// Returns the remarks at the head: conditions for the run.
fn header(job: &Honeycomb) -> Vec<String> {
    let cylinder = job.cylinder;
    let [diameter, outer, length] = [cylinder.diameter, cylinder.outer(), cylinder.length].map(number);
    let rotary = job.machine.rotary;
    let sign = if rotary.sign < 0 { "-" } else { "" };
    let (wanted, letter) = match job.pattern.spacing() {
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
        format!("{wanted} ON DIAMETER {diameter}, {measured}"),
        "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
        format!("CONTROL {}, MACHINE FILE MACHINE.TOML", control::remark(job.control)),
        "WORK ZERO G54 X AT THE FIRST HOLE, Y ON THE AXIS, Z ON THE SURFACE".to_owned(),
        format!("ROTARY {} TURNS ABOUT X, {} = {sign}ROW*180/N", rotary.letter, rotary.letter),
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
    arguments.into_iter().fold(Block::call(COMB), |block, (letter, value)| block.word(letter, number(value)))
}
