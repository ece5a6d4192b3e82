//! `[[tool]]`: a tool's number, length and diameter.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::machine::{Head, HeadKind, Tool, ToolKind};
use gcode_lang::units::Deg;
use gcode_part::reader::bounds::{Bounded, GaugeLength, OffsetNumber, PointAngle, ToolDiameter};
use gcode_part::reader::{FileError, FileKey, Optional, Reader, Word, WordList};

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
    /// Its kind [default: unknown].
    #[serde(default, with = "Optional::<Word<ToolKindName>>")]
    kind: Option<ToolKind>,
    /// Full angle of its point, 180 of a flat end, degrees [default: 90 of a spot-drill or countersink].
    point_angle: Option<Bounded<PointAngle>>,
}

/// Names of the kinds of tools.
pub(super) enum ToolKindName {}

impl WordList for ToolKindName {
    type Value = ToolKind;

    fn all() -> Vec<(&'static str, ToolKind)> {
        ToolKind::NAMES.into()
    }
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
            kind: self.kind,
            point_angle: self.point_angle.as_ref().map(Bounded::get).map(Deg),
        })
    }
}
