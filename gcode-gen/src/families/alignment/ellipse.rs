//! The ellipse in the plane z = 0: an edge finder's ball is fed along it, and its reading shows the remaining
//! errors.
use gcode_part::job::Alignment;

use super::{Macro, Measurement, begin, common_remarks, control, number};
use crate::nc::{Block, ProgramText};

/// O-number of the main program.
pub(crate) const MAIN: u32 = 8220;

/// O-number of the macro with the path.
const PATH: u32 = 8221;

pub(super) const MEASUREMENT: Measurement =
    Measurement { main: MAIN, title: "ELLIPSE OF A PART THAT IS SET UP", write, macros: MACROS };

pub(super) const MACROS: &[Macro] =
    &[Macro { number: PATH, file: "O8221_ellipse.nc", text: include_str!("ellipse.nc") }];

fn write(job: &Alignment, text: &mut ProgramText) {
    let path = &job.ellipse();
    let rotary = job.machine.rotary.letter;
    let k = control::alarm_thousands(job.control.dialect);
    let [from, to] = [path.from, path.to].map(number);
    text.remark(format!("FROM X {from} TO X {to} OF THE SURFACE, Z 0., BALL R {}", number(job.probe.radius)));
    common_remarks(job, text);
    text.remarks([
        format!("CALLS O{PATH}, ALARMS {k}101-{k}114"),
        "READ THE DIAL ON THE WAY, ON A PART IN ITS TRUE PLACE IT SHOWS 0".to_owned(),
        "GCODE-SIM READINGS PREDICTS WHAT IT SHOWS ON A MISPLACED PART".to_owned(),
        "START WITH THE BALL ABOVE THE POLE OF THE PART OR AT +X".to_owned(),
    ]);
    begin(job, text);
    text.blocks(["M05".to_owned(), format!("{rotary}0.")]);
    let arguments = [
        ('A', job.surface.a),
        ('B', job.surface.b),
        ('C', job.machine.clearance()),
        ('D', path.from),
        ('E', path.to),
        ('F', path.feed),
        ('Q', path.chord_error),
        ('R', job.probe.radius),
        ('V', job.machine.retract()),
    ];
    text.block(Block::call(PATH, arguments).comment("ELLIPSE"));
    text.block("M30");
}
