//! The part families: each turns its job into programs.
pub mod pin_holes;

use gcode_sim::job::Job;

use crate::package::Package;

/// One family by the name that job files and the command line use.
pub struct Family {
    pub name: &'static str,
    /// A commented job file that works as it is.
    pub new_job: &'static str,
}

/// Every family there is.
pub const ALL: &[Family] = &[pin_holes::FAMILY];

/// The programs of a job.
pub fn emit(job: &Job) -> Package {
    match job {
        Job::PinHoles(job) => pin_holes::emit(job),
    }
}
