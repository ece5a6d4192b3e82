//! Lines of a tool path in one view: colour by a value or a class, dash pattern by tool, clipped to the frame.
use std::collections::BTreeMap;

use super::drawn_lines::{DrawnCells, DrawnSegments, SAME_LINE, distance};
use super::path_view::{ColorBy, PathRun, PathView, RunAxis, RunKind};
use super::view_frames::{Frames, PlacedView};
use crate::scene::{Pen, Point, Shape, Stroke, Style, Tint};
use nalgebra::Vector3;

/// Resolution of a sheet in parts of the extent of its views: less than 0.1 pixels of an ordinary picture.
const RESOLUTION: f64 = 5e-5;
/// Largest difference of heights that are one, mm.
const SAME_HEIGHT: f64 = 1e-6;
/// Number of shades that are told apart.
const SHADES: f64 = 64.0;
/// Largest number of points of feeds under which the swept width is drawn.
pub(super) const MAX_SWEPT_POINTS: usize = 20_000;

/// Values that the shades of feeds stand for.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadeScale {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Height of the highest plunge above the scale, whose colour there is that of the highest cut.
    pub(super) plunge: Option<f64>,
}

impl ShadeScale {
    /// Returns the range of the values of the feeds; `None` if the colours stand for classes. Heights are those of lines in a
    /// view: a feed along the line of sight is a point.
    pub(super) fn of(
        path: &PathView,
        color_by: ColorBy,
        frames: &Frames,
        depth: impl Fn([f64; 3]) -> f64,
    ) -> Option<Self> {
        let is_line = |pair: &&[[f64; 3]]| {
            frames.views.iter().any(|view| {
                let ends = [view.side.project(pair[0]), view.side.project(pair[1])];
                RESOLUTION * frames.extent < distance(ends[0], ends[1])
            })
        };
        let feeds = || path.runs.iter().filter(|run| run.kind == RunKind::Feed);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut add = |value: f64| (low, high) = (low.min(value), high.max(value));
        match color_by {
            ColorBy::Depth => {
                let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
                let pairs = feeds().flat_map(|run| path.points[run.points.clone()].windows(2));
                for pair in pairs.filter(is_line) {
                    let ends = [depth(pair[0]), depth(pair[1])];
                    lowest = lowest.min(ends[0]).min(ends[1]);
                    highest = highest.max(ends[0]).max(ends[1]);
                    // A feed towards the part or out of it begins or ends above what is cut.
                    let way = (Vector3::from(pair[1]) - Vector3::from(pair[0])).norm();
                    if (ends[1] - ends[0]).abs() < 0.999 * way {
                        ends.into_iter().for_each(&mut add);
                    }
                }
                let high = if low <= high { high } else { highest };
                let plunge = Some(highest).filter(|highest| high + SAME_HEIGHT < *highest);
                return (lowest <= high).then_some(Self { low: lowest, high, plunge });
            }
            ColorBy::Feed => feeds().for_each(|run| add(run.feed)),
            ColorBy::Tool | ColorBy::Program => return None,
        }
        (low <= high).then_some(Self { low, high, plunge: None })
    }

    /// Returns true if all values are the same.
    pub(super) fn is_flat(self) -> bool {
        self.high - self.low < SAME_HEIGHT
    }

    /// Returns the colour of a shade by its number.
    fn tint(self, level: f64) -> Tint {
        Tint::Shade(level / (SHADES - 1.0))
    }

    /// Returns the number of a value's shade.
    fn level(self, value: f64) -> f64 {
        if self.is_flat() {
            return (SHADES / 4.0).floor();
        }
        ((value - self.low) / (self.high - self.low) * SHADES).floor().clamp(0.0, SHADES - 1.0)
    }
}

/// Returns the colour and the dashes of a class: the seventh has the first one's colour and the second one's dashes.
pub(super) fn class_style(class: usize) -> Style {
    Style { tint: Some(Tint::Class(class)), pattern: ((class + class / 6) % 6) as u8, ..Style::default() }
}

/// Returns true if the tool is along the line of sight, or in an unknown direction.
fn is_along_sight(view: &PlacedView, run: &PathRun) -> bool {
    match run.axis {
        RunAxis::Unknown => true,
        RunAxis::Along(axis) => 0.5 < view.side.towards()[axis].abs(),
        RunAxis::Oblique => false,
    }
}

/// Draws the path in a view.
pub(super) struct PathDrawer<'a> {
    pub(super) path: &'a PathView,
    pub(super) color_by: ColorBy,
    pub(super) shades: Option<ShadeScale>,
    /// Axis of the part whose coordinate, times the sign, is the height.
    pub(super) height: (usize, f64),
    /// Order of the first feed of each tool; `None` of a tool that only moves rapidly.
    pub(super) tool_order: &'a [Option<usize>],
    /// Largest extent of the views, mm.
    pub(super) extent: f64,
}

