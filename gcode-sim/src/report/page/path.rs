//! The drawing: canvases, their controls, and the data that the page's script draws and links from.
use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};
use nalgebra::Vector3;
use serde::Serialize;

use super::holes::HoleTable;
use super::lines::Lines;
use super::rows::HoleRowState;
use super::words::{count, shown};
use super::{Page, ReviewSide, exact_path, heading, stock_edges};
use crate::report::figures::short;
use crate::report::work_zeros::zeros;
use gcode_draw::{HoleStatus, Mark, Pen, Scene, Shape, Stroke};
use gcode_inspect::machine::{HeadKind, Machine};
use gcode_part::{Hole, MM_PER_INCH};
use gcode_review::{BlockLocation, Leg, UnplacedEnd};

/// Numbers of moves and points drawn; the page must rotate without delay.
const MOST_MOVES: usize = 40_000;
const MOST_POINTS: usize = 160_000;
/// Number of points of the exact path, which the page draws where it is zoomed in.
const MOST_EXACT_POINTS: usize = 2_000_000;
/// Number of holes drawn.
const MOST_HOLES: usize = 10_000;

/// The data for the script.
#[derive(Debug, Serialize)]
pub(super) struct Data {
    /// Axis of the part that points up.
    up: char,
    /// Edges of the stock, mm.
    stock: Vec<Vec<[f64; 3]>>,
    /// Work zeros: name and place, mm.
    zeros: Vec<(String, [f64; 3])>,
    /// Lowest and highest coordinate of the feeds along `up`, mm, where shades show it.
    heights: Option<[f64; 2]>,
    sides: Vec<SidePath>,
}

/// Least difference of heights that shades show, mm.
const LEAST_HEIGHT: f64 = 0.01;

/// Returns the lowest and the highest coordinate of the feeds; `None` for a comparison, whose colours say what differs, and
/// where all are alike.
fn heights(sides: &[SidePath], up: char) -> Option<[f64; 2]> {
    let [side] = sides else { return None };
    let axis = usize::from(up == 'z') + 1;
    let feeds = side.scene.strokes.iter().filter(|stroke| stroke.pen == Pen::Feed);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let pairs = feeds.flat_map(|stroke| match &stroke.shape {
        Shape::Line(points) => points.windows(2),
        _ => [].windows(2),
    });
    for pair in pairs {
        let ends = [pair[0][axis], pair[1][axis]];
        low = low.min(ends[0]).min(ends[1]);
        // A feed towards the part or out of it begins or ends above what is cut.
        let way = (Vector3::from(pair[1]) - Vector3::from(pair[0])).norm();
        if (ends[1] - ends[0]).abs() < 0.999 * way {
            high = high.max(ends[0]).max(ends[1]);
        }
    }
    (LEAST_HEIGHT < high - low).then(|| [low, high].map(|mm| rounded(mm, 1e3)))
}

/// One side: the scene that is drawn, and the links from it to the listing and the table.
#[derive(Debug, Serialize)]
struct SidePath {
    word: &'static str,
    /// A stroke for each move, a mark for each hole.
    scene: Scene<3>,
    /// Kinds of moves with their feed rates, in the unit of the program: `rapid`, `arc F200`.
    kinds: Vec<String>,
    /// Index of each move's kind.
    kind: Vec<usize>,
    /// Index of each move's block in `blocks`.
    at: Vec<usize>,
    /// Moves that the other side does not make.
    changed: Vec<usize>,
    /// Files of programs, by the number in an anchor.
    files: BTreeMap<u32, String>,
    /// Anchor, name and text of every line with a move or a call.
    lines: Vec<(Option<String>, String, String)>,
    /// Block and calls of each location, innermost first, as indices into `lines`.
    #[serde(rename = "places")]
    blocks: Vec<Vec<usize>>,
    holes: Vec<HoleLinks>,
    /// Letters of the axes.
    axes: Vec<String>,
    /// What the position display shows after each move, in its decimals: axis and coordinate of those that change.
    display: Vec<Vec<(usize, f64)>>,
    /// Unit of lengths on the position display, `mm` or `inch`.
    display_unit: &'static str,
    /// Strokes that are one point, since an end of the move has no place on the part, with that end.
    unplaced: BTreeMap<usize, &'static str>,
    /// Moves to machine coordinates that have no place on the part.
    #[serde(skip)]
    unplaced_moves: usize,
    /// Number of moves.
    all_moves: usize,
    /// Number of moves of each stroke; empty if each stroke is one.
    joined: Vec<usize>,
    /// Exact points of each stroke that lacks some of them, else an empty text.
    exact: Vec<String>,
    /// Largest distance of the path from a stroke with exact points, mm.
    deviation: f64,
    /// Largest distance of the path from a stroke without them, mm.
    #[serde(skip)]
    hidden_deviation: f64,
    /// True if the run ends at the last move with an alarm.
    ends_with_alarm: bool,
    all_holes: usize,
}

