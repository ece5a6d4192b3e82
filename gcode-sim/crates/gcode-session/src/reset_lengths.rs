//! Length offsets of tools touched off that a program sets.
use super::{Request, Run};
use gcode_part::exceeds;

/// Returns the lengths of tools touched off, whose own length is unknown, that a run leaves other than the machine file has them:
/// number of H, its length and that of the file, mm.
pub(super) fn reset_lengths(request: &Request, run: &Run) -> Vec<(u32, f64, f64)> {
    let is_preset = |number: u32| (1..=request.settings.tool_offsets).contains(&(number as usize));
    let tools = request.machine.tools.iter().filter(|tool| tool.length.is_none() && is_preset(tool.number));
    let length =
        |number: u32| run.control.tool_lengths().find(|(h, _)| *h == number).map_or(0.0, |(_, own)| own);
    let lengths = tools.filter_map(|tool| Some((tool.number, length(tool.number), tool.length_offset?)));
    lengths.filter(|(_, own, stated)| exceeds((own - stated).abs(), 0.0)).collect()
}
