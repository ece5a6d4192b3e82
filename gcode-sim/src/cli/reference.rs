//! `gcode-sim reference`: what the part should get, from the job's geometry alone.
use super::args::ReferenceArguments;
use super::{Refusal, Status, holes, input};
use crate::job::Job;
use crate::part::wanted::Wanted;

pub(super) fn run(arguments: &ReferenceArguments) -> Result<Status, Refusal> {
    let named = |error: &dyn std::fmt::Display| Refusal::new(format!("{}, {error}", arguments.job.display()));
    let job = Job::parse(&input::text(&arguments.job)?).map_err(|e| named(&e))?;
    match Wanted::of_job(&job).map_err(|e| named(&e))? {
        Wanted::Holes(reference) => holes::print(&reference.list(), arguments.format)?,
    }
    Ok(Status::Holds)
}
