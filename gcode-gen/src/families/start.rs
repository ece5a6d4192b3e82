//! How main programs begin: what an operator has left in force is refused or cancelled, then the modes are commanded.
//!
//! A main program says in which coordinates it works, its G54, and what else is in force contradicts it. So it refuses G16, G51,
//! G51.1 and G68 in its first block, before its own G54 and tool change, and a shift by G52 or G92 behind its G54: such a shift
//! stands on no screen for offsets, and whoever wants one writes it to G54 or to the external offset (by G10 too), which are read as
//! they are. The resident macros refuse only what bends their formulas, in a block that they execute anyway: they drill or grind in
//! whatever work offset their caller has chosen, and a G52 there is the usual way to a second pattern or part.
use gcode_lang::control::{Dialect, Increment};
use gcode_part::job::JobControl;

use super::control::alarm_thousands;
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;

/// What a main program does about what is in force where it is started.
pub(super) struct Start {
    pub(super) control: JobControl,
    /// n of its `#3000=n` where coordinates are scaled, mirrored, turned or polar: that of its macro.
    pub(super) changed_alarm: u32,
    /// n where the work zero is shifted.
    pub(super) shifted_alarm: u32,
    /// The axes whose shift is an alarm, in the order of their numbers on the control, from 1.
    pub(super) axes: &'static str,
    /// The rotaries whose local shift is cancelled, for their axes have other numbers on every machine.
    pub(super) cancelled_rotaries: String,
}

impl Start {
    /// What the head says of it: alarms of its own, shifts, coordinates.
    pub(super) fn remarks(&self) -> Vec<String> {
        let k = alarm_thousands(self.control.dialect);
        let mut lines = vec![format!(
            "ALARMS {k}{:03} {k}{:03} HERE BEFORE ANYTHING MOVES",
            self.changed_alarm, self.shifted_alarm
        )];
        lines.extend(remarks(self.axes, &self.cancelled_rotaries));
        lines
    }

    pub(super) fn blocks(&self, text: &mut Text) {
        let dialect = self.control.dialect;
        text.block(Block::of(format!(
            "IF[{}]THEN #3000={}({CHANGED_TEXT})",
            changed_condition(dialect),
            self.changed_alarm
        )));
        emit_modes(text);
        for (axis, letter) in (1..).zip(self.axes.chars()) {
            let external = external_offset_term(dialect, &format!("{}", 5200 + axis));
            text.block(Block::of(format!(
                "IF[ABS[#{}-#{}{external}-#{}]GT {}]THEN #3000={}(G52 OR G92 SHIFT IN {letter})",
                5020 + axis,
                5040 + axis,
                5220 + axis,
                number(shift_threshold(self.control.increment)),
                self.shifted_alarm
            )));
        }
        emit_cancel(&self.cancelled_rotaries, text);
    }
}

/// As the control shows it.
const CHANGED_TEXT: &str = "G16 G51 G51.1 G68 IN FORCE";

/// What is true where coordinates are scaled, mirrored, turned or polar, terms joined by OR. A Haas has neither G16 nor #4022.
pub(super) fn changed_condition(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::HaasNgc => "[#4011 EQ 51]OR[#4016 EQ 68]",
        Dialect::Fanuc31i | Dialect::Fanuc0iF => {
            "[#4011 EQ 51]OR[FIX[#4016]EQ 68]OR[#4017 EQ 16]OR[#4022 GT 51]"
        }
    }
}

/// The external offset in a variable, taken off. On a Haas #5201 is the shift by G52 itself, which has to stay in.
pub(super) fn external_offset_term(dialect: Dialect, variable: &str) -> String {
    match dialect {
        Dialect::HaasNgc => String::new(),
        Dialect::Fanuc31i | Dialect::Fanuc0iF => format!("-#{variable}"),
    }
}

/// More than rounding makes, in mm, and less than the least shift there is: half an increment in x and y each is 0.707 of one.
pub(super) fn shift_threshold(increment: Increment) -> f64 {
    0.75 * increment.size()
}

/// The modes that all main programs begin in.
pub(super) fn emit_modes(text: &mut Text) {
    text.block(Block::of("G21"));
    text.block(Block::of("G00 G17 G40 G49 G54 G80 G90 G94"));
}

/// A local shift of rotaries is taken off, where there are any.
pub(super) fn emit_cancel(rotaries: &str, text: &mut Text) {
    if !rotaries.is_empty() {
        text.block(rotaries.chars().fold(Block::of("G52"), |block, letter| block.word(letter, "0.")));
    }
}

/// What the heads of main programs say of shifts and coordinates.
pub(super) fn remarks(axes: &str, cancelled: &str) -> [String; 2] {
    let cancelled = match cancelled.is_empty() {
        true => String::new(),
        false => format!("G52 OF {} IS CANCELLED, ", spaced(cancelled)),
    };
    [
        format!("{cancelled}A SHIFT OF {} BY G52 OR G92 IS AN ALARM", spaced(axes)),
        "AND SO IS A SCALING, A MIRROR IMAGE, A TURN OR G16 LEFT IN FORCE".to_owned(),
    ]
}

/// `X Y Z`
fn spaced(letters: &str) -> String {
    letters.chars().map(String::from).collect::<Vec<_>>().join(" ")
}
