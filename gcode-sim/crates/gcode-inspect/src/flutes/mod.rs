//! Motion → flutes: follows a grinder's wheel on the burr and separates passes from approach, retract and indexing.
//!
//! Feeds that rotate A are grinding moves; all other motion lies between two passes.
mod trace;
mod wheel_collisions;
mod wheel_state;

use nalgebra::Point3;

pub use trace::{Sample, Trace, Window};
pub(crate) use trace::{other_law, wrap_angle};
pub(crate) use wheel_collisions::{CollisionKind, PlungeFeed, WheelCollision};
use wheel_collisions::{CollisionTracker, MotionMode, MovedAxes};
use wheel_state::WheelState;
pub(crate) use wheel_state::{FirstOccurrence, StoppedWheel};

use crate::holes::UnknownRapids;
use crate::holes::unknown_axes::PositionTracker;
use crate::machine::{AxisMotion, LinkMotion, Machine, Wheel};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{
    Axes, AxisIndex, Backtrace, Event, EventKind, EventSink, PlanarArc, Position, UnknownAxes,
};
use gcode_lang::units::{Deg, Rpm};
use gcode_part::Flutes;

/// Largest number of moves: an endless loop must not fill the memory.
const MAX_MOVES: usize = 500_000;

/// Passes over each nominal flute for which points are kept.
const KEPT_PASSES_PER_FLUTE: f64 = 40.0;

/// Least and largest number of kept points.
const KEPT_POINTS_RANGE: (f64, f64) = (20_000.0, 1_000_000.0);

/// Factor and minimum for the number of computed points. Motion between two passes takes more points than a short flute.
const COMPUTED_POINTS: (usize, usize) = (4, 400_000);

/// Distance of the points of a pass, mm.
const POINT_SPACING: f64 = 0.05;

/// Distance of the points between two passes, mm.
const COARSE_POINT_SPACING: f64 = 0.25;

/// Rounding error of the arithmetic, mm.
pub(crate) const ROUNDING_ERROR: f64 = 1e-6;

/// Reason for which flutes cannot be tracked on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GrinderError {
    /// The machine has no wheel.
    #[error(
        "the machine file has no [wheel], which grinds the burr: use the machine.toml next to the program"
    )]
    NoWheel,
    /// No axis A rotates the burr.
    #[error(
        "the machine file has no axis A that rotates the burr about its own axis (a [[table]] with turns = \"x\")"
    )]
    NoBurrAxis,
}

/// One pass of the wheel, in contact from end to end.
#[derive(Clone, Debug)]
pub struct GrindingPass {
    /// Path of the contact.
    pub trace: Trace,
    /// Block of its start.
    pub backtrace: Backtrace,
    /// Number of moves.
    pub(crate) moves: usize,
    /// Least and largest angle of the swivelled wheel; `None` if no axis swivels it.
    pub(crate) head_range: Option<(Deg, Deg)>,
    /// Axes of unknown position on the burr in any move.
    pub(crate) unknown_axes: UnknownAxes,
    /// First move with the wheel stopped.
    pub(crate) stopped_wheel: Option<StoppedWheel>,
    /// First move with M04 in force.
    pub(crate) reversed_wheel: Option<FirstOccurrence>,
    /// Speeds of the rotating wheel, each with its first move.
    pub(crate) speeds: Vec<(Rpm, FirstOccurrence)>,
}

/// Passes and other contact of the wheel with a burr.
#[derive(Clone, Debug, Default)]
pub struct GrindingResult {
    /// Passes in order.
    pub passes: Vec<GrindingPass>,
    /// The deepest collision of each block.
    pub(crate) collisions: Vec<WheelCollision>,
    /// Feeds into the blank that lead to a pass.
    pub(crate) plunges: Vec<PlungeFeed>,
    /// Number of rapids before the wheel is first off the blank: their start is unknown, and they are not checked.
    pub(crate) unchecked_rapids: usize,
    /// Rapids whose path is unknown because axes are in machine coordinates.
    pub(crate) unknown_rapids: Option<UnknownRapids>,
    /// Axes of the control.
    pub(crate) axes: Axes,
    /// End of the burr's cylinder relative to the C axis, x and y, by the machine file; `None` if no C rotates about z.
    pub(crate) offset: Option<[f64; 2]>,
    /// Directions of the axes by their letters, 1 or −1.
    pub(crate) signs: Vec<(char, f64)>,
    /// Findings about motion.
    pub findings: Vec<Diagnostic>,
}

