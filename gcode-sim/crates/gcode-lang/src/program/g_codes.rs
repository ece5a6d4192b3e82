//! Lookup of G codes. A code without a row raises an alarm and is never skipped.
use super::code_facts::{AxisWords, Unsimulated};
pub use super::g_code_row::{Effect, GCodeRow, HolePattern, MeasuringCode, OneShot, name, spelled};
use super::g_code_table::{CODES, DECLARED, DECLARED_WAIT};
use crate::alarm::{Alarm, OtherControl};
use crate::control::{DeclaredEffect, Dialect, Settings};

/// Rows of a code × 10 by family, as indices; 255 for a code that the controls lack.
#[derive(Clone, Copy, Debug)]
pub struct RowLookup([u8; Dialect::ALL_CONTROLS.len()]);

impl RowLookup {
    const NONE: u8 = u8::MAX;
    const NOT_FOUND: Self = Self([Self::NONE; Dialect::ALL_CONTROLS.len()]);

    /// Returns the row of the code on a control.
    #[inline]
    pub fn row_for(&self, dialect: Dialect) -> Option<&'static GCodeRow> {
        CODES.get(usize::from(self.0[dialect as usize]))
    }

    /// Returns the row of the code on the first control that has it.
    pub fn row_for_any(&self) -> Option<&'static GCodeRow> {
        self.0.iter().find_map(|index| CODES.get(usize::from(*index)))
    }
}

/// Returns the rows of all codes, in ascending order.
pub fn all() -> &'static [GCodeRow] {
    CODES
}

/// Returns the rows of a code × 10.
#[inline]
pub fn find(code: u32) -> RowLookup {
    LOOKUP.get(code as usize).copied().unwrap_or(RowLookup::NOT_FOUND)
}

/// Returns the row of a code × 10 on a control: that of the table, or of a declaration where the table has none that runs.
#[inline]
pub fn row_on(code: u32, found: RowLookup, settings: &Settings) -> Option<&'static GCodeRow> {
    match found.row_for(settings.codes) {
        Some(row) if row.effect != Effect::NotSimulated => Some(row),
        row => declared_row(code, settings).or(row),
    }
}

/// Returns the alarm of a code × 10 that a control does not have.
#[cold]
pub fn improper(code: u32) -> Alarm {
    Alarm::ImproperGCode { code: spelled(code), other: other_control(code) }
}

/// Returns the first control that has a code × 10.
pub fn other_control(code: u32) -> Option<OtherControl> {
    Dialect::ALL.iter().find_map(|(name, dialect)| {
        let row = find(code).row_for(*dialect)?;
        Some(OtherControl { name, is_turning_cycle: row.facts.is_turning_cycle })
    })
}

/// Returns the row of a code × 10 that the user declares.
#[cold]
fn declared_row(code: u32, settings: &Settings) -> Option<&'static GCodeRow> {
    Some(match settings.declared_codes.find(b'G', code)? {
        DeclaredEffect::Nothing => &DECLARED,
        DeclaredEffect::Wait => &DECLARED_WAIT,
    })
}

/// Rows of every code × 10 up to the last one.
const LOOKUP: [RowLookup; LAST_CODE + 1] = {
    assert!(CODES.len() <= RowLookup::NONE as usize);
    let mut all = [RowLookup::NOT_FOUND; LAST_CODE + 1];
    let mut index = 0;
    while index < CODES.len() {
        let row = &CODES[index];
        let is_one_shot = matches!(row.effect, Effect::OneShot(_));
        assert!(
            !is_one_shot || !matches!(row.facts.axis_words, AxisWords::Move),
            "a code of group 00 has facts of its own"
        );
        assert!(
            row.effect.is_shown() || !matches!(row.facts.unsimulated, Unsimulated::No),
            "a code without simulated effect has facts that record it"
        );
        let mut set = 0;
        while set < row.dialects.len() {
            all[row.code as usize].0[row.dialects[set] as usize] = index as u8;
            set += 1;
        }
        index += 1;
    }
    all
};

const LAST_CODE: usize = CODES[CODES.len() - 1].code as usize;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::modes::Scaling;

    #[test]
    fn rows_ascend_and_a_control_has_one_for_each_code() {
        for pair in CODES.windows(2) {
            let once = pair[0].dialects.iter().all(|set| !pair[1].dialects.contains(set));
            let ascends = pair[0].code < pair[1].code || pair[0].code == pair[1].code && once;
            assert!(ascends, "G{}", spelled(pair[1].code));
        }
        assert!(find(143).row_for(Dialect::Fanuc31i).is_none());
    }

    /// G70 to G72 of a Haas are turning cycles on a lathe; G187 is none.
    #[test]
    fn the_control_that_has_a_code_is_named() {
        let other = |code| other_control(code).map(|other| (other.name, other.is_turning_cycle));
        for code in [700, 710, 720] {
            assert_eq!(other(code), Some(("haas-ngc", true)), "{code}");
        }
        assert_eq!(other(1870), Some(("haas-ngc", false)));
        assert_eq!(other(9990), None);
    }

    #[test]
    fn the_meaning_of_a_code_depends_on_the_control() {
        let effect = |code, set| find(code).row_for(set).map(|row| row.effect);
        assert_eq!(effect(1540, Dialect::HaasNgc), Some(Effect::AdditionalWork));
        assert_eq!(effect(1540, Dialect::Fanuc31i), None);
        assert_eq!(effect(510, Dialect::Fanuc31i), Some(Effect::Scaling(Scaling::On)));
        assert_eq!(effect(470, Dialect::HaasNgc), Some(Effect::OneShot(OneShot::Engraving)));
        assert_eq!(effect(470, Dialect::Fanuc31i), Some(Effect::OneShot(OneShot::ToolOffset(2))));
        assert_eq!(effect(434, Dialect::Fanuc0iF), None);
    }
}
