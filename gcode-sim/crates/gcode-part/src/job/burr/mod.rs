//! The job file of the family `burr`: ball-end rotary burrs on a 5-axis grinder.
mod file;

pub(super) use file::{File, parse};

use super::{JobControl, SheetInfo};

/// A ball-end rotary burr; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Burr {
    /// Control of the programs.
    pub control: JobControl,
    /// Tooth-bottom shape.
    pub shape: BurrShape,
    /// Number of flutes.
    pub flutes: u32,
    /// Helix angle to the burr's axis; negative for a left-hand burr.
    pub helix: f64,
    /// Law of the helix angle on the nose.
    pub law: FluteLaw,
    /// Tolerance of the contact path's distance from the flute, rounding included.
    pub chord_error: f64,
    /// Machine.
    pub grinder: Grinder,
    /// Form and conditions of the program.
    pub program: BurrProgram,
    /// Tolerances of the flutes.
    pub tolerance: BurrTolerance,
    /// Additional data for the set-up sheet.
    pub sheet: SheetInfo,
}

impl Burr {
    /// Returns the length of the stretch over which a flute's helix angle is measured, mm.
    ///
    /// A path that may deviate from the flute by the chord error has no defined direction at a point; it has
    /// one over a length against which that error is small. 0.5 mm, or 250 chord errors where that is more,
    /// keep the error of the angle below 0.23°, away from the tip.
    pub fn gauge(&self) -> f64 {
        (250.0 * self.chord_error).max(0.5)
    }
}

/// The tooth bottom: a cylinder and a nose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurrShape {
    /// Radius of the cylinder.
    pub radius: f64,
    /// Length of the flutes along the axis, nose included.
    pub length: f64,
    /// Nose beyond the cylinder.
    pub nose: Nose,
    /// Angle between the axis and the nose's normal at the end of a flute.
    pub tip_angle: f64,
    /// Height of the blank above the tooth bottom.
    pub tooth_depth: f64,
}

/// Shape of the nose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nose {
    /// A half ball of the cylinder's radius.
    Ball,
    /// An ellipse in the meridian plane, approximated by two arcs with radii `large` and `small`. The large
    /// arc is tangent to the cylinder; the small one is tangent to the large one and centred on the axis.
    Arcs {
        /// Radius of the arc that is tangent to the cylinder, mm.
        large: f64,
        /// Radius of the arc at the tip, mm.
        small: f64,
    },
}

/// Law of the helix angle on the nose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FluteLaw {
    /// The helix angle is the same up to the tip: a loxodrome.
    ConstantHelix,
    /// The law of the paper: the angle of A is tan B times the travel along the axis over the local radius.
    Published,
}

impl FluteLaw {
    /// All laws with their names in job files.
    pub const ALL: [(&str, Self); 2] =
        [("constant-helix", Self::ConstantHelix), ("published", Self::Published)];

    /// Returns the name in job files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, law)| *law == self).map_or("", |(name, _)| name)
    }
}

/// A 5-axis grinder: X and Y move a table C that carries the burr, A rotates the burr, B swivels the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grinder {
    /// x and y from the C axis to the end of the burr's cylinder (centre of a ball nose) at C0.
    pub c_offset: [f64; 2],
    /// Directions of the axes.
    pub signs: AxisSigns,
    /// True if the job specifies the signs; a default does not constrain other programs.
    pub are_signs_specified: bool,
    /// Distance from the blank at which rapid motion becomes feed, and at which the burr is indexed.
    pub clearance: f64,
    /// True if the job specifies the clearance.
    pub is_clearance_specified: bool,
}

/// Directions of the axes: 1 for an axis that follows the formulas, −1 for a reversed one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSigns {
    /// Sign of X.
    pub x: i8,
    /// Sign of Y.
    pub y: i8,
    /// Sign of A.
    pub a: i8,
    /// Sign of B.
    pub b: i8,
    /// Sign of C.
    pub c: i8,
}

/// Form and conditions of a burr program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurrProgram {
    /// Form of the moves.
    pub form: ProgramForm,
    /// Speed of the contact along the flute, mm/min.
    pub speed: f64,
    /// True if the job specifies that speed; a default does not constrain other programs.
    pub is_speed_specified: bool,
    /// Feed into the blank, mm/min.
    pub plunge: f64,
    /// True if the job specifies the plunge feed.
    pub is_plunge_specified: bool,
    /// Wheel speed, r/min.
    pub wheel: f64,
    /// True if the job specifies the wheel speed.
    pub is_wheel_specified: bool,
}

/// Form in which the moves of a flute are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramForm {
    /// A resident macro computes the moves on the control.
    Loop,
    /// Every move is written out in the program.
    Moves,
}

/// Tolerances of a burr's flutes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurrTolerance {
    /// Tolerance of the helix angle, either way, degrees.
    pub helix: f64,
    /// Tolerance of a flute's azimuth, either way, degrees.
    pub index: f64,
}