/// Sink for the events of a run that tracks the contact on the burr.
#[derive(Debug)]
pub struct FluteTracker<'m> {
    machine: &'m Machine,
    wheel: Wheel,
    /// Axis that rotates the burr about itself.
    burr_axis: AxisIndex,
    /// Axes that move the burr or swivel the wheel, as bits.
    contact_axes: u8,
    flutes: Flutes,
    axis_position: Position,
    moved_axes: MovedAxes,
    current_pass: Option<GrindingPass>,
    result: GrindingResult,
    collisions: CollisionTracker,
    wheel_state: WheelState,
    positions: PositionTracker,
    moves: usize,
    kept_points: usize,
    max_kept_points: usize,
    computed_points: usize,
    max_computed_points: usize,
    /// True once a limit is exceeded: later motion is not checked.
    is_full: bool,
}

impl<'m> FluteTracker<'m> {
    /// Starts with every axis at machine zero.
    ///
    /// # Errors
    /// A machine without a wheel, or without an axis A that rotates the burr.
    pub fn new(machine: &'m Machine, flutes: Flutes) -> Result<Self, GrinderError> {
        let wheel = machine.wheel.ok_or(GrinderError::NoWheel)?;
        let burr_axis = machine.axes.find(b'A').filter(|axis| machine.table.rotary_sign(*axis).is_some());
        let most_kept = (KEPT_PASSES_PER_FLUTE * flutes.length() / POINT_SPACING)
            .clamp(KEPT_POINTS_RANGE.0, KEPT_POINTS_RANGE.1) as usize;
        Ok(Self {
            machine,
            wheel,
            burr_axis: burr_axis.ok_or(GrinderError::NoBurrAxis)?,
            contact_axes: contact_axes(machine, &wheel),
            flutes,
            axis_position: Position::default(),
            moved_axes: MovedAxes::default(),
            current_pass: None,
            result: GrindingResult {
                offset: c_axis_offset(machine),
                signs: axis_signs(machine),
                axes: machine.axes.clone(),
                ..GrindingResult::default()
            },
            collisions: CollisionTracker::default(),
            wheel_state: WheelState::default(),
            positions: PositionTracker::default(),
            moves: 0,
            kept_points: 0,
            max_kept_points: most_kept,
            computed_points: 0,
            max_computed_points: (COMPUTED_POINTS.0 * most_kept).max(COMPUTED_POINTS.1),
            is_full: false,
        })
    }

    /// Ends the run and returns its passes.
    pub fn finish(mut self) -> GrindingResult {
        self.end_pass();
        self.ignore_common_start();
        self.result.unchecked_rapids = self.collisions.unchecked_rapids;
        self.result.plunges = std::mem::take(&mut self.collisions.plunges);
        self.result.collisions = self.collisions.finish();
        self.result.unknown_rapids = self.positions.finish(self.machine);
        self.result
    }

    /// Ignores an unknown angle of the burr about itself if it is unknown in all passes: the flutes count from the first.
    fn ignore_common_start(&mut self) {
        let burr_axis = 1 << self.burr_axis;
        let passes = &mut self.result.passes;
        if passes.iter().all(|pass| pass.unknown_axes.uncommanded & burr_axis != 0) {
            passes.iter_mut().for_each(|pass| pass.unknown_axes = pass.unknown_axes.without(burr_axis));
        }
    }

    fn end_pass(&mut self) {
        self.result.passes.extend(self.current_pass.take());
    }

    /// Reports a limit; later motion is not checked.
    fn report_limit(&mut self, event: &Event<'_>, what: String) {
        self.is_full = true;
        let finding = Diagnostic::new(&LIMIT, format!("{what}: nothing after this is checked"));
        let finding = finding.help(
            "check for a loop that never ends or rotates the burr continuously; otherwise split the program",
        );
        self.result.findings.push(finding.with_backtrace(event.backtrace()));
    }

