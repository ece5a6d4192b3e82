//! `[offsets]`: the work offsets G54 to G59.
use super::AXES;
use crate::machine::WorkOffset;
use gcode_lang::motion::{Axes, AxisIndex};
use gcode_part::reader::bounds::WorkOffsetValue;
use gcode_part::reader::{FileError, FileKey, Reader, TableOf, WordList};

/// Work offsets by code, each with its axes.
pub(super) type FileOffsets = TableOf<WorkCode, TableOf<AxisLetter, WorkOffsetValue>>;

/// Codes of work offsets.
pub(super) enum WorkCode {}

impl WordList for WorkCode {
    type Value = u32;

    fn all() -> Vec<(&'static str, u32)> {
        vec![("G54", 54), ("G55", 55), ("G56", 56), ("G57", 57), ("G58", 58), ("G59", 59)]
    }
}

/// Letters of axes.
pub(super) enum AxisLetter {}

impl WordList for AxisLetter {
    type Value = char;

    fn all() -> Vec<(&'static str, char)> {
        AXES.iter().flat_map(|name| name.chars().map(|letter| (*name, letter))).collect()
    }
}

/// Returns the axis of a letter that is a key of the table `table`.
pub(super) fn axis_of(
    reader: &Reader<'_>,
    axes: &Axes,
    table: &str,
    letter: char,
) -> Result<AxisIndex, FileError> {
    axes.find(letter as u8).ok_or_else(|| {
        let key = format!("{table}.{letter}");
        reader.error_at(&key, format!("key '{key}': the control has no axis {letter}"))
    })
}

/// Returns the offsets of `G54 = { X = 500.0, B = 12.0 }`; axes that are not named are 0.
pub(super) fn work_offsets(
    reader: &Reader<'_>,
    axes: &Axes,
    offsets: <FileOffsets as FileKey>::Value,
) -> Result<Vec<WorkOffset>, FileError> {
    let axis = |code: u32, letter: char| axis_of(reader, axes, &format!("offsets.G{code}"), letter);
    let offset = |(code, values): (u32, Vec<(char, f64)>)| {
        let values = values.into_iter().map(|(letter, value)| Ok((axis(code, letter)?, value)));
        Ok(WorkOffset { code, values: values.collect::<Result<_, FileError>>()? })
    };
    offsets.into_iter().map(offset).collect()
}
