//! The resident macros of the pin holes: NC texts with marks for machine and control.
use gcode_lang::control::{Dialect, Increment};
use gcode_part::job::{HeadKind, PinHoles};

use crate::families::resident::fill;
use crate::nc::number::number;
use crate::nc::program::name;
use crate::package::Program;

/// O-number of the macro for one hole: approach, feed, retract.
pub const HOLE: u32 = 8101;
/// O-number of the macro that computes the head angle of a radius and sets the head.
pub const HEAD: u32 = 8102;

/// Properties that the macros depend on. Everything else is an argument, so that one copy in a control serves
/// all jobs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resident {
    pub dialect: Dialect,
    pub increment: Increment,
    pub rotary: char,
    pub head: HeadKind,
    /// Common variable with the head angle to be set; the next one holds the angle that is set.
    pub common: u32,
}

impl Resident {
    pub fn of(job: &PinHoles) -> Self {
        Self {
            dialect: job.control.dialect,
            increment: job.control.increment,
            rotary: job.machine.rotary.letter,
            head: job.machine.head.kind(),
            common: job.macros.common,
        }
    }

    pub fn programs(&self) -> Vec<Program> {
        vec![
            Program { number: HOLE, text: self.fill(include_str!("hole.nc")) },
            Program { number: HEAD, text: self.fill(include_str!("head.nc")) },
        ]
    }

    /// Returns the common variable with the head's angle; it is vacant until the head is set.
    pub fn set(&self) -> u32 {
        self.common + 1
    }

    fn fill(&self, text: &str) -> String {
        let (set_head, spindle_note) = match self.head {
            HeadKind::Manual => (
                format!("M09\nM05\n#3006=1(SET HEAD TO ANGLE IN #{})\nM03\nM08", self.common),
                "\n(STOPS SPINDLE AND COOLANT FOR THE OPERATOR, THEN M03 M08)",
            ),
            HeadKind::Axis(letter) => (format!("G90 G00 {letter}#{}", self.common), ""),
        };
        let marks = [
            ("{hole}", name(HOLE, self.dialect)),
            // A program's name is at its head, where Haas writes five digits, and in remarks.
            ("{head}(", format!("{}(", name(HEAD, self.dialect))),
            ("{head}", format!("O{HEAD}")),
            ("{head_call}", HEAD.to_string()),
            ("{rotary}", self.rotary.to_string()),
            ("{angle}", self.common.to_string()),
            ("{set}", self.set().to_string()),
            ("{per_degree}", number(self.increment.per_unit())),
            // The head's angle is rounded to its increment: within half of one the angle is the same.
            ("{half}", number(self.increment.size() / 2.0)),
            ("{set_head}", set_head),
            ("{spindle_note}", spindle_note.to_owned()),
        ];
        fill(text, self.dialect, &marks)
    }
}

/// Returns the macros with default settings, as in `macros/`.
pub(super) fn of_the_defaults() -> Vec<(&'static str, Program)> {
    let resident = Resident {
        dialect: Dialect::default(),
        increment: Increment::default(),
        rotary: 'B',
        head: HeadKind::Manual,
        common: 140,
    };
    ["O8101_pin_hole.nc", "O8102_head_angle.nc"].into_iter().zip(resident.programs()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::resident::assert_displayable;

    fn all() -> Vec<Resident> {
        let mut all = Vec::new();
        for (_, dialect) in Dialect::ALL {
            for (_, increment) in Increment::ALL {
                for head in [HeadKind::Manual, HeadKind::Axis('A')] {
                    all.push(Resident { dialect, increment, rotary: 'B', head, common: 140 });
                }
            }
        }
        all
    }

    #[test]
    fn every_control_can_show_every_text() {
        all().iter().flat_map(Resident::programs).for_each(|program| assert_displayable(&program.text));
    }
}
