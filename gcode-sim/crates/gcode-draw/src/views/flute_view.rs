//! Contents of a burr's pictures: outline, flutes, faults and helix angles.
use super::super::role::HoleStatus;

/// Contents of a burr's pictures; mm and degrees.
#[derive(Clone, Debug)]
pub struct FluteView {
    /// Name of the program.
    pub name: String,
    /// Verdict on the flutes, with its sentence.
    pub verdict: (HoleStatus, String),
    /// Further lines of the title block.
    pub lines: Vec<String>,
    /// Tooth bottom along the axis and away from it, from the shank's end of the flutes to the pole.
    pub outline: Vec<[f64; 2]>,
    /// Radius of the circle at which the flutes end.
    pub tip_radius: f64,
    /// Points of each pass, in the order of grinding.
    pub flutes: Vec<Vec<FlutePoint>>,
    /// Places of the findings.
    pub faults: Vec<Fault>,
    /// Helix angles along the flutes.
    pub helix: HelixCourses,
}

/// The place of a finding.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Position on the surface.
    pub spot: FlutePoint,
    /// Index of the pass; `None` if no pass is there.
    pub pass: Option<usize>,
    /// Status that selects the symbol.
    pub standing: HoleStatus,
    /// Faults in a few words each; empty if another mark of the same finding names it.
    pub what: Vec<&'static str>,
}

/// A point of a flute in the part's frame.
#[derive(Clone, Copy, Debug)]
pub struct FlutePoint {
    /// Position, mm.
    pub at: [f64; 3],
    /// Unit vector out of the surface.
    pub out: [f64; 3],
}

/// Helix angles along the flutes in degrees, negative for left-hand flutes.
///
/// Distances are in mm along the tooth bottom's outline from the shank's end.
#[derive(Clone, Debug, Default)]
pub struct HelixCourses {
    /// Angles along each pass, in the order of grinding.
    pub passes: Vec<Vec<HelixAt>>,
    /// Index of the pass with the largest deviation from the law.
    pub worst: usize,
    /// Tolerance of the helix angle, either way.
    pub tolerance: f64,
    /// Names of the specified law and of the other one.
    pub laws: [&'static str; 2],
    /// Angles of both laws along the outline, used if no pass is ground.
    pub wanted: Vec<HelixAt>,
    /// Distances along the nose, with the polar angle at each.
    pub nose: Vec<(f64, String)>,
}

/// Helix angles at one distance from the shank's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelixAt {
    /// Distance from the shank's end, mm.
    pub way: f64,
    /// Actual angle.
    pub found: f64,
    /// Angle by the specified law.
    pub wanted: f64,
    /// Angle by the other law.
    pub other: f64,
}

impl HelixAt {
    /// Returns actual − nominal.
    pub(super) fn off(&self) -> f64 {
        self.found - self.wanted
    }
}
