//! The only place that prints and opens files: arguments in, exit status out.
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

/// How a request ended, the same for both programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitStatus {
    /// Done, and what was asked about holds.
    Passed,
    /// Done, and the answer is no.
    Failed,
    /// The request can't be used.
    Invalid,
    /// The control stopped with an alarm, or a limit ended the run.
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

/// Why a request can't be used, in one sentence with its remedy.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(String);

impl UsageError {
    pub fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

/// Does what the command line asks for.
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

/// Tells what a run did in silence, and why it stopped before its end, if it did.
fn stopped(run: &Run) -> Option<ExitStatus> {
    let sources = run.control.memory().sources();
    run.note_findings().for_each(|note| output::print_message(&diagnostic::render(&note, sources)));
    let finding = run.stop_finding()?;
    output::print_message(&diagnostic::render(&finding, sources));
    Some(ExitStatus::Stopped)
}

/// Tells what was found, and what that means for the exit status.
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
