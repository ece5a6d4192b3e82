//! Path of the tool on the part during a run, for drawings: stretches of moves of one kind, and places of stops.
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use crate::drawn_move::{PathKind, for_each_drawn_pose, is_in_plane, is_placed, moved_axes};
use crate::holes::unknown_axes::PositionTracker;
use crate::machine::{AxisMotion, HeadMessage, Machine, Setup};
use gcode_lang::motion::{CallChain, Event, EventKind, EventSink, PlanarArc, Position, StopKind};
use gcode_lang::source::Span;

/// Largest deviation of a curved path from its chords, mm.
const CHORD_TOLERANCE: f64 = 0.01;
/// Largest deviation of an arc from its chords, in parts of its radius: a small arc may fill a sheet.
const ARC_TOLERANCE: f64 = 5e-4;

/// Largest number of recorded points; later moves are counted alone.
pub const MAX_POINTS: usize = 4_000_000;

/// Largest number of feeds to a hole before the one that makes it.
const MAX_APPROACH_FEEDS: usize = 8;

/// Cosine of the largest angle between a direction and the axis of the part that it counts for: 8°.
const MIN_COSINE: f64 = 0.99;

/// Path of the tool on the part.
#[derive(Clone, Debug, Default)]
pub struct ToolPath {
    /// Points of all stretches, mm. Stretches that follow each other share none.
    pub points: Vec<[f64; 3]>,
    /// Successive moves of one kind by one tool in one program.
    pub stretches: Vec<Stretch>,
    /// Recorded moves.
    pub moves: Vec<PathMove>,
    /// Operator stops.
    pub stops: Vec<PathStop>,
    /// Tip of the tool at the end of the run; `None` if G28, G30 or G53 has sent it to an unknown place, or nothing has moved.
    pub end: Option<[f64; 3]>,
    /// Feeds between positions that are unknown on the part, not recorded.
    pub unplaced_feeds: u64,
    /// Moves beyond [`MAX_POINTS`], not recorded.
    pub omitted_moves: u64,
    /// Number of stretches of feeds with the tool along each axis of the part, with its sign.
    tool_axes: BTreeMap<(usize, bool), u64>,
    /// Number of stretches of feeds with the tool along none, by the axis that is nearest to it.
    oblique_axes: BTreeMap<(usize, bool), u64>,
    /// The same, of moves of a tool whose direction is unknown.
    supposed_axes: BTreeMap<usize, u64>,
}

/// Direction of the tool on the part in a stretch of feeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StretchAxis {
    /// Unknown, or not that of a feed.
    #[default]
    Unknown,
    /// Along an axis of the part, 0 to 2, to its positive end or to its negative one.
    Along(usize, bool),
    /// Along no axis, or changing.
    Oblique,
}

impl StretchAxis {
    /// Returns the direction of a tool.
    fn of(out: &Unit<Vector3<f64>>) -> Self {
        let axis = out.iter().position(|part| MIN_COSINE < part.abs());
        axis.map_or(Self::Oblique, |axis| Self::Along(axis, 0.0 < out[axis]))
    }
}

/// Successive moves of one kind by one tool, at one feed, in one program.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Kind of the moves.
    pub kind: PathKind,
    /// Tool in the spindle; `None` before the first tool change.
    pub tool: Option<u32>,
    /// Feed along the path, mm/min; 0 of a rapid.
    pub feed: f64,
    /// Direction of the tool.
    pub axis: StretchAxis,
    /// Block of its first move.
    pub block: Span,
    /// Its points in [`ToolPath::points`].
    pub points: Range<usize>,
    /// Its moves in [`ToolPath::moves`].
    pub moves: Range<usize>,
}

/// One move of a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathMove {
    /// Index of its last point; its first one is the last of the move before, or the first of the stretch.
    pub last_point: u32,
    /// Offset of its block in the text of the stretch's block.
    pub block_start: u32,
}

/// An operator stop.
#[derive(Clone, Debug, PartialEq)]
pub struct PathStop {
    /// Tip of the tool; `None` if its position is unknown.
    pub at: Option<[f64; 3]>,
    /// Cause of the stop.
    pub kind: StopKind,
    /// Text of its message.
    pub text: String,
    /// Block of the stop.
    pub block: Span,
}

