//! Pictures: a scene or a chart with a title block and a legend, as a view builds them.
use super::chart::Chart;
use super::hole_table::HoleTable;
use super::scene::{HoleStatus, Pen, Scene, Sign, Style};
use super::side::Projection;

/// One picture of a part or program, which [`lay_out`](crate::lay_out) places on a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    pub(super) title: Title,
    /// The drawing, mm.
    pub scene: Scene,
    pub(super) legend: Vec<LegendItem>,
    /// Table in the rest of the panel.
    pub(super) table: HoleTable,
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

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegendItem {
    pub(super) sample: Sample,
    pub(super) text: String,
}

impl LegendItem {
    pub(super) fn new(sample: Sample, text: impl Into<String>) -> Self {
        Self { sample, text: text.into() }
    }
}

/// The sample at the left of a legend line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    Status(HoleStatus),
    /// Replaces `Status` for holes that the sheet draws to scale, without a symbol.
    Plain(HoleStatus),
    Pen(Pen),
    /// A text alone.
    Nothing,
    /// A line whose look differs from its pen's.
    Line(Pen, Style),
    Sign(Sign),
    /// Symbol of a zero point.
    Zero,
    /// Scale of shades from the value of the darkest to that of the lightest, the text above it.
    Shades(f64, f64),
    /// Symbol of ISO 5456-2 for the arrangement of the views.
    Projection(Projection),
    /// Direction of a hole axis; omitted if no axis is drawn.
    Direction,
    /// Deviation in its zone; the sheet adds the magnification, or omits the line if none is drawn.
    Deviation,
    /// Circle of a hole within the circle of its zone; omitted if no deviation is drawn.
    HoleInZone,
    /// Line to the actual position of a hole; omitted if none is drawn.
    Displacement,
}

/// Symbols that the laid-out drawing really contains, for the legend.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LegendUse {
    pub(super) magnification: Option<f64>,
    pub(super) directions: bool,
    pub(super) displacements: bool,
    /// Whether good holes are drawn to scale, without a symbol.
    pub(super) has_plain_good: bool,
    /// Whether bad holes are drawn to scale, without a symbol.
    pub(super) has_plain_rest: bool,
}
