//! `[[table]]` and `[[head.axis]]`: the axes that carry the part, from the bed outwards, and the tool, from the slides outwards.
use nalgebra::{Point3, Unit, Vector3};
use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::json;

use super::{AXES, letter, vector};
use crate::machine::{AxisLink, Chain};
use gcode_lang::motion::Axes;
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::{Bounded, MachinePoint, Sign};
use gcode_part::reader::{FixedArray, Located, Reader, names};

/// An axis that carries the part or the tool.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = turns_or_slides)]
pub(super) struct FileLink {
    /// The axis.
    #[schemars(extend("enum" = AXES))]
    pub(super) letter: Located<String>,
    /// The direction x, y or z of a rotary axis A, B or C, or a vector along it.
    turns: Option<Located<FileDirection>>,
    /// The direction x, y or z of a linear axis: all other letters.
    #[schemars(extend("enum" = names(&DIRECTIONS)))]
    slides: Option<Located<String>>,
    /// 1 if a positive command rotates the part right-handed, or moves it in the positive direction; otherwise
    /// -1.
    sign: Sign,
    /// A point on the axis, mm: machine coordinates of a table [default: the part's origin], from the pivot of a head [default: 0].
    centre: Option<FixedArray<Bounded<MachinePoint>, 3>>,
}

/// Direction of a rotary axis.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
enum FileDirection {
    /// Along x, y or z.
    Along(#[schemars(extend("enum" = names(&DIRECTIONS)))] String),
    /// Along a vector.
    Vector([f64; 3]),
}

/// Requires one of `turns` and `slides`; an axis that slides has no centre.
fn turns_or_slides(schema: &mut Schema) {
    let cases = json!([
        { "required": ["turns"], "not": { "required": ["slides"] } },
        { "required": ["slides"], "not": { "anyOf": [{ "required": ["turns"] }, { "required": ["centre"] }] } },
    ]);
    schema.insert("oneOf".to_owned(), cases);
}

const DIRECTIONS: [(&str, Vector3<f64>); 3] = [
    ("x", Vector3::new(1.0, 0.0, 0.0)),
    ("y", Vector3::new(0.0, 1.0, 0.0)),
    ("z", Vector3::new(0.0, 0.0, 1.0)),
];

impl FileDirection {
    /// Returns the direction with length 1; `None` for another word and for a vector without a direction.
    fn unit(&self) -> Option<Unit<Vector3<f64>>> {
        let vector = match self {
            Self::Along(name) => DIRECTIONS.iter().find(|(known, _)| known == name)?.1,
            Self::Vector(vector) => Vector3::from(*vector),
        };
        Unit::try_new(vector, 1e-9).filter(|unit| unit.norm().is_finite())
    }
}

impl std::fmt::Display for FileDirection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Along(name) => write!(f, "'{name}'"),
            Self::Vector(vector) => write!(f, "{vector:?}"),
        }
    }
}

impl FileLink {
    /// Returns the place of the axis in the file.
    pub(super) fn start(&self) -> usize {
        self.letter.span().start
    }

    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        axes: &Axes,
        inner: &Chain,
        origin: Point3<f64>,
        section: &str,
    ) -> Result<AxisLink, FileError> {
        let axis = letter(reader, &format!("{section}.letter"), &self.letter, axes)?;
        if inner.has_axis(axis) {
            let message = format!("key '{section}.letter': {} is used twice", axes.letter(axis));
            return Err(reader.error(&self.letter, message));
        }
        let sign = f64::from(self.sign.get());
        let mismatch = |key: &str| {
            format!("key '{section}.{key}' does not match {}: A B C rotate, others slide", axes.letter(axis))
        };
        match (&self.turns, &self.slides, &self.centre) {
            (Some(about), None, _) if !axes.is_rotary(axis) => Err(reader.error(about, mismatch("turns"))),
            (Some(about), None, centre) => {
                let unit = about.as_ref().unit().ok_or_else(|| {
                    let allowed = "one of x, y, z, or a vector [x, y, z] that is not all 0";
                    let given = about.as_ref();
                    reader.error(about, format!("key '{section}.turns' is {given}: {allowed}"))
                })?;
                let centre = centre.as_ref().map_or(origin, |centre| Point3::from(vector(centre)));
                Ok(AxisLink::rotary(axis, unit, centre, sign))
            }
            (None, Some(along), _) if axes.is_rotary(axis) => Err(reader.error(along, mismatch("slides"))),
            (None, Some(_), Some(FixedArray([x, ..]))) => {
                Err(reader.error(x, format!("key '{section}.centre' is for 'turns' only")))
            }
            (None, Some(along), None) => {
                let direction = reader.choice(&format!("{section}.slides"), along, &DIRECTIONS)?;
                Ok(AxisLink::linear(axis, Unit::new_unchecked(direction), sign))
            }
            _ => {
                let message =
                    format!("a [[{section}]] needs exactly one of the keys 'turns' and 'slides': x, y or z");
                Err(reader.error(&self.letter, message))
            }
        }
    }
}
