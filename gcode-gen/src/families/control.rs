//! Texts about the control and the rotary in the programs and machine files of all families.
use gcode_lang::control::Dialect;
use gcode_part::job::{JobControl, Rotary};

/// Returns `CONTROL FANUC-31I, INCREMENT IS-B`, for a comment.
pub(super) fn remark(control: JobControl) -> String {
    format!("CONTROL {}, INCREMENT {}", control.dialect.name(), control.increment.name())
}

/// Returns the remark on the control that names the machine file, too.
pub(super) fn machine_remark(control: JobControl) -> String {
    remark(control) + ", MACHINE FILE MACHINE.TOML"
}

/// Returns `B = -AZIMUTH`: the command of the rotary for an angle.
pub(super) fn rotary_command(rotary: Rotary, angle: &str) -> String {
    format!("{} = {}{angle}", rotary.letter, minus(rotary.sign))
}

/// Returns the minus of a negative sign.
pub(super) fn minus(sign: i8) -> &'static str {
    if sign < 0 { "-" } else { "" }
}

/// Returns the thousands that the control adds to n of `#3000=n`: a Fanuc shows 3000 + n, a Haas 1000 + n.
pub(crate) fn alarm_thousands(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::HaasNgc => "1",
        Dialect::Fanuc31i | Dialect::Fanuc0iF => "3",
    }
}

/// Returns the beginning of every machine file.
pub(super) fn machine_file(control: JobControl) -> String {
    let (dialect, increment) = (control.dialect.name(), control.increment.name());
    format!(
        "# The machine and control of the programs next to this file; lengths in mm, angles in degrees.\n\
         [control]\n\
         dialect = \"{dialect}\"\n\
         increment = \"{increment}\"\n"
    )
}

/// Returns the rotary table of a machine file: it rotates the part about `about`, x or y.
pub(super) fn rotary_table(rotary: Rotary, about: char, axis: &str) -> String {
    format!(
        "\n\
         # The rotary table rotates the part about {about}; {axis}.\n\
         [[table]]\n\
         letter = \"{}\"\n\
         turns = \"{about}\"\n\
         sign = {}\n",
        rotary.letter, rotary.sign
    )
}
