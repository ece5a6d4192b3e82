//! Conditions of a run: the arguments of every command that executes a program.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::common;
use gcode_inspect::verify::denied_assumptions;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_part::{Assumption, Total};

/// What a result must not rest on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum DeniedKind {
    /// Values that the run reads and nothing in the program sets
    Assumptions,
}

/// Flag that denies assumptions.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(super) struct DenyArguments {
    /// Fail if a hole or a flute depends on a value that the run reads and nothing in the program sets: a common variable, an
    /// input, a clock, a block skip, an offset, an M code of the machine builder
    #[arg(long, value_name = "WHAT", value_enum)]
    deny: Option<DeniedKind>,
}

impl DenyArguments {
    /// Returns true if assumptions are denied.
    pub(super) fn denies_assumptions(self) -> bool {
        self.deny == Some(DeniedKind::Assumptions)
    }

    /// Returns the errors of assumptions that are denied; `total` is the number of all holes.
    pub(super) fn errors(self, assumptions: &[(Assumption, Backtrace)], total: Total) -> Vec<Diagnostic> {
        if self.denies_assumptions() { denied_assumptions(assumptions, total) } else { Vec::new() }
    }
}

/// A program and the conditions of its run.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct ProgramArguments {
    /// The main program; '-' reads standard input
    #[arg(value_name = "PROGRAM.nc")]
    pub(super) program: PathBuf,

    #[command(flatten)]
    pub(super) conditions: RunConditions,
}

/// The conditions of a run without its program.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Machine, control and start of the run")]
pub(super) struct RunConditions {
    /// The main program of a file with several, by O number, name or path in a dump, e.g. O1234 or
    /// //CNC_MEM/USER/PATH1/O1234 [default: the first, or the main one if the first
    /// is a subprogram]
    #[arg(long = "program", value_name = "O1234")]
    pub(super) main_program: Option<String>,

    /// A folder that holds called programs (repeatable; the program's own folder is searched first)
    #[arg(long = "lib", value_name = "DIR")]
    pub(super) libraries: Vec<PathBuf>,

    /// Set a common variable before the start, e.g. '#500=12.5' (repeatable)
    #[arg(long, value_name = "#N=VALUE")]
    pub(super) set: Vec<String>,

    /// Where an axis stands before the start, in the work coordinates active then, e.g. Z=250. (repeatable); overrides
    /// [start] in the machine file
    #[arg(long, value_name = "AXIS=POSITION", allow_hyphen_values = true)]
    pub(super) start: Vec<String>,

    /// The control: fanuc-31i, fanuc-0i-f or haas-ngc
    #[arg(long, value_name = "NAME")]
    pub(super) dialect: Option<String>,

    /// Stop after this many blocks
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    pub(super) max_blocks: u64,

    /// A setting of the control, e.g. NAT=1, DPI=1, BDT=1+2, 5115=0.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) control: Vec<String>,

    /// A file of such settings (TOML): NAT = 1, 5115 = 0.5, ROA = "A"; flags override it
    #[arg(long, value_name = "CONTROL.toml")]
    pub(super) control_file: Option<PathBuf>,

    /// An input signal, a setting or a parameter that the program reads, e.g. '#1005=1' (repeatable)
    #[arg(long, value_name = "#N=VALUE")]
    pub(super) input: Vec<String>,

    /// The machine: axes, rotary sign, head, tools, offsets [default: that of gcode.toml, machine.toml beside the program,
    /// or X, Y, Z and a rotary B about Y]
    #[arg(long, value_name = "MACHINE.toml")]
    pub(super) machine: Option<PathBuf>,

    /// A code that calls a program (G201=9010, M6=9001, T=9000), waits (G4.1=wait) or does nothing here (M10=nothing) (repeatable)
    #[arg(long, value_name = "CODE=PROGRAM")]
    pub(super) code: Vec<String>,

    /// G31 stops after this fraction of its path, 0 to 1
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true, value_parser = common::number)]
    pub(super) skip: Option<f64>,

    #[arg(
        long,
        value_name = "FILE",
        help = "The part for probing, a job file or a list of holes in the [stock]: G31 stops where the ball of [probe] touches it \
                [default: the [stock] of a machine file with [probe]]"
    )]
    pub(super) part: Option<PathBuf>,

    /// End the run at the main program's N-th M99
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) cycles: Option<u32>,
}

impl RunConditions {
    /// Combines these conditions with a program.
    pub(super) fn of(&self, program: &Path) -> ProgramArguments {
        ProgramArguments { program: program.to_owned(), conditions: self.clone() }
    }

    /// Returns the input files besides programs.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.machine, &self.control_file, &self.part].into_iter().filter_map(|file| file.as_deref())
    }
}