    fn motion(&mut self, event: &Event<'_>, rapid: bool, to: &Position, arc: Option<&PlanarArc>) {
        let from = self.axis_position;
        self.axis_position = *to;
        if self.is_full || (from == *to && arc.is_none()) {
            return;
        }
        // The rotation of the burr about itself changes no depth. Axes that nothing has commanded yet are those that have not
        // moved.
        let (was, is) = self.positions.advance(self.machine);
        let [was, is] =
            [was, is].map(|axes| UnknownAxes { uncommanded: 0, ..axes.without(1 << self.burr_axis) });
        let before = self.moved_axes;
        self.record_moved_axes(&from, to);
        self.moves += 1;
        if self.moves > MAX_MOVES {
            return self.report_limit(event, format!("more than {MAX_MOVES} moves"));
        }
        if rapid && !was.union(is).is_none() {
            return self.check_unknown_rapid(event, (was, is), to);
        }
        let travel = AxisMotion { from: &from, to, arc };
        let grinds = !rapid && from[self.burr_axis] != to[self.burr_axis];
        let apart = if grinds { POINT_SPACING } else { COARSE_POINT_SPACING };
        let steps = self.step_count(&travel, apart);
        if let Some(steps) = steps.filter(|_| grinds)
            && (self.max_kept_points - self.kept_points) as f64 <= steps
        {
            let what =
                format!("more than {} points of passes, one every {POINT_SPACING} mm", self.max_kept_points);
            return self.report_limit(event, what);
        }
        let Some(path) = steps.and_then(|steps| self.contact_points(&travel, steps)) else {
            let what = format!("more than {} points of the wheel's path", self.max_computed_points);
            return self.report_limit(event, what);
        };
        if !grinds {
            self.end_pass();
            let rotates = from[self.burr_axis] != to[self.burr_axis];
            let mode = match rapid {
                true => MotionMode::Rapid { passes_before: rotates.then_some(self.result.passes.len()) },
                false => MotionMode::Feed { seconds: event.seconds.0 },
            };
            self.collisions.check_motion(&self.flutes, event.backtrace(), mode, self.moved_axes, &path);
            return;
        }
        self.kept_points = self.max_kept_points.min(self.kept_points + path.len());
        self.collisions.enter_cut(before);
        let head = self.wheel.angle(&from).zip(self.wheel.angle(to));
        let pass = self.current_pass.get_or_insert_with(|| GrindingPass {
            trace: Trace::default(),
            backtrace: event.backtrace(),
            moves: 0,
            head_range: None,
            unknown_axes: UnknownAxes::default(),
            stopped_wheel: None,
            reversed_wheel: None,
            speeds: Vec::new(),
        });
        pass.moves += 1;
        pass.unknown_axes = pass.unknown_axes.union(self.positions.unknown_axes().only(self.contact_axes));
        pass.trace.append(&self.flutes, &path, event.seconds.0, event.backtrace());
        self.wheel_state.record(pass, || FirstOccurrence { backtrace: event.backtrace(), point: path[0] });
        if let Some((one, other)) = head {
            let (low, high) = if one < other { (one, other) } else { (other, one) };
            let (least, most) = pass.head_range.unwrap_or((low, high));
            pass.head_range =
                Some((if low < least { low } else { least }, if most < high { high } else { most }));
        }
    }

    /// Checks the end of a rapid from or to an unknown position, if that end is known.
    fn check_unknown_rapid(
        &mut self,
        event: &Event<'_>,
        (was, is): (UnknownAxes, UnknownAxes),
        to: &Position,
    ) {
        self.end_pass();
        self.positions.note_rapid(event, was.union(is));
        if is.is_none() {
            let end = self.machine.contact(&self.wheel, to);
            self.collisions.check_motion(
                &self.flutes,
                event.backtrace(),
                MotionMode::Rapid { passes_before: None },
                self.moved_axes,
                &[end, end],
            );
        }
    }

