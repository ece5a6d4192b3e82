//! Charts: graphs above one another over a common abscissa, with ticks, tolerance bands and markers.
use super::ink::{DrawCommand, Ink, Px, Rect, px};
use super::obstacle::Obstacle;
use super::palette;
use super::scene::{Align, HoleStatus, Pen, Point};
use super::symbol;
use super::ticks::Ticks;
use super::words::Words;

/// Graphs over a common abscissa, usually a distance in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Name of the abscissa, with its unit.
    pub x_label: String,
    /// Vertical guide lines: abscissa and caption.
    pub guides: Vec<(f64, String)>,
    /// Intervals of the abscissa without data, marked as such.
    pub gaps: Vec<[f64; 2]>,
    /// Graphs from top to bottom.
    pub graphs: Vec<Graph>,
}

/// One graph: curves, tolerance band and markers over the chart's abscissa.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// Name of the ordinate, with its unit.
    pub y_label: String,
    /// Curves, the later ones on top.
    pub curves: Vec<Curve>,
    /// Tolerance band: abscissa, lower limit, upper limit.
    pub band: Vec<[f64; 3]>,
    /// Whether zero is in range and has a line of its own.
    pub has_zero_line: bool,
    /// Markers with a name.
    pub markers: Vec<ChartMarker>,
}

/// A polyline of a graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Abscissa and ordinate, in the units of the axes.
    pub points: Vec<Point>,
    /// Line style.
    pub pen: Pen,
    /// Whether the curve is left out of the graph's range and clipped to it.
    pub is_clipped: bool,
}

/// A named marker in a graph.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartMarker {
    /// Abscissa and ordinate of the marker.
    pub position: Point,
    /// Status that selects the symbol.
    pub status: HoleStatus,
    /// Text beside the symbol.
    pub name: String,
}

impl Chart {
    /// Draws the graphs into an area of the page.
    pub(super) fn draw(&self, area: Rect, words: &mut Words<'_>) {
        let (text, soft) = (words.text_size, palette::SOFT_TEXT);
        let count = self.graphs.len().max(1) as f64;
        let guided = if self.guides.is_empty() { 0.0 } else { 1.4 * text };
        let (head, gap, foot) = (2.0 * text, 0.8 * text, 3.4 * text);
        let tall = (area.height() - guided - foot - gap * (count - 1.0)) / count - head;
        let ranges: Vec<Range> = self.graphs.iter().map(|graph| Range::of(graph, tall, text)).collect();
        let names = ranges.iter().flat_map(|range| range.ticks.all().map(|at| range.ticks.name(at)));
        let widest = names.map(|name| words.font.width(&name, text)).fold(0.0, f64::max);
        let (west, east) = (area.left + widest + text, area.right - 2.0 * text);
        let curves = self.graphs.iter().flat_map(|graph| &graph.curves);
        let ways = curves.flat_map(|curve| &curve.points).map(|point| point[0]);
        let guides = self.guides.iter().map(|(way, _)| *way).chain(self.gaps.iter().flatten().copied());
        let (left, right) = spread(ways.chain(guides).chain([0.0]), 1.0);
        let across = Ticks::over(left, right, ((east - west) / (4.0 * text)).clamp(2.0, 10.0));
        let x = |at: f64| west + (east - west) * (at - left) / (right - left);
        let mut top = area.top + guided;
        for (index, (graph, range)) in self.graphs.iter().zip(&ranges).enumerate() {
            let frame = Rect { left: west, top: top + head, right: east, bottom: top + head + tall };
            words.write(px(area.left, top + text), Align::Left, text, soft, &graph.y_label, area.width());
            let area = ChartArea { frame, x: &x, range };
            graph.draw_band(&area, words);
            let grid = palette::pen(Pen::Grid, text);
            for at in across.all().map(x) {
                words.sheet.commands.push(upright(&frame, at, grid));
            }
            for (at, name) in &self.guides {
                let pen = palette::pen(Pen::Construction, text);
                words.sheet.commands.push(upright(&frame, x(*at), pen));
                if index == 0 {
                    words.write_if_free(px(x(*at), frame.top - 0.5 * text), Align::Centre, text, soft, name);
                }
            }
            self.draw_gaps(&area, words);
            graph.draw(&area, words);
            top = frame.bottom + gap;
        }
        let bottom = top - gap;
        for at in across.all() {
            let base = px(x(at), bottom + 1.4 * text);
            words.write(base, Align::Centre, text, soft, &across.name(at), east - west);
        }
        let middle = px((west + east) / 2.0, bottom + foot);
        words.write(middle, Align::Centre, text, soft, &self.x_label, area.width());
    }

