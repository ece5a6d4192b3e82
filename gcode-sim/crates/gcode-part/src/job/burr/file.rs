//! Reads the job file of the family `burr`. Errors name the key and its line.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{AxisSigns, Burr, BurrProgram, BurrShape, BurrTolerance, FluteLaw, Grinder, Nose, ProgramForm};
use crate::job::sections::{FileControl, in_range};
use crate::job::sheet::FileSheet;
use crate::job::{FileError, JobControl, Reader};
use crate::reader::bounds::{
    AngleTolerance, Bounded, BurrDiameter, BurrLength, ChordError, ContactSpeed, FluteCount, KeyRange,
    PlungeRate, SideRadius, Sign, TableOffset, TipAngle, TipRadius, ToothDepth, WheelClearance, WheelSpeed,
};
use crate::reader::{Spanned, names};
use gcode_lang::control::{Dialect, Increment};
use gcode_lang::units::Deg;

/// A rotary burr: its flutes, ground on a machine with a C table.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct File {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["burr"]))]
    _family: String,
    /// The control the programs are for [default: fanuc-31i, IS-B].
    control: Option<FileControl>,
    /// The burr.
    burr: FileBurr,
    /// The grinder.
    machine: FileMachine,
    /// Form and conditions of the program.
    program: Option<FileProgram>,
    /// Tolerances of the flutes.
    tolerance: Option<FileTolerance>,
    /// Additional data for the set-up sheet.
    sheet: Option<FileSheet>,
}

/// The burr: a cylinder with a nose.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileBurr {
    /// Of cylinder and nose, mm.
    diameter: Bounded<BurrDiameter>,
    /// Of the flutes, mm, nose included: no less than the nose.
    length: Bounded<BurrLength>,
    /// Their number, limited by the room at the tip.
    flutes: Bounded<FluteCount>,
    /// Degrees, 1 to 60, or -60 to -1 for a left-hand burr.
    #[schemars(extend("anyOf" = [{ "minimum": 1, "maximum": 60 }, { "minimum": -60, "maximum": -1 }]))]
    helix: Spanned<f64>,
    /// constant-helix: the same angle everywhere; published: as in the paper.
    #[schemars(extend("enum" = names(&FluteLaw::ALL)))]
    law: Spanned<String>,
    /// Polar angle at which a flute ends, before the pole, degrees.
    tip_angle: Bounded<TipAngle>,
    /// Between programmed points, mm: no less than the least increment.
    chord_error: Bounded<ChordError>,
    /// mm, no more than the radius [default: 0].
    tooth_depth: Option<Bounded<ToothDepth>>,
    /// Instead of the ball: the tooth-bottom ellipse as two tangent arcs.
    profile: Option<Spanned<FileProfile>>,
}

/// The grinder.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileMachine {
    /// From the C axis to the end of the cylinder at C = 0, X and Y, mm.
    #[schemars(length(equal = 2))]
    c_offset: Spanned<Vec<Bounded<TableOffset>>>,
    /// Directions of the axes: 1, or -1 if reversed.
    signs: Option<FileSigns>,
    /// Clearance of the wheel between passes, mm [default: 2].
    clearance: Option<Bounded<WheelClearance>>,
    /// As in [burr]; allowed once.
    profile: Option<Spanned<FileProfile>>,
}

/// Two tangent arcs, one on the side and one at the tip.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProfile {
    /// Radius of the side, mm: above half the diameter.
    large: Bounded<SideRadius>,
    /// Radius of the tip, mm: below half the diameter.
    small: Bounded<TipRadius>,
}

/// 1, or -1 for an axis that goes the other way [default: 1].
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileSigns {
    /// Of X.
    #[serde(rename = "X")]
    x: Option<Sign>,
    /// Of Y.
    #[serde(rename = "Y")]
    y: Option<Sign>,
    /// Of A.
    #[serde(rename = "A")]
    a: Option<Sign>,
    /// Of B.
    #[serde(rename = "B")]
    b: Option<Sign>,
    /// Of C.
    #[serde(rename = "C")]
    c: Option<Sign>,
}

