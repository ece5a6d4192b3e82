//! A hole as the drawing and the simulator both write it down, and a list of them: one schema for both.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which block of which program made a hole.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    pub program: String,
    pub line: u32,
    pub tool: Option<u32>,
}

/// A hole in the part's frame, lengths in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hole {
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
    pub diameter: Option<f64>,
    #[serde(default)]
    pub from: Option<Origin>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Unit {
    #[default]
    #[serde(rename = "mm")]
    Mm,
}

/// The document that `holes` and `reference` write and `verify` reads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleList {
    pub unit: Unit,
    pub holes: Vec<Hole>,
}
