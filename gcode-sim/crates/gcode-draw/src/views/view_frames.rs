//! Frames of the views of a tool path: the box that they show, its place on the sheet, and scales with part coordinates.
use super::path_view::{Arrangement, PathView, RunKind, StandardView};
use super::top::{DrawnHole, TopView};
use crate::scene::{Align, Pen, Point, Shape, Stroke};
use crate::side::{Projection, Side};
use crate::ticks::Ticks;
use gcode_part::{Hole, Stock, StockAxis};

/// Margin of the box about the feeds, in parts of its largest edge.
const MARGIN: f64 = 0.08;
/// Least edge of the box, mm: enlarged further, a short move or a point looks like a part, and its scale has more digits than a control.
const LEAST_EDGE: f64 = 2.0;
/// Largest distance of a work zero from the feeds at which the box contains it, in parts of its largest edge.
const ZERO_REACH: f64 = 0.5;
/// Space between views for scales and names, in parts of the largest extent of all views.
const GAP: f64 = 0.1;
/// Length of a tick and distance of a name from its frame, in parts of the largest extent of all views.
const TICK: f64 = 0.008;

/// Height of a name above its frame, in ticks: between them is a line for the label of a place on the edge.
const NAME_HEIGHT: f64 = 5.0;

/// Width of a frame under which its name would meet the letter of its upright axis, in parts of the largest extent of all views.
const NARROW: f64 = 0.15;

/// Least width of a picture of holes alone, in radii of the largest.
const LEAST_RADII: f64 = 20.0;

/// The box that the views show, in the coordinates of the top view: right, up, and towards the reader.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewBox {
    top: Side,
    low: [f64; 3],
    high: [f64; 3],
}

impl ViewBox {
    /// Encloses the feeds, the holes and the stock, and work zeros near them; all moves if nothing is cut.
    pub(super) fn of(top: Side, view: &TopView, path: &PathView) -> Self {
        let mut all = Self { top, low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        for run in path.runs.iter().filter(|run| run.kind != RunKind::Rapid) {
            let width = path.tools.get(run.tool).and_then(|tool| tool.swept_width);
            for point in &path.points[run.points.clone()] {
                all.add(*point, width.unwrap_or(0.0) / 2.0);
            }
        }
        for hole in view.holes.iter().filter_map(DrawnHole::shown) {
            let radius = hole.diameter.unwrap_or(0.0) / 2.0;
            let bottom = |axis: usize| hole.entry[axis] - hole.depth * hole.axis[axis];
            all.add(hole.entry, radius);
            all.add([bottom(0), bottom(1), bottom(2)], radius);
        }
        match &path.stock {
            Some(Stock::Box { min, max, .. }) => {
                [*min, *max].into_iter().for_each(|corner| all.add(corner, 0.0))
            }
            Some(Stock::Cylinder { axis, diameter, from, to, .. }) => {
                let (along, radius) = (axis_index(*axis), diameter / 2.0);
                for (end, side) in [(*from, -radius), (*to, radius)] {
                    let mut corner = [side; 3];
                    corner[along] = end;
                    all.add(corner, 0.0);
                }
            }
            Some(Stock::Surface { .. }) | None => {}
        }
        // The front view has the first and the third coordinate of the top view, the right view the second and the third.
        for (side, axes) in [(top, [0, 1]), (top.front(), [0, 2]), (top.from_right(), [1, 2])] {
            for point in view.outlines(side).iter().flat_map(Shape::points) {
                for (axis, mm) in axes.into_iter().zip(point) {
                    (all.low[axis], all.high[axis]) = (all.low[axis].min(mm), all.high[axis].max(mm));
                }
            }
        }
        if all.high[2] < all.low[2] {
            path.points.iter().for_each(|point| all.add(*point, 0.0));
        }
        let reach = ZERO_REACH * all.largest();
        let cuts = all.grown(reach);
        for (_, at) in path.zeros.iter().filter(|(_, at)| cuts.contains(*at)) {
            all.add(*at, 0.0);
        }
        all.grown(MARGIN * all.largest()).widened()
    }

    /// Widens edges about their middles to the least one.
    fn widened(mut self) -> Self {
        for axis in 0..3 {
            let missing = ((LEAST_EDGE - (self.high[axis] - self.low[axis])) / 2.0).max(0.0);
            self.low[axis] -= missing;
            self.high[axis] += missing;
        }
        self
    }

    /// Adds a point, and the circle about it across the line of sight.
    fn add(&mut self, point: [f64; 3], radius: f64) {
        for ((axis, mm), reach) in
            self.top.coordinates(point).into_iter().enumerate().zip([radius, radius, 0.0])
        {
            self.low[axis] = self.low[axis].min(mm - reach);
            self.high[axis] = self.high[axis].max(mm + reach);
        }
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        let coordinates = self.top.coordinates(point);
        (0..3).all(|axis| self.low[axis] <= coordinates[axis] && coordinates[axis] <= self.high[axis])
    }

    fn largest(&self) -> f64 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f64::max)
    }

    fn grown(self, by: f64) -> Self {
        Self { low: self.low.map(|mm| mm - by), high: self.high.map(|mm| mm + by), ..self }
    }

    /// Returns the point of the part at a corner, given by an end of each edge.
    fn corner(&self, ends: [bool; 3]) -> [f64; 3] {
        let at = |axis: usize| if ends[axis] { self.high[axis] } else { self.low[axis] };
        self.top.point([at(0), at(1), at(2)])
    }

    /// Returns the corners of the box on the sheet that enclose it.
    fn extent(&self, side: Side) -> [Point; 2] {
        let ends = [false, true];
        let corners =
            ends.into_iter().flat_map(|a| ends.into_iter().flat_map(move |b| ends.map(|c| [a, b, c])));
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [right, up] in corners.map(|ends| side.project(self.corner(ends))) {
            low = [low[0].min(right), low[1].min(up)];
            high = [high[0].max(right), high[1].max(up)];
        }
        [low, high]
    }
}

