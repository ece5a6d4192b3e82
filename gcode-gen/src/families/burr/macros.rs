//! The resident macro of the burrs: NC text with marks for machine and control.
use gcode_lang::control::{Dialect, Increment};
use gcode_part::job::{AxisSigns, Burr};

use crate::families::resident::fill;
use crate::nc::number::number;
use crate::nc::program::name;
use crate::package::Program;

/// O-number of the macro for one flute: approach, cylinder, nose, retract.
pub const FLUTE: u32 = 8401;

/// Properties that the macro depends on. Everything else is an argument, so that one copy in a control serves
/// all burrs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resident {
    pub dialect: Dialect,
    pub increment: Increment,
    pub signs: AxisSigns,
}

impl Resident {
    pub fn of(job: &Burr) -> Self {
        Self { dialect: job.control.dialect, increment: job.control.increment, signs: job.grinder.signs() }
    }

    pub fn programs(&self) -> Vec<Program> {
        vec![Program { number: FLUTE, text: self.fill(include_str!("flute.nc")) }]
    }

    fn fill(&self, text: &str) -> String {
        let sign = |sign: i8| if sign < 0 { "-" } else { "" }.to_owned();
        let marks = [
            ("{flute}", name(FLUTE, self.dialect)),
            ("{per_unit}", number(self.increment.per_unit())),
            ("{increment}", number(self.increment.size())),
            ("{half}", number(self.increment.size() / 2.0)),
            ("{x}", sign(self.signs.x)),
            ("{y}", sign(self.signs.y)),
            ("{a}", sign(self.signs.a)),
            ("{b}", sign(self.signs.b)),
            ("{c}", sign(self.signs.c)),
        ];
        fill(text, self.dialect, &marks)
    }
}

/// Returns the macro with default settings and its file name in `macros/`.
pub(super) fn of_the_defaults() -> Vec<(&'static str, Program)> {
    let signs = AxisSigns { x: 1, y: 1, a: 1, b: 1, c: 1 };
    let resident = Resident { dialect: Dialect::default(), increment: Increment::default(), signs };
    ["O8401_burr_flute.nc"].into_iter().zip(resident.programs()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::resident::assert_displayable;

    fn all() -> Vec<Resident> {
        let mut all = Vec::new();
        for (_, dialect) in Dialect::ALL {
            for (_, increment) in Increment::ALL {
                for sign in [1, -1] {
                    let signs = AxisSigns { x: sign, y: -sign, a: sign, b: -sign, c: sign };
                    all.push(Resident { dialect, increment, signs });
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
