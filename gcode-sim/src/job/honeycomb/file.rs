//! Reads the job file of the family `honeycomb`: every key checked, its line named.
use serde::Deserialize;
use toml::Spanned;

use super::{Clamp, CombMachine, Cylinder, Drill, Honeycomb, Metric, Spacing};
use crate::job::sections::{FileControl, FileRotary, FileTolerance, heights, length, within};
use crate::job::sheet::FileSheet;
use crate::job::{JobError, Reader};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "family")]
    _family: String,
    control: FileControl,
    machine: FileMachine,
    tolerance: FileTolerance,
    cylinder: FileCylinder,
    pattern: Spanned<FilePattern>,
    drill: FileDrill,
    sheet: Option<FileSheet>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileMachine {
    rotary: FileRotary,
    clearance: Option<Spanned<f64>>,
    retract: Option<Spanned<f64>>,
    clamp: Option<FileClamp>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileClamp {
    on: Spanned<i64>,
    off: Spanned<i64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileCylinder {
    diameter: Spanned<f64>,
    length: Spanned<f64>,
    outer: Option<Spanned<f64>>,
    bore: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FilePattern {
    pitch: Option<Spanned<f64>>,
    divisions: Option<Spanned<i64>>,
    metric: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileDrill {
    diameter: Spanned<f64>,
    depth: Spanned<f64>,
    number: Option<Spanned<i64>>,
    speed: Option<Spanned<f64>>,
    feed: Option<Spanned<f64>>,
    peck: Option<Spanned<f64>>,
}

/// mm/min, in the paper.
const FEED: f64 = 60.0;
/// r/min; the paper names none.
const SPEED: f64 = 1000.0;

/// Reads the text of a job of this family.
pub(in crate::job) fn parse(reader: &Reader<'_>) -> Result<Honeycomb, JobError> {
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
    fn check(&self, reader: &Reader<'_>) -> Result<CombMachine, JobError> {
        let (clearance, retract) = heights(reader, self.clearance.as_ref(), self.retract.as_ref())?;
        let clamp = self.clamp.as_ref().map(|clamp| clamp.check(reader)).transpose()?;
        Ok(CombMachine { rotary: self.rotary.check(reader)?, clearance, retract, clamp })
    }
}

impl FileClamp {
    fn check(&self, reader: &Reader<'_>) -> Result<Clamp, JobError> {
        let own = |key: &str, value: &Spanned<i64>| {
            let code = *value.as_ref();
            let taken = [19, 29, 30, 98, 99].contains(&code);
            if (10..=999).contains(&code) && !taken {
                return Ok(code as u32);
            }
            let allowed = "an M code of the machine's own, 10 to 999 without 19, 29, 30, 98, 99";
            Err(reader.error(value, format!("key 'machine.clamp.{key}' is {code}: {allowed}")))
        };
        let clamp = Clamp { on: own("on", &self.on)?, off: own("off", &self.off)? };
        if clamp.on == clamp.off {
            let message = format!("key 'machine.clamp.off' is {}, which is 'on' too", clamp.off);
            return Err(reader.error(&self.off, message));
        }
        Ok(clamp)
    }
}

impl FileCylinder {
    fn check(&self, reader: &Reader<'_>) -> Result<Cylinder, JobError> {
        let diameter = length(reader, "cylinder.diameter", &self.diameter)?;
        let outer = match &self.outer {
            Some(outer) => {
                let allowed = format!("from the diameter of {diameter} mm to 99999 mm");
                reader.number("cylinder.outer", outer, &allowed, within(diameter, 99_999.0))?
            }
            None => diameter,
        };
        let bore = match &self.bore {
            Some(bore) => {
                let allowed = format!("0 to the diameter of {diameter} mm");
                reader.number("cylinder.bore", bore, &allowed, within(0.0, diameter))?
            }
            None => 0.0,
        };
        Ok(Cylinder { diameter, length: length(reader, "cylinder.length", &self.length)?, outer, bore })
    }
}

impl FileDrill {
    fn check(&self, reader: &Reader<'_>, cylinder: &Cylinder) -> Result<Drill, JobError> {
        let diameter = length(reader, "drill.diameter", &self.diameter)?;
        let radius = cylinder.outer / 2.0;
        let depth = length(reader, "drill.depth", &self.depth)?;
        if depth >= radius {
            let message = format!(
                "key 'drill.depth' is {depth}: below the radius of {radius} mm, for the holes meet on the axis"
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
            value.as_ref().map_or(Ok(or), |value| reader.number(key, value, allowed, within(least, most)))
        };
        let speed = match &self.speed {
            Some(speed) => {
                let allowed = "a whole number from 1 to 99999 r/min";
                reader
                    .number("drill.speed", speed, allowed, |v| within(1.0, 99_999.0)(v) && v.fract() == 0.0)?
            }
            None => SPEED,
        };
        Ok(Drill {
            number,
            diameter,
            depth,
            speed,
            feed: or("drill.feed", &self.feed, "0.01 to 240000 mm/min", 0.01, 240_000.0, FEED)?,
            peck: or("drill.peck", &self.peck, "0.01 to 9999 mm", 0.01, 9_999.0, diameter)?,
        })
    }
}

/// The pitch or the divisions; whether the pattern that follows is possible, the part's geometry tells.
fn spacing(
    reader: &Reader<'_>,
    pattern: &Spanned<FilePattern>,
    cylinder: &Cylinder,
    drill: &Drill,
) -> Result<Spacing, JobError> {
    let FilePattern { pitch, divisions, .. } = pattern.as_ref();
    match (pitch, divisions) {
        (Some(_), Some(divisions)) => Err(reader
            .error(divisions, "key 'pattern.divisions' goes without 'pitch': each follows from the other")),
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
                return told(format!("above the drill's diameter of {diameter} mm, else the holes overlap"));
            }
            let (most, diameter) = (largest_pitch(cylinder.diameter), cylinder.diameter);
            if most < pitch {
                return told(format!(
                    "at most {most:.3} mm, or fewer than two rows fit round diameter {diameter}"
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
