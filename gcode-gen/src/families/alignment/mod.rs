//! A part that is to be set up: programs that measure on the control how it stands, and what they call.
//!
//! The method is that of *Improved Processing Technology of Positioning Pin Hole on Melon Mold*; see
//! `docs/methods/alignment.md`. Each measurement is a file here and a row in `ALL`; what its program has to find on a
//! simulated part before it is written is a file and a row in `check/alignment`.
mod alarms;
mod chord;
mod ellipse;
mod machine_file;
mod resident;
mod runout;
mod sine;
mod writes;

use gcode_part::job::Alignment;

use self::resident::{Macro, Resident};
use self::writes::Writes;
use super::{Family, control, start};
use crate::nc::program::Program as Text;
use crate::package::{Package, Program};

pub use alarms::{ALARMS, MacroAlarm};
pub use chord::{MAIN as CHORD, MATCH as CHORD_MATCH};
pub use ellipse::MAIN as ELLIPSE;
pub use runout::MAIN as RUNOUT;
pub use sine::{LARGEST_TILT, MAIN as SINE_TABLE, STEEPEST, gap};

pub const FAMILY: Family =
    Family { name: "alignment", new_job: include_str!("new.toml"), resident: resident::of_the_defaults };

/// One measurement.
struct Measurement {
    /// The main program's O-number.
    main: u32,
    title: &'static str,
    /// Writes the main program below its title.
    write: fn(&Alignment, &mut Text),
    /// What it calls.
    macros: &'static [Macro],
    /// The common variables that the main program writes itself.
    writes: Writes,
}

impl Measurement {
    /// The common variables that the main program or a macro that it calls writes.
    fn overwrites(&self) -> String {
        Writes::all(self.macros.iter().map(|one| one.writes).chain([self.writes]))
    }
}

/// Every measurement there is, in the order in which a part is set up: each needs what those before it have put right.
const ALL: &[Measurement] =
    &[runout::MEASUREMENT, sine::MEASUREMENT, chord::MEASUREMENT, ellipse::MEASUREMENT];

/// The main programs, the resident macros and the machine file of a job.
pub fn emit(job: &Alignment) -> Package {
    let main = |measurement: &Measurement| {
        let mut text = Text::new(measurement.main, measurement.title, job.control.dialect);
        text.remark(format!("OVERWRITES {}", measurement.overwrites()));
        (measurement.write)(job, &mut text);
        Program { number: measurement.main, text: text.finish() }
    };
    let mut programs: Vec<_> = ALL.iter().map(main).collect();
    programs.extend(Resident::of(job).programs());
    Package {
        mains: ALL.iter().map(|measurement| measurement.main).collect(),
        programs,
        machine: machine_file::machine_file(job),
    }
}

/// The main programs in the order of the work, each with the common variables that it and its macros overwrite.
pub fn overwritten() -> impl Iterator<Item = (u32, String)> {
    ALL.iter().map(|measurement| (measurement.main, measurement.overwrites()))
}

/// The modes that all measurements begin in. A local shift of the rotary is cancelled, for its axis has another number on every
/// machine, so that no macro can look for it; the macros refuse those in X, Y and Z.
fn begin(job: &Alignment, text: &mut Text) {
    start::emit_modes(text);
    start::emit_cancel(&job.machine.rotary.letter.to_string(), text);
}

/// What the heads of all main programs say.
fn common_remarks(job: &Alignment, text: &mut Text) {
    let rotary = job.machine.rotary;
    let sign = if rotary.sign < 0 { "-" } else { "" };
    for line in [
        "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
        format!("CONTROL {}, MACHINE FILE MACHINE.TOML", control::remark(job.control)),
        format!("WORK ZERO G54 X Z ON THE AXIS OF {}, Y AT THE CENTRE OF THE", rotary.letter),
        "ELLIPSOID, FOR THE CENTRE OF THE STYLUS BALL. THE HEAD DOES NOT TURN".to_owned(),
        format!("ROTARY {} = {sign}AZIMUTH, FROM X TOWARDS Z", rotary.letter),
    ] {
        text.remark(line);
    }
    start::remarks("XYZ", &rotary.letter.to_string()).iter().for_each(|line| text.remark(line));
}