    /// Draws two vertical lines for each gap and a thick line at zero between them.
    fn draw_gaps(&self, area: &ChartArea<'_>, words: &mut Words<'_>) {
        let (text, frame) = (words.text_size, area.frame);
        let color = palette::status_colour(HoleStatus::Bad);
        let edge = Ink::dashed(0.1 * text, color, [0.25 * text, 0.35 * text]);
        let level = area.px([0.0, 0.0]).y.clamp(frame.top, frame.bottom);
        for [from, to] in self.gaps.iter().map(|gap| gap.map(area.x)) {
            words.sheet.commands.extend([from, to].map(|x| upright(&frame, x, edge)));
            let along = Ink::solid(0.4 * text, color);
            words.sheet.commands.push(DrawCommand::line(px(from, level), px(to, level), along));
        }
    }
}

/// The frame of one graph on the sheet, with its scales.
struct ChartArea<'c> {
    frame: Rect,
    x: &'c dyn Fn(f64) -> f64,
    range: &'c Range,
}

impl ChartArea<'_> {
    fn px(&self, [x, y]: Point) -> Px {
        let Range { low, high, .. } = *self.range;
        px((self.x)(x), self.frame.bottom - self.frame.height() * (y - low) / (high - low))
    }

    /// Returns a horizontal line across the frame.
    fn level(&self, at: f64, ink: Ink) -> DrawCommand {
        let y = self.px([0.0, at]).y;
        DrawCommand::line(px(self.frame.left, y), px(self.frame.right, y), ink)
    }
}

impl Graph {
    fn draw_band(&self, area: &ChartArea<'_>, words: &mut Words<'_>) {
        let edge = |which: usize| self.band.iter().map(move |at| area.px([at[0], at[which]]));
        if 1 < self.band.len() {
            let (low, high): (Vec<Px>, Vec<Px>) = (edge(1).collect(), edge(2).collect());
            let points = low.iter().chain(high.iter().rev()).copied().collect();
            words.sheet.commands.push(DrawCommand::Area { points, color: palette::BAND });
            let pen = palette::pen(Pen::Limit, words.text_size);
            words.sheet.commands.extend([low, high].map(|points| DrawCommand::path(points, pen)));
        }
    }

    fn draw(&self, area: &ChartArea<'_>, words: &mut Words<'_>) {
        let (text, ticks) = (words.text_size, &area.range.ticks);
        for at in ticks.all() {
            words.sheet.commands.push(area.level(at, palette::pen(Pen::Grid, text)));
            let beside = px(area.frame.left - 0.5 * text, area.px([0.0, at]).y + 0.36 * text);
            let room = area.frame.left;
            words.write(beside, Align::Right, text, palette::SOFT_TEXT, &ticks.name(at), room);
        }
        if self.has_zero_line {
            words.sheet.commands.push(area.level(0.0, Ink::solid(0.08 * text, palette::TEXT)));
        }
        for curve in &self.curves {
            let Range { low, high, .. } = *area.range;
            for piece in between(&curve.points, low, high) {
                let points = piece.into_iter().map(|point| area.px(point)).collect();
                words.sheet.commands.push(DrawCommand::path(points, palette::pen(curve.pen, text)));
            }
        }
        for sign in &self.markers {
            let at = area.px(sign.position);
            words.sheet.commands.extend(symbol::status_sign(sign.status, at, 0.55 * text));
            self.name(sign, at, area, words);
        }
    }

    /// Writes a marker's name where no curve runs: beside the symbol, else above or below it.
    fn name(&self, sign: &ChartMarker, at: Px, area: &ChartArea<'_>, words: &mut Words<'_>) {
        let text = words.text_size;
        let beside = [(Align::Left, 0.8), (Align::Right, -0.8)];
        let level = beside.map(|(align, x)| (align, px(at.x + x * text, at.y + 0.36 * text)));
        let above = beside.map(|(align, x)| (align, px(at.x - x * text, at.y - text)));
        let below = beside.map(|(align, x)| (align, px(at.x - x * text, at.y + 1.6 * text)));
        let is_free = |(align, at): &(Align, Px)| {
            let rect = words.rect(*at, *align, text, &sign.name);
            let pairs = self.curves.iter().flat_map(|curve| curve.points.windows(2));
            let mut lines = pairs.map(|pair| Obstacle::Segment(area.px(pair[0]), area.px(pair[1])));
            area.frame.contains(&rect) && !lines.any(|line| line.hits(&rect))
        };
        if let Some((align, at)) = [level, above, below].into_iter().flatten().find(is_free) {
            words.write_if_free(at, align, text, palette::TEXT, &sign.name);
        }
    }
}

