//! The command line's grammar: commands and their help texts with examples. The arguments of each command are
//! in its own file, shared ones in `conditions`.
use clap::{Parser, Subcommand};

use super::common::Colours;
use super::{
    budget, check, compare, diff, explain, holes, lsp, new, packaging, page_command, prove, readings,
    reference, render, run, schema, settings, sheet, test, verify,
};

/// Executes Fanuc Custom Macro B programs as the control does, follows the tool on the part, and compares the holes
/// with a reference.
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
  0  done, all checks passed
  1  done, a check failed: out of tolerance, missing or extra holes, findings, a difference
  2  the request is invalid: bad flag, unreadable file, malformed job or reference
  3  the control stopped with an alarm, or a limit ended the run

Results go to standard output, messages to standard error. --format json writes one document and nothing else; its \
schema is what `gcode-sim schema` prints for the command.

gcode.toml in the program's folder or one above gives machine, control, libraries and references; so does machine.toml \
beside the program for the machine. Flags win.

A program is simulated, not measured: every number printed here is a prediction.";

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Execute a program and show the end state
    #[command(after_help = "\
Examples:
  gcode-sim run O8100.nc
  gcode-sim run O1234.nc --lib macros --set '#500=12.5' --format json
  gcode-sim run ALL-PROG.TXT --program O1234
  gcode-sim run O1234.nc --control NAT=1 --control DPI=1 --show '#5041'
  gcode-sim run O1234.nc --machine machine.toml --part job.toml --show '#5061'")]
    Run(run::Arguments),

    /// List the holes a program makes, in the part's frame
    #[command(after_help = "\
Examples:
  gcode-sim holes O8100.nc
  gcode-sim holes O8100.nc --machine machine.toml --format json > holes.json")]
    Holes(holes::Arguments),

    /// Compute the nominal holes of a part from a job file's geometry alone
    #[command(after_help = "\
Examples:
  gcode-sim reference job.toml > reference.json
  gcode-sim reference job.toml --format csv")]
    Reference(reference::Arguments),

    /// Verify a program's holes against a reference: position (ISO 1101), depth, missing and extra holes
    #[command(after_help = "\
Examples:
  gcode-sim verify O8100.nc --reference job.toml
  gcode-sim verify O8100.nc --reference reference.csv --tolerance 0.1 --worst-first
  gcode-sim verify O8100.nc --reference job.toml --machine machine.toml --format json
  gcode-sim verify O8100.nc --reference job.toml --picture top.png
  gcode-sim verify O8100.nc --reference job.toml --format sarif > findings.sarif
  gcode-sim verify O8100.nc --reference job.toml --page review.html")]
    Verify(verify::Arguments),

    /// Draw a program's tool path and holes on the part
    #[command(after_help = "\
Examples:
  gcode-sim render O1234.nc -o top.png
  gcode-sim render O1234.nc --machine machine.toml --view top,front,iso -o views.png
  gcode-sim render O1234.nc --view iso --color-by tool -o iso.png
  gcode-sim render O8100.nc --reference job.toml -o top.png --size 1600x1200")]
    Render(render::Arguments),

    /// Write a page that shows a program: its path in 3-D to rotate and to play, its blocks and variables; opens in any browser
    #[command(after_help = "\
Examples:
  gcode-sim page O1234.nc -o page.html
  gcode-sim page O1234.nc -o page.html --machine machine.toml --reference O1234.csv

The page is one file and needs no network. Click a move to see its block and the calls that led there; a finding links to \
its block.")]
    Page(page_command::Arguments),

    /// Write the set-up sheet of a program: tools, offsets, stops, M codes, times, hashes and a picture, to print
    #[command(after_help = "\
Examples:
  gcode-sim sheet O1234.nc -o O1234.html
  gcode-sim sheet O1234.nc -o O1234.html --machine machine.toml --reference O1234.csv

The sheet of a job file is that of `gcode-gen sheet`.")]
    Sheet(sheet::Arguments),

    /// Show edge-finder readings along the part surface
    #[command(after_help = "\
Examples:
  gcode-sim readings O8220.nc --part job.toml --machine machine.toml --picture readings.png
  gcode-sim readings O8220.nc --part job.toml --machine machine.toml --tolerance 0.03
  gcode-sim readings O8220.nc --part job.toml --machine machine.toml --format csv > readings.csv

Above 0: gap between ball and surface; below 0: stylus deflected. [part] in the machine file gives the actual \
position of the part.")]
    Readings(readings::Arguments),

    /// Find faults without a run: missing sequence numbers, missing decimal points, unset variables, and more
    #[command(after_help = "\
Examples:
  gcode-sim check O8100.nc
  gcode-sim check O1234.nc --lib macros --format json
  gcode-sim check O1234.nc --format sarif > findings.sarif

A comment (CHECK-OFF DOUBLED-N) on a block suppresses that rule for the block, at the head of a program for all of it; \
allow = [\"doubled-n\"] in gcode.toml suppresses it for a folder.")]
    Check(check::Arguments),

    /// Compare two revisions of a program by their effect: holes, motion, stops, final state
    #[command(after_help = "\
Examples:
  gcode-sim diff old/O8100.nc new/O8100.nc
  gcode-sim diff old/O8100.nc new/O8100.nc --tolerance 0.01 --picture changes.png
  gcode-sim diff old/O8100.nc new/O8100.nc --page review.html --reference job.toml
  git show HEAD:O8100.nc | gcode-sim diff - O8100.nc

