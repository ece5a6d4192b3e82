//! Path of the tool on the part, move by move, for drawings.
use std::borrow::Cow;
use std::collections::BTreeSet;

use nalgebra::Point3;

use super::block_location::BlockLocation;
use super::first_command::CommandKind;
use super::leg::{Leg, UnplacedEnd, is_same_feed};
use super::record::Record;
use super::steps::StepKind;
use gcode_inspect::drawn_move::{PathKind, for_each_drawn_pose, is_placed, moved_axes};
use gcode_inspect::machine::AxisMotion;
use gcode_inspect::machine::{HeadMessage, Machine, Setup};
use gcode_lang::motion::{AxisIndex, StopKind};

/// Largest deviation of a curved path from its chords, mm.
const CHORD: f64 = 0.05;

/// Largest deviation of [`Leg::exact`] from the path, mm.
const FINE_CHORD: f64 = 0.001;

/// Tolerance at which a path is not simplified further, mm.
const MAX_SIMPLIFICATION: f64 = 100.0;

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
    /// together, without the points that are no farther from the line than the least tolerance that leaves few enough. At most
    /// `exact_points` points are those of [`Leg::exact`].
    pub fn whole_path(&self, machine: &Machine, legs: usize, points: usize, exact_points: usize) -> Vec<Leg> {
        let joined = self.moves().div_ceil(legs.max(1)).max(1);
        let mut all: Vec<Leg> = Vec::new();
        for next in self.legs(machine, usize::MAX, usize::MAX, exact_points) {
            match all.last_mut() {
                Some(leg)
                    if leg.kind == next.kind
                        && is_same_feed(leg, &next)
                        && leg.moves < joined
                        && leg.unplaced == next.unplaced =>
                {
                    leg.join(next);
                }
                _ => all.push(next),
            }
        }
        let mut room = exact_points.saturating_sub(all.iter().map(|leg| leg.exact.len()).sum());
        let mut tolerance = CHORD;
        while points < all.iter().map(|leg| leg.points.len()).sum() && tolerance < MAX_SIMPLIFICATION {
            for leg in &mut all {
                room = leg.simplify(tolerance, room);
            }
            tolerance *= 2.0;
        }
        all
    }

    /// Returns the first moves, at most `moves` with at most `points` points in all.
    pub fn path(&self, machine: &Machine, moves: usize, points: usize) -> Vec<Leg> {
        self.legs(machine, moves, points, 0)
    }

    /// Returns the first moves, each as a leg; curved ones with their exact points as long as `exact_points` are not spent.
    fn legs(&self, machine: &Machine, moves: usize, points: usize, exact_points: usize) -> Vec<Leg> {
        let of_holes: BTreeSet<usize> = self.feeds.iter().flatten().copied().collect();
        let mut legs: Vec<Leg> = Vec::new();
        let mut setup = Setup::default();
        let (mut from, mut unknown) = (self.start.at, self.start.unknown);
        let mut last_placed = None;
        let (mut left, mut exact_left) = (points, exact_points);
        let unknown_starts = self.unknown_axes(machine).iter().map(|(_, moves)| moves + 1).max().unwrap_or(0);
        let mut move_number = 0;
        for (index, step) in self.steps.iter().enumerate() {
            set_up(&mut setup, step.kind);
            let to = step.at;
            if step.is_move() {
                let arc = match step.kind {
                    StepKind::Arc(arc, _) => Some(arc),
                    _ => None,
                };
                let travel = AxisMotion { from: &from, to: &to, arc };
                let mut points_of_move = move_points(machine, &setup, &travel, CHORD);
                let kind = path_kind(step.kind);
                let moved = moved_axes(&travel);
                let is_lost = |unknown, number: usize| {
                    number < unknown_starts || !is_placed(machine, unknown, kind, moved)
                };
                let ends = [
                    is_lost(unknown, move_number),
                    is_lost(self.steps.unknown_after(index), move_number + 1),
                ];
                let unplaced = match ends {
                    [true, true] => Some(UnplacedEnd::Both),
                    [true, false] => Some(UnplacedEnd::Start),
                    [false, true] => Some(UnplacedEnd::End),
                    [false, false] => None,
                };
                match unplaced {
                    Some(UnplacedEnd::End) => points_of_move.truncate(1),
                    Some(_) => points_of_move.drain(..points_of_move.len() - 1).for_each(drop),
                    None => {}
                }
                match (unplaced, last_placed) {
                    (Some(UnplacedEnd::Both), Some(last)) => points_of_move = vec![last],
                    (Some(UnplacedEnd::Both), None) => {}
                    _ => last_placed = points_of_move.last().copied(),
                }
                let is_curved = 2 < points_of_move.len();
                let mut exact = Vec::new();
                if is_curved && 0 < exact_left {
                    exact = move_points(machine, &setup, &travel, FINE_CHORD);
                    exact_left = exact_left.saturating_sub(exact.len());
                }
                move_number += 1;
                if legs.len() == moves || left < points_of_move.len() {
                    break;
                }
                left -= points_of_move.len();
                let back =
                    legs.last().is_some_and(|leg| leg.is_of_hole && is_back(&leg.points, &points_of_move));
                legs.push(Leg {
                    steps: index..=index,
                    moves: 1,
                    kind: step.kind.name(),
                    feed: step.kind.rate(),
                    is_of_hole: of_holes.contains(&index) || back,
                    block_number: step.block_number,
                    unplaced,
                    points: points_of_move,
                    deviation: if is_curved { CHORD } else { 0.0 },
                    exact,
                });
            }
            (from, unknown) = (to, self.steps.unknown_after(index));
        }
        legs
    }

    /// Returns what the position display shows at the end of each leg, which are those of the whole path: axis and coordinate in
    /// the work coordinate system, mm and degrees, of the axes that the program has commanded by then.
    pub fn displays(&self, machine: &Machine, legs: &[Leg]) -> Vec<Vec<(AxisIndex, f64)>> {
        let axes: BTreeSet<AxisIndex> = self.commanded_axes().map(|(axis, _)| axis).collect();
        let unknown = self.unknown_axes(machine);
        let mut made = 0;
        let display = |leg: &Leg| {
            made += leg.moves;
            let shown = self.steps.displayed(*leg.steps.end());
            let is_known =
                |axis: &&AxisIndex| unknown.iter().all(|(of, before)| of != *axis || *before < made);
            axes.iter().filter(is_known).map(|axis| (*axis, shown[*axis])).collect()
        };
        legs.iter().map(display).collect()
    }

    /// Returns each axis that the program commands with the number of moves before its first command; those whose start the
    /// machine file states are left out.
    fn unknown_axes(&self, machine: &Machine) -> Vec<(AxisIndex, usize)> {
        let is_stated = |axis: AxisIndex| machine.start.iter().any(|(stated, _)| *stated == axis);
        self.commanded_axes().filter(|(axis, _)| !is_stated(*axis)).collect()
    }

    /// Iterates over the axes that the program commands, each with the number of moves before.
    fn commanded_axes(&self) -> impl Iterator<Item = (AxisIndex, usize)> {
        let axes = self.first_commands.iter().flatten().filter(|first| first.what == CommandKind::Axis);
        axes.filter_map(|first| Some((self.axes.find(first.name.bytes().next()?)?, first.moves)))
    }
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

