//! The resident macros of the measurements: NC texts with marks for machine and control.
use gcode_lang::control::{Dialect, Increment};
use gcode_part::job::Alignment;

use super::ALL;
use super::writes::Writes;
use crate::families::resident::fill;
use crate::families::start::{external_offset_term, shift_threshold};
use crate::nc::number::number;
use crate::nc::program::name;
use crate::package::Program;

/// A resident macro as in its `.nc` file in this folder.
pub(super) struct Macro {
    pub(super) number: u32,
    /// File name in `macros/`.
    pub(super) file: &'static str,
    pub(super) text: &'static str,
    pub(super) writes: Writes,
}

/// Properties that the macros depend on. Everything else is an argument, so that one copy in a control serves
/// all jobs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resident {
    dialect: Dialect,
    increment: Increment,
    rotary: char,
}

impl Resident {
    pub(super) fn of(job: &Alignment) -> Self {
        Self {
            dialect: job.control.dialect,
            increment: job.control.increment,
            rotary: job.machine.rotary.letter,
        }
    }

    pub(super) fn programs(&self) -> Vec<Program> {
        macros().map(|one| Program { number: one.number, text: self.fill(one) }).collect()
    }

    fn fill(&self, one: &Macro) -> String {
        let marks = [
            ("{name}", name(one.number, self.dialect)),
            ("{rotary}", self.rotary.to_string()),
            ("{increment}", number(self.increment.size())),
            ("{rounding}", number(shift_threshold(self.increment))),
            ("{per_unit}", number(self.increment.per_unit())),
            // Of the axis with number 1 + #12.
            ("{external}", external_offset_term(self.dialect, "[5201+#12]")),
            ("{writes}", one.writes.remark()),
        ];
        fill(one.text, self.dialect, &marks)
    }
}

fn macros() -> impl Iterator<Item = &'static Macro> {
    ALL.iter().flat_map(|measurement| measurement.macros)
}

/// Returns the macros with default settings, as in `macros/`.
pub(super) fn of_the_defaults() -> Vec<(&'static str, Program)> {
    let resident = Resident { dialect: Dialect::default(), increment: Increment::default(), rotary: 'B' };
    macros().map(|one| one.file).zip(resident.programs()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::resident::assert_displayable;

    #[test]
    fn every_control_can_show_every_text() {
        for (_, dialect) in Dialect::ALL {
            for (_, increment) in Increment::ALL {
                for rotary in ['A', 'B', 'C'] {
                    let resident = Resident { dialect, increment, rotary };
                    resident.programs().iter().for_each(|program| assert_displayable(&program.text));
                }
            }
        }
    }
}
