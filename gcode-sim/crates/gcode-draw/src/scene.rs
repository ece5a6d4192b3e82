//! Scenes: lines, circles, texts and marks in mm with their meaning, without pixels, colours or NC words.
//!
//! A scene has 3 dimensions on the part and 2 on a sheet; [`Scene::seen_from`] projects it.
use gcode_lang::units::Deg;
use serde::{Serialize, Serializer};

/// A point of the drawing plane, mm to the right and up; the view defines the two directions on the part.
pub type Point = [f64; 2];

/// Contents of a drawing in mm, on the part (3 dimensions) or on a sheet (2).
///
/// As JSON it is what the viewer of a page reads. A polyline there is a list of its coordinates, one after
/// another, to a thousandth of a millimetre.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct Scene<const D: usize = 2> {
    /// Centre lines through the origin.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<Axis<D>>,
    /// Lines and texts, the later ones on top.
    pub strokes: Vec<Stroke<D>>,
    /// Holes and other positions with a symbol.
    pub marks: Vec<Mark<D>>,
    /// Diameter of the tolerance zone round every mark with a deviation, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zone: Option<f64>,
}

/// An axis of the part: a centre line through its origin, with arrow and name at the positive end.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct Axis<const D: usize = 2> {
    /// Name at the arrow.
    pub name: String,
    /// Unit vector of the positive direction.
    pub direction: [f64; D],
}

/// A shape with its meaning.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct Stroke<const D: usize = 2> {
    /// Geometry, mm.
    #[serde(flatten)]
    pub shape: Shape<D>,
    /// Meaning of the line.
    pub pen: Pen,
    /// Text on the line, if there is room.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub caption: Option<String>,
    /// Look that differs from the pen's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub style: Option<Style>,
}

/// Look of a line that differs from that of its pen: a value as colour, a class as dash pattern, a true width.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Style {
    /// Colour; `None` for the pen's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tint: Option<Tint>,
    /// Number of the dash pattern; 0 for a solid line.
    pub pattern: u8,
    /// Width, mm; `None` for the pen's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Length of the path before this piece of it, mm: its dashes continue those of the pieces before.
    #[serde(skip_serializing_if = "is_zero")]
    pub phase: f64,
}

/// Colour of a line by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tint {
    /// Value on a continuous scale, 0 for its dark end to 1 for its light end.
    Shade(f64),
    /// One of a few classes, counted from 0.
    Class(usize),
    /// Area below the lines, such as that which a tool sweeps.
    Pale,
}

/// Geometry of a stroke, mm.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", bound = "[f64; D]: Serialize")]
pub enum Shape<const D: usize = 2> {
    /// Polyline; arcs are polylines too, see [`arc`].
    #[serde(serialize_with = "coordinates")]
    Line(Vec<[f64; D]>),
    /// Circle in the plane of the sheet.
    Circle {
        /// Centre.
        centre: [f64; D],
        /// Radius, mm.
        radius: f64,
    },
    /// Line with an arrow head at its end.
    Arrow([[f64; D]; 2]),
    /// Symbol of a zero point: a circle with two black quarters.
    Zero([f64; D]),
    /// Symbol of a place on a tool path.
    Sign {
        /// The place.
        at: [f64; D],
        /// Meaning of the place.
        sign: Sign,
    },
    /// Text at a fixed position.
    Text {
        /// Reference point on the base line.
        at: [f64; D],
        /// Side of the text at which the reference point is.
        align: Align,
        /// One line of text.
        text: String,
    },
}

/// Meaning of a place on a tool path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sign {
    /// Start of the path.
    Start,
    /// Operator stop.
    Stop,
    /// End of the path; it stands for a stop in its place, which its label names.
    End,
    /// Position at which an alarm ends the run.
    Alarm,
}

/// Horizontal alignment of a text to its reference point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Align {
    /// The text begins at the point.
    Left,
    /// The point is the text's middle.
    Centre,
    /// The text ends at the point.
    Right,
}

impl Align {
    /// Returns the fraction of the text's width that lies left of its reference point.
    pub(super) fn fraction_left(self) -> f64 {
        match self {
            Self::Left => 0.0,
            Self::Centre => 0.5,
            Self::Right => 1.0,
        }
    }
}

/// Meaning of a line, from which colour, width and dash pattern follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Pen {
    /// Outline of the part, the strongest line of a picture.
    Outline,
    /// Visible edge in a small sketch.
    Edge,
    /// Thread seen along its axis.
    Thread,
    /// Dimension line or leader.
    Dimension,
    /// Centre line of an axis of revolution.
    Centre,
    /// Tool, or the direction from which it comes.
    Tool,
    /// Construction line, not an edge: for example the circle on which holes lie.
    Construction,
    /// Tick of a scale, drawn outwards; numbers that would collide are omitted.
    Scale,
    /// Tick of a scale with its number beyond the end; numbers that would collide are omitted.
    Ruler,
    /// Tool path at cutting feed.
    Feed,
    /// Tool path with a fault.
    Faulty,
    /// Tool path with a fault, on the far side.
    FaultyFarSide,
    /// Tool path in rapid motion.
    Rapid,
    /// Path of a probing move.
    Probe,
    /// Cut that both revisions make.
    Unchanged,
    /// New version of a changed cut.
    New,
    /// Old version of a changed cut.
    Old,
    /// Grid line of a graph.
    Grid,
    /// Actual curve of a graph.
    Measured,
    /// Further actual curves of a graph.
    MeasuredOther,
    /// Limit of a tolerance in a graph, or of the machine's travel.
    Limit,
    /// Nominal curve of a graph.
    Nominal,
    /// Second curve of a graph, for comparison.
    Comparison,
}

