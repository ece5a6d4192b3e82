//! Labels of holes and lines: as many lines of each label as fit, and notes on omitted ones.
use super::font::{ASCENT, DESCENT};
use super::ink::{DrawCommand, Px, Rect, px};
use super::labels::{LabelArea, LabelPlacement, LeaderRule, Symbol};
use super::lines::{SIGN, ZERO};
use super::marks::DrawnMark;
use super::measure::{Frame, LABEL_LIMIT};
use super::obstacle::Obstacle;
use super::palette;
use super::scene::{Align, Mark, Pen, Scene, Shape, Stroke};
use super::sheet::Sheet;
use super::symbol;
use gcode_lang::units::Deg;

/// Line spacing in parts of the text size.
const LEADING: f64 = 1.18;

/// The labels of all holes, placed.
pub(super) struct LabelLayout {
    /// The label area with these labels in it.
    pub(super) field: LabelArea,
    labels: Vec<Label>,
}

/// A placed label: hole, position and number of lines shown.
struct Label {
    mark: usize,
    placement: LabelPlacement,
    lines: usize,
}

impl LabelLayout {
    /// Gives all good holes the same number of label lines, as many as fit. Bad holes get all their lines
    /// unless that costs another hole its number.
    pub(super) fn of(scene: &Scene, drawn: &[DrawnMark], frame: &Frame, field: &LabelArea) -> Self {
        let mut order: Vec<usize> = (0..scene.marks.len()).collect();
        order.sort_by_key(|i| (scene.marks[*i].status, *i));
        order.truncate(LABEL_LIMIT);
        let most = scene.marks.iter().map(|m| m.label.len()).max().unwrap_or(0);
        let mut best = Self { field: field.clone(), labels: Vec::new() };
        let fewer_for_bad_ones = (1..most).rev().map(|bad| (1, bad));
        for (lines, bad) in (1..=most).rev().map(|good| (good, most)).chain(fewer_for_bad_ones) {
            let trial = Self::with_lines((lines, bad), &order, scene, drawn, frame, field.clone());
            let short = |l: &Label| l.lines < lines.min(scene.marks[l.mark].label.len());
            let complete = trial.labels.len() == order.len() && !trial.labels.iter().any(short);
            if complete || best.labels.len() < trial.labels.len() {
                best = trial;
            }
            if complete {
                break;
            }
        }
        best
    }

    fn with_lines(
        (good, bad): (usize, usize),
        order: &[usize],
        scene: &Scene,
        drawn: &[DrawnMark],
        frame: &Frame,
        field: LabelArea,
    ) -> Self {
        let mut trial = Self { field, labels: Vec::new() };
        for i in order {
            let (mark, hole) = (&scene.marks[*i], &drawn[*i]);
            let full = if mark.status.is_good() { good } else { bad }.min(mark.label.len());
            let symbol = |leader_rule: LeaderRule| Symbol {
                position: hole.centre,
                clearance: hole.label_clearance,
                leader_rule,
            };
            let near = if hole.is_crowded { LeaderRule::OutOfCrowd } else { LeaderRule::Clear };
            // A bad hole must be identifiable: its number may be far off, on a leader over other holes.
            let found = match trial.place(mark, full, symbol(near), frame) {
                None if !mark.status.is_good() => {
                    trial.place(mark, full, symbol(LeaderRule::ThroughAll), frame)
                }
                found => found,
            };
            trial.labels.extend(found.map(|(lines, spot)| Label { mark: *i, placement: spot, lines }));
        }
        trial
    }

    fn place(
        &mut self,
        mark: &Mark,
        lines: usize,
        symbol: Symbol,
        frame: &Frame,
    ) -> Option<(usize, LabelPlacement)> {
        (1..=lines).rev().find_map(|n| {
            let size = text_box(&mark.label[..n], frame);
            Some((n, self.field.place(symbol, size, frame.text_size * LEADING)?))
        })
    }

    /// Returns the number of holes whose label is omitted.
    pub(super) fn unlabelled(&self, scene: &Scene) -> usize {
        scene.marks.iter().filter(|m| !m.label.is_empty()).count() - self.labels.len()
    }

