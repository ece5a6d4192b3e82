//! A hole in the part's frame and the hole list: one schema for references and simulated holes.
use nalgebra::{Point3, Unit as Direction, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::assumption::Assumption;
use super::feature::Feature;
use super::stock::Stock;
use super::surface::Surface;

/// Largest difference between levels that are the same one, mm.
pub(super) const SAME_LEVEL: f64 = 0.1;

/// Block of a program that made a hole.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// Program as in messages, such as `O8300`.
    pub program: String,
    /// Line in the file, from 1.
    pub line: u32,
    /// Tool in the spindle; `None` if unknown.
    pub tool: Option<u32>,
}

/// A hole in the part's frame, lengths in mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("anyOf" = [json!({ "required": ["depth"] }), json!({ "required": ["features"] })]))]
pub struct Hole {
    /// Identifier; `None` for holes that a program made and for unnamed entries of a list.
    #[serde(default)]
    pub id: Option<String>,
    /// In a reference: where the axis meets the surface. From a program: where the cutting feed begins.
    pub entry: [f64; 3],
    /// Unit vector out of the part.
    pub axis: [f64; 3],
    /// From the entry, along the axis, to the deepest point; with features it may be left out.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub depth: f64,
    /// Diameter; `None` if unknown.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub diameter: Option<f64>,
    /// Block that made the hole; `None` in a reference.
    #[serde(default)]
    pub from: Option<Origin>,
    /// Diameters, cones and threads on the axis; without them `diameter` and `depth` are one feature.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<Feature>,
    /// True if the hole goes through the part; `depth` is then the thickness.
    #[serde(default, skip_serializing_if = "is_false")]
    pub through: bool,
}

impl Hole {
    /// Returns the diameter, or that of the widest feature; `None` if unknown.
    pub fn widest_diameter(&self) -> Option<f64> {
        self.diameter.into_iter().chain(self.features.iter().map(|feature| feature.diameter)).reduce(f64::max)
    }

    /// Returns a through hole as it is from its far side, with the features that go through.
    #[must_use]
    pub fn from_far_side(&self) -> Self {
        let out = Vector3::from(self.axis);
        let entry = Point3::from(self.entry) - out * self.depth;
        let deep = self.features.iter().filter(|feature| self.depth - SAME_LEVEL <= feature.bottom());
        let features: Vec<Feature> =
            deep.map(|feature| Feature { depth: Some(self.depth), ..*feature }).collect();
        let diameter = self.diameter.filter(|_| features.is_empty());
        Self { entry: entry.into(), axis: (-out).into(), diameter, features, ..self.clone() }
    }
}

fn is_false(value: &bool) -> bool {
    !value
}

/// Unit of a hole list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Unit {
    /// Millimetres.
    #[default]
    #[serde(rename = "mm")]
    Mm,
    /// Inches; a reader makes millimetres of them.
    #[serde(rename = "inch")]
    Inch,
}

/// Millimetres in an inch.
pub const MM_PER_INCH: f64 = 25.4;

/// The document that `holes` and `reference` write and `verify` reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleList {
    /// Unit of all lengths.
    pub unit: Unit,
    /// The holes, in the order of the drawing or of the program.
    pub holes: Vec<Hole>,
    /// Solid material of the part, for a reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stock: Option<Stock>,
    /// Values that the run read and nothing in the program set; absent in a reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub assumptions: Option<Vec<Assumption>>,
    /// The alarm or the limit that ended the run before its end, so that holes may be missing; absent otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
}

impl HoleList {
    /// Returns the list in millimetres.
    #[must_use]
    pub(super) fn in_mm(self) -> Self {
        if self.unit == Unit::Inch { self.scaled(MM_PER_INCH, Unit::Mm) } else { self }
    }

    /// Returns the list in inches.
    #[must_use]
    pub fn in_inches(self) -> Self {
        if self.unit == Unit::Mm { self.scaled(1.0 / MM_PER_INCH, Unit::Inch) } else { self }
    }

    fn scaled(mut self, factor: f64, unit: Unit) -> Self {
        self.unit = unit;
        for hole in &mut self.holes {
            hole.entry = hole.entry.map(|value| value * factor);
            hole.depth *= factor;
            hole.diameter = hole.diameter.map(|diameter| diameter * factor);
            hole.features.iter_mut().for_each(|feature| feature.scale(factor));
        }
        self.stock = self.stock.map(|stock| stock.scaled(factor));
        self
    }

    /// Moves the entry of each hole to the point where its axis leaves the surface; its bottom stays. A hole above the
    /// surface or beside it stays as it is.
    pub fn enter_at(&mut self, surface: &Surface) {
        for hole in &mut self.holes {
            let out = Direction::new_normalize(Vector3::from(hole.axis));
            let bottom = Point3::from(hole.entry) - out.into_inner() * hole.depth;
            let Some(entry) = surface.exit(&bottom, &out) else { continue };
            let depth = (entry - bottom).dot(&out);
            if 0.0 < depth {
                (hole.entry, hole.depth) = (entry.coords.into(), depth);
            }
        }
    }
}
