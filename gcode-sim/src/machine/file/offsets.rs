//! `[offsets]`: what the work coordinate systems G54 to G59 are set to.
use toml::{Spanned, Table};

use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::WorkOffset;
use crate::motion::Axes;

/// `G54 = { X = 500.0, B = 12.0 }`: axes that aren't named stay at 0.
pub(super) fn work_offsets(
    reader: &Reader<'_>,
    axes: &Axes,
    offsets: &Spanned<Table>,
) -> Result<Vec<WorkOffset>, JobError> {
    let fail = |message: String| reader.error(offsets, message);
    let mut found = Vec::new();
    for (name, values) in offsets.as_ref() {
        let code = name.strip_prefix('G').and_then(|code| code.parse::<u32>().ok());
        let code = code
            .filter(|code| (54..=59).contains(code))
            .ok_or_else(|| fail(format!("key 'offsets.{name}' is not known: G54 to G59")))?;
        let values = values
            .as_table()
            .ok_or_else(|| fail(format!("key 'offsets.{name}' names axes: {{ X = 0.0, Y = 0.0 }}")))?;
        let mut offset = WorkOffset { code, values: Vec::new() };
        for (letter, value) in values {
            let axis = match letter.as_bytes() {
                [letter] => axes.find(*letter),
                _ => None,
            };
            let axis = axis.ok_or_else(|| {
                fail(format!("key 'offsets.{name}.{letter}': the control has no axis {letter}"))
            })?;
            let number = value.as_float().or_else(|| value.as_integer().map(|v| v as f64));
            let number = number.filter(|v| v.abs() <= 100_000.0).ok_or_else(|| {
                fail(format!("key 'offsets.{name}.{letter}' is {value}: a number, -100000 to 100000"))
            })?;
            offset.values.push((axis, number));
        }
        found.push(offset);
    }
    Ok(found)
}
