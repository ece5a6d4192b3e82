//! Path of the tool on the part, move by move, for drawings.
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use nalgebra::Point3;

use super::block_location::BlockLocation;
use super::first_command::CommandKind;
use super::record::Record;
use super::steps::{Step, StepKind};
use gcode_inspect::machine::AxisMotion;
use gcode_inspect::machine::{HeadMessage, Machine, Setup};
use gcode_inspect::tool_path::for_each_drawn_pose;
use gcode_lang::motion::{PlanarArc, Position, StopKind};

/// Largest deviation of a curved path from its chords, mm.
const CHORD: f64 = 0.05;

/// Tolerance at which a path is not simplified further, mm.
const MAX_SIMPLIFICATION: f64 = 100.0;

/// One move in the frame of the part; of a grinder the path of the wheel's contact.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Numbers of its steps in the record: one, or several moves of one kind that are drawn together.
    pub steps: RangeInclusive<usize>,
    /// Number of moves.
    pub moves: usize,
    /// `rapid`, `feed`, `arc` or `probing move`.
    pub kind: &'static str,
    /// Feed of a cut, mm/min.
    pub feed: Option<f64>,
    /// True for a move that cuts a hole, or leaves one along the path of its cut.
    pub is_of_hole: bool,
    /// Number of its block in [`Record::block_location`].
    pub block_number: usize,
    /// Points from start to end, mm; the end alone if an axis has not been commanded before the move.
    pub points: Vec<Point3<f64>>,
}

impl Record {
    /// Returns a block by its number.
    pub fn block_location(&self, number: usize) -> Cow<'_, BlockLocation> {
        self.blocks.location(number)
    }

    /// Counts the moves.
    pub fn moves(&self) -> usize {
        self.steps.kinds().filter(|kind| kind.is_move()).count()
    }

    /// Returns all moves in at most about `legs` legs with at most `points` points: consecutive moves of one kind are drawn
    /// together, without the points that are no farther from the line than the least tolerance that leaves few enough.
    pub fn whole_path(&self, machine: &Machine, legs: usize, points: usize) -> Vec<Leg> {
        let joined = self.moves().div_ceil(legs.max(1)).max(1);
        let mut all: Vec<Leg> = Vec::new();
        for next in self.path(machine, usize::MAX, usize::MAX) {
            match all.last_mut() {
                Some(leg) if leg.kind == next.kind && is_same_feed(leg, &next) && leg.moves < joined => {
                    leg.steps = *leg.steps.start()..=*next.steps.end();
                    leg.moves += next.moves;
                    leg.is_of_hole |= next.is_of_hole;
                    match next.points.as_slice() {
                        [_] => leg.points = next.points,
                        _ => leg.points.extend(next.points.into_iter().skip(1)),
                    }
                }
                _ => all.push(next),
            }
        }
        let mut tolerance = CHORD;
        while points < all.iter().map(|leg| leg.points.len()).sum() && tolerance < MAX_SIMPLIFICATION {
            all.iter_mut().for_each(|leg| leg.points = simplified(&leg.points, tolerance));
            tolerance *= 2.0;
        }
        all
    }

    /// Returns the first moves, at most `moves` with at most `points` points in all.
    pub fn path(&self, machine: &Machine, moves: usize, points: usize) -> Vec<Leg> {
        let of_holes: BTreeSet<usize> = self.feeds.iter().flatten().copied().collect();
        let mut legs: Vec<Leg> = Vec::new();
        let mut setup = Setup::default();
        let mut from = Position::default();
        let mut left = points;
        let unknown_starts = self.moves_from_unknown_positions(machine);
        let mut move_number = 0;
        for (index, step) in self.steps.iter().enumerate() {
            set_up(&mut setup, step.kind);
            let to = step.at;
            if step.is_move() {
                let arc = match step.kind {
                    StepKind::Arc(arc, _) => Some(arc),
                    _ => None,
                };
                let mut points_of_move = move_points(machine, &setup, &from, &to, arc);
                if move_number < unknown_starts {
                    points_of_move.drain(..points_of_move.len() - 1);
                }
                move_number += 1;
                if legs.len() == moves || left < points_of_move.len() {
                    break;
                }
                left -= points_of_move.len();
                let back =
                    legs.last().is_some_and(|leg| leg.is_of_hole && is_back(&leg.points, &points_of_move));
                legs.push(leg(index, &step, of_holes.contains(&index) || back, points_of_move));
            }
            from = to;
        }
        legs
    }

    /// Counts the first moves that start at an unknown position: one of the axes that the program commands has not been commanded
    /// by then, and the machine file does not state its start.
    fn moves_from_unknown_positions(&self, machine: &Machine) -> usize {
        let is_stated = |name: &str| {
            let axis = name.bytes().next().and_then(|letter| self.axes.find(letter));
            machine.start.iter().any(|(stated, _)| Some(*stated) == axis)
        };
        let axes = self.first_commands.iter().flatten().filter(|first| first.what == CommandKind::Axis);
        axes.filter(|axis| !is_stated(&axis.name)).map(|axis| axis.moves + 1).max().unwrap_or(0)
    }
}

