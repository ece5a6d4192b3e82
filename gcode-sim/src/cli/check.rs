//! `gcode-sim check`: finds faults of a program without running it.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use super::conditions::RunConditions;
use super::format::FindingFormat;
use super::project::Project;
use super::{ExitStatus, UsageError, options, output, unused_machine};
use crate::report::check::{CheckReport, text};
use crate::report::sarif::Finding;
use gcode_lang::program::Memory;
use gcode_lint::{CheckResult, ControlKnowledge};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The program; '-' reads standard input
    #[arg(value_name = "PROGRAM.nc")]
    program: PathBuf,

    /// A folder that holds called programs (repeatable; the program's own folder is searched first)
    #[arg(long = "lib", value_name = "DIR")]
    libraries: Vec<PathBuf>,

    /// The control: fanuc-31i, fanuc-0i-f or haas-ngc
    #[arg(long, value_name = "NAME")]
    dialect: Option<String>,

    /// A setting of the control, e.g. DPI=1 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    control: Vec<String>,

    /// A file of such settings (TOML): NAT = 1, 5115 = 0.5, ROA = "A"; flags override it
    #[arg(long, value_name = "CONTROL.toml")]
    control_file: Option<PathBuf>,

    /// The machine: its axes and its control [default: that of gcode.toml, machine.toml beside the program, or
    /// X, Y, Z and a rotary B about Y]
    #[arg(long, value_name = "MACHINE.toml")]
    machine: Option<PathBuf>,

    /// A code that calls a program (G201=9010, M6=9001, T=9000), waits (G4.1=wait) or does nothing here (M10=nothing) (repeatable)
    #[arg(long, value_name = "CODE=PROGRAM")]
    code: Vec<String>,

    /// Show each place of a finding, not the first in each file with the lines of the others
    #[arg(long)]
    all: bool,

    /// Output format
    #[arg(long, value_enum, default_value_t = FindingFormat::Text)]
    format: FindingFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let conditions = RunConditions {
        libraries: arguments.libraries.clone(),
        dialect: arguments.dialect.clone(),
        control: arguments.control.clone(),
        control_file: arguments.control_file.clone(),
        machine: arguments.machine.clone(),
        code: arguments.code.clone(),
        ..RunConditions::default()
    };
    let (program, project) = conditions.of(&arguments.program).completed()?;
    project.check_rules()?;
    let (request, mut folders) = options::request(&program)?;
    unused_machine::warn_unused_control(&program, &request);
    let mut memory = Memory::default();
    memory.load(request.name.clone(), request.bytes);
    let is_stated = program.conditions.machine.is_some() || program.conditions.control_file.is_some();
    let knowledge = if is_stated { ControlKnowledge::Stated } else { ControlKnowledge::Assumed };
    let mut checked = gcode_lint::check_loaded(memory, &request.settings, knowledge, &mut folders);
    leave_out_allowed(&mut checked, &project);
    if checked.programs == 0 {
        return Err(UsageError::new(format!("{} contains no program", request.name)));
    }
    match arguments.format {
        FindingFormat::Text => output::print(&text(&checked, arguments.all))?,
        FindingFormat::Json => output::json(&CheckReport::new(&checked))?,
        FindingFormat::Sarif => {
            let sources = checked.memory.sources();
            output::sarif(checked.findings.iter().map(|finding| Finding::of(finding, sources)), None)?;
        }
    }
    Ok(if checked.has_findings() { ExitStatus::Failed } else { ExitStatus::Passed })
}

/// Removes the findings that the project's file allows in the folder of their file.
fn leave_out_allowed(checked: &mut CheckResult, project: &Project) {
    let sources = checked.memory.sources();
    let mut known = BTreeMap::new();
    checked.findings.retain(|finding| {
        let Some(place) = &finding.backtrace else { return true };
        let (rule, source) = (finding.kind.code, place.block.source);
        let is_allowed = known
            .entry((rule, source))
            .or_insert_with(|| project.allows(rule, Path::new(&sources.get(source).name)));
        !*is_allowed
    });
}
