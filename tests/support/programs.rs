//! The two programs as a user has them: built once, then run as processes.
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// The folder with the built programs. A test package doesn't make cargo build other packages' programs, so the
/// first call does.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let test = std::env::current_exe().unwrap();
        let profile = test.ancestors().nth(2).unwrap().to_owned();
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args([
            "build",
            "--quiet",
            "--locked",
            "--package",
            "gcode-sim",
            "--package",
            "gcode-gen",
            "--bins",
        ]);
        cargo.arg("--target-dir").arg(profile.parent().unwrap());
        if profile.ends_with("release") {
            cargo.arg("--release");
        }
        assert!(cargo.status().unwrap().success(), "the programs can't be built");
        profile
    })
}

/// `gcode-sim` or `gcode-gen`, run in a folder of its own with nothing on standard input.
pub fn program(name: &str) -> Command {
    let mut command = Command::new(folder().join(name));
    command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE").stdin(Stdio::null());
    command
}

/// Runs one line such as `gcode-sim run O1.nc --set '#500=1'` in `dir`; `< FILE` and `> FILE` work as in a shell.
pub fn run_line(line: &str, dir: &std::path::Path) -> Output {
    let words = words(line);
    let (name, rest) = words.split_first().unwrap();
    assert!(["gcode-sim", "gcode-gen"].contains(&name.as_str()), "'{line}' must run gcode-sim or gcode-gen");
    let mut command = program(name);
    command.current_dir(dir);
    let mut output = None;
    let mut rest = rest.iter();
    while let Some(word) = rest.next() {
        match word.as_str() {
            "<" => {
                let file = dir.join(rest.next().unwrap());
                command.stdin(std::fs::File::open(file).unwrap());
            }
            ">" => output = rest.next(),
            _ => {
                command.arg(word);
            }
        }
    }
    let mut done = command.output().unwrap();
    if let Some(file) = output {
        std::fs::write(dir.join(file), std::mem::take(&mut done.stdout)).unwrap();
    }
    done
}

/// Splits a line as a shell does, for single and double quotes without escapes.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut quote = None;
    for c in line.chars() {
        match (quote, c) {
            (Some(q), c) if c == q => quote = None,
            (Some(_), c) => word.get_or_insert_default().push(c),
            (None, '\'' | '"') => {
                word.get_or_insert_default();
                quote = Some(c);
            }
            (None, c) if c.is_whitespace() => words.extend(word.take()),
            (None, c) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}