/// Returns true if two moves have the same feed, to the rounding of a rate computed from a path and a time.
fn is_same_feed(one: &Leg, other: &Leg) -> bool {
    match (one.feed, other.feed) {
        (Some(one), Some(other)) => (one - other).abs() <= 1e-9 * one.abs(),
        (one, other) => one == other,
    }
}

fn leg(index: usize, step: &Step<'_>, is_of_hole: bool, points: Vec<Point3<f64>>) -> Leg {
    let (kind, feed) = (step.kind.name(), step.kind.rate());
    Leg { steps: index..=index, moves: 1, kind, feed, is_of_hole, block_number: step.block_number, points }
}

/// Returns the points of a line that are farther than `tolerance` from the line without them, and its ends (Douglas and Peucker).
fn simplified(points: &[Point3<f64>], tolerance: f64) -> Vec<Point3<f64>> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; points.len()];
    is_kept[0] = true;
    is_kept[last] = true;
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let away = |index: &usize| distance_to_line(&points[*index], &points[from], &points[to]);
        let farthest = (from + 1..to).max_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(farthest) = farthest.filter(|index| tolerance < away(index)) {
            is_kept[farthest] = true;
            open.extend([(from, farthest), (farthest, to)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(point, _)| *point).collect()
}

/// Returns the distance of a point from the line between two others, mm.
fn distance_to_line(point: &Point3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let along = to - from;
    let length = along.norm_squared();
    let part = if length == 0.0 { 0.0 } else { ((point - from).dot(&along) / length).clamp(0.0, 1.0) };
    (point - (from + along * part)).norm()
}

/// Returns true if a path ends where the path before starts.
fn is_back(before: &[Point3<f64>], now: &[Point3<f64>]) -> bool {
    before.first().zip(now.last()).is_some_and(|(begin, end)| (begin - end).norm() < 1e-6)
}

/// Applies a command that changes the position of the tool: tool, length, head angle.
fn set_up(setup: &mut Setup, kind: &StepKind) {
    match kind {
        StepKind::Tool(number) => setup.tool = Some(*number),
        StepKind::Length(offset) => setup.offset = **offset,
        StepKind::Stop(StopKind::Message, text, named) => {
            if let HeadMessage::Angle(angle) = HeadMessage::parse(text, named) {
                setup.head_angle = Some(angle);
            }
        }
        _ => {}
    }
}

/// Returns the points of a move on the part.
fn move_points(
    machine: &Machine,
    setup: &Setup,
    from: &Position,
    to: &Position,
    arc: Option<&PlanarArc>,
) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for_each_drawn_pose(machine, setup, &AxisMotion { from, to, arc }, CHORD, |pose| points.push(pose.tip));
    points
}

#[cfg(test)]
mod tests {
    use crate::Revision;
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_session::Request;

