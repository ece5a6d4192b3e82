//! The machine file of a burr job: the grinder for `gcode-sim --machine`.
use gcode_part::job::Burr;

use crate::families::control;

/// Returns the text of `machine.toml`.
pub(super) fn machine_file(job: &Burr) -> String {
    let [x, y] = job.grinder.c_offset;
    let signs = job.grinder.signs();
    let contact = y - job.shape.radius;
    let link = |letter: char, moves: &str, sign: i8, centre: &str| {
        format!("[[table]]\nletter = \"{letter}\"\n{moves}\nsign = {sign}\n{centre}\n")
    };
    format!(
        "{}\
         axes = \"XYABC\"\n\
         \n\
         # Machine zero is on the C axis, with X and Y at 0.\n\
         # X and Y slide the table C, which carries the head A, which rotates the burr about its own axis.\n\
         {}{}{}{}\
         # The burr: x along its axis towards the shank, origin where its cylinder ends.\n\
         [part]\n\
         origin = [{x:?}, {y:?}, 0.0]\n\
         \n\
         # Where the wheel touches; B swivels it to the helix angle.\n\
         [wheel]\n\
         contact = [{x:?}, {contact:?}, 0.0]\n\
         letter = \"B\"\n\
         sign = {}\n",
        control::machine_file(job.control),
        link('X', "slides = \"x\"", signs.x, ""),
        link('Y', "slides = \"y\"", signs.y, ""),
        link('C', "turns = \"z\"", signs.c, "centre = [0.0, 0.0, 0.0]\n"),
        link('A', "turns = \"x\"", signs.a, ""),
        signs.b
    )
}
