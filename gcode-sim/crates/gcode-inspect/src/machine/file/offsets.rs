//! `[offsets]`: the work offsets G54 to G59.
use super::AXES;
use crate::machine::WorkOffset;
use gcode_lang::motion::Axes;
use gcode_part::reader::bounds::WorkOffsetValue;
use gcode_part::reader::{FileError, FileKey, Reader, TableOf, Words};

/// Work offsets by code, each with its axes.
pub(super) type FileOffsets = TableOf<WorkCode, TableOf<AxisLetter, WorkOffsetValue>>;

/// Codes of work offsets.
pub(super) enum WorkCode {}

impl Words for WorkCode {
    type Value = u32;

    fn all() -> Vec<(&'static str, u32)> {
        vec![("G54", 54), ("G55", 55), ("G56", 56), ("G57", 57), ("G58", 58), ("G59", 59)]
    }
}

/// Letters of axes.
pub(super) enum AxisLetter {}

impl Words for AxisLetter {
    type Value = char;

    fn all() -> Vec<(&'static str, char)> {
        AXES.iter().flat_map(|name| name.chars().map(|letter| (*name, letter))).collect()
    }
}

/// Returns the offsets of `G54 = { X = 500.0, B = 12.0 }`; axes that are not named are 0.
pub(super) fn work_offsets(
    reader: &Reader<'_>,
    axes: &Axes,
    offsets: <FileOffsets as FileKey>::Value,
) -> Result<Vec<WorkOffset>, FileError> {
    let axis = |code: u32, letter: char| {
        axes.find(letter as u8).ok_or_else(|| {
            let key = format!("offsets.G{code}.{letter}");
            reader.error_at(&key, format!("key '{key}': the control has no axis {letter}"))
        })
    };
    let offset = |(code, values): (u32, Vec<(char, f64)>)| {
        let values = values.into_iter().map(|(letter, value)| Ok((axis(code, letter)?, value)));
        Ok(WorkOffset { code, values: values.collect::<Result<_, FileError>>()? })
    };
    offsets.into_iter().map(offset).collect()
}
