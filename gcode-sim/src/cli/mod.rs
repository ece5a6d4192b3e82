//! The command line: arguments in, exit status out. All printing and file access is in this module.
mod args;
mod budget;
mod check;
pub mod common;
mod compare;
mod conditions;
mod diff;
mod explain;
pub mod format;
mod holes;
pub mod input;
pub mod library;
mod options;
pub mod output;
pub mod overwrite_guard;
pub mod packaging;
mod page;
mod progress;
mod readings;
mod reference;
mod render;
mod run;
pub mod schema;
mod settings;
mod test;
mod unused_machine;
mod verify;

use std::ffi::OsString;
use std::process::ExitCode;

use args::{Arguments, Command};

use crate::report::diagnostic;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_session::Run;

/// Outcome of a request, the same for both programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitStatus {
    /// Done, all checks passed: exit code 0.
    Passed,
    /// Done, a check failed: exit code 1.
    Failed,
    /// The request is invalid: exit code 2.
    Invalid,
    /// The control stopped with an alarm, or a limit ended the run: exit code 3.
    Stopped,
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(match status {
            ExitStatus::Passed => 0,
            ExitStatus::Failed => 1,
            ExitStatus::Invalid => 2,
            ExitStatus::Stopped => 3,
        })
    }
}

/// An invalid request: one sentence with its remedy.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(String);

impl UsageError {
    /// Builds the error from its sentence.
    pub fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

/// Parses the arguments and executes the command; messages go to standard error.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitStatus {
    let arguments: Arguments = match common::parse(arguments) {
        Ok(arguments) => arguments,
        Err(status) => return status,
    };
    arguments.colours.apply();
    let done = match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Holes(arguments) => holes::run(&arguments),
        Command::Reference(arguments) => reference::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Readings(arguments) => readings::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Diff(arguments) => diff::run(&arguments),
        Command::Test(arguments) => test::run(&arguments),
        Command::Budget(arguments) => budget::run(&arguments),
        Command::Settings(arguments) => settings::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Completions(shell) => packaging::completions::<Arguments>(&shell),
        Command::Man(folder) => packaging::man::<Arguments>(&folder),
        Command::Compare(arguments) => compare::run(&arguments),
    };
    done.unwrap_or_else(|refusal| {
        output::print_message(&format!("error: {refusal}\n"));
        ExitStatus::Invalid
    })
}

/// Prints a run's notes and, if it did not end normally, the finding that stopped it.
fn stopped(run: &Run) -> Option<ExitStatus> {
    let sources = run.control.memory().sources();
    run.note_findings().for_each(|note| output::print_message(&diagnostic::render(&note, sources)));
    let finding = run.stop_finding()?;
    output::print_message(&diagnostic::render(&finding, sources));
    Some(ExitStatus::Stopped)
}

/// Prints the findings and returns the exit status of the most severe one.
fn findings(all: &[Diagnostic], run: &Run) -> ExitStatus {
    let sources = run.control.memory().sources();
    for finding in all {
        output::print_message(&diagnostic::render(finding, sources));
    }
    match all.iter().map(|finding| finding.severity).max() {
        Some(Severity::Alarm) => ExitStatus::Stopped,
        Some(Severity::Error) => ExitStatus::Failed,
        _ => ExitStatus::Passed,
    }
}
