//! Alignment of a part: programs that measure its position on the control, and their resident macros.
//!
//! The method is that of *Improved Processing Technology of Positioning Pin Hole on Melon Mold*; see
//! `docs/methods/alignment.md`. Each measurement is a file here and a row in `ALL`; its trial on simulated
//! parts is a file and a row in `check/alignment`.
mod alarms;
mod chord;
mod ellipse;
mod runout;
mod sine;
mod writes;

use gcode_part::job::Alignment;

use super::{Family, Macro, control, package, start};
use crate::nc::{ProgramText, number};
use crate::package::{Package, Program};

pub(crate) use alarms::{ALARMS, MacroAlarm};
pub(crate) use chord::{MAIN as CHORD, MATCH as CHORD_MATCH};
pub(crate) use ellipse::MAIN as ELLIPSE;
pub(crate) use runout::MAIN as RUNOUT;
pub(crate) use sine::{LARGEST_TILT, MAIN as SINE_TABLE, STEEPEST, gap};

pub(crate) const FAMILY: Family =
    Family { name: "alignment", new_job: include_str!("new.toml"), macros: MACROS };

const MACROS: &[&[Macro]] = &[runout::MACROS, sine::MACROS, chord::MACROS, ellipse::MACROS];

/// One measurement.
struct Measurement {
    /// O-number of the main program.
    main: u32,
    title: &'static str,
    /// Writes the main program below its title.
    write: fn(&Alignment, &mut ProgramText),
    /// Macros that it calls.
    macros: &'static [Macro],
}

/// All measurements in the order of the work: each needs the corrections of those before it.
const ALL: &[Measurement] =
    &[runout::MEASUREMENT, sine::MEASUREMENT, chord::MEASUREMENT, ellipse::MEASUREMENT];

/// Emits the main programs, the resident macros and the machine file of a job.
pub(crate) fn emit(job: &Alignment) -> Package {
    let main = |measurement: &Measurement| {
        let mut text = ProgramText::new(measurement.main, measurement.title, job.control.dialect);
        text.remark(format!("OVERWRITES {}", overwritten_by(measurement)));
        (measurement.write)(job, &mut text);
        Program { number: measurement.main, text: text.finish() }
    };
    let marks = [("{rotary}", job.machine.rotary.letter.to_string())];
    let mut package = package(job.control, ALL.iter().map(main).collect(), MACROS, &marks, machine_file(job));
    for program in &mut package.programs {
        program.text = program.text.replace("{writes}", &writes::remark([program.number]));
    }
    package
}

/// Returns the main programs in the order of the work, each with the common variables that it and its macros
/// overwrite.
pub(crate) fn overwritten() -> impl Iterator<Item = (u32, String)> {
    ALL.iter().map(|measurement| (measurement.main, overwritten_by(measurement)))
}

fn overwritten_by(measurement: &Measurement) -> String {
    writes::remark(measurement.macros.iter().map(|one| one.number).chain([measurement.main]))
}

/// Commands the initial modes of all measurements. A local shift of the rotary axis is cancelled, because its
/// axis number differs between machines and no macro can read it; the macros refuse shifts in X, Y and Z.
fn begin(job: &Alignment, text: &mut ProgramText) {
    start::emit_modes(text);
    start::emit_cancel(&job.machine.rotary.letter.to_string(), text);
}

/// Writes the remarks common to the heads of all main programs.
fn common_remarks(job: &Alignment, text: &mut ProgramText) {
    let rotary = job.machine.rotary;
    text.remarks([
        "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
        control::machine_remark(job.control),
        format!("WORK ZERO G54 X Z ON THE AXIS OF {}, Y AT THE CENTRE OF THE", rotary.letter),
        "ELLIPSOID, FOR THE CENTRE OF THE STYLUS BALL. THE HEAD DOES NOT TURN".to_owned(),
        format!("ROTARY {}, FROM X TOWARDS Z", control::rotary_command(rotary, "AZIMUTH")),
    ]);
    text.remarks(start::remarks("XYZ", &rotary.letter.to_string()));
}

/// Returns the text of `machine.toml`.
fn machine_file(job: &Alignment) -> String {
    format!(
        "{}{}\n\
         # The stylus ball; the programs move its centre.\n\
         [probe]\n\
         radius = {:?}\n",
        control::machine_file(job.control),
        control::rotary_table(job.machine.rotary, 'y', "its axis goes through the part's origin"),
        job.probe.radius
    )
}
/// Returns the main programs in the order of execution. Setting the sine table moves the part, so the run-out is measured at
/// least twice.
pub(crate) fn run_order(mains: &[u32]) -> Vec<u32> {
    let twice = |main: &u32| std::iter::once(*main).chain((*main == SINE_TABLE).then_some(RUNOUT));
    mains.iter().flat_map(twice).collect()
}