impl SidePath {
    /// Returns true if the end of the path is marked.
    fn has_end(&self) -> bool {
        let last = self.scene.strokes.len().checked_sub(1);
        let is_placed = |last| !matches!(self.unplaced.get(&last), Some(&("end" | "both")));
        !self.ends_with_alarm && last.is_some_and(is_placed)
    }
}

/// Links of a hole.
#[derive(Debug, Default, Serialize)]
struct HoleLinks {
    /// Row of the hole in the table.
    row: Option<usize>,
    /// Block and call, as indices into [`SidePath::lines`].
    lines: Vec<usize>,
}

impl Data {
    fn has_pen(&self, pen: Pen) -> bool {
        // A move with an unknown end is a point.
        let is_line = |stroke: &Stroke<3>| matches!(&stroke.shape, Shape::Line(points) if 1 < points.len());
        self.sides
            .iter()
            .any(|side| side.scene.strokes.iter().any(|stroke| stroke.pen == pen && is_line(stroke)))
    }

    /// Returns true if a side makes a cut, or a move of any kind, that the other does not make.
    fn has_changed(&self, is: impl Fn(Pen) -> bool) -> bool {
        self.sides.iter().any(|side| side.changed.iter().any(|stroke| is(side.scene.strokes[*stroke].pen)))
    }

    fn has_hole(&self, is: impl Fn(HoleStatus) -> bool) -> bool {
        self.sides.iter().any(|side| side.scene.marks.iter().any(|mark| is(mark.status)))
    }
}

pub(super) fn data(page: &Page<'_>, sides: &[ReviewSide<'_>], table: &HoleTable) -> Data {
    let up = up(page);
    let drawn =
        sides.iter().enumerate().map(|(side_index, side)| drawn(page, side_index, side, table, sides.len()));
    let stock = page.reference.and_then(|reference| reference.stock.as_ref()).or(page.machine.stock.as_ref());
    let zeros = zeros(page.machine, sides.iter().map(|side| &side.observed.revision.simulation.run));
    let sides: Vec<SidePath> = drawn.collect();
    Data {
        up,
        heights: heights(&sides, up),
        stock: stock.map(stock_edges::edges).unwrap_or_default(),
        zeros,
        sides,
    }
}

/// Returns the axis of the part that points up: along a vertical spindle; without a known head that of most holes.
fn up(page: &Page<'_>) -> char {
    match page.machine.head.kind {
        HeadKind::Fixed(out) if out.z > 0.99 => 'z',
        HeadKind::Free => {
            let holes = &page.new.revision.simulation.extracted.holes;
            let vertical = holes.iter().filter(|hole| 0.9 < hole.axis.z).count();
            if holes.len() <= 2 * vertical { 'z' } else { 'y' }
        }
        HeadKind::Axes { ref direction, .. } if direction.z > 0.99 => 'z',
        _ => 'y',
    }
}

/// Index of lines, each stored once.
#[derive(Default)]
struct LineIndex {
    lines: Vec<(Option<String>, String, String)>,
    numbers: BTreeMap<(String, u32, String), usize>,
}

impl LineIndex {
    fn number(&mut self, location: &BlockLocation, lines: &Lines) -> usize {
        let key = (location.program.clone(), location.line, location.block.clone());
        *self.numbers.entry(key).or_insert_with(|| {
            let anchor = lines.of_location(location).map(|(source, line)| lines.anchor(source, line));
            let name = format!("{}:{}", shown(&location.program), location.line);
            self.lines.push((anchor, name, shown(&location.block)));
            self.lines.len() - 1
        })
    }

    fn numbers(&mut self, location: &BlockLocation, lines: &Lines) -> Vec<usize> {
        std::iter::once(location)
            .chain(&location.calls)
            .map(|location| self.number(location, lines))
            .collect()
    }
}

