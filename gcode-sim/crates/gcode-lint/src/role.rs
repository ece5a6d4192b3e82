//! Role of a program: who starts it.
use std::ops::RangeInclusive;

/// Program numbers of macros, which a control protects.
const MACROS: RangeInclusive<u32> = 9000..=9999;

/// Way in which a program is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Started by the operator: all locals are vacant.
    Main,
    /// Called only by the programs under check.
    Called,
    /// Returns but has no caller under check, or has the number of a macro: called by unknown programs.
    Resident,
}

impl Role {
    /// Returns the role of a program that nothing under check calls, from its number and whether its blocks return and end the run.
    pub(crate) fn of_uncalled(number: Option<u32>, (returns, ends): (bool, bool)) -> Self {
        let is_macro = number.is_some_and(|number| MACROS.contains(&number));
        if is_macro || returns && !ends { Self::Resident } else { Self::Main }
    }
}
