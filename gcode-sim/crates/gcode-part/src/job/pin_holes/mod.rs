//! The job file of the family `pin-holes`: holes on an ellipsoid of revolution.
mod file;
mod tools;

pub(super) use file::{File, FileMachine, FileSurface, parse};

use super::{JobControl, Rotary, SheetInfo};

/// Pin holes on an ellipsoid of revolution; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct PinHoles {
    /// Control of the programs.
    pub control: JobControl,
    /// Machine.
    pub machine: PinMachine,
    /// Surface in which the holes begin.
    pub surface: Surface,
    /// Diameter of the tolerance zone.
    pub position_tolerance: f64,
    /// Tolerance of a hole's depth, either way.
    pub depth_tolerance: f64,
    /// Tools in the order of use.
    pub tools: Vec<Tool>,
    /// True if the job specifies the tools; those of the paper do not constrain other programs.
    pub are_tools_specified: bool,
    /// Common variables of the macros.
    pub macros: MacroSettings,
    /// Holes in the order of drilling.
    pub holes: Vec<HoleSpec>,
    /// Additional data for the set-up sheet.
    pub sheet: SheetInfo,
}

/// Ellipsoid of revolution about y: (x² + z²)/a² + y²/b² = 1; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Equatorial radius.
    pub a: f64,
    /// Polar radius, along the axis of revolution y.
    pub b: f64,
}

/// Machine of a pin-hole or alignment job; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct PinMachine {
    /// Rotary table.
    pub rotary: Rotary,
    /// Head that inclines the tool.
    pub head: Head,
    /// Distance from the surface along the hole at which rapid motion becomes feed.
    pub clearance: f64,
    /// Distance from the surface along the hole to which the tool retracts before the rotary table rotates.
    pub retract: f64,
    /// True if the job specifies the retract height; a default does not constrain other programs.
    pub is_retract_specified: bool,
    /// True if the job specifies the clearance.
    pub is_clearance_specified: bool,
}

/// A head that inclines the tool in the xy plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// Manual setting or axis.
    pub kind: HeadKind,
    /// Distance from the pivot to the gauge line of the spindle. With `pivot = 0` and tools of length 0 the
    /// programmed point is the tool's tip, which is set again after each rotation of the head.
    pub pivot: f64,
}

/// Setting of the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadKind {
    /// An operator sets the head by hand at a stop.
    Manual,
    /// An axis of the control; its angle counts from x towards y.
    Axis(char),
}

/// A tool; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// Number of the tool and of its length offset.
    pub number: u32,
    /// Diameter.
    pub diameter: f64,
    /// Distance from the gauge line of the spindle to the tip.
    pub length: f64,
    /// Spindle speed, r/min.
    pub speed: f64,
    /// Feed into the hole, mm/min.
    pub feed: f64,
    /// Feed out of the hole, mm/min.
    pub retract_feed: f64,
    /// Name in messages and on the set-up sheet.
    pub name: String,
}

/// Common variables of the macros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MacroSettings {
    /// First of two common variables: the specified head angle, and the set one.
    pub common: u32,
}

/// Direction of a hole's axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisDirection {
    /// Parallel to y.
    Axial,
    /// Along the surface normal.
    Normal,
}

/// A hole as the job specifies it; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct HoleSpec {
    /// Unique name.
    pub id: String,
    /// Distance of the entry from the axis of revolution.
    pub radius: f64,
    /// Azimuth about the axis of revolution.
    pub azimuth: f64,
    /// Direction of the axis.
    pub axis: AxisDirection,
    /// Diameter.
    pub diameter: f64,
    /// Depth from the surface along the axis.
    pub depth: f64,
    /// Numbers of the tools in the order of use; the last one has the hole's diameter.
    pub tools: Vec<u32>,
}

#[cfg(test)]
mod tests {
    use super::PinHoles;
    use crate::job::Job;

    /// Parses the smallest job with one replacement and returns its error message, or "no error".
    fn told(from: &str, to: &str) -> String {
        let job = MINIMAL.replace(from, to);
        assert_ne!(job, MINIMAL, "'{from}' is not in the job");
        match Job::parse(&job) {
            Ok(_) => "no error".into(),
            Err(error) => error.to_string(),
        }
    }

    const MINIMAL: &str = r#"family = "pin-holes"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = { letter = "B", sign = 1 }
[surface]
kind = "ellipsoid"
a = 1158.8
b = 724.3
[tolerance]
position = 0.1
[[hole]]
id = "1"
radius = 420.0
azimuth = 0.0
axis = "axial"
diameter = 6.0
depth = 15.0
"#;

