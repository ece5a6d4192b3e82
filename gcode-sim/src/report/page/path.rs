//! The drawing: canvases, their controls, and the data that the page's script draws and links from.
use std::collections::BTreeMap;

use maud::{Markup, html};
use serde::Serialize;

use super::holes::HoleTable;
use super::lines::Lines;
use super::rows::HoleRowState;
use super::words::{count, shown};
use super::{Page, ReviewSide, heading};
use gcode_inspect::machine::HeadKind;
use gcode_part::Hole;
use gcode_review::BlockLocation;

/// Numbers of moves and points drawn; the page must rotate without delay.
const MOST_MOVES: usize = 40_000;
const MOST_POINTS: usize = 160_000;
/// Number of holes drawn.
const MOST_HOLES: usize = 10_000;

/// The data for the script.
#[derive(Debug, Serialize)]
pub(super) struct Data {
    /// Axis of the part that points up.
    up: char,
    sides: Vec<SidePath>,
}

/// One side; lists of moves have one entry per move.
#[derive(Debug, Serialize)]
struct SidePath {
    word: &'static str,
    /// Kinds of moves: `r`apid, `f`eed, `a`rc, `p`robing move.
    kinds: String,
    /// Number of points of each move.
    counts: Vec<u32>,
    /// Coordinates x y z of all points, in thousandths of a millimetre.
    points: Vec<i64>,
    /// Feed rates, mm/min; 0 for a rapid.
    feeds: Vec<f64>,
    /// Index of each move's place in `places`.
    at: Vec<usize>,
    /// Moves that the other side does not make.
    changed: Vec<usize>,
    /// Anchor, name and text of every line with a move or a call.
    lines: Vec<(Option<String>, String, String)>,
    /// Block and calls of each place, innermost first, as indices into `lines`.
    places: Vec<Vec<usize>>,
    holes: Vec<DrawnHole>,
    /// Total number of moves, drawn or not.
    moves: usize,
    all_holes: usize,
}

#[derive(Debug, Serialize)]
struct DrawnHole {
    entry: [f64; 3],
    bottom: [f64; 3],
    diameter: f64,
    id: String,
    state: &'static str,
    /// Row of the hole in the table.
    row: Option<usize>,
    /// Block and call, as indices into [`SidePath::lines`].
    lines: Vec<usize>,
}

pub(super) fn data(page: &Page<'_>, sides: &[ReviewSide<'_>], table: &HoleTable) -> Data {
    let up = match page.machine.head.kind {
        HeadKind::Fixed(out) if out.z > 0.99 => 'z',
        _ => 'y',
    };
    let drawn = sides.iter().enumerate().map(|(place, side)| drawn(page, place, side, table, sides.len()));
    Data { up, sides: drawn.collect() }
}

/// Index of lines, each stored once.
#[derive(Default)]
struct LineIndex {
    lines: Vec<(Option<String>, String, String)>,
    numbers: BTreeMap<(String, u32, String), usize>,
}

impl LineIndex {
    fn number(&mut self, place: &BlockLocation, lines: &Lines) -> usize {
        let key = (place.program.clone(), place.line, place.block.clone());
        *self.numbers.entry(key).or_insert_with(|| {
            let anchor = lines.of_place(place).map(|(source, line)| lines.anchor(source, line));
            let name = format!("{}:{}", shown(&place.program), place.line);
            self.lines.push((anchor, name, shown(&place.block)));
            self.lines.len() - 1
        })
    }

    fn numbers(&mut self, place: &BlockLocation, lines: &Lines) -> Vec<usize> {
        std::iter::once(place).chain(&place.calls).map(|place| self.number(place, lines)).collect()
    }
}

fn drawn(page: &Page<'_>, place: usize, side: &ReviewSide<'_>, table: &HoleTable, sides: usize) -> SidePath {
    let record = &side.observed.revision.record;
    let legs = record.path(page.machine, MOST_MOVES, MOST_POINTS);
    let mut known = LineIndex::default();
    let holes = holes(page, place, side, table, &mut known);
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    let mut places = Vec::new();
    let mut at = Vec::with_capacity(legs.len());
    for leg in &legs {
        at.push(*numbers.entry(leg.place).or_insert_with(|| {
            places.push(known.numbers(&record.places()[leg.place], side.lines));
            places.len() - 1
        }));
    }
    let different = match (page.old, sides) {
        (Some((_, difference)), 2) => difference.compared.steps[place].as_slice(),
        _ => &[],
    };
    let is_different = |step: &usize| different.binary_search(step).is_ok();
    let coordinates = legs.iter().flat_map(|leg| &leg.points).flat_map(|p| [p.x, p.y, p.z]);
    SidePath {
        word: side.word,
        kinds: legs.iter().filter_map(|leg| leg.kind.chars().next()).collect(),
        counts: legs.iter().map(|leg| leg.points.len() as u32).collect(),
        points: coordinates.map(|mm| (mm * 1000.0).round() as i64).collect(),
        feeds: legs.iter().map(|leg| leg.feed.unwrap_or(0.0)).collect(),
        at,
        changed: (0..legs.len()).filter(|leg| is_different(&legs[*leg].step)).collect(),
        lines: known.lines,
        places,
        holes,
        moves: record.moves(),
        all_holes: side.observed.revision.simulation.extracted.holes.len(),
    }
}

