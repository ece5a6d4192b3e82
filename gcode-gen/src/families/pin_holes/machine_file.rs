//! The machine file of a pin-hole job, for `gcode-sim --machine`.
use std::fmt::Write;

use gcode_part::job::{HeadKind, PinHoles};

use crate::families::control;

/// Returns the text of `machine.toml`.
pub(super) fn machine_file(job: &PinHoles) -> String {
    let head = job.machine.head;
    let mut text = control::machine_file(job.control);
    text += &control::rotary_table(job.machine.rotary, 'y', "its axis goes through the part's origin");
    text += "\n# The head tilts the tool in the xy plane; its angle counts from x towards y.\n[head]\n";
    match head.kind() {
        HeadKind::Manual => text.push_str("kind = \"manual\"\n"),
        HeadKind::Axis(letter) => {
            let _ = write!(text, "kind = \"axis\"\nletter = \"{letter}\"\n");
        }
    }
    let _ = writeln!(text, "pivot = {:?}", head.pivot);
    for tool in &job.tools {
        let _ = write!(
            text,
            "\n[[tool]]\nnumber = {}\nlength = {:?}\ndiameter = {:?}\n",
            tool.number, tool.length, tool.diameter
        );
    }
    text
}