/// Form and conditions of the program.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProgram {
    /// loop: a macro computes the points; moves: every move is written out, for a control without LN [default: loop where it can be].
    #[schemars(extend("enum" = names(&FORMS)))]
    form: Option<Spanned<String>>,
    /// Of the contact along the flute, mm/min [default: 200].
    speed: Option<Bounded<ContactSpeed>>,
    /// Of the approach, mm/min [default: 30].
    plunge: Option<Bounded<PlungeRate>>,
    /// r/min [default: 3000].
    wheel: Option<Bounded<WheelSpeed>>,
}

/// How far flutes may be off, either way.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileTolerance {
    /// Of the helix angle, degrees [default: 0.3].
    helix: Option<Bounded<AngleTolerance>>,
    /// Of the gap between neighbours, degrees [default: 0.05].
    index: Option<Bounded<AngleTolerance>>,
}

/// Returns the job of a burr; the control defaults to fanuc-31i with IS-B.
pub(in crate::job) fn parse(reader: &Reader<'_>) -> Result<Burr, FileError> {
    let file: File = toml::from_str(reader.text).map_err(|e| reader.syntax(&e))?;
    let control = match &file.control {
        Some(control) => control.check(reader)?,
        None => JobControl { dialect: Dialect::default(), increment: Increment::default() },
    };
    let burr = &file.burr;
    let profile = match (&burr.profile, &file.machine.profile) {
        (Some(_), Some(second)) => {
            return Err(reader.error(second, "key 'profile' is in [burr] and in [machine]: remove one"));
        }
        (one, other) => one.as_ref().or(other.as_ref()),
    };
    let helix = reader.number(
        "burr.helix",
        &burr.helix,
        "1 to 60 degrees, or -60 to -1 for a left-hand burr (a straight flute has no move that rotates A, \
         which distinguishes grinding from approach)",
        |v| in_range(1.0, 60.0)(v.abs()),
    )?;
    let shape = burr.shape(reader, profile)?;
    let increment = control.increment.size();
    let most = ChordError::MAX;
    let chord =
        format!("{increment} to {most} mm: rounding to the least increment of {increment} uses half of it");
    let chord_error =
        reader.number("burr.chord_error", &burr.chord_error, &chord, in_range(increment, most))?;
    Ok(Burr {
        control,
        shape,
        flutes: burr.count(reader, &shape, chord_error)?,
        helix,
        law: reader.choice("burr.law", &burr.law, &FluteLaw::ALL)?,
        chord_error,
        grinder: file.machine.check(reader)?,
        program: file.program.unwrap_or_default().check(reader, control.dialect)?,
        tolerance: file.tolerance.unwrap_or_default().tolerance(),
        sheet: file.sheet.map(FileSheet::info).unwrap_or_default(),
    })
}

impl FileBurr {
    fn shape(
        &self,
        reader: &Reader<'_>,
        profile: Option<&Spanned<FileProfile>>,
    ) -> Result<BurrShape, FileError> {
        let radius = self.diameter.get() / 2.0;
        let nose = profile.map_or(Ok(Nose::Ball), |profile| profile.as_ref().check(reader, radius))?;
        let long = nose_length(radius, nose);
        let most = BurrLength::MAX;
        let allowed = format!("{long:.3} (the nose alone) to {most} mm");
        // The nose length is compared with the precision that a job would specify.
        let length =
            reader.number("burr.length", &self.length, &allowed, in_range(long - 0.000_5, most))?.max(long);
        let tooth_depth = match &self.tooth_depth {
            Some(depth) => {
                let allowed = format!("0 to {radius} mm (the radius)");
                reader.number("burr.tooth_depth", depth, &allowed, in_range(0.0, radius))?
            }
            None => 0.0,
        };
        Ok(BurrShape { radius, length, nose, tip_angle: self.tip_angle.get(), tooth_depth })
    }

