//! The job file of the family `burr`: ball-end rotary burrs on a 5-axis grinder.
mod file;

pub(super) use file::{File, parse};

use super::{JobControl, SheetInfo};

/// A ball-end rotary burr; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Burr {
    pub control: JobControl,
    pub shape: BurrShape,
    pub flutes: u32,
    /// Against the burr's axis; below 0 for a left-hand burr.
    pub helix: f64,
    pub law: FluteLaw,
    /// How far the path of the contact may be from the flute it approximates, rounding included.
    pub chord_error: f64,
    pub grinder: Grinder,
    pub program: BurrProgram,
    pub tolerance: BurrTolerance,
    pub sheet: SheetInfo,
}

impl Burr {
    /// Over how long a stretch of a flute its helix angle is measured, mm.
    ///
    /// A path that may stray from the flute by the chord error has no direction at a point: it has one over lengths
    /// against which that error is small. 0.5 mm, or 250 chord errors where that is more, keep what straying alone can
    /// make of the angle below 0.23°, away from the tip.
    pub fn gauge(&self) -> f64 {
        (250.0 * self.chord_error).max(0.5)
    }
}

/// The tooth bottom: a cylinder and a nose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurrShape {
    /// Of the cylinder.
    pub radius: f64,
    /// Of the flutes along the axis, nose included.
    pub length: f64,
    pub nose: Nose,
    /// Between the nose's normal, where a flute ends, and the axis.
    pub tip_angle: f64,
    /// How far the blank stands above the tooth bottom.
    pub tooth_depth: f64,
}

/// What the cylinder ends in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nose {
    /// A half ball of the cylinder's radius.
    Ball,
    /// An ellipse in the meridian plane, approximated by two arcs: the large one tangent to the cylinder, the small one
    /// tangent to the large one and centred on the axis.
    Arcs { large: f64, small: f64 },
}

/// How a flute turns on the nose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FluteLaw {
    /// The helix angle stays the same up to the tip: a loxodrome.
    ConstantHelix,
    /// As the paper has it: the angle of A is tan B times the way along the axis over the local radius.
    Published,
}

impl FluteLaw {
    pub const ALL: [(&str, Self); 2] =
        [("constant-helix", Self::ConstantHelix), ("published", Self::Published)];

    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, law)| *law == self).map_or("", |(name, _)| name)
    }
}

/// X and Y slide a table C that carries the burr, A turns the burr, B swivels the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grinder {
    /// From the C axis to the end of the burr's cylinder (a ball's centre), x and y at C = 0.
    pub c_offset: [f64; 2],
    pub signs: AxisSigns,
    /// Whether the job says them: where it doesn't, the default is no demand on other programs.
    pub are_signs_specified: bool,
    /// How far from the blank rapid becomes feed, and the burr stands off while it is turned.
    pub clearance: f64,
    /// Whether the job says that.
    pub is_clearance_specified: bool,
}

/// 1 where an axis obeys the formulas, −1 where it runs the other way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSigns {
    pub x: i8,
    pub y: i8,
    pub a: i8,
    pub b: i8,
    pub c: i8,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurrProgram {
    pub form: ProgramForm,
    /// Of the contact along the flute, mm/min.
    pub speed: f64,
    /// Whether the job says that speed: where it doesn't, the default is no demand on other programs.
    pub is_speed_specified: bool,
    /// Into the blank, mm/min.
    pub plunge: f64,
    /// Whether the job says it.
    pub is_plunge_specified: bool,
    /// Of the wheel, r/min.
    pub wheel: f64,
    /// Whether the job says it.
    pub is_wheel_specified: bool,
}

/// How the moves of a flute are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramForm {
    /// The control computes them, in a resident macro.
    Loop,
    /// Every move stands in the program.
    Moves,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurrTolerance {
    /// Of the helix angle, either way, degrees.
    pub helix: f64,
    /// Of a flute's place round the burr, either way, degrees.
    pub index: f64,
}
