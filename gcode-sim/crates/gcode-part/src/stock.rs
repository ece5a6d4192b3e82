//! `[stock]`: the solid material of the part before the program runs, as a reference or a machine file describes it.
use nalgebra::{Point3, Unit, Vector3};
use schemars::{JsonSchema, Schema, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::solid::Rod;
use super::surface::Surface;
use crate::reader::bounds::{Length, MachinePoint};
use crate::reader::{FileKey, FixedArray};

/// The solid material of the part, in the part's frame, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
#[schemars(transform = describe_kind)]
pub enum Stock {
    /// A box with edges along the part's axes.
    Box {
        /// Its corner with the least coordinates.
        #[serde(deserialize_with = "<FixedArray<MachinePoint, 3> as FileKey>::deserialize")]
        #[schemars(with = "FixedArray<MachinePoint, 3>")]
        min: [f64; 3],
        /// Its corner with the greatest coordinates.
        #[serde(deserialize_with = "<FixedArray<MachinePoint, 3> as FileKey>::deserialize")]
        #[schemars(with = "FixedArray<MachinePoint, 3>")]
        max: [f64; 3],
    },
    /// A cylinder about one of the part's axes.
    Cylinder {
        /// The axis.
        axis: StockAxis,
        /// Its diameter.
        #[serde(deserialize_with = "<Length as FileKey>::deserialize")]
        #[schemars(with = "Length")]
        diameter: f64,
        /// Coordinate of one end along the axis.
        #[serde(deserialize_with = "<MachinePoint as FileKey>::deserialize")]
        #[schemars(with = "MachinePoint")]
        from: f64,
        /// Coordinate of the other end.
        #[serde(deserialize_with = "<MachinePoint as FileKey>::deserialize")]
        #[schemars(with = "MachinePoint")]
        to: f64,
    },
    /// The reference's own surface.
    Surface {},
}

/// Axis of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = list_axes)]
pub enum StockAxis {
    /// The part's x.
    X,
    /// The part's y.
    Y,
    /// The part's z.
    Z,
}

/// Describes the key that distinguishes the kinds.
fn describe_kind(schema: &mut Schema) {
    for kind in schema.get_mut("oneOf").and_then(Value::as_array_mut).into_iter().flatten() {
        let kind = &mut kind["properties"]["kind"];
        let description = "box; cylinder; surface: inside the surface of the reference.";
        *kind = json!({ "type": "string", "enum": [kind["const"]], "description": description });
    }
}

/// Lists the axes in one line.
fn list_axes(schema: &mut Schema) {
    *schema = json_schema!({ "type": "string", "enum": ["x", "y", "z"] });
}

impl Stock {
    /// Returns the body; `own` is the surface of the reference.
    pub fn body(&self, own: Option<Surface>) -> Option<Surface> {
        match *self {
            Self::Box { min, max } => Some(Surface::Block { min: Point3::from(min), max: Point3::from(max) }),
            Self::Cylinder { axis, diameter, from, to } => {
                let axis = match axis {
                    StockAxis::X => Vector3::x_axis(),
                    StockAxis::Y => Vector3::y_axis(),
                    StockAxis::Z => Vector3::z_axis(),
                };
                Some(Surface::Rod(rod(axis, from, to, diameter / 2.0)))
            }
            Self::Surface {} => own,
        }
    }

    /// Returns the reason why no body can have these numbers; `None` if one can.
    pub fn fault(&self) -> Option<String> {
        match self {
            Self::Box { min, max } => {
                let axis = (0..3).find(|i| max[*i] <= min[*i])?;
                let letter = ["x", "y", "z"][axis];
                Some(format!("max is {} in {letter}, and min is {}: max above min", max[axis], min[axis]))
            }
            Self::Cylinder { from, to, .. } => {
                (to <= from).then(|| format!("to is {to}, and from is {from}: to above from"))
            }
            Self::Surface {} => None,
        }
    }
}

fn rod(axis: Unit<Vector3<f64>>, from: f64, to: f64, radius: f64) -> Rod {
    Rod { base: Point3::from(axis.into_inner() * from), axis, length: to - from, radius }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_the_body_that_its_numbers_say() {
        let read = |text: &str| serde_json::from_str::<Stock>(text).unwrap();
        let block = read(r#"{"kind": "box", "min": [0, 0, -20], "max": [100, 50, 0]}"#);
        let depth =
            |stock: &Stock, p: [f64; 3]| -stock.body(None).unwrap().nearest(&Point3::from(p)).distance;
        assert_eq!(depth(&block, [50.0, 25.0, -3.0]), 3.0);
        let bar = read(r#"{"kind": "cylinder", "axis": "x", "diameter": 40, "from": -5, "to": 60}"#);
        assert_eq!(depth(&bar, [10.0, 0.0, 18.0]), 2.0);
        assert_eq!(depth(&bar, [57.0, 0.0, 0.0]), 3.0);
        let sphere = Surface::Ellipsoid { a: 5.0, b: 5.0 };
        assert_eq!(read(r#"{"kind": "surface"}"#).body(Some(sphere)), Some(sphere));
    }

    #[test]
    fn a_body_without_volume_is_refused() {
        let flat = Stock::Box { min: [0.0, 0.0, 0.0], max: [5.0, 5.0, 0.0] };
        assert_eq!(flat.fault().unwrap(), "max is 0 in z, and min is 0: max above min");
        let upside = Stock::Cylinder { axis: StockAxis::Z, diameter: 5.0, from: 0.0, to: -9.0 };
        assert_eq!(upside.fault().unwrap(), "to is -9, and from is 0: to above from");
        for text in [
            r#"{"kind": "ball"}"#,
            r#"{"kind": "surface", "min": [0, 0, 0]}"#,
            r#"{"kind": "box", "min": [0, 0], "max": [1, 1, 1]}"#,
            r#"{"kind": "cylinder", "axis": "w", "diameter": 4, "from": 0, "to": 5}"#,
        ] {
            assert!(serde_json::from_str::<Stock>(text).is_err(), "{text}");
        }
    }
}