    /// Draws the labels and their leaders.
    pub(super) fn write(&self, scene: &Scene, frame: &Frame, sheet: &mut Sheet) {
        let leaders = self.labels.iter().filter_map(|label| label.placement.leader);
        let ink = palette::leader(frame.text_size);
        sheet.commands.extend(leaders.map(|(from, to)| DrawCommand::line(from, to, ink)));
        for label in &self.labels {
            let lines = scene.marks[label.mark].label[..label.lines].to_vec();
            write(lines, &label.placement, Ground::Halo, frame, sheet);
        }
    }

    /// Returns notes that count the omitted and the shortened labels.
    pub(super) fn notes(&self, scene: &Scene) -> Vec<String> {
        let mut notes = Vec::new();
        let without = self.unlabelled(scene);
        if 0 < without {
            // A hole has a symbol in each view, and its label in one.
            let holes = scene.marks.iter().filter(|mark| !mark.label.is_empty()).count();
            notes.push(format!("{without} of {holes} holes without a number: no room."));
        }
        let cut = self.labels.iter().filter(|l| l.lines < scene.marks[l.mark].label.len()).count();
        match cut {
            0 => {}
            1 => notes.push("1 label shortened: no room.".to_owned()),
            _ => notes.push(format!("{cut} labels shortened: no room.")),
        }
        notes
    }
}

/// Captions the lines that satisfy a predicate, such as radii, and returns the captions without room. A circle's
/// caption lies anywhere on it, from the lower left on; a straight line's on its middle; a scale's at the end
/// of the tick; a path's on the path or on a leader to its middle; a place's beside its symbol, whose position `sign_place`
/// returns. A scale may lose numbers without a note.
pub(super) fn caption_strokes(
    scene: &Scene,
    has_caption: impl Fn(&Stroke) -> bool,
    frame: &Frame,
    field: &mut LabelArea,
    sheet: &mut Sheet,
    sign_place: impl Fn(&Stroke) -> Option<Px>,
) -> Vec<String> {
    let mut left = Vec::new();
    let paths: Vec<Path<'_>> = scene.strokes.iter().filter_map(|stroke| Path::of(stroke, frame)).collect();
    for stroke in scene.strokes.iter().filter(|stroke| has_caption(stroke)) {
        let Some(caption) = &stroke.caption else { continue };
        let lines = vec![caption.clone()];
        let size = text_box(&lines, frame);
        let points: Vec<Px> = match &stroke.shape {
            Shape::Circle { centre, radius } => {
                let (centre, radius) = (frame.scale.px(*centre), radius * frame.scale.factor);
                let angles = (0..48).map(|i| Deg(f64::from(i) * 7.5 + 225.0));
                angles.map(|angle| centre.toward(symbol::direction(angle), radius)).collect()
            }
            Shape::Arrow(_) | Shape::Zero(_) | Shape::Sign { .. } | Shape::Text { .. } => Vec::new(),
            // The number of one path must not cover another path, to which a reader would assign it.
            Shape::Line(_) if stroke.pen.is_path() => {
                let own = paths.iter().find(|path| std::ptr::eq(path.stroke, stroke));
                let mut points = own.into_iter().flat_map(|path| path.points.iter().copied());
                let apart = |point: &Px| {
                    let rect = Rect::around(*point, size).grown(0.1 * frame.text_size);
                    let mut others = paths.iter().filter(|path| !std::ptr::eq(path.stroke, stroke));
                    field.is_free(&rect) && !others.any(|path| path.runs_through(&rect))
                };
                points.find(apart).into_iter().collect()
            }
            Shape::Line(points) => points
                .windows(2)
                .flat_map(|ends| {
                    let (from, to) = (frame.scale.px(ends[0]), frame.scale.px(ends[1]));
                    // Beyond a vertical tick the number of a scale would collide with its neighbours.
                    let is_beyond = stroke.pen == Pen::Ruler || stroke.pen == Pen::Scale && from.y == to.y;
                    let middle = px((from.x + to.x) / 2.0, (from.y + to.y) / 2.0);
                    let on_line = (stroke.pen != Pen::Ruler).then_some(middle);
                    [is_beyond.then(|| beyond(from, to, size)), on_line]
                })
                .flatten()
                .collect(),
        };
        let place = match stroke.shape {
            Shape::Zero(at) => Some((frame.scale.px(at), ZERO)),
            Shape::Sign { .. } => sign_place(stroke).map(|at| (at, SIGN)),
            Shape::Line(_) | Shape::Circle { .. } | Shape::Arrow(_) | Shape::Text { .. } => None,
        };
        let spot = field.place_on(points, size).or_else(|| {
            if let Some((position, radius)) = place {
                let clearance = (radius + 0.1) * frame.text_size;
                let rules = [LeaderRule::Clear, LeaderRule::ThroughAll];
                return rules.into_iter().find_map(|leader_rule| {
                    field.place(Symbol { position, clearance, leader_rule }, size, frame.text_size * LEADING)
                });
            }
            let path = paths.iter().find(|path| std::ptr::eq(path.stroke, stroke))?;
            let at = path.points[path.points.len() / 2];
            let symbol = Symbol { position: at, clearance: 0.0, leader_rule: LeaderRule::ThroughAll };
            field.place(symbol, size, frame.text_size * LEADING)
        });
        if let Some(spot) = spot {
            if let Some((from, to)) = spot.leader {
                let (radius, color) = (0.17 * frame.text_size, palette::TEXT);
                sheet.commands.push(DrawCommand::line(from, to, palette::leader(frame.text_size)));
                sheet.commands.push(DrawCommand::Disc { centre: from, radius, color });
            }
            // A number on its line interrupts it, as a dimension does.
            let is_on_line = spot.leader.is_none()
                && stroke.pen != Pen::Ruler
                && matches!(stroke.shape, Shape::Line(_) | Shape::Circle { .. });
            write(lines, &spot, if is_on_line { Ground::Paper } else { Ground::Halo }, frame, sheet);
        } else if !matches!(stroke.pen, Pen::Scale | Pen::Ruler) {
            left.push(caption.clone());
        }
    }
    left
}

