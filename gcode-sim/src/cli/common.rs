//! What the command lines of both programs have in common: help, refusals, colours.
use std::ffi::OsString;

use clap::{Args, Parser, ValueEnum};

use super::{ExitStatus, output};

/// The flag that every command takes.
#[derive(Clone, Copy, Debug, Args)]
pub struct Colours {
    /// Colours on the terminal; NO_COLOR is obeyed
    #[arg(long = "color", global = true, value_enum, default_value_t = Colour::Auto)]
    colour: Colour,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Colour {
    Auto,
    Always,
    Never,
}

impl Colours {
    /// From here on everything printed obeys the flag.
    pub fn apply(self) {
        match self.colour {
            Colour::Auto => {}
            Colour::Always => anstream::ColorChoice::Always.write_global(),
            Colour::Never => anstream::ColorChoice::Never.write_global(),
        }
    }
}

/// The arguments as clap reads them. Help and version are results; everything else that isn't understood is a
/// request that can't be used.
pub fn parse<A: Parser>(arguments: impl IntoIterator<Item = OsString>) -> Result<A, ExitStatus> {
    A::try_parse_from(arguments).map_err(|error| {
        let text = error.render().ansi().to_string();
        if !error.use_stderr() && output::print(&text).is_ok() {
            return ExitStatus::Passed;
        }
        output::print_message(&text);
        ExitStatus::Invalid
    })
}
