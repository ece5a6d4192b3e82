//! Motion → flutes: follows a grinder's wheel on the burr and tells grinding from approach, retract and indexing.
//!
//! Feeds that turn A are grinding moves; whatever else moves lies between two passes.
mod trace;
mod wheel_collisions;
mod wheel_state;

use nalgebra::Point3;

pub use trace::wrap_angle;
pub use trace::{Sample, Trace, Window};
pub use wheel_collisions::{CollisionKind, PlungeFeed, WheelCollision};
use wheel_collisions::{CollisionTracker, MotionMode, MovedAxes};
use wheel_state::WheelState;
pub use wheel_state::{FirstOccurrence, StoppedWheel};

use crate::holes::UnknownWorkZero;
use crate::holes::work_zero::WorkZeroTracker;
use crate::machine::path::AxisMotion;
use crate::machine::{LinkMotion, Machine, Wheel};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{AxisIndex, Backtrace, Event, EventKind, EventSink, PlanarArc, Position};
use gcode_lang::units::{Deg, Rpm};
use gcode_part::Flutes;

/// More moves than this aren't kept: no burr has so many, but a loop that never ends makes them.
const MAX_MOVES: usize = 500_000;
/// Points are kept of all passes together for so many goes over every wanted flute: no burr is ground in as many, …
const KEPT_PASSES_PER_FLUTE: f64 = 40.0;
/// … but for so many at least, and never for more than this.
const KEPT_POINTS_RANGE: (f64, f64) = (20_000.0, 1_000_000.0);
/// So many times as many are computed in all, those between the passes included, and so many at least: turning and going
/// round between two passes takes more of them than a short flute has.
const COMPUTED_POINTS: (usize, usize) = (4, 400_000);

/// How far apart the points of a pass are, and those between two passes, mm.
const POINT_SPACING: f64 = 0.05;
const COARSE_POINT_SPACING: f64 = 0.25;

/// What is left of the arithmetic's own rounding, mm.
pub const ROUNDING_ERROR: f64 = 1e-6;

/// Why flutes can't be followed on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GrinderError {
    #[error(
        "the machine file has no [wheel], which grinds the burr: use the machine.toml next to the program"
    )]
    NoWheel,
    #[error(
        "the machine file has no axis A that rotates the burr about its own axis (a [[table]] with turns = \"x\")"
    )]
    NoBurrAxis,
}

/// One pass of the wheel, in contact from end to end.
#[derive(Clone, Debug)]
pub struct GrindingPass {
    pub trace: Trace,
    /// Where it begins.
    pub backtrace: Backtrace,
    pub moves: usize,
    /// The least and the greatest angle of the swivelled wheel during the pass, where an axis swivels it.
    pub head_range: Option<(Deg, Deg)>,
    /// The first of its moves during which the wheel stood, and the first with M04 in force.
    pub stopped_wheel: Option<StoppedWheel>,
    pub reversed_wheel: Option<FirstOccurrence>,
    /// The speeds of the turning wheel, each from the move on that is the first with it.
    pub speeds: Vec<(Rpm, FirstOccurrence)>,
}

/// What a program does to a burr.
#[derive(Clone, Debug, Default)]
pub struct GrindingResult {
    pub passes: Vec<GrindingPass>,
    /// The deepest of each block.
    pub collisions: Vec<WheelCollision>,
    /// The feeds into the blank behind which a pass begins.
    pub plunges: Vec<PlungeFeed>,
    /// Rapids before the wheel first stood off the blank: where they began nobody knows, and nothing is said of them.
    pub unchecked_rapids: usize,
    /// Rapids whose way isn't known because axes are sent to machine coordinates.
    pub unknown_work_zero: Option<UnknownWorkZero>,
    /// From the C axis to the end of the burr's cylinder, x and y, as the machine file has it; `None` without a C that turns
    /// about z.
    pub offset: Option<[f64; 2]>,
    /// Which way the axes run, by their letters: 1 or −1.
    pub signs: Vec<(char, f64)>,
    pub findings: Vec<Diagnostic>,
}

