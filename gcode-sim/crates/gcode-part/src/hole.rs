//! A hole in the part's frame and the hole list: one schema for references and simulated holes.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::stock::Stock;

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hole {
    /// Identifier; `None` for holes that a program made and for unnamed entries of a list.
    #[serde(default)]
    pub id: Option<String>,
    /// In a reference: where the axis meets the surface. From a program: where the cutting feed begins.
    pub entry: [f64; 3],
    /// Unit vector out of the part.
    pub axis: [f64; 3],
    /// From the entry, along the axis, to the deepest point.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub depth: f64,
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    /// Diameter; `None` if unknown.
    pub diameter: Option<f64>,
    #[serde(default)]
    /// Block that made the hole; `None` in a reference.
    pub from: Option<Origin>,
}

/// Unit of a hole list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Unit {
    #[default]
    /// Millimetres.
    #[serde(rename = "mm")]
    Mm,
}

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
}