    #[test]
    fn every_error_names_the_key_the_line_and_what_is_allowed() {
        for (from, to, message) in [
            ("a = 1158.8\n", "", "line 7: key 'surface.a' is missing"),
            (
                "a = 1158.8",
                "a = \"wide\"",
                "line 9: key 'surface.a' is string \"wide\": a number is required",
            ),
            ("a = 1158.8", "a = inf", "line 9: key 'surface.a' is inf: 0.01 to 99999 mm"),
            ("b = 724.3", "b = 1\nc = 1", "line 11: key 'surface.c' is unknown; allowed: kind, a, b"),
            (", sign = 1", "", "line 6: key 'machine.rotary.sign' is missing"),
            ("sign = 1", "sign = 2", "line 6: key 'machine.rotary.sign' is 2: 1 or -1"),
            ("[tolerance]\nposition = 0.1\n", "", "line 1: key 'tolerance' is missing"),
            ("radius = 420.0\n", "", "line 13: key 'hole.radius' is missing"),
            (
                "420.0",
                "1158.9",
                "line 15: key 'hole.radius' is 1158.9: 0 to the equatorial radius a = 1158.8 mm",
            ),
            ("420.0", "-1", "line 15: key 'hole.radius' is -1: 0 to the equatorial radius a = 1158.8 mm"),
            ("depth = 15.0", "depth = -15.0", "line 19: key 'hole.depth' is -15: 0.01 to 9999 mm"),
            ("depth = 15.0", "depth = nan", "line 19: key 'hole.depth' is NaN: 0.01 to 9999 mm"),
            ("axial", "radial", "line 17: key 'hole.axis' is 'radial': one of axial, normal"),
            ("IS-B", "IS-Z", "line 4: key 'control.increment' is 'IS-Z': one of IS-A, IS-B, IS-C"),
            (
                "pin-holes",
                "pinholes",
                "line 1: family 'pinholes' is unknown: one of pin-holes, honeycomb, burr, alignment",
            ),
            (
                "[control]\n",
                "[contrl]\n",
                "line 2: key 'contrl' is unknown; allowed: family, control, machine, surface, tolerance, \
                 hole, tool, macro, sheet",
            ),
        ] {
            assert_eq!(told(from, to), message, "{from:?} -> {to:?}");
        }
    }

    proptest::proptest! {
        /// A mistyped job is an error with a message, or a job; never a panic.
        #[test]
        fn a_mistyped_job_is_told_or_read(place in 0usize..270, gone in 0usize..9, typed in "[ -~\n]{0,4}") {
            let start = place.min(MINIMAL.len());
            let end = (start + gone).min(MINIMAL.len());
            let text = format!("{}{typed}{}", &MINIMAL[..start], &MINIMAL[end..]);
            if let Err(error) = Job::parse(&text) {
                proptest::prop_assert!(!error.to_string().is_empty());
                proptest::prop_assert!(error.line.is_none_or(|line| line <= text.lines().count() + 1));
            }
        }

        /// Radii, azimuths and depths are read exactly.
        #[test]
        fn numbers_are_read_exactly(radius in 0.0..1158.8f64, azimuth in -720.0..720.0f64, depth in 0.01..99.0f64) {
            let text = MINIMAL
                .replace("radius = 420.0", &format!("radius = {radius:?}"))
                .replace("azimuth = 0.0", &format!("azimuth = {azimuth:?}"))
                .replace("depth = 15.0", &format!("depth = {depth:?}"));
            let hole = &job(&text).holes[0];
            proptest::prop_assert_eq!((hole.radius, hole.azimuth, hole.depth), (radius, azimuth, depth));
        }
    }

    fn job(text: &str) -> PinHoles {
        match Job::parse(text) {
            Ok(Job::PinHoles(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn whole_numbers_are_numbers() {
        let whole = MINIMAL.replace("420.0", "420").replace("724.3", "724").replace("= 0.0", "= -720");
        assert_eq!(job(&whole).holes[0].azimuth, -720.0);
    }

    #[test]
    fn each_diameter_has_its_drill_and_its_end_mill() {
        let hole =
            "[[hole]]\nid = \"2\"\nradius = 1\nazimuth = 2\naxis = \"normal\"\ndiameter = 8\ndepth = 9\n";
        let job = job(&format!("{MINIMAL}{hole}"));
        let diameters: Vec<_> = job.tools.iter().map(|tool| (tool.number, tool.diameter)).collect();
        assert_eq!(diameters, [(1, 5.9), (2, 6.0), (3, 7.9), (4, 8.0)]);
        assert_eq!(job.holes[0].tools, [1, 2]);
        assert_eq!(job.holes[1].tools, [3, 4]);
    }

    #[test]
    fn a_hole_gets_every_tool_that_is_not_larger_and_the_last_one_fits() {
        let tool = |number: u32, diameter: f64| {
            format!("[[tool]]\nnumber = {number}\ndiameter = {diameter}\nspeed = 900\nfeed = 20\n")
        };
        let fits = format!("{MINIMAL}{}{}{}", tool(7, 5.0), tool(3, 6.0), tool(4, 8.0));
        assert_eq!(job(&fits).holes[0].tools, [7, 3]);
        let small = format!("{MINIMAL}{}", tool(7, 5.0));
        assert_eq!(
            Job::parse(&small).unwrap_err().to_string(),
            "line 18: key 'hole.diameter' is 6: the last tool of hole '1' is tool 7 of diameter 5; add a [[tool]] of \
             diameter 6 as the last one"
        );
        let large = format!("{MINIMAL}{}", tool(7, 9.0));
        assert!(Job::parse(&large).unwrap_err().to_string().contains("every [[tool]] is larger"));
        let twice = format!("{MINIMAL}{}{}", tool(7, 6.0), tool(7, 6.0));
        assert_eq!(
            Job::parse(&twice).unwrap_err().to_string(),
            "line 26: key 'tool.number': 7 is used twice"
        );
    }
}
