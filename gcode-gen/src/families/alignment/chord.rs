//! Chord matching: of ten candidates for each of two points the pair whose distance is the model's, and the work offset
//! and B corrected by it.
use gcode_sim::job::Alignment;

use super::{Macro, Measurement, common_remarks};
use crate::families::control;
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;

/// The main program.
pub const MAIN: u32 = 8200;

/// The pair and the correction.
const MATCH: u32 = 8201;

pub(super) const MEASUREMENT: Measurement = Measurement {
    main: MAIN,
    title: "CHORD E F OF A PART TO BE SET UP",
    write,
    macros: &[Macro { number: MATCH, file: "O8201_chord.nc", text: include_str!("chord.nc") }],
};

fn write(job: &Alignment, text: &mut Text) {
    let rotary = job.machine.rotary.letter;
    let chord = &job.chord;
    let k = control::alarm_thousands(job.control.dialect);
    let [e, f] = [chord.e_radius, chord.f_radius].map(number);
    text.remark(format!("E AT X {e} Z 0., F AT X {f} Z 0. ON THE SURFACE"));
    common_remarks(job, text);
    for line in [
        format!("CANDIDATES {} OF E IN #501 ON, X Y Z EACH, OF F IN #531 ON", chord.candidates),
        "#570 #571 THE CHOSEN NUMBERS, #572 THEIR CHORD LESS THAT OF THE MODEL".to_owned(),
        "#573-#576 WHAT IS ADDED TO THE WORK OFFSET IN X Y Z AND THE ROTARY".to_owned(),
        "#577 TILT OF THE CHORD ABOUT Z, NOT CORRECTED".to_owned(),
        format!("CALLS O{MATCH}, ALARMS {k}061-{k}069. NOTHING MOVES"),
        format!("AFTERWARDS {rotary}0. TURNS THE CHORD INTO THE PLANE Z 0"),
    ] {
        text.remark(line);
    }
    text.block(Block::of("G21"));
    text.block(Block::of("G00 G17 G40 G49 G54 G80 G90 G94"));
    text.block(
        Block::call(MATCH)
            .word('A', number(job.surface.a))
            .word('B', number(job.surface.b))
            .word('D', e)
            .word('E', f)
            .word('H', number(f64::from(chord.candidates)))
            .word('U', number(f64::from(job.machine.rotary.sign)))
            .comment("CHORD"),
    );
    text.block(Block::of("M30"));
}
