//! Passes the arguments to the command line and its exit status to the shell.
use std::process::ExitCode;

#[expect(clippy::disallowed_methods, reason = "the arguments are read here alone")]
fn main() -> ExitCode {
    gcode_sim::cli::main(std::env::args_os()).into()
}
