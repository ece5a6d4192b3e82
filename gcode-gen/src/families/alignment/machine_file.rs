//! The machine file of an alignment job, for `gcode-sim --machine`.
use std::fmt::Write;

use gcode_part::job::Alignment;

use crate::families::control;

/// Returns the text of `machine.toml`.
pub(super) fn machine_file(job: &Alignment) -> String {
    let mut text = control::machine_file(job.control);
    text += &control::rotary_table(job.machine.rotary, 'y', "its axis goes through the part's origin");
    let _ = write!(
        text,
        "\n\
         # The stylus ball; the programs move its centre.\n\
         [probe]\n\
         radius = {:?}\n",
        job.probe.radius
    );
    text
}
