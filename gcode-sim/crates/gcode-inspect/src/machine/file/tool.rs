//! `[[tool]]`: a tool's number, length and body.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::machine::{Head, HeadKind, Tool, ToolKind};
use gcode_lang::units::Deg;
use gcode_part::Hand;
use gcode_part::reader::bounds::{
    Bounded, GaugeLength, LengthOffset, OffsetNumber, PointAngle, RadiusOffset, TipLength, ToolDiameter,
};
use gcode_part::reader::{FileError, FileKey, Optional, Reader, Word, WordList};

/// A tool.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTool {
    /// Its number, and that of its length offset; unique.
    pub(super) number: Bounded<OffsetNumber>,
    /// From the gauge line to the tip, mm [default: as long as the length offset in effect].
    length: Option<Bounded<TipLength>>,
    /// mm [default: unknown].
    diameter: Option<Bounded<ToolDiameter>>,
    /// Of a tool touched off at the part, instead of `length`: geometry of the length offset H of its number, as the offset page
    /// shows it, mm [default: what the program sets, else 0].
    length_offset: Option<Bounded<LengthOffset>>,
    /// Cutter radius offset D of its number, mm [default: what the program sets, else 0].
    radius_offset: Option<Bounded<RadiusOffset>>,
    /// Its kind [default: unknown].
    #[serde(default, with = "Optional::<Word<ToolKindName>>")]
    kind: Option<ToolKind>,
    /// Full angle of its point, 180 of a flat end, degrees [default: 90 of a spot-drill or countersink].
    point_angle: Option<Bounded<PointAngle>>,
    /// Its hand [default: right].
    #[serde(default, with = "Optional::<Word<HandName>>")]
    hand: Option<Hand>,
    /// From the tip to the shank, mm; needs `shank_diameter`.
    flute_length: Option<Bounded<GaugeLength>>,
    /// Diameter of the shank, above the flutes, mm; needs `flute_length`.
    shank_diameter: Option<Bounded<ToolDiameter>>,
    /// Diameter of the holder, mm; needs `holder_length`.
    holder_diameter: Option<Bounded<ToolDiameter>>,
    /// Length of the holder below the gauge line, mm; needs `holder_diameter`.
    holder_length: Option<Bounded<GaugeLength>>,
}

/// Names of the kinds of tools.
pub(super) enum ToolKindName {}

impl WordList for ToolKindName {
    type Value = ToolKind;

    fn all() -> Vec<(&'static str, ToolKind)> {
        ToolKind::NAMES.into()
    }
}

/// Names of the hands.
pub(super) enum HandName {}

impl WordList for HandName {
    type Value = Hand;

    fn all() -> Vec<(&'static str, Hand)> {
        vec![("right", Hand::Right), ("left", Hand::Left)]
    }
}

impl FileTool {
    pub(super) fn check(&self, reader: &Reader<'_>, head: &Head) -> Result<Tool, FileError> {
        if let (Some(length), HeadKind::Free) = (&self.length, &head.kind) {
            let message = "key 'tool.length' acts along the tool, whose direction is unknown: give [head] \
                           with its kind, or remove the length";
            return Err(reader.error(length, message));
        }
        if let (Some(offset), Some(_)) = (&self.length_offset, &self.length) {
            let message =
                "key 'tool.length_offset': the tool has a length, which is its H; state one of them";
            return Err(reader.error(offset, message));
        }
        let Self { length, diameter, flute_length, shank_diameter, holder_diameter, holder_length, .. } =
            self;
        self.check_pair(
            reader,
            [("flute_length", flute_length.is_some()), ("shank_diameter", shank_diameter.is_some())],
        )?;
        self.check_pair(
            reader,
            [("holder_diameter", holder_diameter.is_some()), ("holder_length", holder_length.is_some())],
        )?;
        for (name, part) in [("flute_length", flute_length), ("holder_length", holder_length)] {
            if let (Some(part), Some(length)) = (part, length)
                && length.get() < part.get()
            {
                let (part_length, length) = (part.get(), length.get());
                let message = format!(
                    "key 'tool.{name}' is {part_length}: at most the length of the tool, {length} mm"
                );
                return Err(reader.error(part, message));
            }
        }
        Ok(Tool {
            number: self.number.get() as u32,
            length: length.as_ref().map(Bounded::get),
            diameter: diameter.as_ref().map(Bounded::get),
            flute_length: flute_length.as_ref().map(Bounded::get),
            shank_diameter: shank_diameter.as_ref().map(Bounded::get),
            holder_diameter: holder_diameter.as_ref().map(Bounded::get),
            holder_length: holder_length.as_ref().map(Bounded::get),
            length_offset: self.length_offset.as_ref().map(Bounded::get),
            radius_offset: self.radius_offset.as_ref().map(Bounded::get),
            kind: self.kind,
            point_angle: self.point_angle.as_ref().map(Bounded::get).map(Deg),
            hand: self.hand,
        })
    }

    /// Refuses one key of a pair without the other.
    fn check_pair(&self, reader: &Reader<'_>, pair: [(&str, bool); 2]) -> Result<(), FileError> {
        match pair {
            [(given, true), (missing, false)] | [(missing, false), (given, true)] => {
                let message = format!("key 'tool.{given}' needs the key 'tool.{missing}'");
                Err(reader.error(&self.number, message))
            }
            _ => Ok(()),
        }
    }
}