impl PathDrawer<'_> {
    /// Returns the number of the class that the dashes of a feed stand for: its program if the colours stand for programs, else its
    /// tool in the order of the first feeds.
    fn class(&self, run: &PathRun) -> usize {
        match self.color_by {
            ColorBy::Program => run.program,
            ColorBy::Tool | ColorBy::Feed | ColorBy::Depth => {
                self.tool_order.get(run.tool).copied().flatten().unwrap_or(0)
            }
        }
    }

    /// Returns the look of a feed, but for its shade.
    pub(super) fn style(&self, run: &PathRun) -> Style {
        let of_class = class_style(self.class(run));
        let tint = match self.color_by {
            ColorBy::Tool | ColorBy::Program => of_class.tint,
            ColorBy::Feed => self.shades.map(|scale| scale.tint(scale.level(run.feed))),
            ColorBy::Depth => None,
        };
        Style { tint, ..of_class }
    }

    /// Draws the areas that the cutters sweep along the feeds, where the tool is along the line of sight.
    pub(super) fn swept(&self, view: &PlacedView) -> Vec<Stroke> {
        let is_along_sight = |run: &&PathRun| is_along_sight(view, run);
        let feeds = self.path.runs.iter().filter(|run| run.kind == RunKind::Feed).filter(is_along_sight);
        let swept = feeds.filter_map(|run| {
            let width = self.path.tools.get(run.tool)?.swept_width?;
            let points = self.sparse(view, run);
            let style = Style { tint: Some(Tint::Pale), width: Some(width), ..Style::default() };
            // A plunge sweeps no more than its hole, which has a symbol.
            let has_extent = points.iter().any(|point| self.is_apart(*point, points[0]));
            has_extent.then(|| Stroke { style: Some(style), ..Stroke::new(Pen::Feed, moved(view, points)) })
        });
        swept.collect()
    }

    /// Returns true if a mill sweeps a width along a feed where it is not along the line of sight.
    pub(super) fn sweeps_across_sight(&self, view: &PlacedView) -> bool {
        let has_width =
            |run: &PathRun| self.path.tools.get(run.tool).is_some_and(|tool| tool.swept_width.is_some());
        let feeds = self.path.runs.iter().filter(|run| run.kind == RunKind::Feed && has_width(run));
        feeds.filter(|run| !is_along_sight(view, run)).any(|run| {
            let points = &self.path.points[run.points.clone()];
            // A plunge sweeps no more than its hole.
            let is_across = |pair: &[[f64; 3]]| match run.axis {
                RunAxis::Along(axis) => {
                    (0..3).any(|other| other != axis && 1e-6 < (pair[1][other] - pair[0][other]).abs())
                }
                RunAxis::Unknown | RunAxis::Oblique => true,
            };
            points.windows(2).any(is_across)
        })
    }

    /// Draws the rapids, clipped to the frame; returns true with them if any is cut off.
    pub(super) fn rapids(&self, view: &PlacedView) -> (Vec<Stroke>, bool) {
        let (mut strokes, mut is_cut) = (Vec::new(), false);
        let mut line: Vec<Point> = Vec::new();
        let mut drawn = DrawnSegments::new(2.0 * RESOLUTION * self.extent);
        let mut cells = DrawnCells::new(view.frame, SAME_LINE * self.extent);
        for run in self.path.runs.iter().filter(|run| run.kind == RunKind::Rapid) {
            for pair in self.sparse(view, run).windows(2) {
                let Some([from, to]) = clipped([pair[0], pair[1]], view.frame) else {
                    is_cut = true;
                    continue;
                };
                is_cut |= from != pair[0] || to != pair[1];
                for [from, to] in drawn.add([from, to]) {
                    if cells.covers([from, to]) {
                        continue;
                    }
                    if line.last() != Some(&from) {
                        flush(&mut strokes, &mut line, view, Pen::Rapid, None);
                        line = vec![from];
                    }
                    line.push(to);
                    cells.add([from, to]);
                }
            }
            cells.end_run();
        }
        flush(&mut strokes, &mut line, view, Pen::Rapid, None);
        (strokes, is_cut)
    }

    /// Returns true if a sheet can tell two points from each other.
    pub(super) fn is_apart(&self, one: Point, other: Point) -> bool {
        RESOLUTION * self.extent <= distance(one, other)
    }

    /// Returns true if a view shows feeds of a tool as lines.
    pub(super) fn shows_feeds(&self, view: &PlacedView, tool: usize) -> bool {
        let is_of_tool = |run: &&PathRun| run.kind == RunKind::Feed && run.tool == tool;
        self.path.runs.iter().filter(is_of_tool).any(|run| {
            let points = self.sparse(view, run);
            points.iter().any(|point| self.is_apart(*point, points[0]))
        })
    }

    /// Draws feeds and probing moves. Where a tool repeats a line, as the turns of a helix seen along its axis do, the last one is
    /// drawn: dashes of all would fill each other's gaps.
    pub(super) fn feeds(&self, view: &PlacedView) -> Vec<Stroke> {
        let all = self.path.runs.iter().filter(|run| run.kind != RunKind::Rapid);
        let is_dashed = |run: &PathRun| run.kind == RunKind::Feed && self.style(run).pattern != 0;
        let points: usize = all.clone().filter(|run| is_dashed(run)).map(|run| run.points.len()).sum();
        // A probing move is seen on the feed that it follows.
        let probes_on_top = |mut strokes: Vec<Stroke>| {
            strokes.sort_by_key(|stroke| stroke.pen == Pen::Probe);
            strokes
        };
        if MAX_SWEPT_POINTS < points {
            return probes_on_top(all.flat_map(|run| self.feed(view, run)).collect());
        }
        let mut drawn: BTreeMap<usize, DrawnSegments> = BTreeMap::new();
        let mut strokes = Vec::new();
        for run in all.rev() {
            let lines = self.feed(view, run);
            if !is_dashed(run) {
                strokes.extend(lines.into_iter().rev());
                continue;
            }
            let of_class = drawn
                .entry(self.class(run))
                .or_insert_with(|| DrawnSegments::new(2.0 * RESOLUTION * self.extent));
            strokes.extend(lines.into_iter().rev().flat_map(|stroke| of_class.without_repeats(stroke)));
        }
        strokes.reverse();
        probes_on_top(strokes)
    }

    /// Draws a feed or a probing move.
    fn feed(&self, view: &PlacedView, run: &PathRun) -> Vec<Stroke> {
        let mut strokes = Vec::new();
        let pen = if run.kind == RunKind::Probe { Pen::Probe } else { Pen::Feed };
        let style = Some(self.style(run)).filter(|_| run.kind == RunKind::Feed);
        match (self.shades, self.color_by, style) {
            (Some(scale), ColorBy::Depth, Some(style)) => {
                self.shaded(view, run, scale, style, &mut strokes);
            }
            _ => flush(&mut strokes, &mut self.sparse(view, run), view, pen, style),
        }
        strokes
    }

    /// Draws a feed in pieces of one shade each. A steep segment is divided.
    fn shaded(
        &self,
        view: &PlacedView,
        run: &PathRun,
        scale: ShadeScale,
        style: Style,
        to: &mut Vec<Stroke>,
    ) {
        let depth = |point: [f64; 3]| point[self.height.0] * self.height.1;
        let least = RESOLUTION * self.extent;
        let mut drawn = 0.0;
        let mut flush_shade = |line: &mut Vec<Point>, level: f64| {
            let length: f64 = line.windows(2).map(|ends| distance(ends[0], ends[1])).sum();
            let phase = if style.pattern == 0 { 0.0 } else { drawn };
            let styled = Some(Style { tint: Some(scale.tint(level)), phase, ..style });
            flush(to, line, view, Pen::Feed, styled);
            drawn += length;
        };
        let points = &self.path.points[run.points.clone()];
        let (mut line, mut current) = (Vec::new(), f64::NAN);
        let Some(first) = points.first() else { return };
        let (mut before, mut before_depth) = (view.side.project(*first), depth(*first));
        for (index, point) in points.iter().enumerate().skip(1) {
            let (now, now_depth) = (view.side.project(*point), depth(*point));
            let is_last = index + 1 == points.len();
            if !is_last && libm::hypot(now[0] - before[0], now[1] - before[1]) < least {
                continue;
            }
            let pieces =
                ((scale.level(now_depth) - scale.level(before_depth)).abs() / 4.0).ceil().clamp(1.0, 16.0);
            let at = |share: f64| {
                [before[0] + (now[0] - before[0]) * share, before[1] + (now[1] - before[1]) * share]
            };
            for piece in 0..pieces as u32 {
                let middle = (f64::from(piece) + 0.5) / pieces;
                let level = scale.level(before_depth + (now_depth - before_depth) * middle);
                if level != current {
                    flush_shade(&mut line, current);
                    line.push(at(f64::from(piece) / pieces));
                    current = level;
                }
                line.push(at(f64::from(piece + 1) / pieces));
            }
            (before, before_depth) = (now, now_depth);
        }
        flush_shade(&mut line, current);
    }

    /// Returns the projected points of a run without those that a sheet can't tell from the one before.
    fn sparse(&self, view: &PlacedView, run: &PathRun) -> Vec<Point> {
        let least = RESOLUTION * self.extent;
        let points = &self.path.points[run.points.clone()];
        let mut sparse: Vec<Point> = Vec::new();
        for (index, point) in points.iter().enumerate() {
            let now = view.side.project(*point);
            let is_far =
                sparse.last().is_none_or(|last| least <= libm::hypot(now[0] - last[0], now[1] - last[1]));
            if is_far || index + 1 == points.len() {
                sparse.push(now);
            }
        }
        sparse
    }
}

