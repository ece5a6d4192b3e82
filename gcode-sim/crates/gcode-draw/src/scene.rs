//! What to draw, in mm and in roles: no pixels, no colours, no NC words.
use super::chart::Chart;
use super::role::{HoleStatus, Pen, Point};

/// One drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    pub title: Title,
    pub axes: Vec<Axis>,
    pub strokes: Vec<Stroke>,
    pub marks: Vec<Mark>,
    /// Diameter of the tolerance zone round every mark that has a misfit, mm.
    pub zone: Option<f64>,
    pub legend: Vec<LegendItem>,
    /// In the place of the drawing.
    pub chart: Option<Chart>,
}

/// The title block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Title {
    pub name: String,
    /// What is seen and from where.
    pub view: String,
    /// Position tolerance as a feature control frame has it: diameter of the zone, mm.
    pub position: Option<f64>,
    /// Verdict on the whole.
    pub verdict: Option<(HoleStatus, String)>,
    /// Further lines, one thing each.
    pub lines: Vec<String>,
    /// What the reader must not take the picture for.
    pub caution: String,
}

/// An axis of the part: drawn as a centre line through its origin, arrow and name at its positive end.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub name: String,
    /// Unit vector of its positive end.
    pub direction: Point,
}

/// A line of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    pub shape: Shape,
    pub pen: Pen,
    /// Written onto the line where there is room.
    pub caption: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    Line(Vec<Point>),
    Circle { centre: Point, radius: f64 },
}

/// A hole seen along or across its axis, or another place with a sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Where it should be; where it is, if nothing was asked for.
    pub position: Point,
    pub radius: f64,
    pub status: HoleStatus,
    /// Most important first; what finds no room is left out from the end.
    pub label: Vec<String>,
    /// Projection of the unit vector out of the part.
    pub direction: Option<Point>,
    pub deviation: Option<ZoneDeviation>,
    /// Where it is in truth, if there is a place for it.
    pub actual: Option<Point>,
}

/// Actual − nominal at both ends of a hole, mm, seen along the nominal axis: inside the zone's circle is inside tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZoneDeviation {
    pub entry: Point,
    pub bottom: Point,
}

#[derive(Clone, Debug, PartialEq)]
pub struct LegendItem {
    pub sample: Sample,
    pub text: String,
}

/// What a line of the legend shows at its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    Status(HoleStatus),
    /// The sheet puts it in the place of a standing whose holes it draws as they are, without a sign.
    Plain(HoleStatus),
    Pen(Pen),
    /// Left out by the sheet where no axis is drawn.
    Direction,
    /// The sheet adds how many times it is magnified, or leaves the line out where none is drawn.
    Deviation,
    /// A line to where a hole is instead. Left out by the sheet where none is drawn.
    Displacement,
}
