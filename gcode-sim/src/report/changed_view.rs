//! The top view of two revisions: new holes over old ones, and changed cuts beside unchanged ones.
use std::collections::{BTreeMap, BTreeSet};

use super::figures::{count, rounded};
use super::hole_changes::remarks;
use super::tool_path::top_side;
use super::top::{Rotary, blank_hole, hide_constant_rotary, outline, round_up, side};
use gcode_draw::{DrawnHole, HoleStatus, Pen, PicturePurpose, Shape, Side, Sign, Stroke, TopView};
use gcode_inspect::machine::Machine;
use gcode_inspect::tool_path::ToolPath;
use gcode_part::Reference;
use gcode_review::{Change, Leg, Paired, Record, Revision, RevisionDiff, UnplacedEnd};

/// Largest numbers of moves and points drawn of each revision.
const MAX_MOVES: usize = 20_000;
const MAX_POINTS: usize = 100_000;

/// Largest number of kinds of changes stated in the title block.
const MAX_KINDS: usize = 7;

/// Movement beyond which a hole is drawn at both positions instead of in an enlarged circle, mm.
const MAX_CIRCLE_MOVE: f64 = 5.0;

/// Returns the side from which two revisions are drawn: that of the picture of the new one, or of the old one if the new one
/// makes no move. A part with an outline is seen along the spindle.
fn drawn_side(
    sides: [&Revision; 2],
    paths: &[ToolPath; 2],
    machine: &Machine,
    reference: Option<&Reference>,
) -> Side {
    let spindle = side(machine);
    if reference.is_some_and(|reference| reference.surface.is_some()) {
        return spindle;
    }
    let shown = usize::from(!paths[1].moves.is_empty());
    top_side(&paths[shown], &sides[shown].simulation.hole_list().holes, machine, spindle)
}

/// Builds the view of two revisions from the pairs in `compared`. With a reference, the part's outline is
/// drawn. `paths` decide from which side.
pub fn of_changes(
    name: &str,
    (old, new): (&Revision, &Revision),
    machine: &Machine,
    (compared, tolerance): (&RevisionDiff, f64),
    (reference, paths): (Option<&Reference>, &[ToolPath; 2]),
) -> TopView {
    let rotary = Rotary::of(machine);
    let lists = [old, new].map(|side| side.simulation.hole_list().holes);
    let sides = [old, new];
    let tools = sides.map(|side| side.record.made_by());
    let drawn = |pair: &Paired| {
        let was = pair.old.map(|hole| lists[0][hole].clone());
        let is = pair.new.map(|hole| lists[1][hole].clone());
        let found = pair.new.map(|hole| &new.simulation.extracted.holes[hole]);
        let (id, status) = match (pair.old, pair.new) {
            (Some(hole), Some(_)) if !pair.changed => ((hole + 1).to_string(), HoleStatus::Good),
            (Some(hole), Some(_)) => ((hole + 1).to_string(), HoleStatus::Bad),
            (Some(hole), None) => ((hole + 1).to_string(), HoleStatus::Missing),
            (None, hole) => (format!("new {}", hole.unwrap_or_default() + 1), HoleStatus::Extra),
        };
        let made = |side: usize, hole: Option<usize>| {
            hole.map(|hole| (&sides[side].simulation.extracted.holes[hole], tools[side][hole].as_slice()))
        };
        let remarks = remarks(pair, made(0, pair.old), made(1, pair.new));
        let rotary_angle = found.and_then(|found| rotary.angle(found));
        let further_angles = found.map_or_else(Vec::new, |found| rotary.further_angles(found));
        DrawnHole {
            nominal: was,
            actual: is,
            rotary_angle,
            further_angles,
            remarks,
            ..blank_hole(id, status)
        }
    };
    let mut holes: Vec<DrawnHole> = compared.holes.iter().map(drawn).collect();
    hide_constant_rotary(&mut holes);
    let moved = || compared.holes.iter().map(|pair| pair.moved);
    let shown = moved().filter(|moved| *moved <= MAX_CIRCLE_MOVE).fold(0.0, f64::max);
    let farthest = compared.holes.iter().filter(|pair| tolerance < pair.moved);
    let farthest = farthest.max_by(|a, b| a.moved.total_cmp(&b.moved));
    let farthest = farthest.and_then(|pair| {
        let hole = pair.old? + 1;
        Some(format!("largest movement: hole\u{a0}{hole}, {} mm", rounded(pair.moved, 4)))
    });
    let is_other = |(code, _): &(&str, &str)| !is_of_one_hole(code);
    let others: Vec<(&str, &str)> =
        compared.changes.iter().flat_map(Change::effects).filter(is_other).collect();
    // As in the text: an edit is one change, whatever else it does.
    let other_changes =
        compared.changes.iter().filter(|change| change.effects().all(|effect| is_other(&effect))).count();
    let path = path([old, new], machine, compared);
    let more = path.has_other_rapids.then(|| "rapids are not drawn: see --page".to_owned());
    let lines = farthest.into_iter().chain(other_change_lines(&others)).chain(more).collect();
    TopView {
        name: name.to_owned(),
        side: drawn_side(sides, paths, machine, reference),
        outline: reference.and_then(|reference| reference.surface).and_then(outline),
        cylinder: reference.and_then(super::top::cylinder),
        // Without a visible movement the circle has no scale.
        tolerance: (tolerance < shown).then(|| round_up(2.0 * shown)),
        rotary: rotary.letter(),
        is_rotary_reversed: rotary.is_reversed(),
        holes,
        purpose: PicturePurpose::Change,
        verdict: None,
        other_differences: other_changes,
        ending: others.iter().find(|(code, _)| *code == "outcome").map(|_| {
            let stops = |record: &Record| record.outcome() != "end";
            match (stops(&old.record), stops(&new.record)) {
                (_, true) => "the new program stops before its end",
                (true, false) => "the old program stops before its end",
                (false, false) => "the programs end differently",
            }
            .to_owned()
        }),
        path: path.cuts,
        lines,
        zeros: Vec::new(),
        shaft: None,
    }
}

