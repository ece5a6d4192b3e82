//! Passes the arguments to the command line and its exit status to the shell.
use std::process::ExitCode;

fn main() -> ExitCode {
    gcode_sim::cli::main(std::env::args_os()).into()
}
