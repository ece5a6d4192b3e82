//! `gcode-sim new`: files to start from: a machine file, a list of holes, a project's file.
mod machine;
mod project;
mod reference;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::{ExitStatus, UsageError, output, overwrite_guard};

#[derive(Debug, Args)]
#[command(arg_required_else_help = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    file: File,
}

#[derive(Debug, Subcommand)]
enum File {
    /// Write a commented machine file for a kind of machine
    #[command(after_help = "\
Examples:
  gcode-sim new machine --kind 3-axis -o machine.toml
  gcode-sim new machine --kind trunnion --dialect fanuc-0i-f -o machine.toml")]
    Machine(machine::Arguments),

    /// Write the holes that a program makes as a reference, to be corrected against the drawing
    #[command(after_help = "\
Examples:
  gcode-sim new reference --from O1234.nc -o O1234.csv
  gcode-sim new reference --from O1234.nc --clearance 2. --machine machine.toml -o O1234.json

It is no proof of the program: every hole is where the program makes it. Compare each number with the drawing, and
correct those that differ; then run gcode-sim verify with the list.")]
    Reference(Box<reference::Arguments>),

    /// Write a commented project file, gcode.toml
    #[command(after_help = "\
Example:
  gcode-sim new project -o gcode.toml")]
    Project(project::Arguments),
}

/// The file to write.
#[derive(Debug, Args)]
struct OutputFile {
    /// The file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
}

impl OutputFile {
    /// Prints the text, or writes it to the file unless that one has other contents.
    fn write(&self, text: &str) -> Result<(), UsageError> {
        match &self.output {
            None => output::print(text),
            Some(path) => {
                overwrite_guard::write_new(path, text, self.force)?;
                output::print(&format!("written: {}\n", path.display()))
            }
        }
    }

    fn path(&self) -> Option<&Path> {
        self.output.as_deref()
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    match &arguments.file {
        File::Machine(arguments) => machine::run(arguments),
        File::Reference(arguments) => reference::run(arguments),
        File::Project(arguments) => project::run(arguments),
    }
}
