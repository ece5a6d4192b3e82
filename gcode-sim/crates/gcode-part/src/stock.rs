//! `[stock]`: the solid material of the part before the program runs, its voids and the pockets that feeds may mill in it,
//! as a reference or a machine file describes them.
use nalgebra::{Point3, Unit, Vector3};
use schemars::{JsonSchema, Schema, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::part_solid::PartSolid;
use super::solid::Rod;
use super::surface::Surface;
use crate::reader::bounds::{Length, MachinePoint};
use crate::reader::{FileKey, FixedArray, Items, Section};

/// The solid material of the part, in the part's frame, mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
        /// What feeds may mill besides the holes.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[serde(deserialize_with = "<Items<Section<StockRegion>> as FileKey>::deserialize")]
        pocket: Vec<StockRegion>,
        /// What is empty in it before the program runs: slots, cored holes, cast pockets.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[serde(deserialize_with = "<Items<Section<StockRegion>> as FileKey>::deserialize")]
        void: Vec<StockRegion>,
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
        /// What feeds may mill besides the holes.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[serde(deserialize_with = "<Items<Section<StockRegion>> as FileKey>::deserialize")]
        pocket: Vec<StockRegion>,
        /// What is empty in it before the program runs: slots, cored holes, cast pockets.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[serde(deserialize_with = "<Items<Section<StockRegion>> as FileKey>::deserialize")]
        void: Vec<StockRegion>,
    },
    /// The reference's own surface.
    Surface {
        /// What feeds may mill besides the holes.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[serde(deserialize_with = "<Items<Section<StockRegion>> as FileKey>::deserialize")]
        pocket: Vec<StockRegion>,
        /// What is empty in it before the program runs: slots, cored holes, cast pockets.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[serde(deserialize_with = "<Items<Section<StockRegion>> as FileKey>::deserialize")]
        void: Vec<StockRegion>,
    },
}

/// Region of the stock, in the part's frame, mm: a pocket that feeds may mill, or a void that is empty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
#[schemars(transform = describe_kind)]
pub enum StockRegion {
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
    /// A cylinder along one of the part's axes.
    Cylinder {
        /// The axis.
        axis: StockAxis,
        /// A point of its middle line [default: the origin].
        #[serde(default, deserialize_with = "<FixedArray<MachinePoint, 3> as FileKey>::deserialize")]
        #[schemars(with = "FixedArray<MachinePoint, 3>")]
        centre: [f64; 3],
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
    let mut all: Vec<&mut Value> =
        schema.get_mut("oneOf").and_then(Value::as_array_mut).into_iter().flatten().collect();
    let has_surface = all.iter().any(|kind| kind["properties"]["kind"]["const"] == "surface");
    let surface = if has_surface { "; surface: inside the surface of the reference" } else { "" };
    for kind in &mut all {
        let kind = &mut kind["properties"]["kind"];
        let description = format!("box; cylinder{surface}.");
        *kind = json!({ "type": "string", "enum": [kind["const"]], "description": description });
    }
}

/// Lists the axes in one line.
fn list_axes(schema: &mut Schema) {
    *schema = json_schema!({ "type": "string", "enum": ["x", "y", "z"] });
}

impl StockAxis {
    fn direction(self) -> Unit<Vector3<f64>> {
        match self {
            Self::X => Vector3::x_axis(),
            Self::Y => Vector3::y_axis(),
            Self::Z => Vector3::z_axis(),
        }
    }
}

impl Stock {
    /// Returns the body; `own` is the surface of the reference.
    pub fn body(&self, own: Option<Surface>) -> Option<Surface> {
        match *self {
            Self::Box { min, max, .. } => Some(block(min, max)),
            Self::Cylinder { axis, diameter, from, to, .. } => {
                Some(rod(axis, [0.0; 3], diameter, (from, to)))
            }
            Self::Surface { .. } => own,
        }
    }

    /// Returns the body with its voids, as a stylus touches it; `None` without a body, and for an ellipsoid with voids.
    pub fn solid(&self, own: Option<Surface>) -> Option<PartSolid> {
        PartSolid::new(self.body(own)?, self.voids())
    }

    /// Returns the bodies that feeds may remove.
    pub fn pockets(&self) -> Vec<Surface> {
        self.regions().0.iter().map(StockRegion::body).collect()
    }

    /// Returns the bodies that are empty before the program runs.
    pub fn voids(&self) -> Vec<Surface> {
        self.regions().1.iter().map(StockRegion::body).collect()
    }

    /// Returns the pockets and the voids.
    fn regions(&self) -> (&[StockRegion], &[StockRegion]) {
        match self {
            Self::Box { pocket, void, .. }
            | Self::Cylinder { pocket, void, .. }
            | Self::Surface { pocket, void } => (pocket, void),
        }
    }

