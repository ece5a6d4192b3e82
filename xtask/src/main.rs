//! The project's own commands: `cargo xtask check` tells whether all is well, `cargo xtask bless` accepts new results.
use std::process::{Command, ExitCode};

/// What `check` runs, in this order; the first that fails ends it.
const CHECK: &[&[&str]] = &[
    &["fmt", "--all", "--check"],
    &["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"],
    &["test", "--workspace", "--quiet"],
    &["doc", "--workspace", "--no-deps", "--quiet"],
];

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["check"] => CHECK.iter().all(|arguments| cargo(arguments, &[("RUSTDOCFLAGS", "-D warnings")])),
        ["bless"] => {
            cargo(&["test", "--workspace", "--quiet"], &[("INSTA_UPDATE", "always"), ("BLESS", "1")])
        }
        _ => {
            tell("usage: cargo xtask check | bless");
            return ExitCode::from(2);
        }
    };
    if done { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn cargo(arguments: &[&str], surroundings: &[(&str, &str)]) -> bool {
    tell(&format!("cargo {}", arguments.join(" ")));
    let run = Command::new("cargo").args(arguments).envs(surroundings.iter().copied()).status();
    run.is_ok_and(|status| status.success())
}

#[expect(clippy::print_stderr, reason = "a tool for the people who build the project")]
fn tell(text: &str) {
    eprintln!("{text}");
}
