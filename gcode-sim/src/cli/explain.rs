//! `gcode-sim explain`: the page of a code.
use super::args::ExplainArguments;
use super::{Refusal, Status, output};
use crate::report::explain;

pub(super) fn run(arguments: &ExplainArguments) -> Result<Status, Refusal> {
    let Some(code) = &arguments.code else {
        output::print(&explain::list())?;
        return Ok(Status::Holds);
    };
    let unknown = || {
        Refusal::new(format!(
            "{code} is none of this simulator's alarms and findings: gcode-sim explain --list names them"
        ))
    };
    output::print(&explain::find(code).ok_or_else(unknown)?.shown())?;
    Ok(Status::Holds)
}
