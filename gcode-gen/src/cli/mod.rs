//! The generator's command line: arguments in, exit status out. All printing and file access is in this
//! module.
mod emit;
mod emitted_files;
mod new;
mod prove;
mod sheet;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use gcode_sim::cli::common::{self, Colours};
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::packaging::{self, ManArguments, ShellArguments};
use gcode_sim::cli::{ExitStatus, UsageError, schema};

use crate::report::FORMATS;

/// Emits parametric Fanuc macro programs; the control computes the geometry.
#[derive(Debug, Parser)]
#[command(name = "gcode-gen", version, max_term_width = 100, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,

    #[command(flatten)]
    colours: Colours,
}

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  refused: the programs of this job fail verification, or a program was edited since; nothing is written
  2  the request is invalid: bad flag, unreadable or malformed job, unwritable folder

Results go to standard output, messages to standard error. --format json writes one document and nothing else; its \
schema is what `gcode-gen schema` prints for the command.

Every program is simulated and verified against the job's geometry before a file is written. That is a \
prediction, not a measurement.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a commented job file that works unchanged
    #[command(after_help = "\
Examples:
  gcode-gen new pin-holes
  gcode-gen new pin-holes -o job.toml")]
    New {
        /// The part family
        #[arg(value_parser = families())]
        family: String,
        /// The file to write [default: standard output]
        #[arg(short, long, value_name = "JOB.toml")]
        output: Option<PathBuf>,
        /// Replace the file if it exists
        #[arg(long)]
        force: bool,
    },

    /// Write the O-programs, the machine file and the picture of a job
    #[command(after_help = "\
Examples:
  gcode-gen emit job.toml --out nc
  gcode-sim verify nc/O8100.nc --reference job.toml --machine nc/machine.toml

emitted.sha256 in the folder lists the files as they were written. If a program or a picture has other \
contents, nothing is written without --force. A machine.toml with other contents is kept: the programs have \
to pass with it as well.")]
    Emit {
        /// The job file; '-' reads standard input
        #[arg(value_name = "JOB.toml")]
        job: PathBuf,
        /// The folder for the programs; created if it does not exist
        #[arg(short, long, value_name = "DIR")]
        out: PathBuf,
        /// Replace files of the folder that were edited, or that emit did not write
        #[arg(long)]
        force: bool,
        /// Output format
        #[arg(long, value_enum, default_value_t = TextFormat::Text)]
        format: TextFormat,
    },

    /// Write the set-up sheet of a job's programs: one HTML file, for paper and screens
    #[command(after_help = "\
Examples:
  gcode-gen sheet job.toml -o setup.html
  gcode-gen sheet job.toml -o setup.html --rates rates.toml

Part, drawing, minutes and rates come from the job's section [sheet]: see docs/setup-sheet.md.")]
    Sheet {
        /// The job file; '-' reads standard input
        #[arg(value_name = "JOB.toml")]
        job: PathBuf,
        /// The file to write
        #[arg(short, long, value_name = "SHEET.html")]
        output: PathBuf,
        /// Machine-hour rates, instead of the job's [sheet.rates]
        #[arg(long, value_name = "RATES.toml")]
        rates: Option<PathBuf>,
        /// Output format
        #[arg(long, value_enum, default_value_t = TextFormat::Text)]
        format: TextFormat,
    },

    /// Prove a job's resident macro for all values of its quantities at once
    #[command(after_help = "\
Example:
  gcode-gen prove job.toml --over 'hole.radius=0..1100' --over 'surface.a=500..2000'

Exit code 0: every claim is proved; 1: one is refuted or undecided; 2: the request can't be used. See docs/prove-reference.md.")]
    Prove(prove::Arguments),

    /// Write the JSON Schema (draft 2020-12) of a result to standard output
    #[command(after_help = "\
Example:
  gcode-gen schema emit

The schemas of job files and of gcode-sim's results: gcode-sim schema job")]
    Schema(SchemaArguments),

    /// Write shell completions to standard output
    #[command(after_help = "\
Example:
  gcode-gen completions bash > ~/.local/share/bash-completion/completions/gcode-gen")]
    Completions(ShellArguments),

    /// Write the manual pages into a folder, one for each command
    #[command(after_help = "\
Example:
  gcode-gen man ~/.local/share/man/man1")]
    Man(ManArguments),
}

#[derive(Debug, Args)]
struct SchemaArguments {
    /// The document
    #[arg(value_name = "NAME", value_parser = schema::names(FORMATS))]
    name: String,
}

fn families() -> clap::builder::PossibleValuesParser {
    crate::families::ALL.iter().map(|family| family.name).collect::<Vec<_>>().into()
}

/// Parses the arguments and executes the command; messages go to standard error.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitStatus {
    common::main(arguments, |arguments: &Arguments| arguments.colours, execute)
}

fn execute(arguments: Arguments) -> Result<ExitStatus, UsageError> {
    match &arguments.command {
        Command::New { family, output, force } => new::run(family, output.as_deref(), *force),
        Command::Emit { job, out, force, format } => emit::run(job, out, *force, *format),
        Command::Sheet { job, output, rates, format } => sheet::run(job, output, rates.as_deref(), *format),
        Command::Prove(arguments) => prove::run(arguments),
        Command::Schema(name) => schema::print(&name.name, FORMATS),
        Command::Completions(shell) => packaging::completions::<Arguments>(shell),
        Command::Man(folder) => packaging::man::<Arguments>(folder),
    }
}
