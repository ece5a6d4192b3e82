//! Contents of a burr's pictures: outline, flutes, faults and helix angles.
use crate::scene::HoleStatus;

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

/// The site of a finding.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Position on the surface.
    pub point: FlutePoint,
    /// Index of the pass; `None` if no pass is there.
    pub pass: Option<usize>,
    /// Status that selects the symbol.
    pub status: HoleStatus,
    /// Faults in a few words each; empty if another mark of the same finding names it.
    pub labels: Vec<&'static str>,
}

/// A point of a flute in the part's frame.
#[derive(Clone, Copy, Debug)]
pub struct FlutePoint {
    /// Position, mm.
    pub position: [f64; 3],
    /// Unit vector out of the surface.
    pub normal: [f64; 3],
}

/// Helix angles along the flutes in degrees, negative for left-hand flutes.
///
/// Distances are in mm along the tooth bottom's outline from the shank's end.
#[derive(Clone, Debug, Default)]
pub struct HelixCourses {
    /// Angles along each pass, in the order of grinding.
    pub passes: Vec<Vec<HelixPoint>>,
    /// Index of the pass with the largest deviation from the law.
    pub worst_pass: usize,
    /// Tolerance of the helix angle, either way.
    pub tolerance: f64,
    /// Names of the specified law and of the other one.
    pub laws: [&'static str; 2],
    /// Angles of both laws along the outline, used if no pass is ground.
    pub nominal: Vec<HelixPoint>,
    /// Distances along the nose, with the polar angle at each.
    pub nose: Vec<(f64, String)>,
}

/// Helix angles at one distance from the shank's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelixPoint {
    /// Distance from the shank's end, mm.
    pub path_length: f64,
    /// Actual angle.
    pub actual: f64,
    /// Angle by the specified law.
    pub nominal: f64,
    /// Angle by the other law.
    pub other_law: f64,
}

impl HelixPoint {
    /// Returns actual − nominal.
    pub(super) fn error(&self) -> f64 {
        self.actual - self.nominal
    }
}
