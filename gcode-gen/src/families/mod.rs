//! The part families: each turns its job into programs.
pub(crate) mod alignment;
pub(crate) mod burr;
pub(crate) mod control;
mod honeycomb;
mod pattern;
mod pin_holes;
mod resident;
mod start;

use gcode_part::job::{Job, JobControl};

pub(crate) use self::pin_holes::hole_arguments;
pub use self::resident::Macro;
use crate::package::{Package, Program};

/// One part family, by its name in job files and on the command line.
pub struct Family {
    /// Name in job files.
    pub name: &'static str,
    /// A commented job file that works unchanged.
    pub new_job: &'static str,
    /// Resident macros, by the main programs that call them.
    pub macros: &'static [&'static [Macro]],
}

/// All families.
pub const ALL: &[Family] =
    &[pin_holes::FAMILY, honeycomb::FAMILY, burr::FAMILY, alignment::FAMILY, pattern::FAMILY];

/// Returns the family of a job.
pub(crate) fn of(job: &Job) -> &'static Family {
    match job {
        Job::PinHoles(_) => &pin_holes::FAMILY,
        Job::Honeycomb(_) => &honeycomb::FAMILY,
        Job::Burr(_) => &burr::FAMILY,
        Job::Alignment(_) => &alignment::FAMILY,
        Job::Pattern(_) => &pattern::FAMILY,
    }
}

/// Emits the programs of a job.
pub fn emit(job: &Job) -> Package {
    match job {
        Job::PinHoles(job) => pin_holes::emit(job),
        Job::Honeycomb(job) => honeycomb::emit(job),
        Job::Burr(job) => burr::emit(job),
        Job::Alignment(job) => alignment::emit(job),
        Job::Pattern(job) => pattern::emit(job),
    }
}

/// Builds the package of main programs, resident macros with their marks filled in, and a machine file.
fn package(
    control: JobControl,
    mut programs: Vec<Program>,
    macros: &[&[Macro]],
    marks: &[(&str, String)],
    machine: String,
) -> Package {
    let mains = programs.iter().map(|main| main.number).collect();
    programs.extend(macros.iter().flat_map(|of_main| *of_main).map(|one| one.program(control, marks)));
    Package { mains, programs, machine }
}
