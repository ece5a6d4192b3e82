//! The job file of the family `burr`: ball-end rotary burrs on a 5-axis grinder.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{CLEARANCE, FileError, JobControl, Reader, SheetInfo};
use crate::reader::bounds::{
    BurrDiameter, BurrLength, ChordError, ContactSpeed, FluteCount, HelixAngle, HelixTolerance,
    IndexTolerance, KeyRange, PlungeRate, SideRadius, TableOffset, TipAngle, TipRadius, ToothDepth,
    WheelClearance, WheelSpeed,
};
use crate::reader::{AxisSign, FileKey, FixedArray, Optional, Section, Word, WordList};
use gcode_lang::control::Dialect;
use gcode_lang::units::Deg;

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
    /// Returns the form of the moves. The manual of haas-ngc has no function LN, which a loop needs.
    pub fn form(&self) -> ProgramForm {
        let has_loop = self.control.dialect != Dialect::HaasNgc;
        self.program.form.unwrap_or(if has_loop { ProgramForm::Loop } else { ProgramForm::Moves })
    }

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
    /// Returns the name in job files.
    pub fn name(self) -> &'static str {
        match self {
            Self::ConstantHelix => "constant-helix",
            Self::Published => "published",
        }
    }
}

impl WordList for FluteLaw {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        [Self::ConstantHelix, Self::Published].map(|law| (law.name(), law)).into()
    }
}

/// A rotary burr: its flutes, ground on a machine with a C table.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["burr"]))]
    _family: String,
    /// The control the programs are for [default: fanuc-31i, IS-B].
    #[serde(default, with = "Section::<JobControl>")]
    control: JobControl,
    /// The burr.
    #[serde(with = "Section::<FileBurr>")]
    burr: FileBurr,
    /// The grinder.
    #[serde(with = "Section::<Grinder>")]
    machine: Grinder,
    /// Form and conditions of the program.
    #[serde(default, with = "Section::<BurrProgram>")]
    program: BurrProgram,
    /// Tolerances of the flutes.
    #[serde(default, with = "Section::<BurrTolerance>")]
    tolerance: BurrTolerance,
    /// Additional data for the set-up sheet.
    #[serde(default, with = "Section::<SheetInfo>")]
    sheet: SheetInfo,
}

/// The burr: a cylinder with a nose.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileBurr {
    /// Diameter of cylinder and nose, mm.
    #[serde(with = "BurrDiameter")]
    diameter: f64,
    /// Length of the flutes, mm, nose included: no less than the nose.
    #[serde(with = "BurrLength")]
    length: f64,
    /// Their number, limited by the room at the tip.
    #[serde(with = "FluteCount")]
    flutes: i64,
    /// Helix angle, degrees, 1 to 60, or -60 to -1 for a left-hand burr.
    #[serde(with = "HelixAngle")]
    helix: f64,
    /// constant-helix: the same angle everywhere; published: as in the paper.
    #[serde(with = "Word::<FluteLaw>")]
    law: FluteLaw,
    /// Polar angle at which a flute ends, before the pole, degrees.
    #[serde(with = "TipAngle")]
    tip_angle: f64,
    /// Chord error between programmed points, mm: no less than the least increment.
    #[serde(with = "ChordError")]
    chord_error: f64,
    /// Tooth depth, mm, no more than the radius.
    #[serde(default = "ToothDepth::default", with = "ToothDepth")]
    tooth_depth: f64,
    /// Instead of the ball: the tooth-bottom ellipse as two tangent arcs.
    #[serde(default, with = "Optional::<Section<FileProfile>>")]
    profile: Option<FileProfile>,
}

/// Two tangent arcs, one on the side and one at the tip.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProfile {
    /// Radius of the side, mm: above half the diameter.
    #[serde(with = "SideRadius")]
    large: f64,
    /// Radius of the tip, mm: below half the diameter.
    #[serde(with = "TipRadius")]
    small: f64,
}

/// A 5-axis grinder: X and Y move a table C that carries the burr, A rotates the burr, B swivels the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grinder {
    /// Distance from the C axis to the end of the cylinder at C = 0, X and Y, mm.
    #[serde(with = "FixedArray::<TableOffset, 2>")]
    pub c_offset: [f64; 2],
    /// Directions of the axes: 1, or -1 if reversed.
    #[serde(rename = "signs", default, with = "Optional::<Section<AxisSigns>>")]
    pub(crate) specified_signs: Option<AxisSigns>,
    /// Clearance of the wheel between passes, mm [default: 2].
    #[serde(default, with = "Optional::<WheelClearance>")]
    pub(crate) clearance: Option<f64>,
    /// Profile as in [burr]; allowed once.
    #[serde(default, with = "Optional::<Section<FileProfile>>")]
    profile: Option<FileProfile>,
}