fn drawn(
    page: &Page<'_>,
    side_index: usize,
    side: &ReviewSide<'_>,
    table: &HoleTable,
    sides: usize,
) -> SidePath {
    let record = &side.observed.revision.record;
    let legs = record.whole_path(page.machine, MOST_MOVES, MOST_POINTS, MOST_EXACT_POINTS);
    let all_moves = record.moves();
    let (exact, inexact): (Vec<&Leg>, Vec<&Leg>) = legs.iter().partition(|leg| !leg.exact.is_empty());
    let largest = |legs: &[&Leg]| legs.iter().map(|leg| leg.deviation).fold(0.0, f64::max);
    let (deviation, hidden_deviation) = (largest(&exact), largest(&inexact));
    let mut known = LineIndex::default();
    let (marks, holes) = holes(page, side_index, side, table, &mut known).into_iter().unzip();
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    let mut blocks = Vec::new();
    let mut at = Vec::with_capacity(legs.len());
    for leg in &legs {
        at.push(*numbers.entry(leg.block_number).or_insert_with(|| {
            blocks.push(known.numbers(&record.block_location(leg.block_number), side.lines));
            blocks.len() - 1
        }));
    }
    let is_inch = side.observed.revision.simulation.run.control.is_inch();
    let kind = |leg: &Leg| kind(leg, is_inch);
    let kinds: Vec<String> = legs.iter().map(kind).collect::<BTreeSet<_>>().into_iter().collect();
    let different = match (page.old, sides) {
        (Some((_, difference)), 2) => difference.compared.steps[side_index].as_slice(),
        _ => &[],
    };
    let is_different = |leg: &Leg| {
        let next = different.partition_point(|step| step < leg.steps.start());
        different.get(next).is_some_and(|step| step <= leg.steps.end())
    };
    let joined: Vec<usize> =
        if legs.len() < all_moves { legs.iter().map(|leg| leg.moves).collect() } else { Vec::new() };
    let unplaced = |leg: &Leg| leg.unplaced.map(unplaced_word);
    // Before the first known position nothing is left out of a path.
    let begun = legs.iter().skip_while(|leg| leg.unplaced.is_some());
    let unplaced_moves = begun.filter(|leg| leg.unplaced.is_some()).map(|leg| leg.moves).sum();
    SidePath {
        unplaced: legs.iter().enumerate().filter_map(|(at, leg)| Some((at, unplaced(leg)?))).collect(),
        unplaced_moves,
        word: side.word,
        axes: (0..page.machine.axes.len()).map(|axis| page.machine.axes.letter(axis).to_string()).collect(),
        display: changes_of_display(&record.displays(page.machine, &legs), page.machine, is_inch),
        display_unit: if is_inch { "inch" } else { "mm" },
        scene: Scene { strokes: legs.iter().map(stroke).collect(), marks, ..Scene::default() },
        kind: legs.iter().map(|leg| kinds.binary_search(&kind(leg)).unwrap_or_default()).collect(),
        kinds,
        at,
        changed: (0..legs.len()).filter(|leg| is_different(&legs[*leg])).collect(),
        files: side.lines.texts.iter().map(|text| (text.source.0, text.name.clone())).collect(),
        lines: known.lines,
        blocks,
        holes,
        all_moves,
        joined,
        exact: legs.iter().map(|leg| exact_path::encoded(&leg.exact)).collect(),
        deviation,
        hidden_deviation,
        ends_with_alarm: side.observed.revision.simulation.run.stop_finding().is_some(),
        all_holes: side.observed.revision.simulation.extracted.holes.len(),
    }
}

/// Returns the coordinates of each display that differ from the display before, in its unit.
fn changes_of_display(
    displays: &[Vec<(usize, f64)>],
    machine: &Machine,
    is_inch: bool,
) -> Vec<Vec<(usize, f64)>> {
    let mut before: BTreeMap<usize, f64> = BTreeMap::new();
    let in_unit = |(axis, at): &(usize, f64)| match is_inch && !machine.axes.is_rotary(*axis) {
        true => (*axis, rounded(at / MM_PER_INCH, 1e4)),
        false => (*axis, rounded(*at, 1e3)),
    };
    let changes = |display: &Vec<(usize, f64)>| {
        let shown = display.iter().map(in_unit);
        shown.filter(|(axis, at)| before.insert(*axis, *at) != Some(*at)).collect()
    };
    displays.iter().map(changes).collect()
}