impl ToolPath {
    /// Returns the axis of the part, 0 to 2, along which the tool is in most stretches of feeds, and whether it points to the positive
    /// end; of a tool that is always oblique the axis nearest to it in most of them; `None` if its direction is unknown.
    pub fn tool_axis(&self) -> Option<(usize, bool)> {
        most(&self.tool_axes).or_else(|| most(&self.oblique_axes))
    }

    /// Returns the axis of the part along which a tool of unknown direction probably is: most arcs lie across it and most
    /// single-axis rapids along it.
    pub fn supposed_axis(&self) -> Option<(usize, bool)> {
        most(&self.supposed_axes).map(|axis| (axis, true))
    }

    /// Returns true if a feed makes none of the holes of which `is_of_hole` knows the blocks by source and offset, and is
    /// not on the line of the feed into a hole before or after it.
    pub fn has_feed_off_holes(&self, is_of_hole: impl Fn(Span) -> bool) -> bool {
        let mut line: Option<[Point3<f64>; 2]> = None;
        let mut pending: Vec<&[[f64; 3]]> = Vec::new();
        for stretch in self.stretches.iter().filter(|stretch| stretch.kind == PathKind::Feed) {
            let mut first = stretch.points.start;
            for of_move in &self.moves[stretch.moves.clone()] {
                let last = of_move.last_point as usize;
                let points = &self.points[first..=last];
                first = last;
                if is_of_hole(Span { start: of_move.block_start, ..stretch.block }) {
                    let of_hole = [Point3::from(points[0]), Point3::from(points[points.len() - 1])];
                    if !pending.drain(..).all(|points| are_on_line(points, &of_hole)) {
                        return true;
                    }
                    line = Some(of_hole);
                } else if !line.is_some_and(|line| are_on_line(points, &line)) {
                    pending.push(points);
                    if MAX_APPROACH_FEEDS < pending.len() {
                        return true;
                    }
                }
            }
        }
        !pending.is_empty()
    }
}

impl ToolPath {
    /// Returns true if a feed is curved: an arc, a helix, or a turn of the part under the tool.
    pub fn has_curved_feed(&self) -> bool {
        self.stretches.iter().filter(|stretch| stretch.kind == PathKind::Feed).any(|stretch| {
            // Each straight move has one point but the first.
            stretch.moves.len() + 1 < stretch.points.len()
        })
    }
}

/// Returns true if all points are less than 0.01 mm off the line through two others.
fn are_on_line(points: &[[f64; 3]], [from, to]: &[Point3<f64>; 2]) -> bool {
    let along = (to - from).try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
    points.iter().all(|point| {
        let off = Point3::from(*point) - from;
        (off - along * off.dot(&along)).norm() < CHORD_TOLERANCE
    })
}

/// Returns the key with the largest count, the last of equal ones.
fn most<K: Copy + Ord>(counts: &BTreeMap<K, u64>) -> Option<K> {
    counts.iter().max_by_key(|(_, count)| **count).map(|(key, _)| *key)
}

/// Sink for the events of a run that records the path of the tool.
#[derive(Debug)]
pub struct PathRecorder<'m> {
    machine: &'m Machine,
    setup: Setup,
    at: Position,
    positions: PositionTracker,
    /// Calls of the last move: a call or a return ends a stretch.
    calls: CallChain,
    path: ToolPath,
}

