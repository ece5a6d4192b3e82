//! The command line as written: clap's types, and the help texts with their examples.
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::front::Colours;

/// Executes Fanuc Custom Macro B programs as the control would, follows the tool on the part, and holds the
/// holes against a reference.
#[derive(Debug, Parser)]
#[command(name = "gcode-sim", version, max_term_width = 100, after_help = EXIT_CODES)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,

    #[command(flatten)]
    pub(super) colours: Colours,
}

const EXIT_CODES: &str = "\
Exit codes:
  0  done, and what was asked about holds
  1  done, and the answer is no: out of tolerance, missing or extra holes, findings, a difference
  2  the request can't be used: bad flag, unreadable file, malformed job or reference
  3  the control stopped with an alarm, or a limit ended the run

A program is simulated, not measured: every number printed here is a prediction.";

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Execute a program and show the end state
    #[command(after_help = "\
Examples:
  gcode-sim run O8100.nc
  gcode-sim run O1234.nc --lib macros --set '#500=12.5' --format json
  gcode-sim run O1234.nc --control NAT=1 --control DPI=1 --show '#5041'
  gcode-sim run O1234.nc --machine machine.toml --part job.toml --show '#5061'")]
    Run(RunArguments),

    /// List the holes a program makes, in the part's frame
    #[command(after_help = "\
Examples:
  gcode-sim holes O8100.nc
  gcode-sim holes O8100.nc --machine machine.toml --format json > holes.json")]
    Holes(HolesArguments),

    /// Compute the holes the part should get, from a job file's geometry alone
    #[command(after_help = "\
Examples:
  gcode-sim reference job.toml > reference.json
  gcode-sim reference job.toml --format csv")]
    Reference(ReferenceArguments),

    /// Hold a program's holes against a reference: position (ISO 1101), depth, missing and extra holes
    #[command(after_help = "\
Examples:
  gcode-sim verify O8100.nc --reference job.toml
  gcode-sim verify O8100.nc --reference reference.csv --tolerance 0.1 --worst-first
  gcode-sim verify O8100.nc --reference job.toml --machine machine.toml --format json
  gcode-sim verify O8100.nc --reference job.toml --picture top.png")]
    Verify(VerifyArguments),

    /// Draw a program's holes on the part as a PNG
    #[command(after_help = "\
Examples:
  gcode-sim render O8100.nc -o top.png
  gcode-sim render O8100.nc --reference job.toml -o top.png --size 1600x1200")]
    Render(RenderArguments),

    /// Find faults without running: jumps to nowhere, lost points, variables never set, and more
    #[command(after_help = "\
Examples:
  gcode-sim check O8100.nc
  gcode-sim check O1234.nc --lib macros --format json

A comment (CHECK-OFF DOUBLED-N) on a block silences that rule there, at the head of a program in all of it.")]
    Check(CheckArguments),

    /// Compare two revisions of a program by what they do: holes, motion, stops, what they leave behind
    #[command(after_help = "\
Examples:
  gcode-sim diff old/O8100.nc new/O8100.nc
  gcode-sim diff old/O8100.nc new/O8100.nc --tolerance 0.01 --picture changes.png
  git show HEAD:O8100.nc | gcode-sim diff - O8100.nc

Sequence numbers, spaces, comments, names of locals and the way numbers are written make no difference.
Called programs come from each revision's own folder first, then from --lib.
Exit code 0: nothing changes; 1: something does; 3: a revision stops with an alarm or a limit.")]
    Diff(DiffArguments),

    /// Run a folder of programs and hold each against what was accepted of it
    #[command(after_help = "\
Examples:
  gcode-sim test programs
  gcode-sim test programs --lib macros --shard 2/4 --format json
  gcode-sim test programs --only flange --accept

A case is a folder with a program (main.nc, or the only .nc in it) and, where they are wanted, lib/, machine.toml,
control.toml, a reference (reference.json, reference.csv or job.toml), and accepted.json, which --accept writes.")]
    Test(TestArguments),

    /// Tell how far the holes of many parts would be off, on machines and set-ups with errors
    #[command(after_help = "\
Examples:
  gcode-sim budget job.toml --errors errors.toml --samples 200000 --seed 1
  gcode-sim budget job.toml --errors errors.toml --format json
  gcode-sim budget job.toml --errors errors.toml --picture shares.png")]
    Budget(BudgetArguments),

    /// List the settings of the control that --control takes
    Settings,

    /// Tell what an alarm or a finding means, with an example and what to write instead
    #[command(after_help = "\
Examples:
  gcode-sim explain PS0112
  gcode-sim explain 112
  gcode-sim explain hole-position
  gcode-sim explain --list")]
    Explain(ExplainArguments),

    /// Compare two pictures and mark what differs
    #[command(after_help = "\
Example:
  gcode-sim compare before.png after.png -o differences.png")]
    Compare(CompareArguments),
}

/// The program, and everything its run depends on.
#[derive(Debug, Default, Args)]
pub(super) struct ProgramArguments {
    /// The main program; '-' reads standard input
    #[arg(value_name = "PROGRAM.nc")]
    pub(super) program: PathBuf,

