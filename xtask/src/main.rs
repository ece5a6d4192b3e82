//! The project's own commands: `cargo xtask check` checks the workspace, `cargo xtask bless` accepts new results,
//! `cargo xtask bless -- check/NAME` those of the tests whose name contains `check/NAME`.
#![expect(clippy::disallowed_methods, reason = "a tool reads its arguments and starts cargo")]

use std::process::{Command, ExitCode};

/// Commands of `check` in their order; the first failure ends it.
const CHECK: &[&[&str]] = &[
    &["fmt", "--all", "--check"],
    &["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"],
    &["test", "--workspace", "--quiet"],
    &["doc", "--workspace", "--no-deps", "--quiet"],
];

/// Variables of `bless`: snapshots and pictures, files that a program writes.
const ACCEPT: [(&str, &str); 2] = [("INSTA_UPDATE", "always"), ("BLESS", "1")];

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["check"] => CHECK.iter().all(|arguments| cargo(arguments, &[("RUSTDOCFLAGS", "-D warnings")])),
        ["bless"] => cargo(&["test", "--workspace", "--quiet"], &ACCEPT),
        // Only gcode-tests has results in files.
        ["bless", "--", filters @ ..] if !filters.is_empty() => {
            cargo(&[&["test", "--package", "gcode-tests", "--quiet", "--"], filters].concat(), &ACCEPT)
        }
        _ => {
            print("usage: cargo xtask check | bless | bless -- FILTER");
            return ExitCode::from(2);
        }
    };
    if done { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> bool {
    print(&format!("cargo {}", arguments.join(" ")));
    let run = Command::new("cargo").args(arguments).envs(variables.iter().copied()).status();
    run.is_ok_and(|status| status.success())
}

#[expect(clippy::print_stderr, reason = "a tool prints its commands")]
fn print(text: &str) {
    eprintln!("{text}");
}