/// Returns the unknown end of a move as the script names it.
fn unplaced_word(end: UnplacedEnd) -> &'static str {
    match end {
        UnplacedEnd::Start => "start",
        UnplacedEnd::End => "end",
        UnplacedEnd::Both => "both",
    }
}

fn stroke(leg: &Leg) -> Stroke<3> {
    let pen = match leg.kind {
        "rapid" => Pen::Rapid,
        "probing move" => Pen::Probe,
        _ => Pen::Feed,
    };
    Stroke::new(pen, Shape::Line(leg.points.iter().map(|point| point.coords.into()).collect()))
}

/// Returns the kind of a move with its feed rate in the unit of the program.
fn kind(leg: &Leg, is_inch: bool) -> String {
    let unit = if is_inch { MM_PER_INCH } else { 1.0 };
    match leg.feed {
        Some(feed) if feed != 0.0 => format!("{} F{}", leg.kind, short(rounded(feed / unit, 1e3))),
        _ => leg.kind.to_owned(),
    }
}

fn holes(
    page: &Page<'_>,
    side_index: usize,
    side: &ReviewSide<'_>,
    table: &HoleTable,
    known: &mut LineIndex,
) -> Vec<(Mark<3>, HoleLinks)> {
    let simulation = &side.observed.revision.simulation;
    let rows = table.of_side(side_index);
    let mut all = Vec::new();
    for (number, found) in simulation.extracted.holes.iter().enumerate().take(MOST_HOLES) {
        let row = rows.get(&number);
        let lines = known.numbers(&BlockLocation::of(&simulation.run, &found.backtrace), side.lines);
        let id = row.map_or_else(|| (number + 1).to_string(), |(_, id, _)| (*id).to_owned());
        let status = row.map_or(HoleRowState::Unjudged, |(_, _, state)| *state).status();
        let mark = mark(&found.hole(|_| (String::new(), 0)), id, status);
        all.push((mark, HoleLinks { row: row.map(|(row, ..)| *row), lines }));
    }
    let missing = side.observed.verdict.iter().flat_map(|verdict| &verdict.missing);
    let nominal = page.reference.iter().flat_map(|reference| &reference.holes);
    let nominal: BTreeMap<_, _> =
        nominal.map(|hole| (hole.id.as_deref().unwrap_or_default(), hole)).collect();
    let missing =
        missing.filter_map(|id| Some(mark(nominal.get(id.as_str())?, shown(id), HoleStatus::Missing)));
    all.extend(missing.map(|mark| (mark, HoleLinks::default())));
    all
}

fn mark(hole: &Hole, id: String, status: HoleStatus) -> Mark<3> {
    Mark {
        radius: hole.diameter.unwrap_or(0.0) / 2.0,
        depth: rounded(hole.depth, 1e3),
        label: vec![id],
        direction: Some(hole.axis.map(|part| rounded(part, 1e6))),
        ..Mark::new(hole.entry.map(|mm| rounded(mm, 1e3)), status)
    }
}

/// Rounds to parts of 1, without a negative zero.
fn rounded(value: f64, parts: f64) -> f64 {
    0.0 + (value * parts).round() / parts
}

