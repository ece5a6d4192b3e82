//! The job file of the family `honeycomb`: a hexagonal pattern of radial holes on a cylinder.
mod file;

pub(super) use file::{File, parse};

use super::{JobControl, Rotary, SheetInfo};

/// A honeycomb on a cylinder about x; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Honeycomb {
    /// Control of the programs.
    pub control: JobControl,
    /// Machine.
    pub machine: CombMachine,
    /// Part.
    pub cylinder: Cylinder,
    /// Specified pitch or divisions.
    pub spacing: Spacing,
    /// Metric of the distance between neighbours.
    pub metric: Metric,
    /// Tool and holes.
    pub drill: Drill,
    /// Diameter of the tolerance zone.
    pub position_tolerance: f64,
    /// Tolerance of a hole's depth, either way.
    pub depth_tolerance: f64,
    /// Additional data for the set-up sheet.
    pub sheet: SheetInfo,
}

/// Machine of a honeycomb job; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CombMachine {
    /// Rotary table.
    pub rotary: Rotary,
    /// Height above the surface at which rapid motion becomes feed.
    pub clearance: f64,
    /// True if the job specifies the clearance.
    pub is_clearance_specified: bool,
    /// Height above the surface while the rotary table rotates.
    pub retract: f64,
    /// True if the job specifies the retract height; a default does not constrain other programs.
    pub is_retract_specified: bool,
    /// M codes of the rotary clamp; `None` if the job names none.
    pub clamp: Option<Clamp>,
}

/// M codes that clamp and release the rotary table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clamp {
    /// M code that clamps.
    pub on: u32,
    /// M code that releases.
    pub off: u32,
}

/// Cylinder or tube; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Diameter at which the pitch applies.
    pub diameter: f64,
    /// Holes lie at 0 ≤ x ≤ length.
    pub length: f64,
    /// Diameter at which the holes begin.
    pub outer: f64,
    /// Bore diameter; 0 for a solid cylinder.
    pub bore: f64,
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
    /// All metrics with their names in job files.
    pub const ALL: [(&str, Self); 2] = [("arc", Self::Arc), ("chord", Self::Chord)];

    /// Returns the name in job files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arc => "arc",
            Self::Chord => "chord",
        }
    }
}

/// Tool of a honeycomb job and the holes it makes; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drill {
    /// Number of the tool and of its length offset.
    pub number: u32,
    /// Diameter of the drill.
    pub diameter: f64,
    /// Depth of the holes.
    pub depth: f64,
    /// Spindle speed, r/min.
    pub speed: f64,
    /// Feed, mm/min.
    pub feed: f64,
    /// Depth of cut of G83, used for holes deeper than three diameters.
    pub peck: f64,
    /// Fields that the job specifies.
    pub specified: SpecifiedFields,
}

/// Fields of [`Drill`] that the job specifies; a default does not constrain other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpecifiedFields {
    /// True if the job specifies the number.
    pub has_number: bool,
    /// True if the job specifies the speed.
    pub has_speed: bool,
    /// True if the job specifies the feed.
    pub has_feed: bool,
    /// True if the job specifies the depth of cut.
    pub has_peck: bool,
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
    fn what_is_left_out_has_its_default() {
        let job = parsed(MINIMAL);
        assert_eq!(job.cylinder, Cylinder { diameter: 500.0, length: 300.0, outer: 500.0, bore: 0.0 });
        assert_eq!((job.machine.clearance, job.machine.retract, job.machine.clamp), (2.0, 50.0, None));
        assert_eq!((job.drill.number, job.drill.feed, job.drill.peck), (1, 60.0, 5.0));
        assert_eq!(job.spacing, Spacing::Pitch(10.0));
    }

    #[test]
    fn everything_a_job_can_say() {
        let text = MINIMAL
            .replace("sign = 1 }", "sign = -1 }\nclearance = 1\nretract = 20\nclamp = { on = 10, off = 11 }")
            .replace("length = 300.0", "length = 300.0\nouter = 520\nbore = 480")
            .replace("pitch = 10.0", "divisions = 91")
            .replace("\"arc\"", "\"chord\"")
            .replace("depth = 12.0", "depth = 12.0\nnumber = 7\nspeed = 900\nfeed = 50\npeck = 2");
        let job = parsed(&text);
        assert_eq!((job.spacing, job.metric), (Spacing::Divisions(91), Metric::Chord));
        assert_eq!(job.machine.clamp, Some(Clamp { on: 10, off: 11 }));
        assert_eq!((job.cylinder.outer, job.cylinder.bore), (520.0, 480.0));
        assert_eq!((job.drill.number, job.drill.speed, job.drill.peck), (7, 900.0, 2.0));
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
                "line 15: key 'dril' is unknown; allowed: family, control, machine, tolerance, cylinder, \
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
            let told = Job::parse(&text).map_or_else(|error| error.to_string(), |_| "no error".to_owned());
            assert_eq!(told, message, "{from:?} -> {to:?}");
        }
    }
}