    /// Records the axes that move; the rotation of the burr about itself changes no depth.
    fn record_moved_axes(&mut self, from: &Position, to: &Position) {
        let axes = self.machine.table.0.iter().map(|link| link.axis).filter(|axis| *axis != self.burr_axis);
        let moved = axes.filter(|axis| from[*axis] != to[*axis]);
        self.moved_axes.0 = moved.fold(self.moved_axes.0, |mask, axis| mask | 1 << axis);
    }

    /// Returns the number of steps of about `apart` mm along a motion; `None` if that takes too many points.
    fn step_count(&mut self, travel: &AxisMotion<'_>, apart: f64) -> Option<f64> {
        // The length is measured first, with points at most 30° apart: after whole revolutions they would coincide.
        let sweep = travel.arc.map_or(Deg::ZERO, |arc| arc.sweep.abs());
        let turn = self.machine.table.total_rotation(travel.from, travel.to) + sweep;
        let first = self.contact_points(travel, (turn.0 / 30.0).ceil().max(16.0))?;
        let length: f64 = first.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        Some((length / apart).ceil().max(4.0))
    }

    /// Returns the contact on the burr along a motion, in an even number of steps; `None` if that makes too many points in
    /// all.
    fn contact_points(&mut self, travel: &AxisMotion<'_>, steps: f64) -> Option<Vec<Point3<f64>>> {
        if (self.max_computed_points.saturating_sub(self.computed_points)) as f64 <= steps + 2.0 {
            return None;
        }
        let steps = (steps as usize).next_multiple_of(2);
        self.computed_points += steps + 1;
        let at = |n: usize| travel.position(n as f64 / steps as f64);
        Some((0..=steps).map(|n| self.machine.contact(&self.wheel, &at(n))).collect())
    }
}

/// Returns the axes that move the burr or swivel the wheel, as bits.
fn contact_axes(machine: &Machine, wheel: &Wheel) -> u8 {
    let carry = machine.table.0.iter().map(|link| link.axis);
    carry.chain(wheel.swivel_axis.map(|(axis, _)| axis)).fold(0, |axes, axis| axes | 1 << axis)
}

/// Returns the part's origin relative to the C axis with all axes at 0.
fn c_axis_offset(machine: &Machine) -> Option<[f64; 2]> {
    let axis = machine.axes.find(b'C')?;
    let link = machine.table.0.iter().find(|link| link.axis == axis)?;
    match &link.motion {
        LinkMotion::Rotary { about, centre } if about.z.abs() == 1.0 => {
            let from = machine.part.origin - centre;
            Some([from.x, from.y])
        }
        LinkMotion::Rotary { .. } | LinkMotion::Linear { .. } => None,
    }
}

/// Returns the directions of the axes that carry the burr, and of the one that swivels the wheel.
fn axis_signs(machine: &Machine) -> Vec<(char, f64)> {
    let carry = machine.table.0.iter().map(|link| {
        let (LinkMotion::Rotary { about: along, .. } | LinkMotion::Linear { along }) = &link.motion;
        (machine.axes.letter(link.axis), link.sign * along.sum().signum())
    });
    let swivels = machine.wheel.and_then(|wheel| wheel.swivel_axis);
    carry.chain(swivels.map(|(axis, sign)| (machine.axes.letter(axis), sign))).collect()
}

impl EventSink for FluteTracker<'_> {
    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            EventKind::Rapid { to } => self.motion(event, true, to, None),
            EventKind::Feed { to, .. } | EventKind::Skip { to, .. } => self.motion(event, false, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, false, to, Some(arc)),
            EventKind::Start { at, unknown } => {
                self.axis_position = *at;
                self.positions.apply_event(self.machine, *unknown);
            }
            EventKind::PositionUnknown { axes } => self.positions.apply_event(self.machine, *axes),
            EventKind::Spindle { .. } | EventKind::Auxiliary { .. } => {
                self.wheel_state.apply_event(event.kind)
            }
            EventKind::Dwell { .. }
            | EventKind::ToolChange { .. }
            | EventKind::ToolLength { .. }
            | EventKind::ToolSelected { .. }
            | EventKind::Coolant { .. }
            | EventKind::Stop { .. } => {}
        }
    }
}