    /// Returns the stock with all lengths multiplied by a factor.
    #[must_use]
    pub(super) fn scaled(mut self, by: f64) -> Self {
        let scale = |regions: &mut Vec<StockRegion>| {
            regions.iter_mut().for_each(|region| *region = region.clone().scaled(by));
        };
        match &mut self {
            Self::Box { min, max, pocket, void } => {
                [min, max].into_iter().flatten().for_each(|value| *value *= by);
                [pocket, void].into_iter().for_each(scale);
            }
            Self::Cylinder { diameter, from, to, pocket, void, .. } => {
                [diameter, from, to].into_iter().for_each(|value| *value *= by);
                [pocket, void].into_iter().for_each(scale);
            }
            Self::Surface { pocket, void } => [pocket, void].into_iter().for_each(scale),
        }
        self
    }

    /// Returns the reason why no body can have these numbers; `None` if one can.
    pub fn fault(&self) -> Option<String> {
        let own = match *self {
            Self::Box { min, max, .. } => block_fault(min, max),
            Self::Cylinder { from, to, .. } => rod_fault(from, to),
            Self::Surface { .. } => None,
        };
        let (pockets, voids) = self.regions();
        let all = [("pocket", pockets), ("void", voids)].into_iter();
        let mut regions =
            all.flat_map(|(name, all)| all.iter().enumerate().map(move |(index, one)| (name, index, one)));
        own.or_else(|| {
            regions.find_map(|(name, index, region)| {
                let fault = match *region {
                    StockRegion::Box { min, max } => block_fault(min, max),
                    StockRegion::Cylinder { from, to, .. } => rod_fault(from, to),
                };
                fault.map(|fault| format!("{name} {}: {fault}", index + 1))
            })
        })
    }
}

impl StockRegion {
    fn scaled(self, by: f64) -> Self {
        let point = |point: [f64; 3]| point.map(|value| value * by);
        match self {
            Self::Box { min, max } => Self::Box { min: point(min), max: point(max) },
            Self::Cylinder { axis, centre, diameter, from, to } => Self::Cylinder {
                axis,
                centre: point(centre),
                diameter: diameter * by,
                from: from * by,
                to: to * by,
            },
        }
    }

    fn body(&self) -> Surface {
        match *self {
            Self::Box { min, max } => block(min, max),
            Self::Cylinder { axis, centre, diameter, from, to } => rod(axis, centre, diameter, (from, to)),
        }
    }
}

fn block(min: [f64; 3], max: [f64; 3]) -> Surface {
    Surface::Block { min: Point3::from(min), max: Point3::from(max) }
}

fn block_fault(min: [f64; 3], max: [f64; 3]) -> Option<String> {
    let axis = (0..3).find(|i| max[*i] <= min[*i])?;
    let letter = ["x", "y", "z"][axis];
    Some(format!("max is {} in {letter}, and min is {}: max above min", max[axis], min[axis]))
}

fn rod(axis: StockAxis, centre: [f64; 3], diameter: f64, (from, to): (f64, f64)) -> Surface {
    let (axis, centre) = (axis.direction(), Vector3::from(centre));
    let base = Point3::from(centre + axis.into_inner() * (from - centre.dot(&axis)));
    Surface::Rod(Rod { base, axis, length: to - from, radius: diameter / 2.0 })
}

fn rod_fault(from: f64, to: f64) -> Option<String> {
    (to <= from).then(|| format!("to is {to}, and from is {from}: to above from"))
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
        let pocket = r#"{"kind": "cylinder", "axis": "z", "centre": [30, 20, 7], "diameter": 10, "from": -5, "to": 0}"#;
        let plate = read(&format!(r#"{{"kind": "surface", "pocket": [{pocket}]}}"#));
        let distance = |p: [f64; 3]| plate.pockets()[0].nearest(&Point3::from(p)).distance;
        assert_eq!([distance([34.0, 20.0, -2.0]), distance([37.0, 20.0, -2.0])], [-1.0, 2.0]);
        assert_eq!(distance([30.0, 20.0, -9.0]), 4.0);
        assert_eq!(read(r#"{"kind": "surface"}"#).body(Some(sphere)), Some(sphere));
    }

    #[test]
    fn a_body_without_volume_is_refused() {
        let flat =
            Stock::Box { min: [0.0, 0.0, 0.0], max: [5.0, 5.0, 0.0], pocket: Vec::new(), void: Vec::new() };
        assert_eq!(flat.fault().unwrap(), "max is 0 in z, and min is 0: max above min");
        let upside = StockRegion::Cylinder {
            axis: StockAxis::Z,
            centre: [0.0; 3],
            diameter: 5.0,
            from: 0.0,
            to: -9.0,
        };
        let stock = Stock::Surface { pocket: vec![upside.clone()], void: Vec::new() };
        assert_eq!(stock.fault().unwrap(), "pocket 1: to is -9, and from is 0: to above from");
        let stock = Stock::Surface { pocket: Vec::new(), void: vec![upside] };
        assert_eq!(stock.fault().unwrap(), "void 1: to is -9, and from is 0: to above from");
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