impl<'m> PathRecorder<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine) -> Self {
        Self {
            machine,
            setup: Setup::default(),
            at: Position::default(),
            positions: PositionTracker::default(),
            calls: None,
            path: ToolPath::default(),
        }
    }

    /// Returns the recorded path.
    pub fn finish(mut self) -> ToolPath {
        // An axis that no block of the run has commanded counts as known, as in the path.
        let unknown = self.positions.unknown_axes();
        let is_known = is_placed(self.machine, unknown, PathKind::Rapid, 0);
        let tip = self.machine.forward(&self.at, &self.setup).tip.coords.into();
        self.path.end = self.path.end.filter(|_| is_known).map(|_| tip);
        self.path
    }

    /// Returns the tip of the tool; `None` if the position of an axis of a slide is unknown.
    fn tip(&self) -> Option<[f64; 3]> {
        let unknown = self.machine.needed_axes(self.positions.unknown_axes().all());
        (unknown == 0).then(|| self.machine.forward(&self.at, &self.setup).tip.coords.into())
    }

    fn motion(&mut self, event: &Event<'_>, kind: PathKind, to: &Position, arc: Option<&PlanarArc>) {
        let from = std::mem::replace(&mut self.at, *to);
        let (was, is) = self.positions.advance(self.machine);
        let travel = AxisMotion { from: &from, to, arc };
        let moved = moved_axes(&travel) & self.machine.used_axes();
        if moved == 0 {
            return;
        }
        // An axis that is commanded for the first time may move from anywhere.
        self.suppose_axis(kind, arc, moved | was.uncommanded & !is.uncommanded);
        if !is_placed(self.machine, was.union(is), kind, moved) {
            self.path.unplaced_feeds += u64::from(kind == PathKind::Feed);
            return;
        }
        if MAX_POINTS <= self.path.points.len() {
            self.path.omitted_moves += 1;
            return;
        }
        let feed = event.kind.rate().map_or(0.0, |rate| rate.0);
        let path = &mut self.path;
        let first = path.points.len();
        let (mut out, mut axis): (_, Option<StretchAxis>) = (None, None);
        let tolerance = (travel.radius() * ARC_TOLERANCE).clamp(0.1 * CHORD_TOLERANCE, CHORD_TOLERANCE);
        let tolerance = if arc.is_some() { tolerance } else { CHORD_TOLERANCE };
        for_each_drawn_pose(self.machine, &self.setup, &travel, tolerance, |pose| {
            path.points.push(pose.tip.coords.into());
            out = out.or(pose.axis);
            let of_pose = pose.axis.map_or(StretchAxis::Unknown, |axis| StretchAxis::of(&axis));
            axis = Some(if axis.is_none_or(|before| before == of_pose) {
                of_pose
            } else {
                StretchAxis::Oblique
            });
        });
        path.end = path.points.last().copied();
        let axis = axis.filter(|_| kind == PathKind::Feed).unwrap_or_default();
        let is_same_program = match (&self.calls, event.calls) {
            (None, None) => true,
            (Some(before), Some(now)) => Arc::ptr_eq(before, now),
            (None, Some(_)) | (Some(_), None) => false,
        };
        if !is_same_program {
            self.calls.clone_from(event.calls);
        }
        let moves = path.moves.len();
        let continues = |stretch: &&mut Stretch| {
            stretch.kind == kind
                && stretch.tool == self.setup.tool
                && stretch.feed == feed
                && stretch.axis == axis
                && is_same_program
                && stretch.block.source == event.block.source
                && stretch.points.end == first
                && distance(path.points[first - 1], path.points[first]) < 1e-9
        };
        if let Some(stretch) = path.stretches.last_mut().filter(continues) {
            path.points.remove(first);
            stretch.points.end = path.points.len();
            stretch.moves.end = moves + 1;
        } else {
            match (axis, out) {
                (StretchAxis::Along(..), Some(out)) => count_axis(&mut path.tool_axes, &out),
                (StretchAxis::Oblique, Some(out)) => count_axis(&mut path.oblique_axes, &out),
                _ => {}
            }
            path.stretches.push(Stretch {
                kind,
                tool: self.setup.tool,
                feed,
                axis,
                block: event.block,
                points: first..path.points.len(),
                moves: moves..moves + 1,
            });
        }
        path.moves
            .push(PathMove { last_point: (path.points.len() - 1) as u32, block_start: event.block.start });
    }

    /// Counts the axis across an arc, or along a rapid that moves only this axis, if the direction of the tool is unknown.
    fn suppose_axis(&mut self, kind: PathKind, arc: Option<&PlanarArc>, moved: u8) {
        let axis = match arc {
            Some(arc) => (0..3).find(|axis| !is_in_plane(arc, *axis)),
            None if kind == PathKind::Rapid => (0..3).find(|axis| moved == 1 << axis),
            None => None,
        };
        if let Some(axis) = axis
            && self.machine.head.direction(&self.at, &self.setup).is_none()
        {
            *self.path.supposed_axes.entry(axis).or_default() += 1;
        }
    }
}

/// Counts a stretch for the axis of the part that is nearest to a direction, and for its sign.
fn count_axis(counts: &mut BTreeMap<(usize, bool), u64>, direction: &Unit<Vector3<f64>>) {
    let axis = direction.iamax();
    *counts.entry((axis, 0.0 < direction[axis])).or_default() += 1;
}

fn distance(from: [f64; 3], to: [f64; 3]) -> f64 {
    (Point3::from(to) - Point3::from(from)).norm()
}

