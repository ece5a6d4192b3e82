//! `[offsets]`: the work offsets G54 to G59.
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use toml::Table;

use crate::machine::WorkOffset;
use gcode_lang::motion::Axes;
use gcode_part::reader::FileError;
use gcode_part::reader::{Reader, Spanned};

/// Work offsets by code, each with its axes.
#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct FileOffsets(Table);

impl JsonSchema for FileOffsets {
    fn schema_name() -> Cow<'static, str> {
        "Offsets".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let length = json_schema!({ "type": "number", "minimum": -MAX_OFFSET, "maximum": MAX_OFFSET });
        json_schema!({
            "type": "object",
            "patternProperties": {
                "^G5[4-9]$": {
                    "description": "Axes that are not named are 0; mm and degrees.",
                    "type": "object",
                    "patternProperties": { "^[XYZABCUVW]$": length },
                    "additionalProperties": false
                }
            },
            "additionalProperties": false
        })
    }
}

/// Largest offset, either way, mm or degrees.
const MAX_OFFSET: f64 = 100_000.0;

/// Returns the offsets of `G54 = { X = 500.0, B = 12.0 }`; axes that are not named are 0.
pub(super) fn work_offsets(
    reader: &Reader<'_>,
    axes: &Axes,
    offsets: &Spanned<FileOffsets>,
) -> Result<Vec<WorkOffset>, FileError> {
    let fail = |message: String| reader.error(offsets, message);
    let mut found = Vec::new();
    for (name, values) in &offsets.as_ref().0 {
        let code = name.strip_prefix('G').and_then(|code| code.parse::<u32>().ok());
        let code = code
            .filter(|code| (54..=59).contains(code))
            .ok_or_else(|| fail(format!("key 'offsets.{name}' is unknown: G54 to G59")))?;
        let values = values
            .as_table()
            .ok_or_else(|| fail(format!("key 'offsets.{name}' gives axes: {{ X = 0.0, Y = 0.0 }}")))?;
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
            let number = number.filter(|v| v.abs() <= MAX_OFFSET).ok_or_else(|| {
                fail(format!("key 'offsets.{name}.{letter}' is {value}: a number, -100000 to 100000"))
            })?;
            offset.values.push((axis, number));
        }
        found.push(offset);
    }
    Ok(found)
}
