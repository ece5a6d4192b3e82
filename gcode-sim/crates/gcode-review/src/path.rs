//! Path of the tool on the part, move by move, for drawings.
use std::borrow::Cow;
use std::collections::BTreeSet;

use nalgebra::Point3;

use super::block_location::BlockLocation;
use super::record::Record;
use super::steps::{Step, StepKind};
use gcode_inspect::machine::AxisMotion;
use gcode_inspect::machine::{HeadMessage, Machine, Setup};
use gcode_inspect::tool_path::for_each_drawn_pose;
use gcode_lang::motion::{PlanarArc, Position, StopKind};

/// Largest deviation of a curved path from its chords, mm.
const CHORD: f64 = 0.05;

/// One move in the frame of the part; of a grinder the path of the wheel's contact.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Number of the step in the record.
    pub step: usize,
    /// `rapid`, `feed`, `arc` or `probing move`.
    pub kind: &'static str,
    /// Feed of a cut, mm/min.
    pub feed: Option<f64>,
    /// True for a move that cuts a hole, or leaves one along the path of its cut.
    pub is_of_hole: bool,
    /// Number of its block in [`Record::block_location`].
    pub block_number: usize,
    /// Points from start to end, mm.
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

    /// Returns the first moves, at most `moves` with at most `points` points in all.
    pub fn path(&self, machine: &Machine, moves: usize, points: usize) -> Vec<Leg> {
        let of_holes: BTreeSet<usize> = self.feeds.iter().flatten().copied().collect();
        let mut legs: Vec<Leg> = Vec::new();
        let mut setup = Setup::default();
        let mut from = Position::default();
        let mut left = points;
        for (index, step) in self.steps.iter().enumerate() {
            set_up(&mut setup, step.kind);
            let to = step.at;
            if step.is_move() {
                let arc = match step.kind {
                    StepKind::Arc(arc, _) => Some(arc),
                    _ => None,
                };
                let points_of_move = move_points(machine, &setup, &from, &to, arc);
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
}

fn leg(index: usize, step: &Step<'_>, is_of_hole: bool, points: Vec<Point3<f64>>) -> Leg {
    let (kind, feed) = (step.kind.name(), step.kind.rate());
    Leg { step: index, kind, feed, is_of_hole, block_number: step.block_number, points }
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

    #[test]
    fn the_path_has_at_most_the_specified_number_of_moves() {
        assert_eq!(legs("O1\nG0 X1.\nX2.\nX3.\nM30\n", 2).len(), 2);
    }
}
