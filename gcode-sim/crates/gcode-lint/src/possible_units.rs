//! The units that may be in force in a program.
use std::ops::BitOrAssign;

use gcode_lang::program::Program;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::Unit;

/// Units that may be in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PossibleUnits {
    metric: bool,
    inch: bool,
}

impl PossibleUnits {
    pub(super) const BOTH: Self = Self { metric: true, inch: true };

    pub(super) fn of(unit: Unit) -> Self {
        Self { metric: unit == Unit::Metric, inch: unit == Unit::Inch }
    }

    /// Returns the units that the blocks of a program command.
    pub(super) fn commanded_in(program: &Program) -> Self {
        let words = program.ops().iter().filter_map(|op| op.kind().words());
        let mut units = Self::default();
        for row in words.flat_map(|words| words.g_codes().filter_map(|found| found.row_for_any())) {
            if let Effect::Unit(unit) = row.effect {
                units |= Self::of(unit);
            }
        }
        units
    }

    pub(super) fn is_none(self) -> bool {
        self == Self::default()
    }

    /// Returns the only unit that may be in force.
    pub(super) fn only(self) -> Option<Unit> {
        match self {
            Self { metric: true, inch: false } => Some(Unit::Metric),
            Self { metric: false, inch: true } => Some(Unit::Inch),
            _ => None,
        }
    }
}

impl BitOrAssign for PossibleUnits {
    fn bitor_assign(&mut self, other: Self) {
        self.metric |= other.metric;
        self.inch |= other.inch;
    }
}