pub(super) fn viewer(sides: &[ReviewSide<'_>], data: &Data) -> Markup {
    let tools = [
        ("top", "Top", Some("View from above")),
        ("front", "Front", Some("View from the front")),
        ("side", "Side", Some("View from the side")),
        ("reset", "All", Some("View of all cuts and holes")),
        ("in", "+", Some("Zoom in")),
        ("out", "\u{2212}", Some("Zoom out")),
    ];
    html! {
        div #viewer {
            div.tools role="toolbar" aria-label="View" {
                @for (action, name, label) in tools {
                    button type="button" data-view=(action) aria-label=[label] { (name) }
                }
                label { input #rapids type="checkbox" checked; " Rapids" }
                @if sides.len() == 2 { label { input #changed-only type="checkbox"; " Changes only" } }
            }
            @if sides.len() == 1 { (player(data)) }
            p #picked aria-live="polite" { "Click a move or a hole to see its block and its calls." }
            div.canvases {
                @for side in sides {
                    figure {
                        @if sides.len() == 2 { figcaption { (heading(side, sides)) } }
                        canvas id={ "canvas-" (side.word) } tabindex="0" role="img"
                            aria-label={ "Path and holes of the " @if sides.len() == 2 { (side.word) " " } "program on the part" }
                            aria-describedby="keys" {}
                    }
                }
            }
        }
        div #under {
            ul.legend {
                @if data.has_pen(Pen::Rapid) { li.rapid { "rapid" } }
                @if let Some([low, high]) = data.heights {
                    li.depth { "feed, arc: " (data.up) " from " (signed(low)) " to " (signed(high)) " mm, deeper is darker" }
                } @else if data.has_pen(Pen::Feed) {
                    li.feed { "feed, arc" }
                }
                @if data.has_pen(Pen::Probe) { li.probe { "probing move" } }
                @if data.has_changed(|_| true) {
                    li.changed { "different from the other program" }
                }
                @if data.has_changed(|pen| pen != Pen::Rapid) { li.other { "the other program\u{2019}s cut" } }
                @if data.has_hole(|status| matches!(status, HoleStatus::Good | HoleStatus::Unjudged)) { li.hole { "hole, and its depth as a line" } }
                @if data.has_hole(|status| matches!(status, HoleStatus::Bad | HoleStatus::Extra)) {
                    li.wrong { "hole that differs or has a fault" }
                }
                @if data.has_hole(|status| status == HoleStatus::Missing) { li.absent { "missing hole" } }
                @if !data.stock.is_empty() { li.stock { "stock" } }
                @if !data.zeros.is_empty() { li.zero { "work zero" } }
                @if data.sides.iter().any(|side| !side.scene.strokes.is_empty()) {
                    li.start { "start" }
                }
                @if data.sides.iter().any(SidePath::has_end) {
                    li.end { "end" }
                }
                @if data.sides.iter().any(|side| side.ends_with_alarm) { li.alarm-end { "where the run stopped" } }
            }
            details.note #keys {
                summary { "Mouse, touch and keys" }
                "Drag, or use the arrow keys, to rotate; the wheel, two fingers, + and − zoom; Shift and drag moves. "
                "N and P go from move to move, Enter to the block of the selected move, 0 goes back to the first view. "
                "The wheel and two fingers zoom at the pointer."
            }
            @for (side, drawn) in sides.iter().zip(&data.sides) { (left_out(side, sides, drawn)) }
            noscript { p { "The drawing needs scripts; everything else on this page works without them." } }
        }
    }
}

/// Formats a number with a true minus sign.
fn signed(value: f64) -> String {
    short(value).replace('-', "−")
}

/// Returns the controls that play the path move by move.
fn player(data: &Data) -> Markup {
    let last = data.sides.first().map_or(0, |side| side.scene.strokes.len());
    html! {
        div.tools #player role="toolbar" aria-label="Moves" {
            button type="button" data-play="back" aria-label="Back by one move" { "\u{25c2} Back" }
            button type="button" data-play="play" aria-pressed="false" { "Play" }
            button type="button" data-play="step" aria-label="Forward by one move" { "Step \u{25b8}" }
            input #progress type="range" min="0" max=(last) value="0" aria-label="Moves made";
            output #progress-count for="progress" { "0 of " (last) }
        }
    }
}

/// Returns notes on omitted moves and holes.
fn left_out(side: &ReviewSide<'_>, sides: &[ReviewSide<'_>], drawn: &SidePath) -> Markup {
    let shown = drawn.scene.strokes.len();
    html! {
        @if shown < drawn.all_moves {
            p.note {
                (heading(side, sides)) ": " (count(drawn.all_moves as u64)) " moves are drawn as " (count(shown as u64))
                " lines, consecutive moves of one kind together"
                @if drawn.hidden_deviation == 0.0 { "; zoomed in, the path itself is drawn" }
                "."
            }
        }
        @if 0 < drawn.unplaced_moves {
            p.note {
                (heading(side, sides)) ": " (count(drawn.unplaced_moves as u64))
                @if drawn.unplaced_moves == 1 { " move is" } @else { " moves are" }
                " not drawn: without the work offset ([offsets] in the machine file) the places that G28, G30 and G53 "
                "lead to are unknown on the part."
            }
        }
        @if 0.0 < drawn.hidden_deviation {
            p.note {
                (heading(side, sides)) ": there are too many points for all of them: some lines are up to "
                (short(drawn.hidden_deviation)) " mm from the path, however far you zoom in."
            }
        }
        @if MOST_HOLES < drawn.all_holes {
            p.note {
                (heading(side, sides)) ": the first " (count(MOST_HOLES as u64)) " of " (count(drawn.all_holes as u64))
                " holes are drawn."
            }
        }
    }
}