fn holes(
    page: &Page<'_>,
    place: usize,
    side: &ReviewSide<'_>,
    table: &HoleTable,
    known: &mut LineIndex,
) -> Vec<DrawnHole> {
    let simulation = &side.observed.revision.simulation;
    let rows = table.of_side(place);
    let mut all = Vec::new();
    for (number, found) in simulation.extracted.holes.iter().enumerate().take(MOST_HOLES) {
        let row = rows.get(&number);
        let lines = known.numbers(&BlockLocation::of(&simulation.run, &found.backtrace), side.lines);
        let hole = found.hole(|_| (String::new(), 0));
        let id = row.map_or_else(|| (number + 1).to_string(), |(_, id, _)| (*id).to_owned());
        let state = row.map_or(HoleRowState::Unjudged, |(_, _, state)| *state);
        all.push(DrawnHole { lines, row: row.map(|(row, ..)| *row), ..hole_of(&hole, id, state) });
    }
    let missing = side.observed.verdict.iter().flat_map(|verdict| &verdict.missing);
    let wanted = page.reference.iter().flat_map(|reference| &reference.holes);
    let wanted: BTreeMap<_, _> = wanted.map(|hole| (hole.id.as_deref().unwrap_or_default(), hole)).collect();
    all.extend(
        missing.filter_map(|id| Some(hole_of(wanted.get(id.as_str())?, shown(id), HoleRowState::Missing))),
    );
    all
}

fn hole_of(hole: &Hole, id: String, state: HoleRowState) -> DrawnHole {
    let bottom = std::array::from_fn(|i| hole.entry[i] - hole.axis[i] * hole.depth);
    let round = |point: [f64; 3]| point.map(|mm| (mm * 1000.0).round() / 1000.0);
    DrawnHole {
        entry: round(hole.entry),
        bottom: round(bottom),
        diameter: hole.diameter.unwrap_or(0.0),
        id,
        state: state.class(),
        row: None,
        lines: Vec::new(),
    }
}

pub(super) fn viewer(sides: &[ReviewSide<'_>], data: &Data) -> Markup {
    let tools = [
        ("top", "Top"),
        ("front", "Front"),
        ("side", "Side"),
        ("reset", "Reset"),
        ("in", "+"),
        ("out", "\u{2212}"),
    ];
    html! {
        div #viewer {
            div.tools role="toolbar" aria-label="View" {
                @for (action, name) in tools {
                    button type="button" data-view=(action) aria-label=[label(action)] { (name) }
                }
                label { input #rapids type="checkbox" checked; " Rapids" }
                @if sides.len() == 2 { label { input #changed-only type="checkbox"; " Changes only" } }
            }
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
            p #picked aria-live="polite" { "Click a move or a hole to see its block and its calls." }
            ul.legend {
                li.rapid { "rapid" }
                li.feed { "feed, arc" }
                li.probe { "probing move" }
                @if sides.len() == 2 { li.changed { "different from the other program" } }
                li.hole { "hole" }
                li.wrong { "hole that differs or has a fault" }
                li.absent { "missing hole" }
            }
            details.note #keys {
                summary { "Mouse, touch and keys" }
                "Drag, or use the arrow keys, to rotate; the wheel, two fingers, + and − zoom; Shift and drag moves. "
                "N and P go from move to move, Enter to the block of the selected move, 0 resets the view."
            }
            @for (side, drawn) in sides.iter().zip(&data.sides) { (left_out(side, sides, drawn)) }
            noscript { p { "The drawing needs scripts; everything else on this page works without them." } }
        }
    }
}

fn label(action: &str) -> Option<&'static str> {
    match action {
        "in" => Some("Zoom in"),
        "out" => Some("Zoom out"),
        "top" => Some("View from above"),
        "front" => Some("View from the front"),
        "side" => Some("View from the side"),
        _ => None,
    }
}

/// Returns notes on omitted moves and holes.
fn left_out(side: &ReviewSide<'_>, sides: &[ReviewSide<'_>], drawn: &SidePath) -> Markup {
    let shown = drawn.counts.len();
    html! {
        @if shown < drawn.moves {
            p.note {
                (heading(side, sides)) ": the first " (count(shown as u64)) " of " (count(drawn.moves as u64))
                " moves are drawn."
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
