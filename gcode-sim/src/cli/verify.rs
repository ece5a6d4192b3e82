//! `gcode-sim verify`: a program's holes against a reference.
use super::args::{TextFormat, VerifyArguments};
use super::{Refusal, Status, options, output, render};
use crate::report::verdict_table::{Layout, table};
use crate::session;
use crate::verify::{Answer, Tolerances};

pub(super) fn run(arguments: &VerifyArguments) -> Result<Status, Refusal> {
    let asked = options::tolerance("--tolerance", arguments.tolerance)?;
    let depth = options::tolerance("--depth-tolerance", arguments.depth_tolerance)?;
    let (request, mut folders) = options::request(&arguments.program)?;
    let reference = options::reference(&arguments.reference)?;
    let mut tolerances = Tolerances::of(&reference, asked);
    tolerances.depth = depth.unwrap_or(tolerances.depth);
    let simulation = session::simulate(&request, &mut folders, reference.surface)
        .map_err(|error| Refusal::new(error.to_string()))?;
    let verdict = simulation.verify(&reference, tolerances, &request.machine);
    match arguments.format {
        TextFormat::Json => output::json(&verdict)?,
        TextFormat::Text => {
            let layout = Layout { worst_first: arguments.worst_first, full: arguments.full };
            output::print(&table(&verdict, layout))?;
        }
    }
    if let Some(path) = &arguments.picture {
        let view = render::view(&request, &simulation, &reference, &verdict);
        render::write(&view, "1600x1200", path)?;
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
