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

/// One family by the name that job files and the command line use.
pub struct Family {
    pub name: &'static str,
    /// A commented job file that works as it is.
    pub new_job: &'static str,
    /// The resident macros as the default settings have them, each with its file's name in `macros/`.
    pub resident: fn() -> Vec<(&'static str, Program)>,
}

/// Every family there is.
pub const ALL: &[Family] = &[pin_holes::FAMILY, honeycomb::FAMILY, burr::FAMILY, alignment::FAMILY];

/// The family of a job.
pub fn of(job: &Job) -> &'static Family {
    match job {
        Job::PinHoles(_) => &pin_holes::FAMILY,
        Job::Honeycomb(_) => &honeycomb::FAMILY,
        Job::Burr(_) => &burr::FAMILY,
        Job::Alignment(_) => &alignment::FAMILY,
    }
}

/// The programs of a job.
pub fn emit(job: &Job) -> Package {
    match job {
        Job::PinHoles(job) => pin_holes::emit(job),
        Job::Honeycomb(job) => honeycomb::emit(job),
        Job::Burr(job) => burr::emit(job),
        Job::Alignment(job) => alignment::emit(job),
    }
}
