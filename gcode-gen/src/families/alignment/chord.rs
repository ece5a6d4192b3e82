//! Chord matching: chooses, of ten candidates for each of two points, the pair whose distance is the model's,
//! and corrects the work offset and B by it.
use gcode_part::job::Alignment;

use super::{Macro, Measurement, begin, common_remarks, control, number};
use crate::nc::{Block, ProgramText};

/// O-number of the main program.
pub(crate) const MAIN: u32 = 8200;

/// O-number of the macro that chooses the pair and corrects the offset.
pub(crate) const MATCH: u32 = 8201;
/// O-number of the macro that touches candidates if none were entered.
pub(super) const TOUCH: u32 = 8202;

/// Name, first common variable of the candidates, and angle between successive candidates of a spiral. One
/// angle is the golden angle, the other has the opposite sense, so that no two pairs are alike.
const POINTS: [(&str, f64, f64); 2] = [("E", 501.0, 137.508), ("F", 531.0, -100.0)];

pub(super) const MEASUREMENT: Measurement =
    Measurement { main: MAIN, title: "CHORD E F OF A PART TO BE SET UP", write, macros: MACROS };

pub(super) const MACROS: &[Macro] = &[
    Macro { number: MATCH, file: "O8201_chord.nc", text: include_str!("chord.nc") },
    Macro { number: TOUCH, file: "O8202_candidates.nc", text: include_str!("candidates.nc") },
];

fn write(job: &Alignment, text: &mut ProgramText) {
    let rotary = job.machine.rotary.letter;
    let chord = &job.chord;
    let k = control::alarm_thousands(job.control.dialect);
    let [e, f] = [chord.e_radius, chord.f_radius].map(number);
    text.remark(format!("E AT X {e} Z 0., F AT X {f} Z 0. ON THE SURFACE"));
    common_remarks(job, text);
    text.remarks([
        format!("CANDIDATES {} OF E IN #501 ON, X Y Z EACH, OF F IN #531 ON", chord.candidates),
        "#570 #571 THE CHOSEN NUMBERS, #572 THEIR CHORD MINUS THAT OF THE MODEL".to_owned(),
        "#574 #576 WHAT IS ADDED TO THE WORK OFFSET IN Y AND THE ROTARY".to_owned(),
        "#573 #575 OFFSET OF THE CHORD IN X AND Z, NOT CORRECTED".to_owned(),
        "#577 TILT OF THE CHORD ABOUT Z, NOT CORRECTED".to_owned(),
        "TOUCHED POINTS GIVE Y ALONE, THEN #573 #575 #576 ARE 0".to_owned(),
        format!("CALLS O{TOUCH}. WHERE #501-#560 AND #578 ARE VACANT IT TOUCHES THEM WITH"),
        "THE PROBE. CANDIDATES OF MARKS ARE ENTERED BY HAND, ALL OF THEM, WITH".to_owned(),
        "#578 VACANT, THEN NOTHING MOVES. #578 1. IS A TOUCH BROKEN OFF, AN".to_owned(),
        "ALARM. #578 0. CLEARS ALL CANDIDATES AND TOUCHES ANEW".to_owned(),
        "POINTS ARE USED ONCE, #501-#560 AND #578 ARE VACANT AT THE STOP".to_owned(),
        format!("CALLS O{MATCH}, THE PAIR AND THE WORK OFFSET"),
        "AT THE STOP CYCLE START ADDS #574 #576, RESET KEEPS THEM OUT".to_owned(),
        format!("ALARMS {k}061-{k}076 BY O{MATCH}, {k}120-{k}137 BY O{TOUCH}"),
        "START WITH THE BALL CLEAR OF THE PART, ABOVE IT OR AT +X".to_owned(),
        format!("AFTERWARDS {rotary}0. TURNS THE CHORD INTO THE PLANE Z 0"),
    ]);
    begin(job, text);
    let common = [('A', job.surface.a), ('B', job.surface.b), ('C', chord.circle)];
    let candidates = f64::from(chord.candidates);
    for ((name, first, turn), x) in POINTS.into_iter().zip([chord.e_radius, chord.f_radius]) {
        let touch = [
            ('D', x),
            ('F', job.probe.feed),
            ('H', candidates),
            ('I', first),
            ('K', turn),
            ('R', job.probe.radius),
            ('V', job.probe.search),
        ];
        text.block(Block::call(TOUCH, common).numbers(touch).comment(name));
    }
    let choose = [
        ('D', chord.e_radius),
        ('E', chord.f_radius),
        ('H', candidates),
        ('T', job.unevenness()),
        ('U', f64::from(job.machine.rotary.sign)),
        ('V', job.probe.search),
    ];
    text.block(Block::call(MATCH, common).numbers(choose).comment("CHORD"));
    text.block("M30");
}
