//! `gcode-sim settings`: what `--control` takes.
use std::fmt::Write;

use super::{Refusal, Status, output};
use crate::control::{CodeCallKind, FAMILIES, RANGES, ROWS};

pub(super) fn run() -> Result<Status, Refusal> {
    let mut text = String::new();
    for row in ROWS {
        let _ = writeln!(text, "{:<16} {} [{}]", row.key, row.meaning, row.values);
    }
    text.push_str("#1000 to #1031   an input signal [0 or 1]\n");
    text.push_str(
        "G201, M50, T, …  a code that calls a program [the program's number; G-201 is a modal call]\n",
    );
    for family in FAMILIES {
        let (first, last) = (family.first, family.last);
        let (letter, kind) = (char::from(family.letter), kind(family.kind));
        let programs = family.program..=family.program + u32::from(last - first);
        let meaning =
            format!("{letter} codes that call O{} to O{} as {kind}s", programs.start(), programs.end());
        let _ = writeln!(text, "{first} to {last}     {meaning} [a code, 0 for none]");
    }
    for range in RANGES {
        let (first, last) = (range.first, range.first + 2);
        let (letter, kind) = (char::from(range.letter), kind(range.kind));
        let meaning =
            format!("a range of {letter} codes that call {kind}s: first code, first program, how many");
        let _ = writeln!(text, "{first} to {last}     {meaning} [numbers]");
    }
    text.push_str(
        "6090, 6091       the address that calls O9004 with #146, O9005 with #147 [its character code]\n",
    );
    output::print(&text)?;
    Ok(Status::Holds)
}

fn kind(kind: CodeCallKind) -> &'static str {
    match kind {
        CodeCallKind::Macro | CodeCallKind::Modal => "macro",
        CodeCallKind::Subprogram => "subprogram",
    }
}
