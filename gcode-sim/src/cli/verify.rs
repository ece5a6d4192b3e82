//! `gcode-sim verify`: a program against a reference, by what the part should get.
use super::args::{TextFormat, VerifyArguments};
use super::library::Folders;
use super::{Refusal, Status, options, output, render};
use crate::part::reference::Reference;
use crate::part::wanted::Wanted;
use crate::picture;
use crate::report::verdict_table::{Layout, table};
use crate::session::{self, Request};
use crate::verify::{Answer, Tolerances};

pub(super) fn run(arguments: &VerifyArguments) -> Result<Status, Refusal> {
    let asked = options::tolerance("--tolerance", arguments.tolerance)?;
    let depth = options::tolerance("--depth-tolerance", arguments.depth_tolerance)?;
    let (request, folders) = options::request(&arguments.program)?;
    match options::wanted(&arguments.reference)? {
        Wanted::Holes(reference) => {
            let mut tolerances = Tolerances::of(&reference, asked);
            tolerances.depth = depth.unwrap_or(tolerances.depth);
            holes(arguments, &request, folders, &reference, tolerances)
        }
    }
}

fn holes(
    arguments: &VerifyArguments,
    request: &Request,
    mut folders: Folders,
    reference: &Reference,
    tolerances: Tolerances,
) -> Result<Status, Refusal> {
    let simulation = session::simulate(request, &mut folders, reference.surface)
        .map_err(|error| Refusal::new(error.to_string()))?;
    let verdict = simulation.verify(reference, tolerances, &request.machine);
    match arguments.format {
        TextFormat::Json => output::json(&verdict)?,
        TextFormat::Text => {
            let layout = Layout { worst_first: arguments.worst_first, full: arguments.full };
            output::print(&table(&verdict, layout))?;
        }
    }
    if let Some(path) = &arguments.picture {
        let view = render::view(request, &simulation, reference, &verdict);
        render::write(&picture::main_view(&view), "1600x1200", path)?;
        if arguments.format == TextFormat::Text {
            output::print(&format!("picture: {}\n", path.display()))?;
        }
    }
    let status = super::findings(&verdict.diagnostics, &simulation.run);
    Ok(match verdict.verdict {
        Answer::Fail if status == Status::Holds => Status::Fails,
        _ => status,
    })
}
