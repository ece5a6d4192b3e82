//! `gcode-sim settings`: what `--control` takes.
use std::fmt::Write;

use super::{Refusal, Status, output};
use crate::control::ROWS;

pub(super) fn run() -> Result<Status, Refusal> {
    let mut text = String::new();
    for row in ROWS {
        let _ = writeln!(text, "{:<16} {} [{}]", row.key, row.meaning, row.allowed);
    }
    text.push_str("#1000 to #1031   an input signal [0 or 1]\n");
    text.push_str("G201, M50, …     a code that calls a macro [the macro's program number]\n");
    output::print(&text)?;
    Ok(Status::Holds)
}
