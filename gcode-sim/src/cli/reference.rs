//! `gcode-sim reference`: what the part should get, from the job's geometry alone.
use super::args::ReferenceArguments;
use super::{Refusal, Status, holes, input};
use crate::job::Job;
use crate::part::reference::Reference;

pub(super) fn run(arguments: &ReferenceArguments) -> Result<Status, Refusal> {
    let named = |error: &dyn std::fmt::Display| Refusal::new(format!("{}, {error}", arguments.job.display()));
    let job = Job::parse(&input::text(&arguments.job)?).map_err(|e| named(&e))?;
    let reference = Reference::of_job(&job).map_err(|e| named(&e))?;
    holes::print(&reference.list(), arguments.format)?;
    Ok(Status::Holds)
}
