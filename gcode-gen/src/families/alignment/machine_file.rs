//! The machine file of an alignment job: what `gcode-sim --machine` needs to follow the emitted programs.
use std::fmt::Write;

use gcode_sim::job::Alignment;

use crate::families::control;

/// The text of `machine.toml`.
pub(super) fn machine_file(job: &Alignment) -> String {
    let rotary = job.machine.rotary;
    let mut text = control::machine_file(job.control);
    let _ = write!(
        text,
        "\n\
         # The rotary table carries the part about y; its axis goes through the part's origin.\n\
         [[table]]\n\
         letter = \"{}\"\n\
         turns = \"y\"\n\
         sign = {}\n\
         \n\
         # The stylus ball; the programs move its centre.\n\
         [probe]\n\
         radius = {:?}\n",
        rotary.letter, rotary.sign, job.probe_radius
    );
    text
}
