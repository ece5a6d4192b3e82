//! The way of the tool on the part, move by move: what a drawing is made of.
use std::collections::BTreeSet;

use nalgebra::Point3;

use super::record::{BlockLocation, Record};
use super::steps::{Step, StepKind};
use gcode_inspect::machine::AxisMotion;
use gcode_inspect::machine::{HeadMessage, Machine, Setup};
use gcode_lang::motion::{MAX_AXES, PlanarArc, Position, StopKind};

/// A curved way strays from the chords it is drawn with by no more than this, mm.
const CHORD: f64 = 0.05;

/// One move in the part's frame; of a grinder the way of the wheel's contact.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Which step of the record it is.
    pub step: usize,
    /// `rapid`, `feed`, `arc` or `probing move`.
    pub kind: &'static str,
    /// mm/min, of a cut.
    pub feed: Option<f64>,
    /// It cuts a hole, or comes out of one the way it went in.
    pub is_of_hole: bool,
    /// Which of [`Record::places`] moves here.
    pub place: usize,
    /// From its beginning to its end.
    pub points: Vec<Point3<f64>>,
}

impl Record {
    /// The blocks that [`Leg::place`] counts.
    pub fn places(&self) -> &[BlockLocation] {
        &self.places
    }

    /// How many moves go somewhere.
    pub fn moves(&self) -> usize {
        self.steps.iter().filter(|step| step.is_move()).count()
    }

    /// The first moves, as long as they are no more than `moves` with no more than `points` points in all.
    pub fn path(&self, machine: &Machine, moves: usize, points: usize) -> Vec<Leg> {
        let of_holes: BTreeSet<usize> = self.feeds.iter().flatten().copied().collect();
        let mut legs: Vec<Leg> = Vec::new();
        let mut setup = Setup::default();
        let mut from = Position::default();
        let mut left = points;
        for (index, step) in self.steps.iter().enumerate() {
            set_up(&mut setup, &step.kind);
            let to = step.at;
            if step.is_move() {
                let arc = match &step.kind {
                    StepKind::Arc(arc, _) => Some(arc),
                    _ => None,
                };
                let way = way(machine, &setup, &from, &to, arc);
                if legs.len() == moves || left < way.len() {
                    break;
                }
                left -= way.len();
                let back = legs.last().is_some_and(|leg| leg.is_of_hole && is_back(&leg.points, &way));
                legs.push(leg(index, step, of_holes.contains(&index) || back, way));
            }
            from = to;
        }
        legs
    }
}

fn leg(index: usize, step: &Step, is_of_hole: bool, points: Vec<Point3<f64>>) -> Leg {
    let (kind, feed) = (step.kind.name(), step.kind.rate());
    Leg { step: index, kind, feed, is_of_hole, place: step.place, points }
}

/// It ends where the way before began.
fn is_back(before: &[Point3<f64>], way: &[Point3<f64>]) -> bool {
    before.first().zip(way.last()).is_some_and(|(begin, end)| (begin - end).norm() < 1e-6)
}

/// What other than an axis changes where the tool is.
fn set_up(setup: &mut Setup, kind: &StepKind) {
    match kind {
        StepKind::Tool(number) => setup.tool = Some(*number),
        StepKind::Length(offset) => setup.offset = *offset,
        StepKind::Stop(StopKind::Message, text, named) => {
            if let HeadMessage::Angle(angle) = HeadMessage::parse(text, named) {
                setup.head_angle = Some(angle);
            }
        }
        _ => {}
    }
}

fn way(
    machine: &Machine,
    setup: &Setup,
    from: &Position,
    to: &Position,
    arc: Option<&PlanarArc>,
) -> Vec<Point3<f64>> {
    let travel = AxisMotion { from, to, arc };
    let Some(wheel) = &machine.wheel else {
        let mut points = Vec::new();
        machine.for_each_pose(&travel, setup, CHORD, |pose| points.push(pose.tip));
        return points;
    };
    let turning = (0..MAX_AXES).filter(|axis| machine.axes.is_rotary(*axis));
    let turned: f64 = turning.map(|axis| (to[axis] - from[axis]).abs()).sum();
    let sweep = arc.map_or(0.0, |arc| arc.sweep.0.abs());
    // A chord of 3° is 1.4 µm off a circle of 4 mm, a burr's.
    let chords = ((turned + sweep) / 3.0).ceil().clamp(1.0, 1000.0) as u32;
    let at = |part: u32| travel.position(f64::from(part) / f64::from(chords));
    (0..=chords).map(|part| machine.contact(wheel, &at(part))).collect()
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
    fn a_turned_table_turns_the_way_on_the_part() {
        // B90 brings the part's +z to the machine's +x: on the part the tool at x = 10 stands at z = 10.
        let path = legs("O1\nG0 B90.\nG0 X10.\nG1 X10. Y-2. F100\nM30\n", 10);
        let expected = [("rapid", [0.0; 3]), ("rapid", [0.0, 0.0, 10.0]), ("feed", [0.0, -2.0, 10.0])];
        for ((kind, end), (wanted, point)) in path.iter().zip(expected) {
            assert_eq!(*kind, wanted);
            assert!((0..3).all(|i| (end[i] - point[i]).abs() < 1e-9), "{end:?} instead of {point:?}");
        }
        assert_eq!(path.len(), 3);
    }

    #[test]
    fn no_more_moves_are_followed_than_asked_for() {
        assert_eq!(legs("O1\nG0 X1.\nX2.\nX3.\nM30\n", 2).len(), 2);
    }
}
