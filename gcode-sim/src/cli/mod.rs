//! The command line: arguments in, exit status out. All printing and file access is in this module.
mod args;
mod budget;
mod check;
pub mod common;
mod compare;
mod conditions;
mod dap;
mod diff;
mod disk_files;
mod explain;
pub mod format;
mod framing;
mod holes;
pub mod input;
pub mod library;
pub mod lsp;
mod message_frames;
mod new;
mod options;
pub mod output;
pub mod overwrite_guard;
pub mod packaging;
mod page;
mod page_command;
mod picture_file;
pub mod progress;
mod project;
mod prove;
mod readings;
mod reference;
mod reference_file;
mod render;
mod rerun;
mod run;
pub mod schema;
mod settings;
mod sheet;
mod test;
mod unused_machine;
mod verify;

use std::ffi::OsString;
use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

use args::{Arguments, Command};

use crate::report::diagnostic;
use gcode_draw::PictureError;
use gcode_inspect::verify::{Answer, Conclusion, Ending, Verdict};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_part::reader::FileError;
use gcode_session::{GrindingError, Run, SessionError, Simulation};

/// Outcome of a request, the same for both programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ExitStatus {
    /// Done, all checks passed: exit code 0.
    Passed = 0,
    /// Done, a check failed: exit code 1.
    Failed = 1,
    /// The request is invalid: exit code 2.
    Invalid = 2,
    /// The control stopped with an alarm, or a limit ended the run: exit code 3.
    Stopped = 3,
}

impl From<Conclusion<'_>> for ExitStatus {
    fn from(conclusion: Conclusion<'_>) -> Self {
        match (conclusion.ending, conclusion.answer) {
            (Ending::Alarm | Ending::Limit, _) => Self::Stopped,
            (Ending::End, Answer::Fail) => Self::Failed,
            (Ending::End, Answer::Pass) => Self::Passed,
        }
    }
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(status as u8)
    }
}

/// An invalid request: one sentence with its remedy.
#[derive(Debug, thiserror::Error)]
pub enum UsageError {
    /// Arguments or files are unusable.
    #[error("{0}")]
    Request(String),
    /// The run cannot begin.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The wheel cannot be followed.
    #[error(transparent)]
    Grinding(#[from] GrindingError),
    /// The picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl UsageError {
    /// Builds the error from its sentence.
    pub fn new(message: impl Into<String>) -> Self {
        Self::Request(message.into())
    }

    /// Builds the error of a file's contents.
    pub fn in_file(path: &Path, error: impl Display) -> Self {
        Self::new(format!("{}, {error}", path.display()))
    }

    /// Builds the error of a TOML file's contents; a key that another file or family has is named with its home.
    pub fn in_toml(path: &Path, error: &FileError) -> Self {
        let homes = error.unknown_key().map(crate::schema::homes_of).unwrap_or_default();
        match homes.as_slice() {
            [] => Self::in_file(path, error),
            homes => Self::in_file(path, format!("{error}; it is a key of {}", homes.join(", "))),
        }
    }

    /// Builds the error of a file or folder that cannot be read.
    pub(crate) fn unreadable(path: &Path, error: impl Display) -> Self {
        Self::new(format!("{} cannot be read: {error}", path.display()))
    }

    /// Builds the error of a file or folder that cannot be written.
    pub fn unwritable(path: &Path, error: impl Display) -> Self {
        Self::new(format!("{} cannot be written: {error}", path.display()))
    }
}

/// Parses the arguments and executes the command; messages go to standard error.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitStatus {
    common::main(arguments, |arguments: &Arguments| arguments.colours, execute)
}

fn execute(arguments: Arguments) -> Result<ExitStatus, UsageError> {
    match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Holes(arguments) => holes::run(&arguments),
        Command::Reference(arguments) => reference::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Readings(arguments) => readings::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Page(arguments) => page_command::run(&arguments),
        Command::Sheet(arguments) => sheet::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Diff(arguments) => diff::run(&arguments),
        Command::Test(arguments) => test::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Budget(arguments) => budget::run(&arguments),
        Command::Prove(arguments) => prove::run(&arguments),
        Command::Settings(arguments) => settings::run(&arguments),
        Command::Lsp(arguments) => lsp::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Dap => dap::run(),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Completions(shell) => packaging::completions::<Arguments>(&shell),
        Command::Man(folder) => packaging::man::<Arguments>(&folder),
        Command::Compare(arguments) => compare::run(&arguments),
    }
}

/// Prints the findings of a verdict and returns its exit status.
fn concluded(conclusion: Conclusion<'_>, all: &[Diagnostic], run: &Run) -> ExitStatus {
    findings(all, run);
    conclusion.into()
}

/// Prints the findings of a run or of the verdict on it, and returns the exit status.
fn judged(simulation: &Simulation, verdict: Option<&Verdict>) -> ExitStatus {
    match verdict {
        Some(verdict) => concluded(verdict.conclusion(), &verdict.diagnostics, &simulation.run),
        None => findings(simulation.findings_without_reference(), &simulation.run),
    }
}

/// Prints the findings and returns the exit status of the most severe one.
fn findings<'a>(all: impl IntoIterator<Item = &'a Diagnostic>, run: &Run) -> ExitStatus {
    let sources = run.control.memory().sources();
    let status = all.into_iter().map(|finding| {
        output::print_message(&diagnostic::render(finding, sources));
        match finding.severity {
            Severity::Alarm => ExitStatus::Stopped,
            Severity::Error => ExitStatus::Failed,
            Severity::Warning | Severity::Note => ExitStatus::Passed,
        }
    });
    status.max().unwrap_or(ExitStatus::Passed)
}