    fn legs(text: &str, moves: usize) -> Vec<(&'static str, [f64; 3])> {
        let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::default());
        let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
        let path = revision.record.path(&request.machine, moves, 1000);
        path.iter().map(|leg| (leg.kind, leg.points[leg.points.len() - 1].coords.into())).collect()
    }

    #[test]
    fn a_turn_of_the_table_turns_the_path_on_the_part() {
        // B90 turns the part's +z to the machine's +x: the tool at x = 10 is at z = 10 of the part.
        let path = legs("O1\nG0 B90.\nG0 X10.\nG1 X10. Y-2. F100\nM30\n", 10);
        let expected = [("rapid", [0.0; 3]), ("rapid", [0.0, 0.0, 10.0]), ("feed", [0.0, -2.0, 10.0])];
        for ((kind, end), (expected_kind, point)) in path.iter().zip(expected) {
            assert_eq!(*kind, expected_kind);
            assert!((0..3).all(|i| (end[i] - point[i]).abs() < 1e-9), "{end:?} instead of {point:?}");
        }
        assert_eq!(path.len(), 3);
    }

    /// A zigzag of 40 feeds of 1 mm, 0.4 high, and the rapid before it from an unknown position, in 5 legs: 8 feeds each. The points of the zigzag are 0.4 from
    /// the line between its ends, which is more than 0.05, 0.1 and 0.2 and no more than 0.4.
    #[test]
    fn a_whole_path_joins_moves_and_leaves_out_points() {
        let zigzag: String = (1..=40)
            .map(|index| format!("G1 X{index}. Y{} F100\n", if index % 2 == 0 { "0" } else { "0.4" }))
            .collect();
        let request = Request::new(
            "O1.nc",
            format!("O1\nG0 X0 Y0 Z1.\n{zigzag}M30\n").into_bytes(),
            Machine::default(),
        );
        let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
        let whole = revision.record.whole_path(&request.machine, 5, 100);
        let counts: Vec<_> = whole.iter().map(|leg| (leg.kind, leg.moves, leg.points.len())).collect();
        assert_eq!(
            counts,
            [
                ("rapid", 1, 1),
                ("feed", 9, 10),
                ("feed", 9, 10),
                ("feed", 9, 10),
                ("feed", 9, 10),
                ("feed", 4, 5)
            ]
        );
        let few = revision.record.whole_path(&request.machine, 5, 20);
        assert!(few.iter().all(|leg| leg.points.len() <= 3), "{few:?}");
        let end = few.last().unwrap().points.last().unwrap();
        assert_eq!((end.x, few.iter().map(|leg| leg.moves).sum::<usize>()), (40.0, 41));
    }

    /// X is known after the first move, Z after the second: the third is the first one between known positions. A stated start
    /// of X and Z makes all of them known; of X alone it changes nothing.
    #[test]
    fn a_move_from_an_unknown_position_is_its_end_alone() {
        let text = "O1\nG90 G54 G0 X5. Y0\nG43 Z9. H1\nG1 Z-1. F100\nX8.\nM30\n";
        let counts = |start: &str| -> Vec<usize> {
            let machine = format!("[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n{start}");
            let machine = Machine::parse(&machine).unwrap();
            let request = Request::new("O1.nc", text.as_bytes().to_vec(), machine);
            let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
            let path = revision.record.path(&request.machine, 10, 1000);
            path.iter().map(|leg| leg.points.len()).collect()
        };
        assert_eq!(counts(""), [1, 1, 2, 2]);
        assert_eq!(counts("[start]\nX = 1.0\nY = 1.0\n"), [1, 1, 2, 2]);
        assert_eq!(counts("[start]\nX = 1.0\nY = 1.0\nZ = 100.0\n"), [2, 2, 2, 2]);
    }

    #[test]
    fn the_path_has_at_most_the_specified_number_of_moves() {
        assert_eq!(legs("O1\nG0 X1.\nX2.\nX3.\nM30\n", 2).len(), 2);
    }
}
