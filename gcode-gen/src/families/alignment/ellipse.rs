//! The ellipse in the plane z = 0: an edge finder's ball is fed along it, and its reading shows the remaining
//! errors.
use gcode_part::job::Alignment;

use super::writes::Writes;
use super::{Macro, Measurement, begin, common_remarks};
use crate::families::control;
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;

/// O-number of the main program.
pub const MAIN: u32 = 8220;

/// O-number of the macro with the path.
const PATH: u32 = 8221;

pub(super) const MEASUREMENT: Measurement = Measurement {
    main: MAIN,
    title: "ELLIPSE OF A PART THAT IS SET UP",
    write,
    macros: &[Macro {
        number: PATH,
        file: "O8221_ellipse.nc",
        text: include_str!("ellipse.nc"),
        writes: Writes(&[]),
    }],
    writes: Writes(&[]),
};

fn write(job: &Alignment, text: &mut Text) {
    let path = &job.ellipse();
    let rotary = job.machine.rotary.letter;
    let k = control::alarm_thousands(job.control.dialect);
    let [from, to] = [path.from, path.to].map(number);
    text.remark(format!("FROM X {from} TO X {to} OF THE SURFACE, Z 0., BALL R {}", number(job.probe.radius)));
    common_remarks(job, text);
    for line in [
        format!("CALLS O{PATH}, ALARMS {k}101-{k}114"),
        "READ THE DIAL ON THE WAY, ON A PART IN ITS TRUE PLACE IT SHOWS 0".to_owned(),
        "GCODE-SIM READINGS PREDICTS WHAT IT SHOWS ON A MISPLACED PART".to_owned(),
        "START WITH THE BALL ABOVE THE POLE OF THE PART OR AT +X".to_owned(),
    ] {
        text.remark(line);
    }
    begin(job, text);
    text.block(Block::of("M05"));
    text.block(Block::of(format!("{rotary}0.")));
    text.block(
        Block::call(PATH)
            .word('A', number(job.surface.a))
            .word('B', number(job.surface.b))
            .word('C', number(job.machine.clearance()))
            .word('D', from)
            .word('E', to)
            .word('F', number(path.feed))
            .word('Q', number(path.chord_error))
            .word('R', number(job.probe.radius))
            .word('V', number(job.machine.retract()))
            .comment("ELLIPSE"),
    );
    text.block(Block::of("M30"));
}
