//! What the programs and machine files of all families say of the control.
use gcode_sim::control::{Dialect, Increment};
use gcode_sim::job::JobControl;

fn names(control: JobControl) -> (&'static str, &'static str) {
    let dialect = Dialect::ALL.iter().find(|(_, d)| *d == control.dialect).map_or("", |(name, _)| name);
    let increment = Increment::ALL.iter().find(|(_, i)| *i == control.increment).map_or("", |(name, _)| name);
    (dialect, increment)
}

/// `FANUC-31I, INCREMENT IS-B`, for a comment.
pub(super) fn remark(control: JobControl) -> String {
    let (dialect, increment) = names(control);
    format!("{dialect}, INCREMENT {increment}")
}

/// What the control adds to n of `#3000=n`, in thousands: a Fanuc shows 3000 + n, a Haas 1000 + n.
pub(super) fn alarm_thousands(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::HaasNgc => "1",
        Dialect::Fanuc31i | Dialect::Fanuc0iF => "3",
    }
}

/// How every machine file begins.
pub(super) fn machine_file(control: JobControl) -> String {
    let (dialect, increment) = names(control);
    format!(
        "# The machine and control that the programs beside this file are for; lengths in mm, angles in degrees.\n\
         [control]\n\
         dialect = \"{dialect}\"\n\
         increment = \"{increment}\"\n"
    )
}