/// Returns the index of an axis in a point.
pub(super) fn axis_index(axis: StockAxis) -> usize {
    match axis {
        StockAxis::X => 0,
        StockAxis::Y => 1,
        StockAxis::Z => 2,
    }
}

/// A view with its frame and its place on the sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedView {
    pub(super) kind: StandardView,
    pub(super) side: Side,
    /// Lower left and upper right corner of the frame, before it is moved.
    pub(super) frame: [Point; 2],
    /// Displacement on the sheet.
    shift: Point,
}

impl PlacedView {
    /// Returns the place of a point of the part on the sheet.
    pub(super) fn project(&self, at: [f64; 3]) -> Point {
        self.moved(self.side.project(at))
    }

    /// Moves a projected point to its place on the sheet.
    pub(super) fn moved(&self, [right, up]: Point) -> Point {
        [right + self.shift[0], up + self.shift[1]]
    }
}

/// The views of a sheet.
#[derive(Clone, Debug)]
pub(super) struct Frames {
    pub(super) views: Vec<PlacedView>,
    /// Largest extent of all views together, mm.
    pub(super) extent: f64,
    shown: ViewBox,
}

/// Returns column and row of a view, rows from below.
fn cell(view: StandardView, projection: Projection) -> (usize, usize) {
    let (column, row) = match view {
        StandardView::Top => (0, 1),
        StandardView::Front => (0, 0),
        StandardView::Right => (1, 0),
        StandardView::Isometric => (1, 1),
    };
    match projection {
        Projection::Third => (column, row),
        Projection::First => (1 - column, 1 - row),
    }
}