/// Returns the middle of a box that continues a line at its end.
fn beyond(from: Px, to: Px, (width, height): (f64, f64)) -> Px {
    let (x, y) = (to.x - from.x, to.y - from.y);
    let length = libm::hypot(x, y).max(1e-9);
    px(to.x + x / length * width / 2.0, to.y + y / length * height / 2.0)
}

/// A captioned tool path: a sample of its points and their bounding box.
struct Path<'s> {
    stroke: &'s Stroke,
    points: Vec<Px>,
    bounds: Rect,
}

/// Number of points sampled from a path.
const POINTS: usize = 120;

impl<'s> Path<'s> {
    fn of(stroke: &'s Stroke, frame: &Frame) -> Option<Self> {
        let Shape::Line(points) = &stroke.shape else { return None };
        if !stroke.pen.is_path() || stroke.caption.is_none() {
            return None;
        }
        let step = (points.len() / POINTS).max(1);
        let points: Vec<Px> = points.iter().step_by(step).map(|p| frame.scale.px(*p)).collect();
        let bounds = Rect::enclosing(*points.first()?, &points);
        Some(Self { stroke, points, bounds })
    }

    fn runs_through(&self, rect: &Rect) -> bool {
        self.bounds.overlaps(rect)
            && self.points.windows(2).any(|pair| Obstacle::Segment(pair[0], pair[1]).hits(rect))
    }
}

fn text_box(lines: &[String], frame: &Frame) -> (f64, f64) {
    let widest = lines.iter().map(|l| frame.font.width(l, frame.text_size)).fold(0.0, f64::max);
    let height = frame.text_size * (LEADING * (lines.len() as f64 - 1.0) + ASCENT + DESCENT);
    (widest + 0.3 * frame.text_size, height + 0.1 * frame.text_size)
}

/// What lies between a label and the drawing below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ground {
    /// The box of the label, which interrupts what is below it.
    Paper,
    /// A rim about each letter: lines stay visible between them.
    Halo,
}