impl Pen {
    /// Returns true for pens of the tool path, which labels may cover.
    pub(super) fn is_path(self) -> bool {
        use Pen::{Faulty, FaultyFarSide, Feed, New, Old, Probe, Rapid, Unchanged};
        matches!(self, Feed | Faulty | FaultyFarSide | Rapid | Probe | Unchanged | New | Old)
    }
}

/// Result of comparing a hole with its nominal, in order of importance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HoleStatus {
    /// Out of tolerance, or changed.
    Bad,
    /// Not made, or lost.
    Missing,
    /// Not in the reference, or added.
    Extra,
    /// Not compared.
    #[default]
    Unjudged,
    /// In tolerance, or unchanged.
    Good,
}

impl HoleStatus {
    /// Returns true if the hole needs no attention.
    pub(super) fn is_good(self) -> bool {
        matches!(self, Self::Good | Self::Unjudged)
    }
}

/// A hole, or another position with a symbol.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct Mark<const D: usize = 2> {
    /// Nominal position; the actual one if there is no nominal.
    pub position: [f64; D],
    /// Radius of the hole, mm.
    pub radius: f64,
    /// Radius of the widest circle drawn round it, mm; labels lie beyond it.
    #[serde(skip)]
    pub rim: f64,
    /// Depth of the hole against `direction`, mm.
    #[serde(skip_serializing_if = "is_zero")]
    pub depth: f64,
    /// Status that selects the symbol.
    pub status: HoleStatus,
    /// Label lines, most important first; lines without room are omitted from the end.
    pub label: Vec<String>,
    /// Unit vector out of the part, or its projection.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; D]>,
    /// Actual − nominal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation: Option<ZoneDeviation<D>>,
    /// Actual position, if a nominal one is given too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub actual: Option<[f64; D]>,
}

fn coordinates<const D: usize, S: Serializer>(points: &[[f64; D]], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(points.iter().flatten().map(|mm| Coordinate(*mm)))
}

/// A length in mm, as JSON without superfluous digits: a path has hundreds of thousands.
struct Coordinate(f64);

impl Serialize for Coordinate {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let thousandths = (self.0 * 1000.0).round();
        match thousandths % 1000.0 == 0.0 {
            true => to.serialize_i64((thousandths / 1000.0) as i64),
            false => to.serialize_f64(thousandths / 1000.0),
        }
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Actual − nominal at both ends of a hole, mm. On a sheet it is seen along the nominal axis: inside the zone's
/// circle is inside tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct ZoneDeviation<const D: usize = 2> {
    /// At the entry.
    pub entry: [f64; D],
    /// At the bottom.
    pub bottom: [f64; D],
}

impl<const D: usize> Stroke<D> {
    /// Builds a stroke without texts.
    pub fn new(pen: Pen, shape: Shape<D>) -> Self {
        Self { shape, pen, caption: None, style: None }
    }
}

impl Shape {
    /// Returns the points of the shape; the corners round a circle.
    pub(super) fn points(&self) -> Vec<Point> {
        match self {
            Self::Line(points) => points.clone(),
            Self::Circle { centre: [x, y], radius } => {
                vec![[x - radius, y - radius], [x + radius, y + radius]]
            }
            Self::Arrow(ends) => ends.to_vec(),
            Self::Zero(at) | Self::Sign { at, .. } | Self::Text { at, .. } => vec![*at],
        }
    }
}

impl<const D: usize> Mark<D> {
    /// Builds a mark without a hole's dimensions and without label.
    pub fn new(position: [f64; D], status: HoleStatus) -> Self {
        let label = Vec::new();
        Self {
            position,
            radius: 0.0,
            rim: 0.0,
            depth: 0.0,
            status,
            label,
            direction: None,
            deviation: None,
            actual: None,
        }
    }
}

/// Returns the points of an arc of an ellipse, a polyline of 96 segments, from an angle to another in degrees,
/// counter-clockwise if the second is larger. It deviates by less than 0.06 % of the larger radius.
pub fn arc([x, y]: Point, [right, up]: [f64; 2], [from, to]: [f64; 2]) -> Vec<Point> {
    let angles = (0..=96).map(|n| Deg(from + (to - from) * f64::from(n) / 96.0));
    angles.map(|angle| [x + right * angle.cos(), y + up * angle.sin()]).collect()
}