impl Frames {
    /// Places the views so that they align: a column has one abscissa, a row one ordinate. Two views that share neither
    /// lie side by side.
    pub(super) fn of(shown: ViewBox, arrangement: &Arrangement) -> Self {
        let views = &arrangement.views;
        let cells: Vec<(usize, usize)> = match views[..] {
            [first, second] => {
                let cells = [first, second].map(|view| cell(view, arrangement.projection));
                let is_aligned = cells[0].0 == cells[1].0 || cells[0].1 == cells[1].1;
                if is_aligned { cells.into() } else { vec![(0, 0), (1, 0)] }
            }
            _ => views.iter().map(|view| cell(*view, arrangement.projection)).collect(),
        };
        let sides: Vec<Side> = views.iter().map(|view| view.side(arrangement.top)).collect();
        let frames: Vec<[Point; 2]> = sides.iter().map(|side| shown.extent(*side)).collect();
        let (mut widths, mut heights) = ([0.0f64; 2], [0.0f64; 2]);
        for ((column, row), [low, high]) in cells.iter().zip(&frames) {
            widths[*column] = widths[*column].max(high[0] - low[0]);
            heights[*row] = heights[*row].max(high[1] - low[1]);
        }
        let gap = GAP * widths.iter().sum::<f64>().max(heights.iter().sum());
        let after = |size: f64| if 0.0 < size { size + gap } else { 0.0 };
        let (second_column, second_row) = (after(widths[0]), after(heights[0]));
        let placed = cells.iter().zip(views.iter().zip(&sides)).zip(&frames).map(
            |(((column, row), (kind, side)), [low, high])| {
                let corner = [*column as f64 * second_column, *row as f64 * second_row];
                let shift = [corner[0] - low[0], corner[1] - low[1]];
                PlacedView { kind: *kind, side: *side, frame: [*low, *high], shift }
            },
        );
        let extent = (second_column + widths[1]).max(second_row + heights[1]);
        Self { views: placed.collect(), extent, shown }
    }

    /// Frames a top view alone, with the part's coordinates on the sheet, about the holes and the points given. A small hole
    /// leaves room about itself.
    pub(super) fn in_place(view: &TopView, path: &PathView, corners: &[Point]) -> Self {
        let mut shown = ViewBox::of(view.side, view, path);
        let edges = [0, 1].map(|axis| shown.high[axis] - shown.low[axis]);
        let radius = |hole: &Hole| hole.diameter.unwrap_or(0.0) / 2.0;
        let radii = view.holes.iter().filter_map(DrawnHole::shown).map(radius);
        let least = LEAST_RADII * radii.fold(0.0, f64::max);
        let missing = ((least - edges[0].max(edges[1])) / 2.0).max(0.0);
        for axis in [0, 1] {
            shown.low[axis] -= missing;
            shown.high[axis] += missing;
            for corner in corners {
                shown.low[axis] = shown.low[axis].min(corner[axis]);
                shown.high[axis] = shown.high[axis].max(corner[axis]);
            }
        }
        if !corners.is_empty() {
            shown = shown.grown(0.5 * MARGIN * shown.largest());
        }
        let frame = shown.extent(view.side);
        let [[left, bottom], [right, top]] = frame;
        let extent = (right - left).max(top - bottom);
        let placed = PlacedView { kind: StandardView::Top, side: view.side, frame, shift: [0.0, 0.0] };
        Self { views: vec![placed], extent, shown }
    }

    /// Draws the frame of a view with its scales and, among others, its name.
    pub(super) fn strokes(&self, view: &PlacedView) -> Vec<Stroke> {
        let [[left, bottom], [right, top]] = view.frame;
        let mut strokes = Vec::new();
        let mut line = |points: Vec<Point>, pen: Pen, caption: Option<String>| {
            let shape = Shape::Line(points.into_iter().map(|point| view.moved(point)).collect());
            strokes.push(Stroke { caption, ..Stroke::new(pen, shape) });
        };
        if view.kind == StandardView::Isometric {
            let at = |ends: [bool; 3]| view.side.project(self.shown.corner(ends));
            let floor = [[false, false], [true, false], [true, true], [false, true], [false, false]];
            line(floor.map(|[a, b]| at([a, b, false])).into(), Pen::Scale, None);
            line(vec![at([false; 3]), at([false, false, true])], Pen::Scale, None);
            let origin = [false; 3];
            let scales = [
                ([at(origin), at([true, false, false])], 0, [0.0, -1.0]),
                ([at([true, false, false]), at([true, true, false])], 1, [0.0, -1.0]),
                ([at(origin), at([false, false, true])], 2, [-1.0, 0.0]),
            ];
            self.scales(&scales, &mut line);
        } else {
            let corners = [[left, bottom], [right, bottom], [right, top], [left, top], [left, bottom]];
            line(corners.into(), Pen::Scale, None);
            let (across, upwards) = match view.kind {
                StandardView::Top | StandardView::Isometric => (0, 1),
                StandardView::Front => (0, 2),
                StandardView::Right => (1, 2),
            };
            let scales = [
                ([[left, bottom], [right, bottom]], across, [0.0, -1.0]),
                ([[left, bottom], [left, top]], upwards, [-1.0, 0.0]),
            ];
            self.scales(&scales, &mut line);
        }
        if self.views.len() == 1 {
            return strokes;
        }
        // Above a narrow frame the name is clear of the letter of the upright axis.
        let height = if right - left < NARROW * self.extent { 5.5 } else { NAME_HEIGHT };
        let at = view.moved([(left + right) / 2.0, top + height * TICK * self.extent]);
        let name = Shape::Text { at, align: Align::Centre, text: view.kind.name().to_owned() };
        strokes.push(Stroke::new(Pen::Scale, name));
        strokes
    }