    #[command(flatten)]
    pub(super) conditions: RunConditions,
}

/// Everything a run depends on but its program.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct RunConditions {
    /// A folder that holds called programs (repeatable; the program's own folder is searched first)
    #[arg(long = "lib", value_name = "DIR")]
    pub(super) libraries: Vec<PathBuf>,

    /// Set a common variable before the start, e.g. '#500=12.5' (repeatable)
    #[arg(long, value_name = "#N=VALUE")]
    pub(super) set: Vec<String>,

    /// The control: fanuc-31i, fanuc-0i-f or haas-ngc
    #[arg(long, value_name = "NAME")]
    pub(super) dialect: Option<String>,

    /// Stop after this many blocks
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    pub(super) max_blocks: u64,

    /// A setting of the control, e.g. NAT=1, DPI=1, BDT=1+2, 5115=0.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) control: Vec<String>,

    /// A file of such settings (TOML): NAT = 1, 5115 = 0.5, ROA = "A"; flags go before it
    #[arg(long, value_name = "CONTROL.toml")]
    pub(super) control_file: Option<PathBuf>,

    /// An input signal, e.g. '#1005=1' (repeatable)
    #[arg(long, value_name = "#N=0|1")]
    pub(super) input: Vec<String>,

    /// The machine: axes, rotary sign, head, tools, offsets [default: the machine of the paper]
    #[arg(long, value_name = "MACHINE.toml")]
    pub(super) machine: Option<PathBuf>,

    /// A code that calls a program, e.g. G201=9010, M50=9020, M6=9001 or T=9000 (repeatable)
    #[arg(long, value_name = "CODE=PROGRAM")]
    pub(super) code: Vec<String>,

    /// G31 stops after this part of its path, 0 to 1
    #[arg(long, value_name = "PART", allow_negative_numbers = true)]
    pub(super) skip: Option<f64>,

    /// The part that is there to be probed: G31 stops where the ball of the machine's or the job's [probe] touches it
    #[arg(long, value_name = "JOB.toml")]
    pub(super) part: Option<PathBuf>,

    /// End the run at the main program's N-th M99
    #[arg(long, value_name = "N")]
    pub(super) cycles: Option<u32>,
}

impl RunConditions {
    /// These, and a program.
    pub(super) fn of(&self, program: &Path) -> ProgramArguments {
        ProgramArguments { program: program.to_owned(), conditions: self.clone() }
    }
}

#[derive(Debug, Args)]
pub(super) struct RunArguments {
    #[command(flatten)]
    pub(super) program: ProgramArguments,

    /// Add every move to the result, in machine coordinates
    #[arg(long)]
    pub(super) moves: bool,

    /// Write what the program prints (DPRNT, BPRNT) to this file
    #[arg(long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// Show a system variable at the end, e.g. '#5041' (repeatable)
    #[arg(long, value_name = "#N")]
    pub(super) show: Vec<String>,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

#[derive(Debug, Args)]
pub(super) struct HolesArguments {
    #[command(flatten)]
    pub(super) program: ProgramArguments,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    pub(super) format: ListFormat,
}

#[derive(Debug, Args)]
pub(super) struct ReferenceArguments {
    /// The job file
    #[arg(value_name = "JOB.toml")]
    pub(super) job: PathBuf,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = ListFormat::Json)]
    pub(super) format: ListFormat,
}

#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    #[command(flatten)]
    pub(super) program: ProgramArguments,

    /// What the part should get: a hole list (JSON or CSV) or a job file (TOML)
    #[arg(long, value_name = "REF")]
    pub(super) reference: PathBuf,

    /// Diameter of the tolerance zone, or how far a burr's contact may be off its surface, mm [default: the
    /// job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) tolerance: Option<f64>,

    /// How far a hole's depth may be off, mm [default: the job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) depth_tolerance: Option<f64>,

    /// List the worst hole first
    #[arg(long)]
    pub(super) worst_first: bool,

    /// All of an inspector's columns: nominal and actual x y z i j k d l
    #[arg(long)]
    pub(super) full: bool,

    /// Also draw to this file: the top view of holes, a cylinder unrolled, or a burr from the side
    #[arg(long, value_name = "OUT.png")]
    pub(super) picture: Option<PathBuf>,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

#[derive(Debug, Args)]
pub(super) struct RenderArguments {
    #[command(flatten)]
    pub(super) program: ProgramArguments,

    /// The picture to write
    #[arg(short, long, value_name = "OUT.png")]
    pub(super) output: PathBuf,

    /// What the part should get: draws the outline, each hole's verdict and its misfit
    #[arg(long, value_name = "REF")]
    pub(super) reference: Option<PathBuf>,

    /// Diameter of the tolerance zone, mm [default: the job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) tolerance: Option<f64>,

    /// Which way to look [default: top, or side for a burr]
    #[arg(long, value_enum)]
    pub(super) view: Option<View>,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1200")]
    pub(super) size: String,
}

#[derive(Debug, Args)]
pub(super) struct BudgetArguments {
    /// The job file: the holes, and the machine they are drilled on
    #[arg(value_name = "JOB.toml")]
    pub(super) job: PathBuf,

