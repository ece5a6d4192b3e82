//! Reads the job file of the family `burr`: every key checked, its line named.
use schemars::JsonSchema;
use serde::Deserialize;

use super::{AxisSigns, Burr, BurrProgram, BurrShape, BurrTolerance, FluteLaw, Grinder, Nose, ProgramForm};
use crate::job::sections::{FileControl, in_range, sign};
use crate::job::sheet::FileSheet;
use crate::job::{FileError, JobControl, Reader};
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
    #[schemars(range(min = 0.5, max = 200.0))]
    diameter: Spanned<f64>,
    /// Of the flutes, mm, nose included: no less than the nose.
    #[schemars(range(min = 0.0, max = 500.0))]
    length: Spanned<f64>,
    /// Their number, limited by the room at the tip.
    #[schemars(range(min = 1, max = 360))]
    flutes: Spanned<i64>,
    /// Degrees, 1 to 60, or -60 to -1 for a left-hand burr.
    #[schemars(extend("anyOf" = [{ "minimum": 1, "maximum": 60 }, { "minimum": -60, "maximum": -1 }]))]
    helix: Spanned<f64>,
    /// constant-helix: the same angle everywhere; published: as in the paper.
    #[schemars(extend("enum" = names(&FluteLaw::ALL)))]
    law: Spanned<String>,
    /// Polar angle at which a flute ends, before the pole, degrees.
    #[schemars(range(min = 1.0, max = 85.0))]
    tip_angle: Spanned<f64>,
    /// Between programmed points, mm: no less than the least increment.
    #[schemars(range(min = 0.000_1, max = 1.0))]
    chord_error: Spanned<f64>,
    /// mm, no more than the radius [default: 0].
    #[schemars(range(min = 0.0, max = 100.0))]
    tooth_depth: Option<Spanned<f64>>,
    /// Instead of the ball: the tooth-bottom ellipse as two tangent arcs.
    profile: Option<Spanned<FileProfile>>,
}

/// The grinder.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileMachine {
    /// From the C axis to the end of the cylinder at C = 0, X and Y, mm.
    #[schemars(length(equal = 2), inner(range(min = -2000.0, max = 2000.0)))]
    c_offset: Spanned<Vec<Spanned<f64>>>,
    /// Directions of the axes: 1, or -1 if reversed.
    signs: Option<FileSigns>,
    /// Clearance of the wheel between passes, mm [default: 2].
    #[schemars(range(min = 0.1, max = 500.0))]
    clearance: Option<Spanned<f64>>,
    /// As in [burr]; allowed once.
    profile: Option<Spanned<FileProfile>>,
}

/// Two tangent arcs, one on the side and one at the tip.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProfile {
    /// Radius of the side, mm: above half the diameter.
    #[schemars(range(min = 0.25, max = 2000.0))]
    large: Spanned<f64>,
    /// Radius of the tip, mm: below half the diameter.
    #[schemars(range(min = 0.05, max = 100.0))]
    small: Spanned<f64>,
}

/// 1, or -1 for an axis that goes the other way [default: 1].
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileSigns {
    /// Of X.
    #[serde(rename = "X")]
    #[schemars(extend("enum" = [1, -1]))]
    x: Option<Spanned<i64>>,
    /// Of Y.
    #[serde(rename = "Y")]
    #[schemars(extend("enum" = [1, -1]))]
    y: Option<Spanned<i64>>,
    /// Of A.
    #[serde(rename = "A")]
    #[schemars(extend("enum" = [1, -1]))]
    a: Option<Spanned<i64>>,
    /// Of B.
    #[serde(rename = "B")]
    #[schemars(extend("enum" = [1, -1]))]
    b: Option<Spanned<i64>>,
    /// Of C.
    #[serde(rename = "C")]
    #[schemars(extend("enum" = [1, -1]))]
    c: Option<Spanned<i64>>,
}

