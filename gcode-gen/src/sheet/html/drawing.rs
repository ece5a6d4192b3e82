//! Small drawings as scenes in mm of the part, written as SVG.
use gcode_draw::{Align, Pen, Point, Scene, Shape, Sheet, Stroke, svg};
use maud::{Markup, PreEscaped};

/// Width of every drawing in its own units; text is 12 units high.
pub(super) const WIDTH: f64 = 480.0;

/// A scene, and the paper on which it is drawn.
pub(super) struct Drawing {
    strokes: Vec<Stroke>,
    /// Position of the scene's zero point from the upper left corner, paper units.
    pub origin: [f64; 2],
    pub height: f64,
    /// Length of a paper unit, mm.
    pub unit: f64,
}

impl Drawing {
    pub(super) fn new(origin: [f64; 2], height: f64, unit: f64) -> Self {
        Self { strokes: Vec::new(), origin, height, unit }
    }

    fn add(&mut self, pen: Pen, shape: Shape) {
        self.strokes.push(Stroke::new(pen, shape));
    }

    pub(super) fn line(&mut self, pen: Pen, points: impl Into<Vec<Point>>) {
        self.add(pen, Shape::Line(points.into()));
    }

    pub(super) fn circle(&mut self, centre: Point, radius: f64) {
        self.add(Pen::Edge, Shape::Circle { centre, radius });
    }

    /// Draws a tool or its path as an arrow.
    pub(super) fn arrow(&mut self, from: Point, to: Point) {
        self.add(Pen::Tool, Shape::Arrow([from, to]));
    }

    /// Draws the symbol of the work zero with a text beside it, `right` and `up` in paper units.
    pub(super) fn zero(&mut self, at: Point, right: f64, up: f64, text: &str) {
        self.add(Pen::Edge, Shape::Zero(at));
        self.text(at, right, up, Align::Left, text);
    }

    /// Writes a text beside a point, `right` and `up` in paper units.
    pub(super) fn text(&mut self, [x, y]: Point, right: f64, up: f64, align: Align, text: impl Into<String>) {
        let at = [x + right * self.unit, y + up * self.unit];
        self.add(Pen::Edge, Shape::Text { at, align, text: text.into() });
    }

    /// Returns the SVG element, with a description for screen readers.
    pub(super) fn markup(self, words: &str) -> Markup {
        let scene = Scene { strokes: self.strokes, ..Scene::default() };
        let sheet = Sheet::to_scale(&scene, [WIDTH, self.height], self.origin, 1.0 / self.unit, 12.0);
        PreEscaped(svg(&sheet, words))
    }
}
