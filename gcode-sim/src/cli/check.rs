//! `gcode-sim check`: what can be known of a program without running it.
use super::args::{CheckArguments, RunConditions, TextFormat};
use super::{Refusal, Status, options, output};
use crate::check::check;
use crate::report::check::{CheckReport, text};

pub(super) fn run(arguments: &CheckArguments) -> Result<Status, Refusal> {
    let conditions = RunConditions {
        libraries: arguments.libraries.clone(),
        dialect: arguments.dialect.clone(),
        control: arguments.control.clone(),
        control_file: arguments.control_file.clone(),
        machine: arguments.machine.clone(),
        code: arguments.code.clone(),
        ..RunConditions::default()
    };
    let (request, mut folders) = options::request(&conditions.of(&arguments.program))?;
    let checked = check(request.name.clone(), request.bytes, &request.settings, &mut folders);
    if checked.programs == 0 {
        return Err(Refusal::new(format!("{} holds no program", request.name)));
    }
    match arguments.format {
        TextFormat::Text => output::print(&text(&checked))?,
        TextFormat::Json => output::json(&CheckReport::new(&checked))?,
    }
    Ok(if checked.stands() { Status::Fails } else { Status::Holds })
}