    /// Draws scales along edges of the box: their ends, the number of the top view's direction, and where their ticks point. The
    /// letters of all axes come before the numbers, which give way to them.
    fn scales(
        &self,
        scales: &[([Point; 2], usize, [f64; 2])],
        line: &mut impl FnMut(Vec<Point>, Pen, Option<String>),
    ) {
        for is_letter in [true, false] {
            for (ends, edge, outwards) in scales {
                self.scale(*ends, (*edge, is_letter), *outwards, line);
            }
        }
    }

    /// Draws the letter of a scale, or its ticks.
    fn scale(
        &self,
        [from, to]: [Point; 2],
        (edge, is_letter): (usize, bool),
        outwards: [f64; 2],
        line: &mut impl FnMut(Vec<Point>, Pen, Option<String>),
    ) {
        let (low, high) = (self.shown.low[edge], self.shown.high[edge]);
        let Some((name, sign)) = self.shown.top.axis_of_coordinate(edge) else { return };
        let tick = TICK * self.extent;
        let at = |coordinate: f64| {
            let share = (coordinate - low) / (high - low);
            [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]
        };
        let further = |[right, up]: Point, [x, y]: [f64; 2], by: f64| [right + x * by, up + y * by];
        let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
        let (end, along) = if 0.0 < sign { (to, 1.0) } else { (from, -1.0) };
        let direction = [(to[0] - from[0]) / length * along, (to[1] - from[1]) / length * along];
        if is_letter {
            line(vec![end, further(end, direction, tick)], Pen::Ruler, Some(name.to_string()));
            return;
        }
        let most = (14.0 * length / self.extent).clamp(3.0, 10.0);
        let (first, last) = if 0.0 < sign { (low, high) } else { (-high, -low) };
        let ticks = Ticks::over(first, last, most);
        for value in ticks.all() {
            let start = at(sign * value);
            line(vec![start, further(start, outwards, tick)], Pen::Ruler, Some(ticks.name(value)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::path_view::PathRun;
    use super::*;

    /// Returns the box about a feed along z from 0 to a depth.
    fn about_plunge(depth: f64) -> ViewBox {
        let run = PathRun {
            kind: RunKind::Feed,
            tool: 0,
            program: 0,
            feed: 100.0,
            axis: super::super::path_view::RunAxis::Unknown,
            points: 0..2,
        };
        let points = vec![[5.0, 5.0, 0.0], [5.0, 5.0, depth]];
        let path = PathView { points, runs: vec![run], ..PathView::default() };
        ViewBox::of(Side::Z, &TopView::default(), &path)
    }

    /// 8 % of 100 mm on each side are 16 mm across the feed and 116 along it; 8 % of 0.1 mm are less than the least edge.
    #[test]
    fn a_short_move_is_not_enlarged_without_limit() {
        let edges = |depth: f64| {
            let all = about_plunge(depth);
            [0, 1, 2]
                .map(|axis| (all.high[axis] - all.low[axis]) * 1e6)
                .map(f64::round)
                .map(|edge| edge / 1e6)
        };
        assert_eq!(edges(-100.0), [16.0, 16.0, 116.0]);
        assert_eq!(edges(-0.1), [2.0, 2.0, 2.0]);
        assert_eq!(edges(0.0), [2.0, 2.0, 2.0]);
    }
}
