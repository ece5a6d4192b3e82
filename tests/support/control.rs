//! Cases of kind `control`: many small programs in one file, each with the end that was worked out for it.
//!
//! `cases.txt` has, after a sentence on what it is about, cases of the form
//!
//! ```text
//! == vacant equals vacant
//! IF[#1 EQ #0]THEN #100=1
//! M30
//! -- end=normal; #100=1
//! ```
//!
//! A case with a `machine.toml` runs on the axes of that machine file. A program that doesn't begin with O, `:` or `%` is
//! O0001. [`crate::expect`] has the words behind `--`.
use gcode_inspect::machine::Machine;

use crate::{Case, expect};

pub(crate) fn run(case: &Case) {
    let text = case.text("cases.txt");
    let machine = case.optional("machine.toml").map(|text| Machine::parse(&text).unwrap());
    let mut wrong = String::new();
    let mut names: Vec<&str> = Vec::new();
    for entry in text.split("== ").skip(1) {
        let (name, rest) = entry.split_once('\n').unwrap();
        let (program, expected) =
            rest.rsplit_once("-- ").unwrap_or_else(|| panic!("{name}: no end is expected"));
        assert!(!names.contains(&name), "{}: two cases are called '{name}'", case.name());
        assert!(!program.contains("\n-- "), "{}: '{name}' has two ends", case.name());
        names.push(name);
        let head = if program.starts_with(['O', ':', '%']) { "" } else { "O0001\n" };
        let program = format!("{head}{program}");
        let mut settings = expect::settings(program.as_bytes());
        if let Some(machine) = &machine {
            (settings.axes, settings.kinematics) = (machine.axes.clone(), machine.kinematics());
        }
        for difference in expect::run_on(program.as_bytes(), settings, 100_000).differences(expected.trim()) {
            wrong.push_str(&format!("{name}: {difference}\n"));
        }
    }
    assert!(!names.is_empty(), "{}: no cases", case.name());
    assert!(wrong.is_empty(), "{}:\n{wrong}", case.name());
}