/// Listens to a run and follows the contact on the burr.
#[derive(Debug)]
pub struct FluteTracker<'m> {
    machine: &'m Machine,
    wheel: Wheel,
    /// The axis that turns the burr about itself.
    burr_axis: AxisIndex,
    flutes: Flutes,
    axis_position: Position,
    moved_axes: MovedAxes,
    current_pass: Option<GrindingPass>,
    result: GrindingResult,
    collisions: CollisionTracker,
    wheel_state: WheelState,
    work_zero: WorkZeroTracker,
    moves: usize,
    /// Points kept of passes, and computed at all, and the most that may be.
    kept_points: usize,
    max_kept_points: usize,
    computed_points: usize,
    max_computed_points: usize,
    /// No more is looked at, and that is told.
    is_full: bool,
}

impl<'m> FluteTracker<'m> {
    /// Starts with every axis at machine zero.
    ///
    /// # Errors
    /// A machine without a wheel, or without an A that turns the burr.
    pub fn new(machine: &'m Machine, flutes: Flutes) -> Result<Self, GrinderError> {
        let wheel = machine.wheel.ok_or(GrinderError::NoWheel)?;
        let turns = machine.axes.find(b'A').filter(|axis| {
            let of_axis = |link: &&crate::machine::AxisLink| link.axis == *axis;
            machine
                .table
                .0
                .iter()
                .find(of_axis)
                .is_some_and(|l| matches!(l.motion, LinkMotion::Rotary { .. }))
        });
        let most_kept = (KEPT_PASSES_PER_FLUTE * flutes.length() / POINT_SPACING)
            .clamp(KEPT_POINTS_RANGE.0, KEPT_POINTS_RANGE.1) as usize;
        Ok(Self {
            machine,
            wheel,
            burr_axis: turns.ok_or(GrinderError::NoBurrAxis)?,
            flutes,
            axis_position: Position::default(),
            moved_axes: MovedAxes::default(),
            current_pass: None,
            result: GrindingResult {
                offset: c_axis_offset(machine),
                signs: axis_signs(machine),
                ..GrindingResult::default()
            },
            collisions: CollisionTracker::default(),
            wheel_state: WheelState::default(),
            work_zero: WorkZeroTracker::default(),
            moves: 0,
            kept_points: 0,
            max_kept_points: most_kept,
            computed_points: 0,
            max_computed_points: (COMPUTED_POINTS.0 * most_kept).max(COMPUTED_POINTS.1),
            is_full: false,
        })
    }

    pub fn finish(mut self) -> GrindingResult {
        self.end_pass();
        self.result.unchecked_rapids = self.collisions.unchecked_rapids;
        self.result.plunges = std::mem::take(&mut self.collisions.plunges);
        self.result.collisions = self.collisions.finish();
        self.result.unknown_work_zero = self.work_zero.finish(self.machine);
        self.result
    }

    fn end_pass(&mut self) {
        self.result.passes.extend(self.current_pass.take());
    }

