//! `[[table]]`: the axes that carry the part, from the bed outwards.
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

/// An axis that carries the part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = turns_or_slides)]
pub(super) struct FileLink {
    /// The axis.
    #[schemars(extend("enum" = AXES))]
    letter: Located<String>,
    /// The direction x, y or z of a rotary axis: A, B and C.
    #[schemars(extend("enum" = names(&DIRECTIONS)))]
    turns: Option<Located<String>>,
    /// The direction x, y or z of a linear axis: all other letters.
    #[schemars(extend("enum" = names(&DIRECTIONS)))]
    slides: Option<Located<String>>,
    /// 1 if a positive command rotates the part right-handed, or moves it in the positive direction; otherwise
    /// -1.
    sign: Sign,
    /// A point on the axis, machine coordinates, mm [default: the part's origin].
    centre: Option<FixedArray<Bounded<MachinePoint>, 3>>,
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

impl FileLink {
    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        axes: &Axes,
        inner: &Chain,
        origin: Point3<f64>,
    ) -> Result<AxisLink, FileError> {
        let axis = letter(reader, "table.letter", &self.letter, axes)?;
        if inner.has_axis(axis) {
            let message = format!("key 'table.letter': {} is used twice", axes.letter(axis));
            return Err(reader.error(&self.letter, message));
        }
        let sign = f64::from(self.sign.get());
        let kinds = (&self.turns, &self.slides);
        let (key, direction) = match kinds {
            (Some(about), None) => ("turns", about),
            (None, Some(along)) => ("slides", along),
            _ => {
                let message = "a [[table]] needs exactly one of the keys 'turns' and 'slides': x, y or z";
                return Err(reader.error(&self.letter, message));
            }
        };
        if (key == "turns") != axes.is_rotary(axis) {
            let message =
                format!("key 'table.{key}' does not match {}: A B C rotate, others slide", axes.letter(axis));
            return Err(reader.error(direction, message));
        }
        let unit = Unit::new_unchecked(reader.choice(&format!("table.{key}"), direction, &DIRECTIONS)?);
        match (&self.centre, key) {
            (Some(FixedArray([x, ..])), "slides") => {
                Err(reader.error(x, "key 'table.centre' is for 'turns' only"))
            }
            (_, "slides") => Ok(AxisLink::linear(axis, unit, sign)),
            (Some(centre), _) => Ok(AxisLink::rotary(axis, unit, Point3::from(vector(centre)), sign)),
            (None, _) => Ok(AxisLink::rotary(axis, unit, origin, sign)),
        }
    }
}