fn path_kind(kind: &StepKind) -> PathKind {
    match kind {
        StepKind::Rapid => PathKind::Rapid,
        StepKind::Probe(_) => PathKind::Probe,
        _ => PathKind::Feed,
    }
}

/// Returns the points of a move on the part.
fn move_points(machine: &Machine, setup: &Setup, travel: &AxisMotion<'_>, chord: f64) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for_each_drawn_pose(machine, setup, travel, chord, |pose| points.push(pose.tip));
    points
}

#[cfg(test)]
mod tests {
    use super::UnplacedEnd;
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

    /// G54 is X −300 Z −400, H1 is 50 long: the machine stands at Z −400 + 50 + 10 where the display shows Z 10. G55 has other
    /// zeros, and shows other numbers for the same place. B, which nothing has commanded yet, is not shown.
    #[test]
    fn a_display_shows_work_coordinates() {
        let text = "O1\nG10 L2 P1 X-300. Y0 Z-400.\nG10 L2 P2 X-100. Y0 Z0.\nG10 L10 P1 R50.\nG90 G54 G0 X5. Y0\nG43 H1 Z10.\nB90.\n\
                    G55 X5.\nM30\n";
        let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::default());
        let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
        let legs = revision.record.path(&request.machine, 10, 1000);
        let shown = revision.record.displays(&request.machine, &legs);
        assert_eq!(shown[0], [(0, 5.0), (1, 0.0)]);
        assert_eq!(shown[1], [(0, 5.0), (1, 0.0), (2, 10.0)]);
        assert_eq!(shown[2][3].1, 90.0);
        // From machine X −295 to −95; Z is that of the machine, −340, less the length alone: G55's zero is 0.
        assert_eq!(shown[3], [(0, 5.0), (1, 0.0), (2, -390.0), (shown[2][3].0, 90.0)]);
    }

    /// A zigzag of 40 feeds of 1 mm, 0.4 high, and the rapid before it from an unknown position, in 5 legs: 8 feeds each. The
    /// points of the zigzag are 0.4 from the line between its ends, which is more than 0.05, 0.1 and 0.2 and no more than 0.4.
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
        let whole = revision.record.whole_path(&request.machine, 5, 100, 0);
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
        let few = revision.record.whole_path(&request.machine, 5, 20, 1000);
        assert!(few.iter().all(|leg| leg.points.len() <= 3), "{few:?}");
        // What is left out stays beside them: the points of whole, of the legs that have fewer now.
        for (leg, all) in few.iter().zip(&whole) {
            let exact = if leg.exact.is_empty() { &leg.points } else { &leg.exact };
            assert_eq!(exact, &all.points);
        }
        let unlimited: usize = few.iter().map(|leg| leg.exact.len()).sum();
        let limited = revision.record.whole_path(&request.machine, 5, 20, unlimited - 1);
        assert!(limited.iter().map(|leg| leg.exact.len()).sum::<usize>() < unlimited);
        assert!(limited.iter().any(|leg| leg.exact.is_empty() && 0.0 < leg.deviation), "and it says so");
        let end = few.last().unwrap().points.last().unwrap();
        assert_eq!((end.x, few.iter().map(|leg| leg.moves).sum::<usize>()), (40.0, 41));
    }

    /// Chords of a circle of 10 mm deviate from it by 10 − 10·cos(half their angle).
    #[test]
    fn an_arc_has_fine_chords_beside_its_coarse_ones() {
        let text = "O1\nG90 G0 X10. Y0 Z0\nG3 X10. Y0 I-10. J0 F100\nG3 X10. Y0 I-10. J0 F100\nM30\n";
        let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::default());
        let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
        let deviation = |points: &[nalgebra::Point3<f64>]| {
            let of_chord =
                |pair: &[nalgebra::Point3<f64>]| 10.0 - (pair[0].coords + pair[1].coords).norm() / 2.0;
            points.windows(2).map(of_chord).fold(0.0, f64::max)
        };
        for legs in [10, 2] {
            let path = revision.record.whole_path(&request.machine, legs, 1000, 10_000);
            let arc = path.last().unwrap();
            assert!(deviation(&arc.points) <= 0.05 && 0.01 < deviation(&arc.points), "{legs}");
            assert!(deviation(&arc.exact) <= 0.001 && !arc.exact.is_empty(), "{legs}");
        }
        let none = revision.record.whole_path(&request.machine, 10, 1000, 0);
        assert!(none.iter().all(|leg| leg.exact.is_empty()));
        assert_eq!(none.last().unwrap().deviation, 0.05);
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

    /// G28 sends Z to machine zero, and X and Y follow there: without G54 this place on the part is unknown, and the ends that are
    /// known remain. With G54 its zero is at Z −400 of the machine, so that Z is 400 less the tool's 120.
    #[test]
    fn a_move_to_a_machine_position_without_its_offset_has_no_end() {
        let text =
            "O1\nG90 G54 G0 X5. Y0\nG43 H1 Z50.\nG91 G28 Z0\nG90 X9.\nG43 H1 Z50.\nX7.\nG91 G28 Z0\nM30\n";
        let legs = |offsets: &str| -> Vec<_> {
            let head = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n[[tool]]\nnumber = 1\nlength = 120.0\n";
            let machine = Machine::parse(&format!("{head}{offsets}")).unwrap();
            let text = text.replace("O1\n", "O1\nT1 M6\n");
            let request = Request::new("O1.nc", text.into_bytes(), machine);
            let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
            let path = revision.record.path(&request.machine, 10, 1000);
            path.iter().map(|leg| (leg.unplaced, leg.points.last().unwrap().z, leg.points.len())).collect()
        };
        let (start, end, both) = (Some(UnplacedEnd::Start), Some(UnplacedEnd::End), Some(UnplacedEnd::Both));
        let unknown = legs("");
        let placed = [
            (start, 50.0, 1),
            (end, 50.0, 1),
            (both, 50.0, 1),
            (start, 50.0, 1),
            (None, 50.0, 2),
            (end, 50.0, 1),
        ];
        assert_eq!(unknown[1..], placed);
        let offsets = "[part]\norigin = [0.0, 0.0, -400.0]\n[offsets.G54]\nX = 0.0\nY = 0.0\nZ = -400.0\n";
        let known: Vec<_> =
            legs(offsets).iter().map(|(unplaced, z, points)| (*unplaced, z.round(), *points)).collect();
        let placed = [
            (start, 50.0, 1),
            (None, 280.0, 2),
            (None, 280.0, 2),
            (None, 50.0, 2),
            (None, 50.0, 2),
            (None, 280.0, 2),
        ];
        assert_eq!(known[1..], placed);
    }

    /// `[start]` is Z 250: the first rapid comes from there, not from machine zero.
    #[test]
    fn a_stated_start_is_where_the_path_begins() {
        let head =
            "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n[start]\nX = -5.0\nY = 0.0\nZ = 250.0\n";
        let text = "O1\nG90 G54 G0 X5. Y0\nM30\n";
        let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::parse(head).unwrap());
        let revision = Revision::of(&request, &mut NoLibrary, None).unwrap();
        let path = revision.record.path(&request.machine, 10, 1000);
        let ends: Vec<[f64; 3]> = path[0].points.iter().map(|point| point.coords.into()).collect();
        assert_eq!(ends, [[-5.0, 0.0, 250.0], [5.0, 0.0, 250.0]]);
    }

    #[test]
    fn the_path_has_at_most_the_specified_number_of_moves() {
        assert_eq!(legs("O1\nG0 X1.\nX2.\nX3.\nM30\n", 2).len(), 2);
    }
}
