//! Reads the job file of the family `honeycomb`: every key checked, its line named.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{Clamp, CombMachine, Cylinder, Drill, Honeycomb, Metric, Spacing, SpecifiedFields};
use crate::job::sections::{FileControl, FileRotary, FileTolerance, heights, in_range, length};
use crate::job::sheet::FileSheet;
use crate::job::{FileError, Reader};
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
    #[schemars(range(min = 0.01, max = 9_999.0))]
    clearance: Option<Spanned<f64>>,
    /// Retract height above the surface between holes, mm, no less than the clearance [default: 50].
    #[schemars(range(min = 0.01, max = 9_999.0))]
    retract: Option<Spanned<f64>>,
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
    #[schemars(range(min = 0.01, max = 99_999.0))]
    diameter: Spanned<f64>,
    /// mm.
    #[schemars(range(min = 0.01, max = 99_999.0))]
    length: Spanned<f64>,
    /// Where the holes begin, mm, no less than diameter [default: diameter].
    #[schemars(range(min = 0.01, max = 99_999.0))]
    outer: Option<Spanned<f64>>,
    /// Of a tube, mm, no more than diameter [default: 0, solid].
    #[schemars(range(min = 0.0, max = 99_999.0))]
    bore: Option<Spanned<f64>>,
}

/// How the holes stand to one another: by pitch or by divisions, the other one follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["pitch"] }, { "required": ["divisions"] }]))]
struct FilePattern {
    /// Between neighbours, mm, above the drill diameter; adjusted so that the pattern closes.
    #[schemars(range(min = 0.01, max = 99_999.0))]
    pitch: Option<Spanned<f64>>,
    /// Rows of one group round the circumference.
    #[schemars(range(min = 2, max = 100_000))]
    divisions: Option<Spanned<i64>>,
    /// Metric of the distance between neighbours: arc on the surface, or chord.
    #[schemars(extend("enum" = names(&Metric::ALL)))]
    metric: Spanned<String>,
}

/// The tool and the holes it makes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileDrill {
    /// mm.
    #[schemars(range(min = 0.01, max = 99_999.0))]
    diameter: Spanned<f64>,
    /// mm, below the radius of the part.
    #[schemars(range(min = 0.01, max = 99_999.0))]
    depth: Spanned<f64>,
    /// Of the tool and of its length offset [default: 1].
    #[schemars(range(min = 1, max = 400))]
    number: Option<Spanned<i64>>,
    /// A whole number of r/min [default: 1000].
    #[schemars(range(min = 1.0, max = 99_999.0), extend("multipleOf" = 1))]
    speed: Option<Spanned<f64>>,
    /// mm/min [default: 60].
    #[schemars(range(min = 0.01, max = 240_000.0))]
    feed: Option<Spanned<f64>>,
    /// Of G83, mm, which a hole deeper than three diameters gets [default: the diameter].
    #[schemars(range(min = 0.01, max = 9_999.0))]
    peck: Option<Spanned<f64>>,
}

/// M codes that end, call or rigid-tap.
const RESERVED_M_CODES: [i64; 5] = [19, 29, 30, 98, 99];
/// mm/min, in the paper.
const DEFAULT_FEED: f64 = 60.0;
/// r/min; the paper names none.
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
        position_tolerance: file.tolerance.position(reader)?,
        depth_tolerance: file.tolerance.depth(reader)?,
        cylinder,
        drill,
        sheet: FileSheet::of(file.sheet, reader)?,
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
        let diameter = length(reader, "cylinder.diameter", &self.diameter)?;
        let outer = match &self.outer {
            Some(outer) => {
                let allowed = format!("from the diameter of {diameter} mm to 99999 mm");
                reader.number("cylinder.outer", outer, &allowed, in_range(diameter, 99_999.0))?
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
        Ok(Cylinder { diameter, length: length(reader, "cylinder.length", &self.length)?, outer, bore })
    }
}

impl FileDrill {
    fn check(&self, reader: &Reader<'_>, cylinder: &Cylinder) -> Result<Drill, FileError> {
        let diameter = length(reader, "drill.diameter", &self.diameter)?;
        let radius = cylinder.outer / 2.0;
        let depth = length(reader, "drill.depth", &self.depth)?;
        if depth >= radius {
            let message = format!(
                "key 'drill.depth' is {depth}: below the radius of {radius} mm, because the holes meet on the axis"
            );
            return Err(reader.error(&self.depth, message));
        }
        let number = match &self.number {
            Some(number) if !(1..=400).contains(number.as_ref()) => {
                let message = format!("key 'drill.number' is {}: 1 to 400", number.as_ref());
                return Err(reader.error(number, message));
            }
            Some(number) => *number.as_ref() as u32,
            None => 1,
        };
        let or = |key: &str, value: &Option<Spanned<f64>>, allowed: &str, least: f64, most: f64, or: f64| {
            value.as_ref().map_or(Ok(or), |value| reader.number(key, value, allowed, in_range(least, most)))
        };
        let speed = match &self.speed {
            Some(speed) => {
                let allowed = "a whole number from 1 to 99999 r/min";
                reader.number("drill.speed", speed, allowed, |v| {
                    in_range(1.0, 99_999.0)(v) && v.fract() == 0.0
                })?
            }
            None => DEFAULT_SPEED,
        };
        Ok(Drill {
            number,
            diameter,
            depth,
            speed,
            feed: or("drill.feed", &self.feed, "0.01 to 240000 mm/min", 0.01, 240_000.0, DEFAULT_FEED)?,
            peck: or("drill.peck", &self.peck, "0.01 to 9999 mm", 0.01, 9_999.0, diameter)?,
            specified: SpecifiedFields {
                has_number: self.number.is_some(),
                has_speed: self.speed.is_some(),
                has_feed: self.feed.is_some(),
                has_peck: self.peck.is_some(),
            },
        })
    }
}

/// The pitch or the divisions; whether the pattern that follows is possible, the part's geometry tells.
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
        (None, Some(divisions)) => {
            let number = *divisions.as_ref();
            if (2..=100_000).contains(&number) {
                return Ok(Spacing::Divisions(number as u32));
            }
            let allowed = "a whole number from 2 to 100000";
            Err(reader.error(divisions, format!("key 'pattern.divisions' is {number}: {allowed}")))
        }
        (Some(key), None) => {
            let pitch = length(reader, "pattern.pitch", key)?;
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

/// Rows of one group are √3 pitches apart; one and a half of them fill the circumference. In whole micrometres.
fn largest_pitch(diameter: f64) -> f64 {
    let most = std::f64::consts::PI * diameter / (1.5 * 3.0f64.sqrt());
    (most * 1e3).floor() / 1e3
}