/// Draws a vertical line across a frame.
fn upright(frame: &Rect, x: f64, ink: Ink) -> DrawCommand {
    DrawCommand::line(px(x, frame.bottom), px(x, frame.top), ink)
}

/// Returns the pieces of a curve between the ordinates `low` and `high`.
fn between(points: &[Point], low: f64, high: f64) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let ([x, y], [to_x, to_y]) = (pair[0], pair[1]);
        let at = |level: f64| (level - y) / (to_y - y);
        let (mut from, mut to) = (0.0f64, 1.0f64);
        if y == to_y {
            if y < low || high < y {
                continue;
            }
        } else {
            let (enters, leaves) = if y < to_y { (at(low), at(high)) } else { (at(high), at(low)) };
            (from, to) = (from.max(enters), to.min(leaves));
        }
        if to <= from {
            continue;
        }
        let there = |part: f64| [x + (to_x - x) * part, y + (to_y - y) * part];
        match pieces.last_mut().filter(|piece| from == 0.0 && piece.last() == Some(&pair[0])) {
            Some(piece) => piece.push(if to == 1.0 { pair[1] } else { there(to) }),
            None => pieces.push(vec![
                if from == 0.0 { pair[0] } else { there(from) },
                if to == 1.0 { pair[1] } else { there(to) },
            ]),
        }
    }
    pieces
}

/// Range of a graph's ordinate and its ticks.
struct Range {
    low: f64,
    high: f64,
    ticks: Ticks,
}

impl Range {
    fn of(graph: &Graph, tall: f64, text: f64) -> Self {
        let fitted = graph.curves.iter().filter(|curve| !curve.is_clipped);
        let curves = fitted.flat_map(|curve| &curve.points).map(|point| point[1]);
        let band = graph.band.iter().flat_map(|[_, low, high]| [*low, *high]);
        let signs = graph.markers.iter().map(|sign| sign.position[1]);
        let zero = graph.has_zero_line.then_some(0.0);
        let (low, high) = spread(curves.chain(band).chain(signs).chain(zero), 1e-3);
        let room = 0.05 * (high - low);
        let (low, high) = (low - room, high + room);
        Self { low, high, ticks: Ticks::over(low, high, (tall / (2.2 * text)).clamp(2.0, 10.0)) }
    }
}

/// Returns the least and the greatest value; values closer together than `least` give a range of that width.
fn spread(values: impl Iterator<Item = f64>, least: f64) -> (f64, f64) {
    let reach = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), reach);
    match high - low {
        apart if apart.is_nan() || apart < 0.0 => (0.0, least),
        apart if apart < least => (low, low + least),
        _ => (low, high),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve from 0 up to 4 and down again, clipped to 1 to 3, gives two pieces that end on the limits.
    #[test]
    fn a_curve_is_clipped_at_the_limits_of_its_graph() {
        let roof = [[0.0, 0.0], [4.0, 4.0], [8.0, 0.0]];
        let pieces = between(&roof, 1.0, 3.0);
        assert_eq!(pieces, [vec![[1.0, 1.0], [3.0, 3.0]], vec![[5.0, 3.0], [7.0, 1.0]]]);
        assert_eq!(between(&roof, -1.0, 5.0), [roof.to_vec()]);
        assert!(between(&[[0.0, 5.0], [1.0, 5.0]], 1.0, 3.0).is_empty());
    }

    #[test]
    fn the_range_of_a_graph_contains_its_band_but_no_clipped_curve() {
        let curve = |y: f64, guest: bool| Curve {
            points: vec![[0.0, y], [9.0, y]],
            pen: Pen::Nominal,
            is_clipped: guest,
        };
        let graph = Graph {
            curves: vec![curve(20.1, false), curve(70.0, true)],
            band: vec![[0.0, 19.7, 20.3], [9.0, 19.7, 20.3]],
            ..Graph::default()
        };
        let range = Range::of(&graph, 400.0, 10.0);
        assert!((range.low - 19.67).abs() < 1e-9 && (range.high - 20.33).abs() < 1e-9);
        let range = Range::of(&Graph { has_zero_line: true, ..graph }, 400.0, 10.0);
        assert!(range.low < 0.0 && range.high < 22.0);
    }
}
