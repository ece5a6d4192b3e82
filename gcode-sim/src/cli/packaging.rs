//! Shell completions and manual pages of either program.
use std::path::PathBuf;

use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use super::{ExitStatus, UsageError, output};

/// The shell of a completion script.
#[derive(Debug, Args)]
pub struct ShellArguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// The folder of the manual pages.
#[derive(Debug, Args)]
pub struct ManArguments {
    /// The folder for the pages
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Prints the completion script of a shell for a program's commands and flags.
pub fn completions<A: CommandFactory>(arguments: &ShellArguments) -> Result<ExitStatus, UsageError> {
    let mut command = A::command();
    let name = command.get_name().to_owned();
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, name, &mut text);
    output::print(&String::from_utf8_lossy(&text))?;
    Ok(ExitStatus::Passed)
}

/// Writes `gcode-sim.1`, `gcode-sim-run.1` and so on, all or none.
pub fn man<A: CommandFactory>(arguments: &ManArguments) -> Result<ExitStatus, UsageError> {
    let pages = pages(A::command()).map_err(|error| UsageError::new(format!("no manual page: {error}")))?;
    let files: Vec<(PathBuf, Vec<u8>)> =
        pages.into_iter().map(|(name, text)| (arguments.folder.join(name), text)).collect();
    output::write_all(&files)?;
    Ok(ExitStatus::Passed)
}

/// Returns the pages of the program and of each command, with their file names.
fn pages(command: Command) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let below: Vec<Command> = command.get_subcommands().cloned().collect();
    std::iter::once(command)
        .chain(below)
        .map(|command| {
            let man = Man::new(command);
            let mut text = Vec::new();
            man.render(&mut text)?;
            Ok((man.get_filename(), text))
        })
        .collect()
}
