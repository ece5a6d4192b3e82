//! `gcode-sim diff`: what two revisions of a program do differently.
use std::path::PathBuf;

use clap::Args;

use super::args::{RunConditions, TextFormat};
use super::{Refusal, Status, options, output, render, unused_machine};
use crate::changes::{Revision, changes};
use crate::picture;
use crate::report::changes::ChangesReport;
use crate::report::{diagnostic, top};

#[derive(Debug, Args)]
pub(super) struct DiffArguments {
    /// The revision on the machine
    #[arg(value_name = "OLD.nc")]
    old: PathBuf,

    /// The revision to review
    #[arg(value_name = "NEW.nc")]
    new: PathBuf,

    #[command(flatten)]
    run: RunConditions,

    /// What differs by no more than this is the same, mm or degrees
    #[arg(long, value_name = "MM", default_value_t = 0.0001, allow_negative_numbers = true)]
    tolerance: f64,

    /// Also draw the new holes over the old ones to this file
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &DiffArguments) -> Result<Status, Refusal> {
    let tolerance = options::tolerance("--tolerance", Some(arguments.tolerance))?.unwrap_or_default();
    let (old_request, mut old_folders) = options::request(&arguments.run.of(&arguments.old))?;
    let (new_request, mut new_folders) = options::request(&arguments.run.of(&arguments.new))?;
    unused_machine::tell(&arguments.run.of(&arguments.new), &new_request);
    let refused = |error: crate::session::SessionError| Refusal::new(error.to_string());
    let old = Revision::of(&old_request, &mut old_folders, None).map_err(refused)?;
    let new = Revision::of(&new_request, &mut new_folders, None).map_err(refused)?;
    let found = changes(&old.record, &new.record, tolerance);
    let report = ChangesReport::new(
        (&old_request.name, &old.record),
        (&new_request.name, &new.record),
        &found,
        tolerance,
    );
    match arguments.format {
        TextFormat::Json => output::json(&report)?,
        TextFormat::Text => output::print(&report.text())?,
    }
    if let Some(path) = &arguments.picture {
        let name = format!("{} against {}", render::name(&new_request), render::name(&old_request));
        let view = top::of_changes(&name, &old.simulation, &new.simulation, &new_request.machine, tolerance);
        let scene = picture::top_view(&view.map_err(Refusal::new)?);
        render::write(&scene, "1600x1200", path)?;
        if arguments.format == TextFormat::Text {
            output::print(&format!("picture: {}\n", path.display()))?;
        }
    }
    let mut status = if found.is_empty() { Status::Holds } else { Status::Fails };
    for revision in [&old, &new] {
        let sources = revision.simulation.run.control.memory().sources();
        for finding in revision.stopped() {
            output::tell(&diagnostic::render(finding, sources));
            status = Status::Stopped;
        }
    }
    Ok(status)
}
