//! The job file of the family `honeycomb`: a hexagonal pattern of radial holes on a cylinder.
mod file;

pub(super) use file::{File, parse};

use super::{JobControl, Rotary, SheetInfo};

/// A honeycomb on a cylinder about x; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Honeycomb {
    pub control: JobControl,
    pub machine: CombMachine,
    pub cylinder: Cylinder,
    pub spacing: Spacing,
    pub metric: Metric,
    pub drill: Drill,
    /// Diameter of the tolerance zone.
    pub position_tolerance: f64,
    /// How far a hole's depth may be off.
    pub depth_tolerance: f64,
    pub sheet: SheetInfo,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CombMachine {
    pub rotary: Rotary,
    /// How far above the surface rapid becomes feed.
    pub clearance: f64,
    /// Whether the job says that.
    pub is_clearance_specified: bool,
    /// How far above the surface the tool is while the rotary turns.
    pub retract: f64,
    /// Whether the job says that: where it doesn't, the default is no demand on other programs.
    pub is_retract_specified: bool,
    pub clamp: Option<Clamp>,
}

/// The M codes that hold the rotary and let it go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clamp {
    pub on: u32,
    pub off: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// On which the pitch is to hold.
    pub diameter: f64,
    /// Holes stand at 0 ≤ x ≤ length.
    pub length: f64,
    /// Where the holes begin.
    pub outer: f64,
    /// 0 where the cylinder is solid.
    pub bore: f64,
}

/// What was asked for: the other one follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// Between neighbours, before the pattern is closed.
    Pitch(f64),
    /// Rows of one group round the circumference.
    Divisions(u32),
}

/// How the distance of neighbours counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// On the developed surface.
    Arc,
    /// Straight, as a calliper measures.
    Chord,
}

impl Metric {
    pub const ALL: [(&str, Self); 2] = [("arc", Self::Arc), ("chord", Self::Chord)];

    pub fn name(self) -> &'static str {
        match self {
            Self::Arc => "arc",
            Self::Chord => "chord",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drill {
    /// Its number, and that of its length offset.
    pub number: u32,
    pub diameter: f64,
    pub depth: f64,
    /// r/min.
    pub speed: f64,
    /// mm/min.
    pub feed: f64,
    /// Of G83, which a hole deeper than three diameters gets.
    pub peck: f64,
    pub specified: SpecifiedFields,
}

/// Which of its numbers the job says: where it doesn't, the default is no demand on other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpecifiedFields {
    pub has_number: bool,
    pub has_speed: bool,
    pub has_feed: bool,
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
