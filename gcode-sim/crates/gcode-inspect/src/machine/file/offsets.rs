//! `[offsets]`: the work offsets G54 to G59 and G54.1 P1 to P300.
use std::collections::BTreeSet;

use super::AXES;
use crate::machine::WorkOffset;
use gcode_lang::control::Dialect;
use gcode_lang::motion::{Axes, AxisIndex};
use gcode_lang::program::modes::WorkSystem;
use gcode_part::reader::bounds::WorkOffsetValue;
use gcode_part::reader::{FileError, FileKey, Reader, TableOf, WordList};

/// Work offsets by code, each with its axes.
pub(super) type FileOffsets = TableOf<WorkCode, TableOf<AxisLetter, WorkOffsetValue>>;

/// Codes of additional work coordinate systems, each with its largest number.
const ADDITIONAL: [(&str, u16); 2] = [("G54.1 P", 300), ("G154 P", 99)];

/// Codes of work offsets.
pub(super) enum WorkCode {}

impl WordList for WorkCode {
    type Value = WorkSystem;

    fn all() -> Vec<(&'static str, WorkSystem)> {
        let names = ["G54", "G55", "G56", "G57", "G58", "G59"];
        names.into_iter().zip((1..).map(WorkSystem::Standard)).collect()
    }

    fn find(word: &str) -> Option<WorkSystem> {
        if let Some((_, system)) = Self::all().into_iter().find(|(name, _)| *name == word) {
            return Some(system);
        }
        let (digits, max) =
            ADDITIONAL.into_iter().find_map(|(code, max)| Some((word.strip_prefix(code)?, max)))?;
        let number = digits.parse().ok().filter(|number| (1..=max).contains(number))?;
        (number.to_string() == digits).then_some(WorkSystem::Additional(number))
    }

    fn names() -> Vec<String> {
        let standard = Self::all().into_iter().map(|(name, _)| name.to_owned());
        standard.chain(["G54.1 P1 to P300".to_owned(), "G154 P1 to P99 of a Haas".to_owned()]).collect()
    }

    fn pattern() -> String {
        r"G5[4-9]|G54\.1 P[1-9][0-9]{0,2}|G154 P[1-9][0-9]?".to_owned()
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
    let axis = |system: WorkSystem, letter: char| {
        axis_of(reader, axes, &format!("offsets.{}", system.name(Dialect::default())), letter)
    };
    let mut systems = BTreeSet::new();
    let offset = |(system, values): (WorkSystem, Vec<(char, f64)>)| {
        if !systems.insert(system) {
            let key = format!("offsets.{}", system.name(Dialect::default()));
            let message = format!("key '{key}': the offset is there twice, and G154 P1 is G54.1 P1");
            return Err(reader.error_at(&key, message));
        }
        let values = values.into_iter().map(|(letter, value)| Ok((axis(system, letter)?, value)));
        Ok(WorkOffset { system, values: values.collect::<Result<_, FileError>>()? })
    };
    offsets.into_iter().map(offset).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_without_a_digit_behind_it_is_explained() {
        let error = crate::machine::Machine::parse("[offsets.G54]\nX = 5.\n").unwrap_err();
        let expected = "line 2: key 'offsets.G54.X' is 5.: a number has a digit on both sides of its point; write X = 5.0";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn a_work_offset_has_one_spelling() {
        assert_eq!(WorkCode::find("G59"), Some(WorkSystem::Standard(6)));
        assert_eq!(WorkCode::find("G54.1 P300"), Some(WorkSystem::Additional(300)));
        assert_eq!(WorkCode::find("G154 P9"), Some(WorkSystem::Additional(9)));
        for word in ["G60", "G54.1 P301", "G154 P100", "G54.1 P0", "G54.1 P01", "G54.1P1", "g54"] {
            assert_eq!(WorkCode::find(word), None, "{word}");
        }
    }
}