/// Directions of the axes: 1 for an axis that follows the formulas, −1 for a reversed one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "UPPERCASE")]
pub struct AxisSigns {
    /// Sign of X.
    #[serde(default = "AxisSign::default", with = "AxisSign")]
    pub x: i8,
    /// Sign of Y.
    #[serde(default = "AxisSign::default", with = "AxisSign")]
    pub y: i8,
    /// Sign of A.
    #[serde(default = "AxisSign::default", with = "AxisSign")]
    pub a: i8,
    /// Sign of B.
    #[serde(default = "AxisSign::default", with = "AxisSign")]
    pub b: i8,
    /// Sign of C.
    #[serde(default = "AxisSign::default", with = "AxisSign")]
    pub c: i8,
}

/// Form and conditions of a burr program. A default does not constrain other programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurrProgram {
    /// loop: a macro computes the points; moves: every move is written out, for a control without LN [default: loop where it can
    /// be].
    #[serde(default, with = "Optional::<Word<ProgramForm>>")]
    form: Option<ProgramForm>,
    /// Speed of the contact along the flute, mm/min [default: 200].
    #[serde(default, with = "Optional::<ContactSpeed>")]
    pub(crate) speed: Option<f64>,
    /// Feed into the blank, mm/min [default: 30].
    #[serde(default, with = "Optional::<PlungeRate>")]
    pub(crate) plunge: Option<f64>,
    /// Wheel speed, r/min [default: 3000].
    #[serde(default, with = "Optional::<WheelSpeed>")]
    pub(crate) wheel: Option<f64>,
}

/// Form in which the moves of a flute are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramForm {
    /// A resident macro computes the moves on the control.
    Loop,
    /// Every move is written out in the program.
    Moves,
}

impl WordList for ProgramForm {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        vec![("loop", Self::Loop), ("moves", Self::Moves)]
    }
}

/// Tolerances of a burr's flutes, either way.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurrTolerance {
    /// Tolerance of the helix angle, degrees.
    #[serde(default = "HelixTolerance::default", with = "HelixTolerance")]
    pub helix: f64,
    /// Tolerance of the gap between neighbours, degrees.
    #[serde(default = "IndexTolerance::default", with = "IndexTolerance")]
    pub index: f64,
}

impl Default for BurrTolerance {
    fn default() -> Self {
        Self { helix: HelixTolerance::default(), index: IndexTolerance::default() }
    }
}

impl Grinder {
    /// Returns the directions of the axes.
    pub fn signs(&self) -> AxisSigns {
        self.specified_signs.unwrap_or(AxisSigns { x: 1, y: 1, a: 1, b: 1, c: 1 })
    }

    /// Returns the distance from the blank at which rapid motion becomes feed, and at which the burr is
    /// indexed, mm.
    pub fn clearance(&self) -> f64 {
        self.clearance.unwrap_or(CLEARANCE)
    }
}

impl BurrProgram {
    /// Returns the speed of the contact along the flute, mm/min.
    pub fn speed(&self) -> f64 {
        self.speed.unwrap_or(200.0)
    }

    /// Returns the feed into the blank, mm/min.
    pub fn plunge(&self) -> f64 {
        self.plunge.unwrap_or(30.0)
    }

    /// Returns the wheel speed, r/min.
    pub fn wheel(&self) -> f64 {
        self.wheel.unwrap_or(3000.0)
    }
}

