//! `gcode-sim diff`: what two revisions of a program do differently.
use super::args::{DiffArguments, TextFormat};
use super::{Refusal, Status, options, output, render};
use crate::changes::{Revision, changes};
use crate::part::reference::Reference;
use crate::report::changes::ChangesReport;
use crate::report::diagnostic;
use crate::verify::Tolerances;

pub(super) fn run(arguments: &DiffArguments) -> Result<Status, Refusal> {
    let tolerance = options::tolerance("--tolerance", Some(arguments.tolerance))?.unwrap_or_default();
    let (old_request, mut old_folders) = options::request(&arguments.run.of(&arguments.old))?;
    let (new_request, mut new_folders) = options::request(&arguments.run.of(&arguments.new))?;
    let refused = |error: crate::session::SessionError| Refusal::new(error.to_string());
    let old = Revision::of(&old_request, &mut old_folders).map_err(refused)?;
    let new = Revision::of(&new_request, &mut new_folders).map_err(refused)?;
    let found = changes(&old, &new, tolerance);
    let report = ChangesReport::new((&old_request.name, &old), (&new_request.name, &new), &found, tolerance);
    match arguments.format {
        TextFormat::Json => output::json(&report)?,
        TextFormat::Text => output::print(&report.text())?,
    }
    if let Some(path) = &arguments.picture {
        // The old holes are what the new ones are held against: the picture marks what is off, lost and added.
        let mut list = old.simulation.list();
        for (index, hole) in list.holes.iter_mut().enumerate() {
            hole.id = Some((index + 1).to_string());
        }
        let reference = Reference::of_list(list).map_err(|error| Refusal::new(error.to_string()))?;
        let tolerances = Tolerances { position: 2.0 * tolerance, depth: tolerance, diameter: tolerance };
        let verdict = new.simulation.verify(&reference, tolerances, &new_request.machine);
        let view = render::view(&new_request, &new.simulation, &reference, &verdict);
        render::write(&view, "1600x1200", path)?;
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