impl EventSink for PathRecorder<'_> {
    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            EventKind::Rapid { to } => self.motion(event, PathKind::Rapid, to, None),
            EventKind::Feed { to, .. } => self.motion(event, PathKind::Feed, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, PathKind::Feed, to, Some(arc)),
            EventKind::Skip { to, .. } => self.motion(event, PathKind::Probe, to, None),
            EventKind::ToolChange { number } => self.setup.tool = Some(*number),
            EventKind::ToolLength { offset, wear, .. } => {
                (self.setup.offset, self.setup.wear) = (*offset, *wear);
            }
            EventKind::Start { at, unknown } => {
                self.at = *at;
                self.positions.apply_event(self.machine, *unknown);
            }
            EventKind::PositionUnknown { axes } => self.positions.apply_event(self.machine, *axes),
            EventKind::Stop { kind, text, variables } => {
                let stop = PathStop { at: self.tip(), kind: *kind, text: text.clone(), block: event.block };
                self.path.stops.push(stop);
                if *kind == StopKind::Message
                    && let HeadMessage::Angle(angle) = HeadMessage::parse(text, variables)
                {
                    self.setup.head_angle = Some(angle);
                }
            }
            EventKind::Dwell { .. }
            | EventKind::ToolSelected { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::holes::event_script::EventScript;
    use crate::machine::{Head, HeadKind};
    use gcode_lang::motion::UnknownAxes;
    use gcode_lang::units::{Deg, MmPerMin};

    fn path(machine: &Machine, script: &EventScript) -> ToolPath {
        let mut recorder = PathRecorder::new(machine);
        script.emit_to(&mut recorder);
        recorder.finish()
    }

    fn unknown(axes: u8) -> EventKind {
        EventKind::PositionUnknown { axes: UnknownAxes { uncommanded: axes, ..UnknownAxes::default() } }
    }

    fn upright() -> Machine {
        Machine { head: Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0), ..Machine::default() }
    }

    #[test]
    fn successive_moves_of_one_kind_and_tool_are_a_stretch() {
        let script =
            EventScript::new().then("tool 1; rapid X10; rapid Z2; feed Z-1; feed X20; tool 2; feed X30");
        let path = path(&upright(), &script);
        let stretches: Vec<_> = path
            .stretches
            .iter()
            .map(|of| (of.kind, of.tool, path.points[of.points.clone()].len()))
            .collect();
        let expected =
            [(PathKind::Rapid, Some(1), 3), (PathKind::Feed, Some(1), 3), (PathKind::Feed, Some(2), 2)];
        assert_eq!(stretches, expected);
        assert_eq!((path.moves.len(), path.end), (5, Some([30.0, 0.0, -1.0])));
        assert_eq!(path.points.last(), Some(&[30.0, 0.0, -1.0]));
        assert_eq!(path.tool_axis(), Some((2, true)));
    }

    /// Two holes from above, then a contour of five feeds with the table at B90: three stretches, two of them along z.
    #[test]
    fn a_contour_counts_once_for_the_axis_of_the_tool() {
        let script = EventScript::new().then(
            "tool 1; rapid Z2; feed Z-1; rapid Z2; rapid X10; feed Z-1; rapid Z50; rapid B90; feed Z40; feed X20; \
             feed Y5; feed X0; feed Y0",
        );
        let path = path(&upright(), &script);
        let feeds = path.stretches.iter().filter(|of| of.kind == PathKind::Feed);
        let axes: Vec<StretchAxis> = feeds.map(|of| of.axis).collect();
        let down = StretchAxis::Along(2, true);
        assert!(axes[..2] == [down, down] && matches!(axes[2..], [StretchAxis::Along(0, _)]), "{axes:?}");
        assert_eq!(path.tool_axis(), Some((2, true)));
    }

    /// With the table at B30 and B60 the tool is 30° and 60° off z: nearest to z in two stretches, to x in one. In a whole turn it is
    /// along z at both ends, and along no axis between.
    #[test]
    fn an_oblique_tool_counts_for_the_nearest_axis() {
        let path = |script: &str| path(&upright(), &EventScript::new().then(script));
        let two_angles = path("rapid B30; feed X10; rapid Z5; feed X20; rapid Z9; rapid B60; feed X30");
        assert_eq!((two_angles.tool_axes.len(), two_angles.tool_axis()), (0, Some((2, true))));
        let axes: Vec<StretchAxis> = path("feed X10; feed B360").stretches.iter().map(|of| of.axis).collect();
        assert_eq!(axes, [StretchAxis::Along(2, true), StretchAxis::Oblique]);
    }

    /// Chords of a quarter of radius 10 deviate by at most 0.005: each spans at most 2·acos(1 − 0.0005) = 3.62°, so that
    /// there are at least 25.
    #[test]
    fn an_arc_has_points_within_a_part_of_its_radius() {
        let to = Position([0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let arc = PlanarArc { plane: (0, 1), centre: (0.0, 0.0), sweep: Deg(90.0) };
        let script =
            EventScript::new().then("rapid X10").with(EventKind::Arc { to, arc, rate: MmPerMin(10.0) });
        let path = path(&upright(), &script);
        let points = &path.points[path.stretches[1].points.clone()];
        assert!(25 < points.len() && points.len() < 80, "{}", points.len());
        for pair in points.windows(2) {
            let middle = nalgebra::center(&Point3::from(pair[0]), &Point3::from(pair[1]));
            assert!(
                9.995 <= middle.coords.norm() && (Point3::from(pair[0]).coords.norm() - 10.0).abs() < 1e-9
            );
        }
    }

    /// X is unknown until its first move has ended; Y and Z are known.
    #[test]
    fn a_move_from_an_unknown_position_is_not_recorded() {
        let script = EventScript::new().with(unknown(1)).with(unknown(0)).then("feed X10; feed X20; feed Y5");
        let path = path(&upright(), &script);
        assert_eq!((path.unplaced_feeds, path.moves.len(), path.points[0]), (1, 2, [10.0, 0.0, 0.0]));
    }

    /// Z goes to machine zero, X follows there, and Z comes back: three rapids without a place. A feed across at that height keeps its
    /// x; a path that ends there has no end.
    #[test]
    fn rapids_at_an_unknown_machine_position_are_not_recorded() {
        let home = |axes: u8| EventKind::PositionUnknown {
            axes: UnknownAxes { at_machine_position: axes, ..UnknownAxes::default() },
        };
        let there =
            EventScript::new().with(home(0)).then("rapid Z5").with(home(4)).then("rapid Z0; rapid X10");
        let path = |script: EventScript| path(&upright(), &script);
        let lost = path(there.clone());
        assert_eq!((lost.moves.len(), lost.end), (1, None));
        let back = path(there.clone().with(home(0)).then("rapid Z5; rapid X20"));
        assert_eq!((back.moves.len(), back.end), (2, Some([20.0, 0.0, 5.0])));
        assert_eq!(back.points[back.stretches[1].points.clone()], [[10.0, 0.0, 5.0], [20.0, 0.0, 5.0]]);
        assert_eq!(path(there.then("feed X30")).moves.len(), 2);
    }

    /// The direction of the default machine's tool is unknown: two rapids along z and one along x.
    #[test]
    fn rapids_along_an_axis_indicate_the_tool() {
        let script = EventScript::new().then("rapid Z5; rapid X10; rapid Z1; feed X20; feed X30; feed X40");
        let path = path(&Machine::default(), &script);
        assert_eq!((path.tool_axis(), path.supposed_axis()), (None, Some((2, true))));
    }

    /// The first rapid places X and Y, and only X changes its number; it is one along X if it places X alone.
    #[test]
    fn a_rapid_that_places_several_axes_is_along_none() {
        let supposed = |after: u8| {
            let script = EventScript::new().with(unknown(3)).with(unknown(after)).then("rapid X10; feed X20");
            path(&Machine::default(), &script).supposed_axis()
        };
        assert_eq!((supposed(0), supposed(2)), (None, Some((0, true))));
    }

    /// Events 4, 5 and 6 are the feed to the hole, the feed into it, and the feed out of it; event 7 is a feed across.
    #[test]
    fn feeds_along_a_hole_belong_to_it() {
        let script = |more: &str| {
            EventScript::new().then(&format!("tool 1; rapid X5; feed Z1; feed Z-9; feed Z2{more}"))
        };
        let is_of_hole = |block: Span| block.start == 5;
        assert!(!path(&upright(), &script("")).has_feed_off_holes(is_of_hole));
        assert!(path(&upright(), &script("; feed X6")).has_feed_off_holes(is_of_hole));
        assert!(path(&upright(), &script("")).has_feed_off_holes(|_| false));
    }
}
