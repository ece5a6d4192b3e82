//! The part families: each turns its job into programs.
pub mod alignment;
pub mod burr;
pub(crate) mod control;
pub mod honeycomb;
pub mod pin_holes;
mod resident;
mod start;

use gcode_part::job::Job;

use crate::package::{Package, Program};

/// One part family, by its name in job files and on the command line.
pub struct Family {
    pub name: &'static str,
    /// A commented job file that works unchanged.
    pub new_job: &'static str,
    /// Resident macros with default settings, each with its file name in `macros/`.
    pub resident: fn() -> Vec<(&'static str, Program)>,
}

/// All families.
pub const ALL: &[Family] = &[pin_holes::FAMILY, honeycomb::FAMILY, burr::FAMILY, alignment::FAMILY];

/// Returns the family of a job.
pub fn of(job: &Job) -> &'static Family {
    match job {
        Job::PinHoles(_) => &pin_holes::FAMILY,
        Job::Honeycomb(_) => &honeycomb::FAMILY,
        Job::Burr(_) => &burr::FAMILY,
        Job::Alignment(_) => &alignment::FAMILY,
    }
}

/// Emits the programs of a job.
pub fn emit(job: &Job) -> Package {
    match job {
        Job::PinHoles(job) => pin_holes::emit(job),
        Job::Honeycomb(job) => honeycomb::emit(job),
        Job::Burr(job) => burr::emit(job),
        Job::Alignment(job) => alignment::emit(job),
    }
}
