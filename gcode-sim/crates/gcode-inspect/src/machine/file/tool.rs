//! `[[tool]]`: a tool's number, length and diameter.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::machine::{Head, HeadKind, Tool};
use gcode_part::reader::FileError;
use gcode_part::reader::Reader;
use gcode_part::reader::bounds::{Bounded, GaugeLength, OffsetNumber, ToolDiameter};

/// A tool.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTool {
    /// Its number, and that of its length offset; unique.
    pub(super) number: Bounded<OffsetNumber>,
    /// From the gauge line to the tip, mm [default: as long as the length offset in effect].
    length: Option<Bounded<GaugeLength>>,
    /// mm [default: unknown].
    diameter: Option<Bounded<ToolDiameter>>,
}

impl FileTool {
    pub(super) fn check(&self, reader: &Reader<'_>, head: &Head) -> Result<Tool, FileError> {
        if let (Some(length), HeadKind::Free) = (&self.length, &head.kind) {
            let message = "key 'tool.length' acts along the tool, whose direction is unknown: give [head] \
                           with its kind, or remove the length";
            return Err(reader.error(length, message));
        }
        Ok(Tool {
            number: self.number.get() as u32,
            length: self.length.as_ref().map(Bounded::get),
            diameter: self.diameter.as_ref().map(Bounded::get),
        })
    }
}