    /// Tells once that nothing is looked at from here on.
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
        let (was, is) = self.work_zero.advance();
        let before = self.moved_axes;
        self.record_moved_axes(&from, to);
        self.moves += 1;
        if self.moves > MAX_MOVES {
            return self.report_limit(event, format!("more than {MAX_MOVES} moves"));
        }
        if rapid && was | is != 0 {
            return self.check_unknown_rapid(event, (was, is), to);
        }
        let travel = AxisMotion { from: &from, to, arc };
        let grinds = !rapid && from[self.burr_axis] != to[self.burr_axis];
        let apart = if grinds { POINT_SPACING } else { COARSE_POINT_SPACING };
        let Some(steps) = self.step_count(&travel, apart) else {
            return self.report_limit(
                event,
                format!("more than {} points of the wheel's path", self.max_computed_points),
            );
        };
        if grinds && (self.max_kept_points - self.kept_points) as f64 <= steps {
            let what =
                format!("more than {} points of passes, one every {POINT_SPACING} mm", self.max_kept_points);
            return self.report_limit(event, what);
        }
        let Some(path) = self.contact_points(&travel, steps) else {
            return self.report_limit(
                event,
                format!("more than {} points of the wheel's path", self.max_computed_points),
            );
        };
        if !grinds {
            self.end_pass();
            let turns = (from[self.burr_axis] != to[self.burr_axis]).then_some(self.result.passes.len());
            let by = match rapid {
                true => MotionMode::Rapid { passes_before: turns },
                false => MotionMode::Feed { seconds: event.seconds.0 },
            };
            self.collisions.check_motion(&self.flutes, event.backtrace(), by, self.moved_axes, &path);
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
            stopped_wheel: None,
            reversed_wheel: None,
            speeds: Vec::new(),
        });
        pass.moves += 1;
        pass.trace.append(&self.flutes, &path, event.seconds.0, event.backtrace());
        self.wheel_state.record(pass, || FirstOccurrence { backtrace: event.backtrace(), point: path[0] });
        if let Some((one, other)) = head {
            let (low, high) = if one < other { (one, other) } else { (other, one) };
            let (least, most) = pass.head_range.unwrap_or((low, high));
            pass.head_range =
                Some((if low < least { low } else { least }, if most < high { high } else { most }));
        }
    }

    /// A rapid from or to where nobody knows: only an end that is known is looked at.
    fn check_unknown_rapid(&mut self, event: &Event<'_>, (was, is): (u8, u8), to: &Position) {
        self.end_pass();
        self.work_zero.note_rapid(event, was | is);
        if is == 0 {
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

    /// Notes which axes move; how far the burr is turned about itself, no depth depends on.
    fn record_moved_axes(&mut self, from: &Position, to: &Position) {
        let axes = self.machine.table.0.iter().map(|link| link.axis).filter(|axis| *axis != self.burr_axis);
        let moved = axes.filter(|axis| from[*axis] != to[*axis]);
        self.moved_axes.0 = moved.fold(self.moved_axes.0, |mask, axis| mask | 1 << axis);
    }

    /// In how many steps a motion is looked at, so that no two points are farther apart than about `apart` mm; `None`
    /// where telling that takes too many of them.
    fn step_count(&mut self, travel: &AxisMotion<'_>, apart: f64) -> Option<f64> {
        // The length is measured first: by points a twelfth of a turn apart, for after whole turns all are in one place.
        let sweep = travel.arc.map_or(Deg::ZERO, |arc| arc.sweep.abs());
        let turn = self.machine.table.total_rotation(travel.from, travel.to) + sweep;
        let first = self.contact_points(travel, (turn.0 / 30.0).ceil().max(16.0))?;
        let length: f64 = first.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        Some((length / apart).ceil().max(4.0))
    }

    /// The contact on the burr in so many steps along a motion, one more if that is odd; `None` where that makes too
    /// many of them in all.
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

/// From the C axis to the part's origin while all axes stand at 0.
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

/// Of the axes that carry the burr, and of the one that swivels the wheel.
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
            // How far the burr is turned about itself, no depth depends on.
            EventKind::WorkZeroUnknown { axes } => {
                self.work_zero.apply_event(self.machine, axes & !(1 << self.burr_axis))
            }
            EventKind::Spindle { .. } | EventKind::Auxiliary { .. } => {
                self.wheel_state.apply_event(event.kind)
            }
            EventKind::Dwell { .. }
            | EventKind::ToolChange { .. }
            | EventKind::ToolLength { .. }
            | EventKind::Coolant { .. }
            | EventKind::Stop { .. } => {}
        }
    }
}