/// Reads a job of this family; the control defaults to fanuc-31i with IS-B.
pub(super) fn parse(reader: &Reader<'_>) -> Result<Burr, FileError> {
    let File { control, burr, machine: grinder, program, tolerance, sheet, .. } = reader.parse()?;
    if burr.profile.is_some() && grinder.profile.is_some() {
        let message = "key 'profile' is in [burr] and in [machine]: remove one";
        return Err(reader.error_at("machine.profile", message));
    }
    let shape = burr.shape(reader, &grinder)?;
    let (increment, most, error) = (control.increment.size(), ChordError::MAX, burr.chord_error);
    let allowed = format_args!(
        "{increment} to {most} mm: rounding to the least increment of {increment} uses half of it"
    );
    reader.check((increment..=most).contains(&error), "burr.chord_error", error, allowed)?;
    let is_loop = program.form == Some(ProgramForm::Loop);
    let allowed = "haas-ngc has no LN, which the loop needs; use 'moves'";
    reader.check(!is_loop || control.dialect != Dialect::HaasNgc, "program.form", "'loop'", allowed)?;
    Ok(Burr {
        control,
        shape,
        flutes: burr.count(reader, &shape)?,
        helix: burr.helix,
        law: burr.law,
        chord_error: error,
        grinder,
        program,
        tolerance,
        sheet,
    })
}

impl FileBurr {
    fn shape(&self, reader: &Reader<'_>, grinder: &Grinder) -> Result<BurrShape, FileError> {
        let radius = self.diameter / 2.0;
        let nose = match (self.profile, grinder.profile) {
            (None, None) => Nose::Ball,
            (Some(profile), _) => profile.check(reader, "burr.profile", radius)?,
            (None, Some(profile)) => profile.check(reader, "machine.profile", radius)?,
        };
        let (long, most) = (nose_length(radius, nose), BurrLength::MAX);
        let allowed = format_args!("{long:.3} (the nose alone) to {most} mm");
        // The nose length is compared with the precision that a job would specify.
        let is_long = (long - 0.000_5..=most).contains(&self.length);
        reader.check(is_long, "burr.length", self.length, allowed)?;
        let depth = self.tooth_depth;
        let allowed = format_args!("0 to {radius} mm (the radius)");
        reader.check((0.0..=radius).contains(&depth), "burr.tooth_depth", depth, allowed)?;
        let length = self.length.max(long);
        Ok(BurrShape { radius, length, nose, tip_angle: self.tip_angle, tooth_depth: depth })
    }

    /// Returns the number of flutes, limited by the room at the tip: each takes up to four chord errors of
    /// circumference.
    fn count(&self, reader: &Reader<'_>, shape: &BurrShape) -> Result<u32, FileError> {
        let end = match shape.nose {
            Nose::Ball => shape.radius,
            Nose::Arcs { small, .. } => small,
        };
        let round = std::f64::consts::TAU * end * Deg(shape.tip_angle).sin();
        let limit = FluteCount::MAX as f64;
        let most = (round / (4.0 * self.chord_error)).floor().clamp(1.0, limit);
        let flutes = self.flutes;
        u32::try_from(flutes).ok().filter(|n| 1 <= *n && f64::from(*n) <= most).ok_or_else(|| {
            let message = match most < limit {
                _ if flutes < 1 => format!("key 'burr.flutes' is {flutes}: a burr has at least 1"),
                true => format!(
                    "key 'burr.flutes' is {flutes}: at most {most:.0}, because they end on a circle of \
                     {round:.3} mm circumference and each needs up to four chord errors of it: fewer \
                     flutes, a larger tip_angle or a smaller chord_error"
                ),
                false => format!("key 'burr.flutes' is {flutes}: at most {limit}"),
            };
            reader.error_at("burr.flutes", message)
        })
    }
}

/// Returns the length of the nose beyond the end of the cylinder.
fn nose_length(radius: f64, nose: Nose) -> f64 {
    match nose {
        Nose::Ball => radius,
        Nose::Arcs { large, small } => {
            let (between, aside) = (large - small, large - radius);
            (between * between - aside * aside).sqrt() + small
        }
    }
}

impl FileProfile {
    fn check(self, reader: &Reader<'_>, section: &str, radius: f64) -> Result<Nose, FileError> {
        let Self { large, small } = self;
        let (most, least) = (SideRadius::MAX, TipRadius::MIN);
        let bounds = [
            (
                radius < large && large <= most,
                "large",
                large,
                format!("above {radius} (half the diameter) to {most} mm"),
            ),
            (
                least <= small && small < radius,
                "small",
                small,
                format!("{least} to less than {radius} mm (half the diameter)"),
            ),
        ];
        for (is_allowed, key, value, allowed) in bounds {
            if !is_allowed {
                let message = format!("key 'profile.{key}' is {value}: {allowed}");
                return Err(reader.error_at(&format!("{section}.{key}"), message));
            }
        }
        Ok(Nose::Arcs { large, small })
    }
}
