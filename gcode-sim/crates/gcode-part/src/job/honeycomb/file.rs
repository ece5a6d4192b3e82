//! Reads the job file of the family `honeycomb`. Errors name the key and its line.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{Clamp, CombMachine, Cylinder, Drill, Honeycomb, Metric, Spacing, SpecifiedFields};
use crate::job::sections::{FileControl, FileRotary, FileTolerance, heights, in_range};
use crate::job::sheet::FileSheet;
use crate::job::{FileError, Reader};
use crate::reader::bounds::{
    Bounded, Depth, Divisions, DrillNumber, FeedRate, KeyRange, Length, OuterDiameter, Radius, Retract,
    SpindleSpeed,
};
use crate::reader::{Spanned, names};

/// A hexagonal pattern of radial holes on a cylinder about x.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct File {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["honeycomb"]))]
    _family: String,
    /// The control of the programs.
    control: FileControl,
    /// The machine.
    machine: FileMachine,
    /// Tolerances of the holes.
    tolerance: FileTolerance,
    /// The part.
    cylinder: FileCylinder,
    /// The pattern of the holes.
    pattern: Spanned<FilePattern>,
    /// The tool and the holes it makes.
    drill: FileDrill,
    /// Additional data for the set-up sheet.
    sheet: Option<FileSheet>,
}

/// The machine.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileMachine {
    /// The axis that rotates the part.
    rotary: FileRotary,
    /// Distance from the surface where the feed begins, mm [default: 2].
    clearance: Option<Bounded<Depth>>,
    /// Retract height above the surface between holes, mm, no less than the clearance [default: 50].
    retract: Option<Bounded<Retract>>,
    /// The M codes that clamp and release the rotary [default: none].
    clamp: Option<FileClamp>,
}

/// M codes of the machine's own.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileClamp {
    /// Clamps the rotary.
    #[schemars(range(min = 10, max = 999), extend("not" = { "enum": RESERVED_M_CODES }))]
    on: Spanned<i64>,
    /// Releases the rotary.
    #[schemars(range(min = 10, max = 999), extend("not" = { "enum": RESERVED_M_CODES }))]
    off: Spanned<i64>,
}

/// The part: holes stand at 0 ≤ x ≤ length.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileCylinder {
    /// Diameter of the pitch, mm.
    diameter: Bounded<Length>,
    /// mm.
    length: Bounded<Length>,
    /// Where the holes begin, mm, no less than diameter [default: diameter].
    outer: Option<Bounded<OuterDiameter>>,
    /// Of a tube, mm, no more than diameter [default: 0, solid].
    bore: Option<Bounded<Radius>>,
}

/// How the holes stand to one another: by pitch or by divisions, the other one follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["pitch"] }, { "required": ["divisions"] }]))]
struct FilePattern {
    /// Between neighbours, mm, above the drill diameter; adjusted so that the pattern closes.
    pitch: Option<Bounded<Length>>,
    /// Rows of one group round the circumference.
    divisions: Option<Bounded<Divisions>>,
    /// Metric of the distance between neighbours: arc on the surface, or chord.
    #[schemars(extend("enum" = names(&Metric::ALL)))]
    metric: Spanned<String>,
}

/// The tool and the holes it makes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileDrill {
    /// mm.
    diameter: Bounded<Length>,
    /// mm, below the radius of the part.
    depth: Bounded<Length>,
    /// Of the tool and of its length offset [default: 1].
    number: Option<Bounded<DrillNumber>>,
    /// A whole number of r/min [default: 1000].
    speed: Option<Bounded<SpindleSpeed>>,
    /// mm/min [default: 60].
    feed: Option<Bounded<FeedRate>>,
    /// Of G83, mm, which a hole deeper than three diameters gets [default: the diameter].
    peck: Option<Bounded<Depth>>,
}

/// M codes that end a program, call one or select rigid tapping.
const RESERVED_M_CODES: [i64; 5] = [19, 29, 30, 98, 99];
/// Feed in the paper, mm/min.
const DEFAULT_FEED: f64 = 60.0;
/// Default speed, r/min; the paper gives none.
const DEFAULT_SPEED: f64 = 1000.0;

/// Reads the text of a job of this family.
pub(in crate::job) fn parse(reader: &Reader<'_>) -> Result<Honeycomb, FileError> {
    let file: File = toml::from_str(reader.text).map_err(|e| reader.syntax(&e))?;
    let cylinder = file.cylinder.check(reader)?;
    let drill = file.drill.check(reader, &cylinder)?;
    Ok(Honeycomb {
        control: file.control.check(reader)?,
        machine: file.machine.check(reader)?,
        spacing: spacing(reader, &file.pattern, &cylinder, &drill)?,
        metric: reader.choice("pattern.metric", &file.pattern.as_ref().metric, &Metric::ALL)?,
        position_tolerance: file.tolerance.position(),
        depth_tolerance: file.tolerance.depth(),
        cylinder,
        drill,
        sheet: file.sheet.map(FileSheet::info).unwrap_or_default(),
    })
}

