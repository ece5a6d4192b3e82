//! The job file of the family `honeycomb`: a hexagonal pattern of radial holes on a cylinder.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    CLEARANCE, Family, FileError, HoleTolerance, JobControl, Reader, Rotary, SheetInfo, check_retract,
    retract_height,
};
use crate::reader::bounds::{
    ClampCode, Depth, Divisions, DrillNumber, FeedRate, KeyRange, Length, OuterDiameter, Radius, Retract,
    SpindleSpeed,
};
use crate::reader::{FileKey, Optional, Section, Word, WordList};

/// A hexagonal pattern of radial holes on a cylinder about x.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Honeycomb {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["honeycomb"]))]
    _family: String,
    /// The control of the programs.
    #[serde(with = "Section::<JobControl>")]
    pub control: JobControl,
    /// The machine.
    #[serde(with = "Section::<CombMachine>")]
    pub machine: CombMachine,
    /// Tolerances of the holes.
    #[serde(with = "Section::<HoleTolerance>")]
    pub tolerance: HoleTolerance,
    /// The part.
    #[serde(with = "Section::<Cylinder>")]
    pub cylinder: Cylinder,
    /// The pattern of the holes.
    #[serde(with = "Section::<HolePattern>")]
    pub pattern: HolePattern,
    /// The tool and the holes it makes.
    #[serde(with = "Section::<Drill>")]
    pub drill: Drill,
    /// Additional data for the set-up sheet.
    #[serde(default, with = "Section::<SheetInfo>")]
    pub sheet: SheetInfo,
}

/// The machine of a honeycomb job.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CombMachine {
    /// The axis that rotates the part.
    #[serde(with = "Section::<Rotary>")]
    pub rotary: Rotary,
    /// Distance from the surface where the feed begins, mm [default: 2].
    #[serde(default, with = "Optional::<Depth>")]
    pub(crate) clearance: Option<f64>,
    /// Retract height above the surface between holes, mm, no less than the clearance [default: 50].
    #[serde(default, with = "Optional::<Retract>")]
    pub(crate) retract: Option<f64>,
    /// The M codes that clamp and release the rotary [default: none].
    #[serde(default, with = "Optional::<Section<Clamp>>")]
    pub clamp: Option<Clamp>,
}

/// M codes of the machine's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clamp {
    /// M code that clamps the rotary.
    #[serde(with = "ClampCode")]
    pub on: u32,
    /// M code that releases the rotary.
    #[serde(with = "ClampCode")]
    pub off: u32,
}

/// The part: holes lie at 0 ≤ x ≤ length.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Diameter of the pitch, mm.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// Length, mm.
    #[serde(with = "Length")]
    pub length: f64,
    /// Where the holes begin, mm, no less than diameter [default: diameter].
    #[serde(default, with = "Optional::<OuterDiameter>")]
    outer: Option<f64>,
    /// Bore of a tube, mm, no more than diameter [default: 0, solid].
    #[serde(default, with = "Radius")]
    pub bore: f64,
}

/// How the holes are spaced: by pitch or by divisions, the other one follows.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["pitch"] }, { "required": ["divisions"] }]))]
pub struct HolePattern {
    /// Distance between neighbours, mm, above the drill diameter; adjusted so that the pattern closes.
    #[serde(default, with = "Optional::<Length>")]
    pitch: Option<f64>,
    /// Rows of one group round the circumference.
    #[serde(default, with = "Optional::<Divisions>")]
    divisions: Option<u32>,
    /// Metric of the distance between neighbours: arc on the surface, or chord.
    #[serde(with = "Word::<Metric>")]
    pub metric: Metric,
}

/// Specified dimension of the pattern; the other one follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// Distance between neighbours before the pattern is closed, mm.
    Pitch(f64),
    /// Rows of one group round the circumference.
    Divisions(u32),
}

/// Metric of the distance between neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Length on the developed surface.
    Arc,
    /// Straight distance, as a calliper measures it.
    Chord,
}

impl Metric {
    /// Returns the name in job files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arc => "arc",
            Self::Chord => "chord",
        }
    }
}

impl WordList for Metric {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        [Self::Arc, Self::Chord].map(|metric| (metric.name(), metric)).into()
    }
}

/// The tool and the holes it makes. A default does not constrain other programs.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drill {
    /// Diameter of the drill, mm.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// Depth of the holes, mm, below the radius of the part.
    #[serde(with = "Length")]
    pub depth: f64,
    /// Number of the tool and of its length offset [default: 1].
    #[serde(default, with = "Optional::<DrillNumber>")]
    pub(crate) number: Option<u32>,
    /// Spindle speed, a whole number of r/min [default: 1000].
    #[serde(default, with = "Optional::<SpindleSpeed>")]
    pub(crate) speed: Option<f64>,
    /// Feed, mm/min [default: 60].
    #[serde(default, with = "Optional::<FeedRate>")]
    pub(crate) feed: Option<f64>,
    /// Depth of cut of G83, mm, for holes deeper than three diameters [default: the diameter].
    #[serde(default, with = "Optional::<Depth>")]
    pub(crate) peck: Option<f64>,
}

