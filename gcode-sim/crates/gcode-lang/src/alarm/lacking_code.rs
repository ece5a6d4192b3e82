//! What to do about a G code that the control lacks.

/// A control that has a code which another one lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherControl {
    /// Its name.
    pub name: &'static str,
    /// True if the code is a turning cycle on a lathe.
    pub is_turning_cycle: bool,
}

/// Returns what to do about a G code that the control lacks; `other` is one that has it.
pub fn lacking_code_help(code: &str, other: Option<OtherControl>) -> String {
    match other {
        Some(OtherControl { name, is_turning_cycle: true }) => format!(
            "on a lathe it is a turning cycle, and turning is not simulated; on a mill with {name} it drills a pattern of holes: give --dialect {name}"
        ),
        Some(OtherControl { name, .. }) => {
            format!("{name} has it: give --dialect {name} for such a control, or correct the code")
        }
        None => format!(
            "correct it; if this machine has it, give what it does: --code G{code}=wait, --code G{code}=nothing, or the number of the macro that it calls"
        ),
    }
}