impl FileMachine {
    fn check(&self, reader: &Reader<'_>) -> Result<CombMachine, FileError> {
        let (clearance, retract) = heights(reader, self.clearance.as_ref(), self.retract.as_ref())?;
        let clamp = self.clamp.as_ref().map(|clamp| clamp.check(reader)).transpose()?;
        let retract_said = self.retract.is_some();
        let (clearance_said, rotary) = (self.clearance.is_some(), self.rotary.check(reader)?);
        Ok(CombMachine {
            rotary,
            clearance,
            is_clearance_specified: clearance_said,
            retract,
            is_retract_specified: retract_said,
            clamp,
        })
    }
}

impl FileClamp {
    fn check(&self, reader: &Reader<'_>) -> Result<Clamp, FileError> {
        let own = |key: &str, value: &Spanned<i64>| {
            let code = *value.as_ref();
            if (10..=999).contains(&code) && !RESERVED_M_CODES.contains(&code) {
                return Ok(code as u32);
            }
            let allowed = "an M code of the machine's own, 10 to 999 without 19, 29, 30, 98, 99";
            Err(reader.error(value, format!("key 'machine.clamp.{key}' is {code}: {allowed}")))
        };
        let clamp = Clamp { on: own("on", &self.on)?, off: own("off", &self.off)? };
        if clamp.on == clamp.off {
            let message = format!("key 'machine.clamp.off' is {}, the same as 'on'", clamp.off);
            return Err(reader.error(&self.off, message));
        }
        Ok(clamp)
    }
}

impl FileCylinder {
    fn check(&self, reader: &Reader<'_>) -> Result<Cylinder, FileError> {
        let diameter = self.diameter.get();
        let outer = match &self.outer {
            Some(outer) => {
                let most = OuterDiameter::MAX;
                let allowed = format!("from the diameter of {diameter} mm to {most} mm");
                reader.number("cylinder.outer", outer, &allowed, in_range(diameter, most))?
            }
            None => diameter,
        };
        let bore = match &self.bore {
            Some(bore) => {
                let allowed = format!("0 to the diameter of {diameter} mm");
                let wide = reader.number("cylinder.bore", bore, &allowed, in_range(0.0, diameter))?;
                if wide >= outer {
                    let message = format!(
                        "key 'cylinder.bore' is {wide}: below the outer diameter of {outer} mm, because \
                         the tube needs a wall"
                    );
                    return Err(reader.error(bore, message));
                }
                wide
            }
            None => 0.0,
        };
        Ok(Cylinder { diameter, length: self.length.get(), outer, bore })
    }
}

impl FileDrill {
    fn check(&self, reader: &Reader<'_>, cylinder: &Cylinder) -> Result<Drill, FileError> {
        let (diameter, depth, radius) = (self.diameter.get(), self.depth.get(), cylinder.outer / 2.0);
        if depth >= radius {
            let message = format!(
                "key 'drill.depth' is {depth}: below the radius of {radius} mm, because the holes meet on the axis"
            );
            return Err(reader.error(&self.depth, message));
        }
        Ok(Drill {
            number: self.number.as_ref().map_or(1, |number| number.get() as u32),
            diameter,
            depth,
            speed: self.speed.as_ref().map_or(DEFAULT_SPEED, Bounded::get),
            feed: self.feed.as_ref().map_or(DEFAULT_FEED, Bounded::get),
            peck: self.peck.as_ref().map_or(diameter, Bounded::get),
            specified: SpecifiedFields {
                has_number: self.number.is_some(),
                has_speed: self.speed.is_some(),
                has_feed: self.feed.is_some(),
                has_peck: self.peck.is_some(),
            },
        })
    }
}

/// Returns the pitch or the divisions. The geometry of the part decides later whether the pattern is
/// possible.
fn spacing(
    reader: &Reader<'_>,
    pattern: &Spanned<FilePattern>,
    cylinder: &Cylinder,
    drill: &Drill,
) -> Result<Spacing, FileError> {
    let FilePattern { pitch, divisions, .. } = pattern.as_ref();
    match (pitch, divisions) {
        (Some(_), Some(divisions)) => {
            Err(reader
                .error(divisions, "key 'pattern.divisions' excludes 'pitch': each follows from the other"))
        }
        (None, None) => {
            Err(reader.error(pattern, "key 'pattern.pitch' is missing: give it, or 'divisions' instead"))
        }
        (None, Some(divisions)) => Ok(Spacing::Divisions(divisions.get() as u32)),
        (Some(key), None) => {
            let pitch = key.get();
            let told = |allowed: String| {
                Err(reader.error(key, format!("key 'pattern.pitch' is {pitch}: {allowed}")))
            };
            if pitch <= drill.diameter {
                let diameter = drill.diameter;
                return told(format!(
                    "above the drill diameter of {diameter} mm, otherwise the holes overlap"
                ));
            }
            let (most, diameter) = (largest_pitch(cylinder.diameter), cylinder.diameter);
            if most < pitch {
                return told(format!(
                    "at most {most:.3} mm, otherwise fewer than two rows fit round diameter {diameter}"
                ));
            }
            Ok(Spacing::Pitch(pitch))
        }
    }
}

/// Returns the largest pitch with two rows of each group, in whole micrometres.
///
/// Rows of one group are √3 pitches apart; one and a half of them fill the circumference.
fn largest_pitch(diameter: f64) -> f64 {
    let most = std::f64::consts::PI * diameter / (1.5 * 3.0f64.sqrt());
    (most * 1e3).floor() / 1e3
}