    /// What set-up and machine are off by
    #[arg(long, value_name = "ERRORS.toml")]
    pub(super) errors: PathBuf,

    /// How many parts are drawn
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub(super) samples: usize,

    /// Another seed draws other parts
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(super) seed: u64,

    /// The machine, without errors [default: the one that goes with the job]
    #[arg(long, value_name = "MACHINE.toml")]
    pub(super) machine: Option<PathBuf>,

    /// Diameter of the tolerance zone, mm [default: the job's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) tolerance: Option<f64>,

    /// On how many threads; the answer doesn't depend on it [default: as many as there are processors]
    #[arg(long, value_name = "N")]
    pub(super) threads: Option<std::num::NonZeroUsize>,

    /// Also draw each source's share to this file
    #[arg(long, value_name = "OUT.png")]
    pub(super) picture: Option<PathBuf>,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// An alarm as the control shows it (PS0112, ps112, 112, MC3021) or a finding (hole-position)
    #[arg(value_name = "CODE", required_unless_present = "list")]
    pub(super) code: Option<String>,

    /// Name all codes that can be explained
    #[arg(long, conflicts_with = "code")]
    pub(super) list: bool,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// The program; '-' reads standard input
    #[arg(value_name = "PROGRAM.nc")]
    pub(super) program: PathBuf,

    /// A folder that holds called programs (repeatable; the program's own folder is searched first)
    #[arg(long = "lib", value_name = "DIR")]
    pub(super) libraries: Vec<PathBuf>,

    /// The control: fanuc-31i, fanuc-0i-f or haas-ngc
    #[arg(long, value_name = "NAME")]
    pub(super) dialect: Option<String>,

    /// A setting of the control, e.g. DPI=1 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) control: Vec<String>,

    /// A file of such settings (TOML): NAT = 1, 5115 = 0.5, ROA = "A"; flags go before it
    #[arg(long, value_name = "CONTROL.toml")]
    pub(super) control_file: Option<PathBuf>,

    /// The machine: its axes and its control [default: the machine of the paper]
    #[arg(long, value_name = "MACHINE.toml")]
    pub(super) machine: Option<PathBuf>,

    /// A code that calls a program, e.g. G201=9010, M50=9020, M6=9001 or T=9000 (repeatable)
    #[arg(long, value_name = "CODE=PROGRAM")]
    pub(super) code: Vec<String>,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

#[derive(Debug, Args)]
pub(super) struct DiffArguments {
    /// The revision on the machine
    #[arg(value_name = "OLD.nc")]
    pub(super) old: PathBuf,

    /// The revision to review
    #[arg(value_name = "NEW.nc")]
    pub(super) new: PathBuf,

    #[command(flatten)]
    pub(super) run: RunConditions,

    /// What differs by no more than this is the same, mm or degrees
    #[arg(long, value_name = "MM", default_value_t = 0.0001, allow_negative_numbers = true)]
    pub(super) tolerance: f64,

    /// Also draw the new holes over the old ones to this file
    #[arg(long, value_name = "OUT.png")]
    pub(super) picture: Option<PathBuf>,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

#[derive(Debug, Args)]
pub(super) struct TestArguments {
    /// Folders with cases, at any depth
    #[arg(value_name = "DIR", required = true)]
    pub(super) folders: Vec<PathBuf>,

    /// A folder that holds called programs, after each case's own folders (repeatable)
    #[arg(long = "lib", value_name = "DIR")]
    pub(super) libraries: Vec<PathBuf>,

    /// Only cases with this in their names (repeatable)
    #[arg(long, value_name = "NAME")]
    pub(super) only: Vec<String>,

    /// Only the K-th of N parts of the cases
    #[arg(long, value_name = "K/N")]
    pub(super) shard: Option<String>,

    /// Accept what came of the cases: write their accepted.json
    #[arg(long)]
    pub(super) accept: bool,

    /// What differs by no more than this is the same, mm or degrees
    #[arg(long, value_name = "MM", default_value_t = 0.0001, allow_negative_numbers = true)]
    pub(super) tolerance: f64,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    pub(super) format: TextFormat,
}

#[derive(Debug, Args)]
pub(super) struct CompareArguments {
    /// One picture
    #[arg(value_name = "A.png")]
    pub(super) left: PathBuf,

    /// The other picture
    #[arg(value_name = "B.png")]
    pub(super) right: PathBuf,

    /// Where to write the picture that marks what differs
    #[arg(short, long, value_name = "DIFF.png")]
    pub(super) output: Option<PathBuf>,

    /// How much a colour value may differ, 0 to 255
    #[arg(long, value_name = "STEPS", default_value_t = 1)]
    pub(super) tolerance: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum TextFormat {
    Text,
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ListFormat {
    Text,
    Json,
    Csv,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum View {
    /// Along the axis of revolution, or along a spindle that stands
    Top,
    /// A cylinder unrolled, with its seam; needs --reference with a job of a cylinder
    Development,
    /// A burr from the side
    Side,
    /// A burr from its tip
    Tip,
    /// A burr's helix angle over the polar angle, with both laws
    Helix,
}
