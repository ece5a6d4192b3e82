//! The machine file of a honeycomb job, for `gcode-sim --machine`.
use std::fmt::Write;

use gcode_part::job::Honeycomb;

use crate::families::control;

/// Returns the text of `machine.toml`.
pub(super) fn machine_file(job: &Honeycomb) -> String {
    let mut text = control::machine_file(job.control);
    text += &control::rotary_table(job.machine.rotary, 'x', "its axis is the cylinder's");
    let _ = write!(
        text,
        "\n\
         # The spindle is along z.\n\
         [head]\n\
         kind = \"fixed\"\n\
         direction = [0.0, 0.0, 1.0]\n\
         \n\
         # The part's origin is on the cylinder's axis, the programs' Z0 on its surface.\n\
         [part]\n\
         origin = [0.0, 0.0, {:?}]\n\
         \n\
         [[tool]]\n\
         number = {}\n\
         diameter = {:?}\n",
        -job.cylinder.outer() / 2.0,
        job.drill.number(),
        job.drill.diameter
    );
    text
}
