//! Scenes: contents of a drawing in mm, without pixels, colours or NC words.
use super::chart::Chart;
use super::role::{HoleStatus, Pen, Point};

/// One drawing in mm, as a view builds it and [`lay_out`](crate::lay_out) places it on a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    pub(super) title: Title,
    pub(super) axes: Vec<Axis>,
    pub(super) strokes: Vec<Stroke>,
    pub(super) marks: Vec<Mark>,
    /// Diameter of the tolerance zone round every mark with a deviation, mm.
    pub(super) zone: Option<f64>,
    pub(super) legend: Vec<LegendItem>,
    /// Chart that replaces the drawing.
    pub(super) chart: Option<Chart>,
}

/// The title block.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Title {
    pub(super) name: String,
    /// Name of the view and its direction.
    pub(super) view: String,
    /// Position tolerance for the feature control frame: diameter of the zone, mm.
    pub(super) position: Option<f64>,
    /// Overall verdict.
    pub(super) verdict: Option<(HoleStatus, String)>,
    /// Further lines, one fact each.
    pub(super) lines: Vec<String>,
    /// Restriction on the use of the picture, such as “predicted by simulation”.
    pub(super) caution: String,
}

/// An axis of the part: a centre line through its origin, with arrow and name at the positive end.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) name: String,
    /// Unit vector of the positive direction.
    pub(super) direction: Point,
}

/// A line of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) shape: Shape,
    pub(super) pen: Pen,
    /// Text on the line, if there is room.
    pub(super) caption: Option<String>,
}

/// Geometry of a stroke, mm.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    Line(Vec<Point>),
    Circle { centre: Point, radius: f64 },
}

/// A hole, or another position with a symbol.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    /// Nominal position; the actual one if there is no nominal.
    pub(super) position: Point,
    pub(super) radius: f64,
    pub(super) status: HoleStatus,
    /// Label lines, most important first; lines without room are omitted from the end.
    pub(super) label: Vec<String>,
    /// Projection of the unit vector out of the part.
    pub(super) direction: Option<Point>,
    pub(super) deviation: Option<ZoneDeviation>,
    /// Actual position, if a nominal one is given too.
    pub(super) actual: Option<Point>,
}

/// Actual − nominal at both ends of a hole, mm, seen along the nominal axis: inside the zone's circle is
/// inside tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ZoneDeviation {
    pub(super) entry: Point,
    pub(super) bottom: Point,
}

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegendItem {
    pub(super) sample: Sample,
    pub(super) text: String,
}

/// The sample at the left of a legend line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sample {
    Status(HoleStatus),
    /// Replaces `Standing` for holes that the sheet draws to scale, without a symbol.
    Plain(HoleStatus),
    Pen(Pen),
    /// Direction of a hole axis; omitted if no axis is drawn.
    Direction,
    /// Deviation in its zone; the sheet adds the magnification, or omits the line if none is drawn.
    Deviation,
    /// Line to the actual position of a hole; omitted if none is drawn.
    Displacement,
}