/// Ends a polyline at its last point, with which the next one begins; one without extent is not drawn.
fn flush(
    strokes: &mut Vec<Stroke>,
    line: &mut Vec<Point>,
    view: &PlacedView,
    pen: Pen,
    style: Option<Style>,
) {
    let points = std::mem::take(line);
    line.extend(points.last().copied());
    let is_point =
        points.iter().all(|point| libm::hypot(point[0] - points[0][0], point[1] - points[0][1]) < 1e-6);
    if !is_point {
        strokes.push(Stroke { style, ..Stroke::new(pen, moved(view, points)) });
    }
}

fn moved(view: &PlacedView, points: Vec<Point>) -> Shape {
    Shape::Line(points.into_iter().map(|point| view.moved(point)).collect())
}

/// Returns the part of a segment inside a rectangle (clipping by Liang and Barsky).
pub(super) fn clipped([from, to]: [Point; 2], [low, high]: [Point; 2]) -> Option<[Point; 2]> {
    let way = [to[0] - from[0], to[1] - from[1]];
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        for (slope, room) in [(-way[axis], from[axis] - low[axis]), (way[axis], high[axis] - from[axis])] {
            if slope == 0.0 && room < 0.0 {
                return None;
            } else if slope < 0.0 {
                first = first.max(room / slope);
            } else if 0.0 < slope {
                last = last.min(room / slope);
            }
        }
    }
    let at = |share: f64| match share {
        0.0 => from,
        1.0 => to,
        _ => [from[0] + way[0] * share, from[1] + way[1] * share],
    };
    (first < last).then(|| [at(first), at(last)])
}

