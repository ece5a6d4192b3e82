//! Facts of a run that an editor shows: values of variables by block, deviations of holes by call, the end.
use std::collections::{BTreeMap, BTreeSet};

use gcode_control::Value;
use gcode_ide::TextRange;
use gcode_session::{ExecutedBlock, VariableRole, VariableValues};

/// Facts of a run for one file: the main program, or a program that it calls.
#[derive(Debug, Default)]
pub(crate) struct RunFacts {
    /// Executed blocks of the file, in order.
    pub blocks: Vec<ExecutedBlock>,
    /// Common variables at the end.
    pub commons: BTreeMap<u32, f64>,
    /// Holes of each calling line, lines counted from 1.
    pub holes: BTreeMap<u32, HolesOfLine>,
    /// Why the run is not complete.
    pub stop: Option<String>,
    /// A limit ended the run, or it did not begin: values may still change.
    pub is_cut_off: bool,
    /// `O8100`, the executed main program.
    pub main: String,
}

/// Holes of a line, held against the reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct HolesOfLine {
    /// Diameters of the smallest zone that contains the worst axis, and of the tolerance zone, mm; `None` if the reference has
    /// none of the holes.
    pub worst: Option<(f64, f64)>,
    /// Number of holes that the reference has.
    pub count: usize,
    /// Kinds of their errors.
    pub errors: BTreeSet<&'static str>,
    /// Number of holes that the reference lacks.
    pub extra: usize,
}

impl RunFacts {
    /// Returns the facts of a run that does not begin.
    pub(crate) fn cut_off(reason: impl Into<String>) -> Self {
        Self { stop: Some(reason.into()), is_cut_off: true, ..Self::default() }
    }

    /// Returns the values of a variable in the block at an offset.
    pub(crate) fn in_block(&self, range: TextRange, number: u32) -> Option<&VariableValues> {
        let next = self.blocks.partition_point(|executed| executed.block.start <= range.start);
        let executed = self.blocks[..next].last().filter(|executed| range.start <= executed.block.end)?;
        let of_variable =
            |role| executed.values.iter().find(move |values| values.number == number && values.role == role);
        of_variable(VariableRole::Assigned).or_else(|| of_variable(VariableRole::Read))
    }

    /// Returns true if the block at an offset was executed.
    pub(crate) fn is_executed(&self, offset: u32) -> bool {
        let next = self.blocks.partition_point(|executed| executed.block.start <= offset);
        self.blocks[..next].last().is_some_and(|executed| offset <= executed.block.end)
    }
}

/// Returns the value of a variable as text, `vacant` for none.
pub(crate) fn value_text(value: Value) -> String {
    value.as_number().map_or_else(|| "vacant".to_owned(), number_text)
}

/// Returns a number as text, at most six decimals.
pub(crate) fn number_text(number: f64) -> String {
    let text = format!("{number:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
