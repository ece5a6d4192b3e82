//! Command-line parts that both programs share: help, usage errors, colours.
use std::ffi::OsString;

use clap::{Args, Parser, ValueEnum};

use super::{ExitStatus, UsageError, output};

/// The colour flag, which every command takes.
#[derive(Clone, Copy, Debug, Args)]
pub struct Colours {
    /// Colours on the terminal; NO_COLOR is obeyed
    #[arg(long = "color", global = true, value_enum, default_value_t = Colour::Auto, display_order = 100)]
    colour: Colour,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Colour {
    Auto,
    Always,
    Never,
}

impl Colours {
    /// Applies the flag to everything printed from here on.
    fn apply(self) {
        match self.colour {
            Colour::Auto => {}
            Colour::Always => anstream::ColorChoice::Always.write_global(),
            Colour::Never => anstream::ColorChoice::Never.write_global(),
        }
    }
}

/// Parses the arguments with clap and executes the command. Help and version count as results; anything else that
/// clap rejects is an invalid request.
pub fn main<A: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    colours: impl Fn(&A) -> Colours,
    execute: impl FnOnce(A) -> Result<ExitStatus, UsageError>,
) -> ExitStatus {
    let arguments = match A::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            let text = error.render().ansi().to_string();
            if !error.use_stderr() && output::print(&text).is_ok() {
                return ExitStatus::Passed;
            }
            output::print_message(&text);
            return ExitStatus::Invalid;
        }
    };
    colours(&arguments).apply();
    execute(arguments).unwrap_or_else(|refusal| {
        output::print_message(&format!("error: {refusal}\n"));
        ExitStatus::Invalid
    })
}