/// Form and conditions of the program.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProgram {
    /// loop: a macro computes the points; moves: every move is written out, for a control without LN [default: loop where it can be].
    #[schemars(extend("enum" = names(&FORMS)))]
    form: Option<Spanned<String>>,
    /// Of the contact along the flute, mm/min [default: 200].
    #[schemars(range(min = 1.0, max = 20_000.0))]
    speed: Option<Spanned<f64>>,
    /// Of the approach, mm/min [default: 30].
    #[schemars(range(min = 0.1, max = 5_000.0))]
    plunge: Option<Spanned<f64>>,
    /// r/min [default: 3000].
    #[schemars(range(min = 1.0, max = 99_999.0))]
    wheel: Option<Spanned<f64>>,
}

/// How far flutes may be off, either way.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileTolerance {
    /// Of the helix angle, degrees [default: 0.3].
    #[schemars(range(min = 0.001, max = 10.0))]
    helix: Option<Spanned<f64>>,
    /// Of the gap between neighbours, degrees [default: 0.05].
    #[schemars(range(min = 0.001, max = 10.0))]
    index: Option<Spanned<f64>>,
}

/// The job of a burr, whose control is the default one unless the file says more.
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
    let chord =
        format!("{increment} to 1 mm: rounding to the least increment of {increment} uses half of it");
    let chord_error =
        reader.number("burr.chord_error", &burr.chord_error, &chord, in_range(increment, 1.0))?;
    Ok(Burr {
        control,
        shape,
        flutes: burr.count(reader, &shape, chord_error)?,
        helix,
        law: reader.choice("burr.law", &burr.law, &FluteLaw::ALL)?,
        chord_error,
        grinder: file.machine.check(reader)?,
        program: FileProgram::check(file.program.as_ref(), reader, control.dialect)?,
        tolerance: FileTolerance::check(file.tolerance.as_ref(), reader)?,
        sheet: FileSheet::of(file.sheet, reader)?,
    })
}

/// A key that may be left out.
fn optional(
    reader: &Reader<'_>,
    key: &str,
    value: Option<&Spanned<f64>>,
    (low, high, unit): (f64, f64, &str),
    default: f64,
) -> Result<f64, FileError> {
    let allowed = format!("{low} to {high} {unit}");
    value.map_or(Ok(default), |value| reader.number(key, value, &allowed, in_range(low, high)))
}

impl FileBurr {
    fn shape(
        &self,
        reader: &Reader<'_>,
        profile: Option<&Spanned<FileProfile>>,
    ) -> Result<BurrShape, FileError> {
        let diameter =
            reader.number("burr.diameter", &self.diameter, "0.5 to 200 mm", in_range(0.5, 200.0))?;
        let radius = diameter / 2.0;
        let nose = profile.map_or(Ok(Nose::Ball), |profile| profile.as_ref().check(reader, radius))?;
        let long = nose_length(radius, nose);
        let allowed = format!("{long:.3} (the nose alone) to 500 mm");
        // As long as the nose is to the digit that a job would say it with.
        let length =
            reader.number("burr.length", &self.length, &allowed, in_range(long - 0.000_5, 500.0))?.max(long);
        Ok(BurrShape {
            radius,
            length,
            nose,
            tip_angle: reader.number(
                "burr.tip_angle",
                &self.tip_angle,
                "1 to 85 degrees: at the pole a flute has no width",
                in_range(1.0, 85.0),
            )?,
            tooth_depth: optional(
                reader,
                "burr.tooth_depth",
                self.tooth_depth.as_ref(),
                (0.0, radius, "mm (the radius)"),
                0.0,
            )?,
        })
    }

    /// As many as have room beside each other at the tip, were they as wide as twice the chord error.
    fn count(&self, reader: &Reader<'_>, shape: &BurrShape, chord_error: f64) -> Result<u32, FileError> {
        let end = match shape.nose {
            Nose::Ball => shape.radius,
            Nose::Arcs { small, .. } => small,
        };
        let round = std::f64::consts::TAU * end * Deg(shape.tip_angle).sin();
        let most = (round / (4.0 * chord_error)).floor().clamp(1.0, 360.0);
        let flutes = *self.flutes.as_ref();
        u32::try_from(flutes).ok().filter(|n| 1 <= *n && f64::from(*n) <= most).ok_or_else(|| {
            let message = match most < 360.0 {
                _ if flutes < 1 => format!("key 'burr.flutes' is {flutes}: a burr has at least 1"),
                true => format!(
                    "key 'burr.flutes' is {flutes}: at most {most:.0}, because they end on a circle of \
                     {round:.3} mm circumference and each needs up to four chord errors of it: fewer \
                     flutes, a larger tip_angle or a smaller chord_error"
                ),
                false => format!("key 'burr.flutes' is {flutes}: at most 360"),
            };
            reader.error(&self.flutes, message)
        })
    }
}