#[cfg(test)]
mod tests {
    use super::super::path_view::{Arrangement, StandardView};
    use super::super::top::TopView;
    use super::super::view_frames::ViewBox;
    use super::*;
    use crate::side::{Projection, Side};

    /// A drilled feed to z −20 is a point in the top view, where the slot at z −2 is the only line; from the front it is a line.
    #[test]
    fn the_scale_of_heights_is_that_of_the_lines_in_a_view() {
        let run = |points| PathRun {
            kind: RunKind::Feed,
            tool: 0,
            program: 0,
            feed: 100.0,
            axis: RunAxis::Along(2),
            points,
        };
        let points = vec![[5.0, 5.0, 0.0], [5.0, 5.0, -20.0], [0.0, 0.0, -2.0], [40.0, 0.0, -2.0]];
        let path = PathView { points, runs: vec![run(0..2), run(2..4)], ..PathView::default() };
        let scale = |view| {
            let arrangement = Arrangement {
                top: Side::Z,
                views: vec![view],
                projection: Projection::Third,
                color_by: ColorBy::Depth,
            };
            let frames = Frames::of(ViewBox::of(Side::Z, &TopView::default(), &path), &arrangement);
            let scale = ShadeScale::of(&path, ColorBy::Depth, &frames, |at| at[2]).unwrap();
            ([scale.low, scale.high], scale.plunge)
        };
        assert_eq!(scale(StandardView::Top), ([-2.0, -2.0], None));
        assert_eq!(scale(StandardView::Front), ([-20.0, -2.0], Some(0.0)));
    }

    /// From (−10, 5) to (30, 25) the line enters a square of 0 to 20 at (0, 10) and leaves it at (20, 20).
    #[test]
    fn a_segment_is_cut_at_the_frame() {
        let frame = [[0.0, 0.0], [20.0, 20.0]];
        assert_eq!(clipped([[-10.0, 5.0], [30.0, 25.0]], frame), Some([[0.0, 10.0], [20.0, 20.0]]));
        assert_eq!(clipped([[1.0, 2.0], [3.0, 2.0]], frame), Some([[1.0, 2.0], [3.0, 2.0]]));
        assert_eq!(clipped([[-10.0, 5.0], [-1.0, 25.0]], frame), None);
        assert_eq!(clipped([[-10.0, 21.0], [30.0, 21.0]], frame), None);
    }
}
