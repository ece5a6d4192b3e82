//! `[start]`: positions of the axes at the start of the run.
use super::offsets::{AxisLetter, axis_of};
use gcode_lang::motion::{Axes, AxisIndex};
use gcode_part::reader::bounds::WorkOffsetValue;
use gcode_part::reader::{FileError, FileKey, Reader, TableOf};

/// Positions by axis, in the work coordinate system that is active at the start.
pub(super) type FileStart = TableOf<AxisLetter, WorkOffsetValue>;

/// Returns the positions of `[start]`, such as `Z = 250.0`.
pub(super) fn start_positions(
    reader: &Reader<'_>,
    axes: &Axes,
    start: <FileStart as FileKey>::Value,
) -> Result<Vec<(AxisIndex, f64)>, FileError> {
    start.into_iter().map(|(letter, value)| Ok((axis_of(reader, axes, "start", letter)?, value))).collect()
}