impl CombMachine {
    /// Returns the height above the surface at which rapid motion becomes feed, mm.
    pub fn clearance(&self) -> f64 {
        self.clearance.unwrap_or(CLEARANCE)
    }

    /// Returns the height above the surface while the rotary table rotates, mm.
    pub fn retract(&self) -> f64 {
        retract_height(self.retract, self.clearance())
    }
}

impl Cylinder {
    /// Returns the diameter at which the holes begin, mm.
    pub fn outer(&self) -> f64 {
        self.outer.unwrap_or(self.diameter)
    }
}

impl HolePattern {
    /// Returns the pitch or the divisions, of which a job has one.
    pub fn spacing(&self) -> Spacing {
        match self.pitch {
            Some(pitch) => Spacing::Pitch(pitch),
            None => Spacing::Divisions(self.divisions.unwrap_or_default()),
        }
    }
}

impl Drill {
    /// Returns the number of the tool and of its length offset.
    pub fn number(&self) -> u32 {
        self.number.unwrap_or(1)
    }

    /// Returns the spindle speed, r/min; the paper gives none.
    pub fn speed(&self) -> f64 {
        self.speed.unwrap_or(1000.0)
    }

    /// Returns the feed, mm/min; by default that of the paper.
    pub fn feed(&self) -> f64 {
        self.feed.unwrap_or(60.0)
    }

    /// Returns the depth of cut of G83, mm, used for holes deeper than three diameters.
    pub fn peck(&self) -> f64 {
        self.peck.unwrap_or(self.diameter)
    }
}

impl Family for Honeycomb {
    fn check(&mut self, reader: &Reader<'_>) -> Result<(), FileError> {
        check_retract(reader, self.machine.retract(), self.machine.clearance())?;
        if let Some(Clamp { on, off }) = self.machine.clamp
            && on == off
        {
            let message = format!("key 'machine.clamp.off' is {off}, the same as 'on'");
            return Err(reader.error_at("machine.clamp.off", message));
        }
        self.cylinder.check(reader)?;
        let (depth, radius) = (self.drill.depth, self.cylinder.outer() / 2.0);
        let allowed = format_args!("below the radius of {radius} mm, because the holes meet on the axis");
        reader.check(depth < radius, "drill.depth", depth, allowed)?;
        self.check_spacing(reader)
    }
}

impl Cylinder {
    fn check(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let Self { diameter, bore, .. } = *self;
        let (outer, most) = (self.outer(), OuterDiameter::MAX);
        let allowed = format_args!("from the diameter of {diameter} mm to {most} mm");
        reader.check((diameter..=most).contains(&outer), "cylinder.outer", outer, allowed)?;
        let allowed = format_args!("0 to the diameter of {diameter} mm");
        reader.check((0.0..=diameter).contains(&bore), "cylinder.bore", bore, allowed)?;
        let allowed = format_args!("below the outer diameter of {outer} mm, because the tube needs a wall");
        reader.check(bore < outer, "cylinder.bore", bore, allowed)
    }
}

impl Honeycomb {
    /// Checks the pitch or the divisions. The geometry of the part decides later whether the pattern is
    /// possible.
    fn check_spacing(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let pitch = match (self.pattern.pitch, self.pattern.divisions) {
            (Some(_), Some(_)) => {
                let message = "key 'pattern.divisions' excludes 'pitch': each follows from the other";
                return Err(reader.error_at("pattern.divisions", message));
            }
            (None, None) => {
                let message = "key 'pattern.pitch' is missing: give it, or 'divisions' instead";
                return Err(reader.error_at("pattern", message));
            }
            (None, Some(_)) => return Ok(()),
            (Some(pitch), None) => pitch,
        };
        let (drill, diameter) = (self.drill.diameter, self.cylinder.diameter);
        let allowed = format_args!("above the drill diameter of {drill} mm, otherwise the holes overlap");
        reader.check(drill < pitch, "pattern.pitch", pitch, allowed)?;
        let most = largest_pitch(diameter);
        let allowed =
            format_args!("at most {most:.3} mm, otherwise fewer than two rows fit round diameter {diameter}");
        reader.check(pitch <= most, "pattern.pitch", pitch, allowed)
    }
}

