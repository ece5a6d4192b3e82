//! Alignment of a part: programs that measure its position on the control, and their resident macros.
//!
//! The method is that of *Improved Processing Technology of Positioning Pin Hole on Melon Mold*; see
//! `docs/methods/alignment.md`. Each measurement is a file here and a row in `ALL`; its trial on simulated
//! parts is a file and a row in `check/alignment`.
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
    /// O-number of the main program.
    main: u32,
    title: &'static str,
    /// Writes the main program below its title.
    write: fn(&Alignment, &mut Text),
    /// Macros that it calls.
    macros: &'static [Macro],
    /// Common variables that the main program itself writes.
    writes: Writes,
}

impl Measurement {
    /// Returns the common variables that the main program or its macros write.
    fn overwrites(&self) -> String {
        Writes::all(self.macros.iter().map(|one| one.writes).chain([self.writes]))
    }
}

/// All measurements in the order of the work: each needs the corrections of those before it.
const ALL: &[Measurement] =
    &[runout::MEASUREMENT, sine::MEASUREMENT, chord::MEASUREMENT, ellipse::MEASUREMENT];

/// Emits the main programs, the resident macros and the machine file of a job.
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

/// Returns the main programs in the order of the work, each with the common variables that it and its macros
/// overwrite.
pub fn overwritten() -> impl Iterator<Item = (u32, String)> {
    ALL.iter().map(|measurement| (measurement.main, measurement.overwrites()))
}

/// Commands the initial modes of all measurements. A local shift of the rotary axis is cancelled, because its
/// axis number differs between machines and no macro can read it; the macros refuse shifts in X, Y and Z.
fn begin(job: &Alignment, text: &mut Text) {
    start::emit_modes(text);
    start::emit_cancel(&job.machine.rotary.letter.to_string(), text);
}

/// Writes the remarks common to the heads of all main programs.
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