/// How far the nose reaches beyond the end of the cylinder.
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
            &format!("above {radius} (half the diameter) to 2000 mm"),
            |v| radius < v && v <= 2000.0,
        )?;
        let small = reader.number(
            "profile.small",
            &self.small,
            &format!("0.05 to less than {radius} mm (half the diameter)"),
            |v| 0.05 <= v && v < radius,
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
        let offset = |value: &Spanned<f64>| {
            reader.number("machine.c_offset", value, "-2000 to 2000 mm", in_range(-2000.0, 2000.0))
        };
        let of = |key: &str, value: Option<&Spanned<i64>>| {
            value.map_or(Ok(1), |value| sign(reader, &format!("machine.signs.{key}"), value))
        };
        let given = self.signs.as_ref();
        Ok(Grinder {
            c_offset: [offset(x)?, offset(y)?],
            signs: AxisSigns {
                x: of("X", given.and_then(|s| s.x.as_ref()))?,
                y: of("Y", given.and_then(|s| s.y.as_ref()))?,
                a: of("A", given.and_then(|s| s.a.as_ref()))?,
                b: of("B", given.and_then(|s| s.b.as_ref()))?,
                c: of("C", given.and_then(|s| s.c.as_ref()))?,
            },
            are_signs_specified: given.is_some(),
            is_clearance_specified: self.clearance.is_some(),
            clearance: optional(
                reader,
                "machine.clearance",
                self.clearance.as_ref(),
                (0.1, 500.0, "mm"),
                2.0,
            )?,
        })
    }
}

const FORMS: [(&str, ProgramForm); 2] = [("loop", ProgramForm::Loop), ("moves", ProgramForm::Moves)];

impl FileProgram {
    fn check(file: Option<&Self>, reader: &Reader<'_>, dialect: Dialect) -> Result<BurrProgram, FileError> {
        // The function LN isn't in that control's manual.
        let without_loop = dialect == Dialect::HaasNgc;
        let form = match file.and_then(|file| file.form.as_ref()) {
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
        let number = |key: &str, value: Option<&Spanned<f64>>, bounds, default| {
            optional(reader, &format!("program.{key}"), value, bounds, default)
        };
        Ok(BurrProgram {
            form,
            speed: number("speed", file.and_then(|f| f.speed.as_ref()), (1.0, 20_000.0, "mm/min"), 200.0)?,
            is_speed_specified: file.is_some_and(|f| f.speed.is_some()),
            plunge: number("plunge", file.and_then(|f| f.plunge.as_ref()), (0.1, 5_000.0, "mm/min"), 30.0)?,
            is_plunge_specified: file.is_some_and(|f| f.plunge.is_some()),
            wheel: number("wheel", file.and_then(|f| f.wheel.as_ref()), (1.0, 99_999.0, "r/min"), 3000.0)?,
            is_wheel_specified: file.is_some_and(|f| f.wheel.is_some()),
        })
    }
}

impl FileTolerance {
    fn check(file: Option<&Self>, reader: &Reader<'_>) -> Result<BurrTolerance, FileError> {
        let number = |key: &str, value: Option<&Spanned<f64>>, default| {
            optional(reader, &format!("tolerance.{key}"), value, (0.001, 10.0, "degrees"), default)
        };
        Ok(BurrTolerance {
            helix: number("helix", file.and_then(|f| f.helix.as_ref()), 0.3)?,
            index: number("index", file.and_then(|f| f.index.as_ref()), 0.05)?,
        })
    }
}