/// Returns the changes that no hole's symbol shows, one line for each kind.
fn other_change_lines(others: &[(&str, &str)]) -> Vec<String> {
    let mut kinds: Vec<(&str, &str, usize)> = Vec::new();
    for (code, message) in others {
        match kinds.iter_mut().find(|(known, ..)| known == code) {
            Some((.., more)) => *more += 1,
            None => kinds.push((code, message, 0)),
        }
    }
    let line = |(code, message, more): &(&str, &str, usize)| match more {
        0 => format!("{code}: {message}"),
        more => format!("{code}: {message}; and {more} more"),
    };
    let mut lines: Vec<String> = kinds.iter().take(MAX_KINDS).map(line).collect();
    if MAX_KINDS < kinds.len() {
        let more = count(kinds.len() - MAX_KINDS, "more kind");
        lines.push(format!("{more} of changes: see the text of diff"));
    }
    lines
}

/// Returns true for changes shown by a hole's own symbol; a changed order has none.
fn is_of_one_hole(code: &str) -> bool {
    code.starts_with("hole-") && code != "hole-order"
}

struct Path {
    /// Cuts that make no hole: unchanged, new and old ones; where a run stops.
    cuts: Vec<Stroke<3>>,
    has_other_rapids: bool,
}

fn path(sides: [&Revision; 2], machine: &Machine, compared: &RevisionDiff) -> Path {
    let mut has_other_rapids = false;
    let mut pieces: BTreeMap<Pen, Vec<Vec<[f64; 3]>>> = BTreeMap::new();
    let mut stops: Vec<([f64; 3], String)> = Vec::new();
    for (side_index, side) in sides.into_iter().enumerate() {
        let different: BTreeSet<usize> = compared.steps[side_index].iter().copied().collect();
        let legs = side.record.path(machine, MAX_MOVES, MAX_POINTS);
        has_other_rapids |=
            legs.iter().any(|leg| leg.kind == "rapid" && different.contains(leg.steps.start()));
        for leg in legs.iter().filter(|leg| leg.kind != "rapid" && !leg.is_of_hole) {
            let pen = match (different.contains(leg.steps.start()), side_index) {
                (false, 0) => continue,
                (false, _) => Pen::Unchanged,
                (true, 0) => Pen::Old,
                (true, _) => Pen::New,
            };
            append_leg(pieces.entry(pen).or_default(), leg);
        }
        stops.extend(stop(side, &legs).map(|at| (at, format!("{} stops", ["old", "new"][side_index]))));
    }
    if let [(was, _), (is, words)] = stops.as_mut_slice()
        && was == is
    {
        "both stop".clone_into(words);
        stops.remove(0);
    }
    let strokes = |(pen, lines): (Pen, Vec<Vec<[f64; 3]>>)| {
        lines.into_iter().map(move |points| Stroke::new(pen, Shape::Line(points)))
    };
    let signs = stops.into_iter().map(|(at, words)| Stroke {
        caption: Some(words),
        ..Stroke::new(Pen::Edge, Shape::Sign { at, sign: Sign::Alarm })
    });
    Path { cuts: pieces.into_iter().flat_map(strokes).chain(signs).collect(), has_other_rapids }
}

/// Returns where a run that does not reach its end stops; `None` if that is unknown on the part, or not drawn.
fn stop(side: &Revision, legs: &[Leg]) -> Option<[f64; 3]> {
    let last = legs.last().filter(|_| legs.len() == side.record.moves() && side.record.outcome() != "end")?;
    let is_placed = matches!(last.unplaced, None | Some(UnplacedEnd::Start));
    last.points.last().filter(|_| is_placed).map(|point| point.coords.into())
}

/// Joins consecutive cuts to one line, so that their dashes continue.
fn append_leg(pieces: &mut Vec<Vec<[f64; 3]>>, leg: &Leg) {
    let mut points = leg.points.iter().map(|point| point.coords.into());
    match pieces.last_mut().filter(|piece| piece.last().copied() == points.clone().next()) {
        Some(piece) => piece.extend(points.skip(1)),
        None => pieces.push(points.by_ref().collect()),
    }
}