Sequence numbers, spaces, comments, names of locals and the way numbers are written are ignored. \
Called programs come from each revision's own folder first, then from --lib, those of the old one from \
--old-lib if given.
Exit code 0: no difference; 1: a difference; 3: a revision stops with an alarm or a limit.")]
    Diff(diff::Arguments),

    /// Run a folder of programs and compare each with its accepted result
    #[command(after_help = "\
Examples:
  gcode-sim test programs
  gcode-sim test programs --lib macros --shard 2/4 --format json
  gcode-sim test programs --only flange --accept
  gcode-sim test programs --lib macros --format junit > result.xml
  gcode-sim test --merge shard-1.json shard-2.json --format sarif

A case is a folder with a program (main.nc, or the only one in it that no other calls) and, optionally, lib/, machine.toml, \
control.toml, a reference (reference.json, reference.csv or job.toml), and accepted.json, which --accept writes.")]
    Test(test::Arguments),

    /// Write a file to start from: a machine file, a list of holes, a project file
    #[command(after_help = "\
Examples:
  gcode-sim new machine --kind trunnion -o machine.toml
  gcode-sim new reference --from O1234.nc -o O1234.csv
  gcode-sim new project -o gcode.toml

A file that exists with other contents is kept, unless --force replaces it.")]
    New(new::Arguments),

    /// Estimate the position error of each hole over many parts, on machines and set-ups with errors
    #[command(after_help = "\
Examples:
  gcode-sim budget job.toml --errors errors.toml --samples 200000 --seed 1
  gcode-sim budget job.toml --errors errors.toml --format json
  gcode-sim budget job.toml --errors errors.toml --picture shares.png")]
    Budget(budget::Arguments),

    /// Prove a claim on a program for all values of its variables at once, or refute it by a run
    #[command(after_help = "\
Examples:
  gcode-sim prove O9010.nc --range '#1=0.1..9.9' --range '#2=-180..180' --claim '#100 LE 12.1'
  gcode-sim prove O9010.nc --range '#1=0..50' --where '#1 NE 10' --claim no-alarm --claim 'blocks LE 500'
  gcode-sim prove O8101.nc --lib macros --range '#101=500..2000' --call 'G65 P8101 A#101 B700.' --claim 'alarm MC3003'
  gcode-sim prove O9010.nc --range '#1=0..50' --claim 'travel 1320=X100.,Y50. 1321=X-5.'
  gcode-sim prove O9010.nc --range '#1=0.1..9.9' --bounds '#100' --format json

Claims: a condition as in IF, at the end of every run that ends without an alarm; no-alarm; 'alarm CODE|CODE', no other alarm; \
'blocks LE N'; 'travel 1320=… 1321=…', no overtravel with these stroke limits. Each is proved, refuted with a counterexample \
that run confirms, or undecided with the share of the values that is left (see docs/prove.md). Exit code 0: all are proved.")]
    Prove(prove::Arguments),

    /// List the control settings for --control
    #[command(after_help = "\
Examples:
  gcode-sim settings
  gcode-sim settings --format json")]
    Settings(settings::Arguments),

    /// Debug a program from an editor, forwards and backwards: the Debug Adapter Protocol over standard input and output
    #[command(after_help = "\
An editor starts this command and sends requests; docs/debugger.md has the configuration of VS Code, Neovim and Emacs.

Keys of the launch request:
  program      path of the program
  mainProgram  O number of the main program in a file with several
  machine      path of the machine file
  library      folders of called programs
  control      settings as `gcode-sim settings` lists them, {\"NAT\": 1}
  variables    values before the start, {\"#500\": 12.5}
  reference    hole list or job file, for stops at bad holes
  stopOnEntry  stop in front of the first block

gcode.toml and machine.toml count as for the other commands; the launch wins.

Examples:
  gcode-sim dap     (an editor starts it; the launch request of a program: {\"program\": \"O1234.nc\", \"stopOnEntry\": true})")]
    Dap,

    /// Explain an alarm or finding, with an example and a fix
    #[command(after_help = "\
Examples:
  gcode-sim explain PS0112
  gcode-sim explain 112
  gcode-sim explain hole-position
  gcode-sim explain --list")]
    Explain(explain::Arguments),

    /// Serve an editor: the Language Server Protocol 3.17 on standard input and output
    #[command(after_help = "\
Example:
  gcode-sim lsp

The editor starts it; docs/editors.md has the lines for Neovim, Helix and Emacs.
Exit code 0 after shutdown and exit, 1 otherwise.")]
    Lsp(lsp::Arguments),

    /// Write the JSON Schema (draft 2020-12) of a file or of a result to standard output
    #[command(after_help = "\
Examples:
  gcode-sim schema job > job.schema.json
  gcode-sim schema verify

First line of a job file for editors that check it: #:schema ./job.schema.json (see docs/schemas.md)")]
    Schema(schema::Arguments),

    /// Write shell completions to standard output
    #[command(after_help = "\
Example:
  gcode-sim completions bash > ~/.local/share/bash-completion/completions/gcode-sim")]
    Completions(packaging::ShellArguments),

    /// Write the manual pages into a folder, one for each command
    #[command(after_help = "\
Example:
  gcode-sim man ~/.local/share/man/man1")]
    Man(packaging::ManArguments),

    /// Compare two pictures and mark the differences
    #[command(after_help = "\
Example:
  gcode-sim compare before.png after.png -o differences.png")]
    Compare(compare::Arguments),
}
