//! Command-line parts that both programs share: help, usage errors, colours.
use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
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

/// Parses the number of a flag.
pub(super) fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| match text.replacen(',', ".", 1) {
        pointed if pointed.parse::<f64>().is_ok() => format!("a number has a point, not a comma: {pointed}"),
        _ => "a number is required, such as 0.1".to_owned(),
    })
}

/// Removes the quotes of `'#500=12.5'`, which the command line of Windows leaves there.
fn unquoted(argument: OsString) -> OsString {
    let text = argument.to_str().and_then(|text| text.strip_prefix('\'')?.strip_suffix('\''));
    match text.filter(|text| text.starts_with('#')) {
        Some(text) => OsString::from(text),
        None => argument,
    }
}

/// Returns true for an argument that names a list of holes or a job.
fn is_list_in_place_of_program(argument: &OsString) -> bool {
    let ending = Path::new(argument).extension().map(|ending| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ["csv", "json", "toml"].iter().any(|list| ending == *list))
}

/// Returns the right place of a file among the arguments, if it is in a place where none goes.
fn tip_for_files(given: &[OsString]) -> Option<String> {
    if given.get(1).is_some_and(|one| one == "new") {
        if given.get(2).is_none_or(|one| one != "reference") {
            return None;
        }
        let is_from = |one: &OsString| one == "--from" || one.to_string_lossy().starts_with("--from=");
        return Some(match given.iter().any(is_from) {
            true => "the list goes behind -o".to_owned(),
            false => "the program goes behind --from, and the list behind -o".to_owned(),
        });
    }
    let list = given.iter().find(|one| is_list_in_place_of_program(one))?;
    Some(format!("{} goes behind --reference; the program is given alone", list.to_string_lossy()))
}

/// Parses the arguments with clap and executes the command. Help and version count as results; anything else that
/// clap rejects is an invalid request.
pub fn main<A: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    colours: impl Fn(&A) -> Colours,
    execute: impl FnOnce(A) -> Result<ExitStatus, UsageError>,
) -> ExitStatus {
    let given: Vec<OsString> = arguments.into_iter().map(unquoted).collect();
    let arguments = match A::try_parse_from(&given) {
        Ok(arguments) => arguments,
        Err(mut error) => {
            if error.kind() == ErrorKind::UnknownArgument {
                // The tip to write `-- --flag` takes the flag for a value, which none is.
                error.remove(ContextKind::Suggested);
                if let Some(tip) = tip_for_files(&given) {
                    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
                }
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comma_in_a_number_is_named() {
        assert_eq!(number("0.1"), Ok(0.1));
        assert_eq!(number("0,1").unwrap_err(), "a number has a point, not a comma: 0.1");
        assert_eq!(number("1,0,1").unwrap_err(), "a number is required, such as 0.1");
    }

    #[test]
    fn a_file_in_a_wrong_place_has_a_tip() {
        let tip = |line: &str| tip_for_files(&line.split(' ').map(OsString::from).collect::<Vec<_>>());
        let from = Some("the program goes behind --from, and the list behind -o".to_owned());
        assert_eq!(tip("gcode-sim new reference O1.nc -o x.csv"), from);
        let list = Some("the list goes behind -o".to_owned());
        assert_eq!(tip("gcode-sim new reference --from O1.nc x.csv"), list);
        assert_eq!(tip("gcode-sim new reference --from=O1.nc x.csv"), list);
        assert_eq!(tip("gcode-sim new machine x.toml"), None);
        let behind = Some("x.csv goes behind --reference; the program is given alone".to_owned());
        assert_eq!(tip("gcode-sim verify O1.nc x.csv"), behind);
        assert_eq!(tip("gcode-sim verify O1.nc O2.nc"), None);
    }

    #[test]
    fn quotes_about_a_variable_are_removed() {
        for (given, expected) in
            [("'#500=12.5'", "#500=12.5"), ("'O1.nc'", "'O1.nc'"), ("'#5", "'#5"), ("#5", "#5"), ("'", "'")]
        {
            assert_eq!(unquoted(given.into()), OsString::from(expected), "{given}");
        }
    }
}