    /// Returns the number of flutes, limited by the room at the tip: each takes up to four chord errors of
    /// circumference.
    fn count(&self, reader: &Reader<'_>, shape: &BurrShape, chord_error: f64) -> Result<u32, FileError> {
        let end = match shape.nose {
            Nose::Ball => shape.radius,
            Nose::Arcs { small, .. } => small,
        };
        let round = std::f64::consts::TAU * end * Deg(shape.tip_angle).sin();
        let limit = FluteCount::MAX as f64;
        let most = (round / (4.0 * chord_error)).floor().clamp(1.0, limit);
        let flutes = self.flutes.get();
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
            reader.error(&self.flutes, message)
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
    fn check(&self, reader: &Reader<'_>, radius: f64) -> Result<Nose, FileError> {
        let large = reader.number(
            "profile.large",
            &self.large,
            &format!("above {radius} (half the diameter) to {} mm", SideRadius::MAX),
            |v| radius < v && v <= SideRadius::MAX,
        )?;
        let small = reader.number(
            "profile.small",
            &self.small,
            &format!("{} to less than {radius} mm (half the diameter)", TipRadius::MIN),
            |v| TipRadius::MIN <= v && v < radius,
        )?;
        Ok(Nose::Arcs { large, small })
    }
}

impl FileMachine {
    fn check(&self, reader: &Reader<'_>) -> Result<Grinder, FileError> {
        let [x, y] = self.c_offset.as_ref().as_slice() else {
            let count = self.c_offset.as_ref().len();
            let message = format!(
                "key 'machine.c_offset' has {count} numbers: two, X and Y from the C axis to the end of the cylinder, mm"
            );
            return Err(reader.error(&self.c_offset, message));
        };
        let none = FileSigns::default();
        let signs = self.signs.as_ref().unwrap_or(&none);
        let of = |sign: &Option<Sign>| sign.as_ref().map_or(1, Sign::get);
        Ok(Grinder {
            c_offset: [x.get(), y.get()],
            signs: AxisSigns {
                x: of(&signs.x),
                y: of(&signs.y),
                a: of(&signs.a),
                b: of(&signs.b),
                c: of(&signs.c),
            },
            are_signs_specified: self.signs.is_some(),
            is_clearance_specified: self.clearance.is_some(),
            clearance: self.clearance.as_ref().map_or(2.0, Bounded::get),
        })
    }
}

const FORMS: [(&str, ProgramForm); 2] = [("loop", ProgramForm::Loop), ("moves", ProgramForm::Moves)];

impl FileProgram {
    fn check(&self, reader: &Reader<'_>, dialect: Dialect) -> Result<BurrProgram, FileError> {
        // The manual of that control has no function LN.
        let without_loop = dialect == Dialect::HaasNgc;
        let form = match &self.form {
            Some(form) => match reader.choice("program.form", form, &FORMS)? {
                ProgramForm::Loop if without_loop => {
                    let message =
                        "key 'program.form' is 'loop': haas-ngc has no LN, which the loop needs; use 'moves'";
                    return Err(reader.error(form, message));
                }
                form => form,
            },
            None if without_loop => ProgramForm::Moves,
            None => ProgramForm::Loop,
        };
        Ok(BurrProgram {
            form,
            speed: self.speed.as_ref().map_or(200.0, Bounded::get),
            is_speed_specified: self.speed.is_some(),
            plunge: self.plunge.as_ref().map_or(30.0, Bounded::get),
            is_plunge_specified: self.plunge.is_some(),
            wheel: self.wheel.as_ref().map_or(3000.0, Bounded::get),
            is_wheel_specified: self.wheel.is_some(),
        })
    }
}

impl FileTolerance {
    fn tolerance(&self) -> BurrTolerance {
        BurrTolerance {
            helix: self.helix.as_ref().map_or(0.3, Bounded::get),
            index: self.index.as_ref().map_or(0.05, Bounded::get),
        }
    }
}