/// Writes the lines of a label.
fn write(lines: Vec<String>, spot: &LabelPlacement, ground: Ground, frame: &Frame, sheet: &mut Sheet) {
    let (rect, size, align) = (spot.rect, frame.text_size, spot.align);
    if ground == Ground::Paper {
        sheet.commands.push(DrawCommand::Area { points: rect.corners(), color: palette::PAPER });
    }
    let x = match align {
        Align::Left => rect.left + 0.15 * size,
        Align::Centre => rect.centre().x,
        Align::Right => rect.right - 0.15 * size,
    };
    for (n, line) in lines.iter().enumerate() {
        let at = px(x, rect.top + size * (0.05 + ASCENT + LEADING * n as f64));
        let color = if n == 0 { palette::TEXT } else { palette::SOFT_TEXT };
        if ground == Ground::Halo {
            sheet.commands.push(DrawCommand::Halo { at, align, size, text: line.clone() });
        }
        sheet.commands.push(DrawCommand::Text { at, align, size, text: line.clone(), color });
    }
    sheet.labels.push((rect, lines));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::lay_out;
    use crate::picture::Picture;
    use crate::scene::Point;
    use crate::sheet::Sheet;
    use crate::size::Size;

    fn sheet(lines: Vec<(Vec<Point>, Pen, &str)>) -> Sheet {
        let outline = vec![[0.0, 0.0], [100.0, 0.0], [100.0, 60.0], [0.0, 60.0], [0.0, 0.0]];
        let stroke = |(points, pen, caption): (Vec<Point>, Pen, &str)| Stroke {
            caption: (!caption.is_empty()).then(|| caption.to_owned()),
            ..Stroke::new(pen, Shape::Line(points))
        };
        let strokes = lines.into_iter().chain([(outline, Pen::Outline, "")]).map(stroke).collect();
        let scene = Scene { strokes, ..Scene::default() };
        lay_out(&Picture { scene, ..Picture::default() }, Size::new(480, 360).unwrap()).unwrap()
    }

    fn rect_of(sheet: &Sheet, words: &str) -> Rect {
        sheet.labels.iter().find(|(_, lines)| lines[0] == words).unwrap_or_else(|| panic!("{words}")).0
    }

    /// Lines a tenth of a letter apart.
    #[test]
    fn paths_too_close_for_their_numbers_have_leaders() {
        let path = |n: usize| {
            let y = 1.0 + 0.4 * n as f64;
            (0..=40).map(|k| [2.0 + 2.4 * f64::from(k), y]).collect::<Vec<_>>()
        };
        let names = ["1", "2", "3", "4", "5"];
        let sheet = sheet(names.iter().enumerate().map(|(n, name)| (path(n), Pen::Feed, *name)).collect());
        assert!(sheet.notes.is_empty(), "{:?}", sheet.notes);
        let rects: Vec<Rect> = names.iter().map(|name| rect_of(&sheet, name)).collect();
        let ends = sheet.commands.iter().filter(|ink| matches!(ink, DrawCommand::Disc { .. })).count();
        assert!(3 <= ends, "{rects:?}");
    }

    /// The number of the left tick continues it to the left; the number of the upper tick interrupts it.
    #[test]
    fn the_number_of_a_scale_continues_a_horizontal_tick_and_interrupts_a_vertical_one() {
        let tick = |from: Point, to: Point, name: &'static str| (vec![from, to], Pen::Scale, name);
        let sheet =
            sheet(vec![tick([-1.0, 30.0], [-4.0, 30.0], "left"), tick([50.0, 61.0], [50.0, 68.0], "over")]);
        let (left, over) = (rect_of(&sheet, "left"), rect_of(&sheet, "over"));
        let ends = |upright: bool| {
            let lines = sheet.commands.iter().filter_map(|ink| match ink {
                DrawCommand::Line { points, .. } if points.len() == 2 => Some((points[0], points[1])),
                _ => None,
            });
            let mut ticks = lines.filter(|(a, b)| if upright { a.x == b.x } else { a.y == b.y });
            ticks.next().unwrap()
        };
        assert!((left.right - ends(false).1.x).abs() < 1e-9, "{left:?}");
        let (low, high) = ends(true);
        assert!((over.centre().y - (low.y + high.y) / 2.0).abs() < 1e-9, "{over:?}");
    }

    #[test]
    fn a_scale_omits_numbers_without_a_note() {
        let tick = |x: f64, name: &'static str| (vec![[x, 61.0], [x, 66.0]], Pen::Scale, name);
        let sheet = sheet(vec![tick(50.0, "r100"), tick(51.0, "r101"), tick(70.0, "r120")]);
        let named: Vec<&str> = sheet.labels.iter().map(|(_, lines)| lines[0].as_str()).collect();
        assert_eq!(named, ["r100", "r120"]);
        assert!(sheet.notes.is_empty(), "{:?}", sheet.notes);
    }
}
