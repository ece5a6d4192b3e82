//! Role of a program: who starts it.

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
