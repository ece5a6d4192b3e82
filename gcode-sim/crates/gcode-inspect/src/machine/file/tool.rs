//! `[[tool]]`: a tool's number, length and diameter.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::machine::{Head, HeadKind, Tool};
use gcode_part::reader::FileError;
use gcode_part::reader::{Reader, Spanned};

/// A tool.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTool {
    /// Its number, and that of its length offset; unique.
    #[schemars(range(min = 1, max = 99_999_999))]
    pub(super) number: Spanned<i64>,
    /// From the gauge line to the tip, mm [default: as long as the length offset in effect].
    #[schemars(range(min = 0.0, max = 10_000.0))]
    length: Option<Spanned<f64>>,
    /// mm [default: unknown].
    #[schemars(range(min = 0.001, max = 10_000.0))]
    diameter: Option<Spanned<f64>>,
}

impl FileTool {
    pub(super) fn check(&self, reader: &Reader<'_>, head: &Head) -> Result<Tool, FileError> {
        let number = *self.number.as_ref();
        let number =
            u32::try_from(number).ok().filter(|n| (1..=99_999_999).contains(n)).ok_or_else(|| {
                reader.error(&self.number, format!("key 'tool.number' is {number}: 1 to 99999999"))
            })?;
        if let (Some(length), HeadKind::Free) = (&self.length, &head.kind) {
            let message = "key 'tool.length' acts along the tool, whose direction is unknown: give [head] \
                           with its kind, or remove the length";
            return Err(reader.error(length, message));
        }
        let within = |key: &str, value: &Option<Spanned<f64>>, allowed: &str, least: f64| {
            value
                .as_ref()
                .map(|v| reader.number(key, v, allowed, |v| v >= least && v <= 10_000.0))
                .transpose()
        };
        Ok(Tool {
            number,
            length: within("tool.length", &self.length, "mm, 0 to 10000", 0.0)?,
            diameter: within("tool.diameter", &self.diameter, "mm, 0.001 to 10000", 0.001)?,
        })
    }
}
