//! The beginning of main programs: modes left in force are refused or cancelled, then the initial modes are
//! commanded.
//!
//! A main program works in its own G54, and anything else in force contradicts it. It refuses G16, G51, G51.1
//! and G68 in its first block, before its own G54 and tool change, and a shift by G52 or G92 after its G54.
//! No offset screen shows such a shift; an intended shift belongs in G54 or in the external offset (also by
//! G10), which are used as they are. The resident macros refuse only modes that distort their formulas, in a
//! block that they execute anyway: they drill or grind in the work offset of their caller, and a G52 there is
//! the usual way to a second pattern or part.
use gcode_lang::control::{Dialect, Increment};
use gcode_part::job::JobControl;

use super::control::alarm_thousands;
use crate::nc::{Block, ProgramText, number};

/// Checks of a main program on the modes and shifts in force at its start.
pub(super) struct Start {
    pub(super) control: JobControl,
    /// n of its `#3000=n` for scaled, mirrored, rotated or polar coordinates; that of its macro.
    pub(super) changed_alarm: u32,
    /// n of its `#3000=n` for a shifted work zero.
    pub(super) shifted_alarm: u32,
    /// Axes whose shift is an alarm, in the order of their numbers on the control, from 1.
    pub(super) axes: &'static str,
    /// Rotary axes whose local shift is cancelled, because their axis numbers differ between machines.
    pub(super) cancelled_rotaries: String,
}

impl Start {
    /// Returns the remarks for the head: own alarms, shifts, coordinates.
    pub(super) fn remarks(&self) -> Vec<String> {
        let k = alarm_thousands(self.control.dialect);
        let mut lines = vec![format!(
            "ALARMS {k}{:03} {k}{:03} HERE BEFORE ANYTHING MOVES",
            self.changed_alarm, self.shifted_alarm
        )];
        lines.extend(remarks(self.axes, &self.cancelled_rotaries));
        lines
    }

    /// Writes the blocks: refusals, initial modes, cancelled shifts.
    pub(super) fn blocks(&self, text: &mut ProgramText) {
        let dialect = self.control.dialect;
        text.block(format!(
            "IF[{}]THEN #3000={}(G16 G51 G51.1 G68 IN FORCE)",
            changed_condition(dialect),
            self.changed_alarm
        ));
        emit_modes(text);
        for (axis, letter) in (1..).zip(self.axes.chars()) {
            let external = external_offset_term(dialect, &(5200 + axis).to_string());
            text.block(format!(
                "IF[ABS[#{}-#{}{external}-#{}]GT {}]THEN #3000={}(G52 OR G92 SHIFT IN {letter})",
                5020 + axis,
                5040 + axis,
                5220 + axis,
                number(shift_threshold(self.control.increment)),
                self.shifted_alarm
            ));
        }
        emit_cancel(&self.cancelled_rotaries, text);
    }
}

/// Returns the condition for scaled, mirrored, rotated or polar coordinates, terms joined by OR. A Haas has
/// neither G16 nor #4022.
pub(super) fn changed_condition(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::HaasNgc => "[#4011 EQ 51]OR[#4016 EQ 68]",
        Dialect::Fanuc31i | Dialect::Fanuc0iF => {
            "[#4011 EQ 51]OR[FIX[#4016]EQ 68]OR[#4017 EQ 16]OR[#4022 GT 51]"
        }
    }
}

/// Returns the term that subtracts the external offset. On a Haas #5201 is the shift by G52 itself, which
/// must stay in.
pub(super) fn external_offset_term(dialect: Dialect, variable: &str) -> String {
    match dialect {
        Dialect::HaasNgc => String::new(),
        Dialect::Fanuc31i | Dialect::Fanuc0iF => format!("-#{variable}"),
    }
}

/// Returns a threshold in mm above rounding and below the least shift: half an increment in x and y each is
/// 0.707 of one.
pub(super) fn shift_threshold(increment: Increment) -> f64 {
    0.75 * increment.size()
}

/// Writes the initial modes of all main programs.
pub(super) fn emit_modes(text: &mut ProgramText) {
    text.blocks(["G21", "G00 G17 G40 G49 G54 G80 G90 G94"]);
}

/// Cancels a local shift of rotary axes, if there are any.
pub(super) fn emit_cancel(rotaries: &str, text: &mut ProgramText) {
    if !rotaries.is_empty() {
        text.block(Block::of("G52").numbers(rotaries.chars().map(|letter| (letter, 0.0))));
    }
}

/// Returns the remarks on shifts and coordinates for the heads of main programs.
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

/// Returns `X Y Z`.
fn spaced(letters: &str) -> String {
    letters.chars().map(String::from).collect::<Vec<_>>().join(" ")
}
