//! The resident macro of the honeycomb: NC text with marks for machine and control.
use gcode_lang::control::Dialect;
use gcode_part::job::{Clamp, Honeycomb};

use crate::families::resident::fill;
use crate::nc::program::name;
use crate::package::Program;

/// O-number of the macro for the whole pattern: rows, angles, pitch.
pub const COMB: u32 = 8301;

/// π with as many digits as all three dialects accept in one number: the error on a metre of circumference is
/// 1 nm.
const PI: &str = "3.14159265";

/// Properties that the macro depends on. Everything else is an argument, so that one copy in a control serves
/// all jobs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resident {
    pub dialect: Dialect,
    pub rotary: char,
    pub clamp: Option<Clamp>,
}

impl Resident {
    pub fn of(job: &Honeycomb) -> Self {
        Self { dialect: job.control.dialect, rotary: job.machine.rotary.letter, clamp: job.machine.clamp }
    }

    pub fn program(&self) -> Program {
        let code = |code: Option<u32>| code.map_or_else(String::new, |code| format!("\nM{code}"));
        let marks = [
            ("{comb}", name(COMB, self.dialect)),
            ("{pi}", PI.to_owned()),
            ("{rotary}", self.rotary.to_string()),
            ("{unclamp}", code(self.clamp.map(|clamp| clamp.off))),
            ("{clamp}", code(self.clamp.map(|clamp| clamp.on))),
        ];
        Program { number: COMB, text: fill(include_str!("comb.nc"), self.dialect, &marks) }
    }
}

/// Returns the macro with default settings, as in `macros/`.
pub(super) fn of_the_defaults() -> Vec<(&'static str, Program)> {
    let resident = Resident { dialect: Dialect::default(), rotary: 'B', clamp: None };
    vec![("O8301_honeycomb.nc", resident.program())]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::resident::assert_displayable;

    fn all() -> Vec<Program> {
        let clamps = [None, Some(Clamp { on: 10, off: 11 })];
        let residents = Dialect::ALL
            .into_iter()
            .flat_map(|(_, dialect)| clamps.map(|clamp| Resident { dialect, rotary: 'B', clamp }.program()));
        residents.collect()
    }

    #[test]
    fn every_control_can_show_every_text() {
        all().into_iter().for_each(|program| assert_displayable(&program.text));
    }

    #[test]
    fn the_rotary_is_let_go_before_it_turns_and_held_before_the_drill_comes() {
        let clamp = Some(Clamp { on: 10, off: 11 });
        let text = Resident { dialect: Dialect::Fanuc31i, rotary: 'A', clamp }.program().text;
        assert!(text.contains("DO1\nM11\nA[#21*#18*#15]\nM10\n#20="), "{text}");
    }
}