/// Returns the largest pitch with two rows of each group, in whole micrometres.
///
/// Rows of one group are √3 pitches apart; one and a half of them fill the circumference.
fn largest_pitch(diameter: f64) -> f64 {
    let most = std::f64::consts::PI * diameter / (1.5 * 3.0f64.sqrt());
    (most * 1e3).floor() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;

    const MINIMAL: &str = r#"family = "honeycomb"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = { letter = "B", sign = 1 }
[tolerance]
position = 0.1
[cylinder]
diameter = 500.0
length = 300.0
[pattern]
pitch = 10.0
metric = "arc"
[drill]
diameter = 5.0
depth = 12.0
"#;

    fn parsed(text: &str) -> Honeycomb {
        match Job::parse(text) {
            Ok(Job::Honeycomb(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_key_that_is_left_out_has_its_default() {
        let job = parsed(MINIMAL);
        assert_eq!((job.cylinder.outer(), job.cylinder.bore), (500.0, 0.0));
        assert_eq!((job.machine.clearance(), job.machine.retract(), job.machine.clamp), (2.0, 50.0, None));
        assert_eq!((job.drill.number(), job.drill.feed(), job.drill.peck()), (1, 60.0, 5.0));
        assert_eq!(job.pattern.spacing(), Spacing::Pitch(10.0));
    }

    #[test]
    fn every_key_of_a_job_is_read() {
        let text = MINIMAL
            .replace("sign = 1 }", "sign = -1 }\nclearance = 1\nretract = 20\nclamp = { on = 10, off = 11 }")
            .replace("length = 300.0", "length = 300.0\nouter = 520\nbore = 480")
            .replace("pitch = 10.0", "divisions = 91")
            .replace("\"arc\"", "\"chord\"")
            .replace("depth = 12.0", "depth = 12.0\nnumber = 7\nspeed = 900\nfeed = 50\npeck = 2");
        let job = parsed(&text);
        assert_eq!((job.pattern.spacing(), job.pattern.metric), (Spacing::Divisions(91), Metric::Chord));
        assert_eq!(job.machine.clamp, Some(Clamp { on: 10, off: 11 }));
        assert_eq!((job.cylinder.outer(), job.cylinder.bore), (520.0, 480.0));
        assert_eq!((job.drill.number(), job.drill.speed(), job.drill.peck()), (7, 900.0, 2.0));
    }

    #[test]
    fn every_error_names_the_key_the_line_and_what_is_allowed() {
        for (from, to, message) in [
            (
                "pitch = 10.0\n",
                "",
                "line 12: key 'pattern.pitch' is missing: give it, or 'divisions' instead",
            ),
            (
                "pitch = 10.0",
                "pitch = 10.0\ndivisions = 91",
                "line 14: key 'pattern.divisions' excludes 'pitch': each follows from the other",
            ),
            ("pitch = 10.0", "divisions = 1", "line 13: key 'pattern.divisions' is 1: 2 to 100000"),
            (
                "pitch = 10.0",
                "pitch = 4.9",
                "line 13: key 'pattern.pitch' is 4.9: above the drill diameter of 5 mm, otherwise the holes overlap",
            ),
            (
                "pitch = 10.0",
                "pitch = 700.0",
                "line 13: key 'pattern.pitch' is 700: at most 604.599 mm, otherwise fewer than two rows \
                 fit round diameter 500",
            ),
            ("pitch = 10.0", "pitch = -1", "line 13: key 'pattern.pitch' is -1: 0.01 to 99999 mm"),
            ("\"arc\"", "\"straight\"", "line 14: key 'pattern.metric' is 'straight': one of arc, chord"),
            (
                "depth = 12.0",
                "depth = 250",
                "line 17: key 'drill.depth' is 250: below the radius of 250 mm, because the holes meet on the axis",
            ),
            (
                "length = 300.0",
                "length = 300.0\nouter = 499",
                "line 12: key 'cylinder.outer' is 499: from the diameter of 500 mm to 99999 mm",
            ),
            (
                "length = 300.0",
                "length = 300.0\nbore = 501",
                "line 12: key 'cylinder.bore' is 501: 0 to the diameter of 500 mm",
            ),
            (
                "length = 300.0",
                "length = 300.0\nbore = 500",
                "line 12: key 'cylinder.bore' is 500: below the outer diameter of 500 mm, because the tube \
                 needs a wall",
            ),
            (
                "sign = 1 }",
                "sign = 1 }\nclamp = { on = 10, off = 10 }",
                "line 7: key 'machine.clamp.off' is 10, the same as 'on'",
            ),
            (
                "sign = 1 }",
                "sign = 1 }\nclamp = { on = 30, off = 10 }",
                "line 7: key 'machine.clamp.on' is 30: an M code of the machine's own, 10 to 999 without 19, 29, 30, 98, 99",
            ),
            ("length = 300.0\n", "", "line 9: key 'cylinder.length' is missing"),
            (
                "[drill]",
                "[dril]",
                "line 15: key 'dril' is unknown (did you mean 'drill'?); allowed: family, control, machine, tolerance, cylinder, \
                 pattern, drill, sheet",
            ),
            (
                "depth = 12.0",
                "depth = 12.0\nspeed = 900.5",
                "line 18: key 'drill.speed' is 900.5: a whole number from 1 to 99999 r/min",
            ),
        ] {
            let text = MINIMAL.replace(from, to);
            assert_ne!(text, MINIMAL, "'{from}' is not in the job");
            let found = Job::parse(&text).map_or_else(|error| error.to_string(), |_| "no error".to_owned());
            assert_eq!(found, message, "{from:?} -> {to:?}");
        }
    }
}
