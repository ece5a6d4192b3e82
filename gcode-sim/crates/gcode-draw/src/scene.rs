//! Scenes: contents of a drawing in mm, without pixels, colours or NC words.
use super::chart::Chart;
use super::role::{HoleStatus, Pen, Point};

/// One drawing in mm, as a view builds it and [`lay_out`](crate::lay_out) places it on a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    pub title: Title,
    pub axes: Vec<Axis>,
    pub strokes: Vec<Stroke>,
    pub marks: Vec<Mark>,
    /// Diameter of the tolerance zone round every mark with a deviation, mm.
    pub zone: Option<f64>,
    pub legend: Vec<LegendItem>,
    /// Chart that replaces the drawing.
    pub chart: Option<Chart>,
}

/// The title block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Title {
    pub name: String,
    /// Name of the view and its direction.
    pub view: String,
    /// Position tolerance for the feature control frame: diameter of the zone, mm.
    pub position: Option<f64>,
    /// Overall verdict.
    pub verdict: Option<(HoleStatus, String)>,
    /// Further lines, one fact each.
    pub lines: Vec<String>,
    /// Restriction on the use of the picture, such as “predicted by simulation”.
    pub caution: String,
}

/// An axis of the part: a centre line through its origin, with arrow and name at the positive end.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub name: String,
    /// Unit vector of the positive direction.
    pub direction: Point,
}

/// A line of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    pub shape: Shape,
    pub pen: Pen,
    /// Text on the line, if there is room.
    pub caption: Option<String>,
}

/// Geometry of a stroke, mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    Line(Vec<Point>),
    Circle { centre: Point, radius: f64 },
}

/// A hole, or another position with a symbol.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Nominal position; the actual one if there is no nominal.
    pub at: Point,
    pub radius: f64,
    pub standing: HoleStatus,
    /// Label lines, most important first; lines without room are omitted from the end.
    pub label: Vec<String>,
    /// Projection of the unit vector out of the part.
    pub direction: Option<Point>,
    pub misfit: Option<ZoneDeviation>,
    /// Actual position, if a nominal one is given too.
    pub found: Option<Point>,
}

/// Actual − nominal at both ends of a hole, mm, seen along the nominal axis: inside the zone's circle is
/// inside tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZoneDeviation {
    pub entry: Point,
    pub bottom: Point,
}

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendItem {
    pub sample: Sample,
    pub text: String,
}

/// The sample at the left of a legend line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    Standing(HoleStatus),
    /// Replaces `Standing` for holes that the sheet draws to scale, without a symbol.
    Plain(HoleStatus),
    Pen(Pen),
    /// Direction of a hole axis; omitted if no axis is drawn.
    Direction,
    /// Deviation in its zone; the sheet adds the magnification, or omits the line if none is drawn.
    Misfit,
    /// Line to the actual position of a hole; omitted if none is drawn.
    Astray,
}
