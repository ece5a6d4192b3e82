//! `gcode-sim explain`: the page of a code.
use clap::Args;

use super::{Refusal, Status, output};
use crate::report::explain;

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// An alarm as the control shows it (PS0112, ps112, 112, MC3021) or a finding (hole-position)
    #[arg(value_name = "CODE", required_unless_present = "list")]
    code: Option<String>,

    /// Name all codes that can be explained
    #[arg(long, conflicts_with = "code")]
    list: bool,
}

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
    let pages: Vec<String> = explain::pages(code).map(|page| page.shown()).collect();
    if pages.is_empty() {
        return Err(unknown());
    }
    output::print(&pages.join("\n"))?;
    Ok(Status::Holds)
}
