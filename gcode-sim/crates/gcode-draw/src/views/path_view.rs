//! Contents of a picture of a tool path.
use std::ops::Range;

use crate::scene::Sign;
use crate::side::{Projection, Side};
use gcode_part::Stock;

/// The path of a program on the part; everything but points and runs may be unknown.
#[derive(Clone, Debug, Default)]
pub struct PathView {
    /// Points of all runs, mm.
    pub points: Vec<[f64; 3]>,
    /// Runs in the order of the program.
    pub runs: Vec<PathRun>,
    /// Tools by their index in a run.
    pub tools: Vec<DrawnTool>,
    /// Names of the programs by their index in a run.
    pub programs: Vec<String>,
    /// Places with a symbol.
    pub places: Vec<PathPlace>,
    /// Work zeros: name and position, mm.
    pub zeros: Vec<(String, [f64; 3])>,
    /// Travel limits of the tip.
    pub limits: Vec<TravelLimit>,
    /// Solid material before the program runs.
    pub stock: Option<Stock>,
    /// What the picture lacks, one sentence each.
    pub notes: Vec<String>,
}

/// Successive moves of one kind.
#[derive(Clone, Debug)]
pub struct PathRun {
    /// Kind of the moves.
    pub kind: RunKind,
    /// Index of the tool.
    pub tool: usize,
    /// Index of the program.
    pub program: usize,
    /// Feed along the path, mm/min.
    pub feed: f64,
    /// Direction of the tool.
    pub axis: RunAxis,
    /// Its points.
    pub points: Range<usize>,
}

/// Direction of the tool on the part in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RunAxis {
    /// Unknown: the tool is taken to be along the line of sight of the top view.
    #[default]
    Unknown,
    /// Along an axis of the part, 0 to 2.
    Along(usize),
    /// Along no axis, or changing.
    Oblique,
}

/// Kind of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunKind {
    /// Rapid moves.
    Rapid,
    /// Feed moves.
    Feed,
    /// Probing moves.
    Probe,
}

/// A tool in the legend.
#[derive(Clone, Debug, Default)]
pub struct DrawnTool {
    /// Number, kind and diameter: `T1 end mill Φ10`.
    pub name: String,
    /// Width that it sweeps across its axis, mm; `None` if it is unknown or depends on the depth.
    pub swept_width: Option<f64>,
}

/// A travel limit of the tip along an axis of the part.
#[derive(Clone, Debug, PartialEq)]
pub struct TravelLimit {
    /// Index of the axis.
    pub axis: usize,
    /// Coordinate, mm.
    pub mm: f64,
    /// Name of the tool with whose length it holds; `None` if it holds for all.
    pub tool: Option<String>,
}

/// A place on the path with a symbol.
#[derive(Clone, Debug)]
pub struct PathPlace {
    /// Meaning.
    pub sign: Sign,
    /// Position, mm.
    pub at: [f64; 3],
    /// One word or code.
    pub label: String,
}

/// Arrangement of the views of a tool path on a sheet.
#[derive(Clone, Debug)]
pub struct Arrangement {
    /// Side that the top view shows.
    pub top: Side,
    /// The views; one without a repetition at least.
    pub views: Vec<StandardView>,
    /// Arrangement of several views.
    pub projection: Projection,
    /// Meaning of the colours of feeds.
    pub color_by: ColorBy,
}

/// A view in its relation to the top of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardView {
    /// From above.
    Top,
    /// From the front.
    Front,
    /// From the right.
    Right,
    /// From the front, the right and above.
    Isometric,
}

impl StandardView {
    /// Returns the side that the view shows.
    pub(super) fn side(self, top: Side) -> Side {
        match self {
            Self::Top => top,
            Self::Front => top.front(),
            Self::Right => top.from_right(),
            Self::Isometric => top.isometric(),
        }
    }

    /// Returns the name on the sheet.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Top => "Top",
            Self::Front => "Front",
            Self::Right => "Right",
            Self::Isometric => "Isometric",
        }
    }
}

/// Meaning of the colours of feeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// The coordinate towards the reader of the top view.
    #[default]
    Depth,
    /// The tool.
    Tool,
    /// The feed rate.
    Feed,
    /// The program.
    Program,
}
