//! Motion → holes: follows the tool on the part, sees feeds along one line as passes, and passes as holes.
use gcode_lang::alarm::kinds::LIMIT;
mod clamping;
mod clearance;
mod cutting;
#[cfg(test)]
pub(crate) mod event_script;
mod findings;
mod group;
mod length_mismatch;
mod line;
mod line_findings;
mod machine_requests;
pub(crate) mod per_block;
mod probing;
mod rapids;
pub(crate) mod spindle;
#[cfg(test)]
mod tests;
pub(crate) mod work_zero;

use nalgebra::Point3;

pub use clearance::{CONTACT_CLEARANCE, CloseMotion, CloseMotionKind, ROUNDING_ALLOWANCE};
pub use cutting::CutConditions;
use group::DrillPass;
pub use group::DrilledHole;
pub use length_mismatch::LengthMismatch;
use line::{CuttingLine, ToolExit};
pub use machine_requests::unclear_head;
pub use work_zero::UnknownWorkZero;

use self::clamping::ClampState;
use self::clearance::CloseMotions;
use self::cutting::{CutConditionsByBlock, CuttingState};
use self::findings::Findings;
use self::length_mismatch::LengthMismatches;
use self::rapids::{CurvedMotion, TOUCH_DEPTH};
use self::work_zero::WorkZeroTracker;
use crate::machine::path::AxisMotion;
use crate::machine::{Frame, Machine, Pose, Setup};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{
    Backtrace, Event, EventKind, EventSink, PlanarArc, Position, SkipMove, SkipSignal, SpindleDirection,
    StopKind,
};
use gcode_lang::source::Span;
use gcode_lang::units::Rpm;
use gcode_part::ProcessLimits;
use gcode_part::Surface;
use gcode_part::{Hole, HoleList, Origin, Unit};

/// More passes than this aren't kept: no part has so many holes, but a loop that never ends drills them, and must not
/// fill the memory.
const MAX_PASSES: usize = 200_000;

/// What a program does to the part.
#[derive(Clone, Debug, Default)]
pub struct HoleExtraction {
    /// In the order in which they were begun.
    pub holes: Vec<DrilledHole>,
    pub findings: Vec<Diagnostic>,
    /// What passes near the part, where the part's surface is known.
    pub close_motions: Vec<CloseMotion>,
    /// What was in force where the tool cut.
    pub cut_conditions: Vec<CutConditions>,
    /// Feeds of tools whose lengths aren't those that the control reckons with.
    pub length_mismatches: Vec<LengthMismatch>,
    /// Rapids whose way over the part isn't known.
    pub unknown_work_zero: Option<UnknownWorkZero>,
    /// What the motion was looked at for.
    pub process_limits: ProcessLimits,
}

/// Listens to a run and collects the holes it makes.
#[derive(Debug)]
pub struct HoleExtractor<'m> {
    machine: &'m Machine,
    surface: Option<Surface>,
    axis_position: Position,
    setup: Setup,
    cutting_state: CuttingState,
    /// The last M code since M03, M04 or M05 that went to the machine builder's logic, which may have started the spindle.
    builder_code: Option<u32>,
    process_limits: ProcessLimits,
    clamp_state: ClampState,
    /// The part's place while the table stands as it does in `at`.
    frame: Frame,
    /// The tool on the part.
    pose: Pose,
    /// The tool has been outside the part: what it does before that, nobody knows where it stood.
    has_been_outside: bool,
    current_line: Option<Box<CuttingLine>>,
    passes: Vec<DrillPass>,
    /// As many passes are kept.
    max_passes: usize,
    /// The first of the passes that were too many.
    first_excess_pass: Option<Backtrace>,
    work_zero: WorkZeroTracker,
    findings: Findings,
    close_motions: CloseMotions,
    cut_conditions: CutConditionsByBlock,
    length_mismatches: LengthMismatches,
    /// How many times a probe was sent to the part.
    probe_count: u64,
}

/// How a motion was asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum MotionKind {
    Rapid,
    Feed,
    /// Neither cuts nor hurries: a probe looks for its signal.
    Probe,
}

impl<'m> HoleExtractor<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine) -> Self {
        let (at, setup) = (Position::default(), Setup::default());
        let frame = machine.part_frame(&at);
        let pose = machine.tool_pose(&at, &setup).relative_to(&frame);
        Self {
            machine,
            surface: None,
            axis_position: at,
            setup,
            cutting_state: CuttingState::default(),
            builder_code: None,
            process_limits: ProcessLimits::default(),
            clamp_state: ClampState::default(),
            frame,
            pose,
            has_been_outside: false,
            current_line: None,
            passes: Vec::new(),
            max_passes: MAX_PASSES,
            first_excess_pass: None,
            work_zero: WorkZeroTracker::default(),
            findings: Findings::default(),
            close_motions: CloseMotions::default(),
            cut_conditions: CutConditionsByBlock::default(),
            length_mismatches: LengthMismatches::default(),
            probe_count: 0,
        }
    }

    /// With the part's surface known, motion inside it is seen as well.
    #[must_use]
    pub fn with_surface(mut self, surface: Option<Surface>) -> Self {
        self.surface = surface;
        self
    }

    /// With what the reference says of how the part is to be worked, the motion is held against that as well.
    #[must_use]
    pub fn with_process_limits(mut self, conduct: &ProcessLimits) -> Self {
        self.process_limits = conduct.clone();
        self
    }

    pub fn finish(mut self) -> HoleExtraction {
        if let Some(line) = self.current_line.take() {
            let after = line.curved_exit();
            self.report_line(line, after, false);
        }
        let mut findings = self.findings.finish();
        findings.extend(self.first_excess_pass.map(|place| {
            let message =
                format!("more than {MAX_PASSES} feeds into the part: nothing after this is checked");
            let finding = Diagnostic::new(&LIMIT, message).with_backtrace(place);
            finding.help("check for a loop that never ends; otherwise split the program")
        }));
        let holes = group::group_holes(&self.passes, self.machine);
        HoleExtraction {
            holes,
            findings,
            close_motions: self.close_motions.finish(),
            cut_conditions: self.cut_conditions.finish(),
            length_mismatches: self.length_mismatches.finish(),
            unknown_work_zero: self.work_zero.finish(self.machine),
            process_limits: self.process_limits,
        }
    }

    fn push_passes(&mut self, passes: impl IntoIterator<Item = DrillPass>) {
        for pass in passes {
            if self.passes.len() < self.max_passes {
                self.passes.push(pass);
            } else if self.first_excess_pass.is_none() {
                self.first_excess_pass = Some(pass.backtrace);
            }
        }
    }

    fn motion(&mut self, event: &Event<'_>, kind: MotionKind, to: &Position, arc: Option<&PlanarArc>) {
        let from = self.axis_position;
        self.check_idle_axes(event, &from, to);
        self.check_clamp_released(event, &from, to);
        let before = self.pose;
        if self.machine.table.is_moved(&from, to) {
            self.frame = self.machine.part_frame(to);
        }
        self.axis_position = *to;
        self.pose = self.machine.tool_pose(to, &self.setup).relative_to(&self.frame);
        let (was, is) = self.work_zero.advance();
        if was | is != 0 && kind != MotionKind::Feed {
            self.report_unknown_rapid(event, &before.tip, (was, is));
            return;
        }
        let travel = AxisMotion { from: &from, to, arc };
        if !self.machine.is_straight(&travel) {
            self.end_line_on_curve(event, kind, &travel);
            return;
        }
        if (self.pose.tip - before.tip).norm() < 1e-9 {
            return;
        }
        let free_from = self.update_line(event, kind, before.tip);
        match (kind, free_from) {
            (MotionKind::Rapid, Some(start)) => self.check_rapid(event, &start, &self.pose.tip.clone()),
            (MotionKind::Feed, Some(start)) => self.start_line(event, start),
            _ => {}
        }
        self.update_outside();
    }

    /// Follows a straight motion from `from` on the current line. Where it has left the line, or there is none:
    /// the point from which it moved freely.
    fn update_line(&mut self, event: &Event<'_>, kind: MotionKind, from: Point3<f64>) -> Option<Point3<f64>> {
        let Some(mut line) = self.current_line.take() else { return Some(from) };
        let tip = self.pose.tip;
        if kind == MotionKind::Rapid && line.is_overrun(&tip) {
            if line.is_bar_shifted() {
                self.report_back_boring(&line);
            } else {
                self.report_overrun(event, &line, &tip);
            }
            return Some(from);
        }
        let is_spindle_stopped =
            kind == MotionKind::Rapid && self.cutting_state.spindle_direction == SpindleDirection::Off;
        if is_spindle_stopped && line.is_inward() && line.try_bar_shift(&tip) {
            self.current_line = Some(line);
            return None;
        }
        match line.exit_after(&from, &tip) {
            ToolExit::OnLine => {
                let again = match kind {
                    MotionKind::Feed => {
                        if line.depth_of(&from) < line.depth_of(&tip) {
                            self.record_line_feed(event, &mut line);
                        }
                        line.feed_to(&tip, event.backtrace(), &self.axis_position)
                    }
                    MotionKind::Rapid | MotionKind::Probe => {
                        let (again, uncut) = line.rapid_to(&tip);
                        if uncut {
                            self.report_rapid_beyond_cut(event, &line);
                        }
                        again
                    }
                };
                self.push_passes(again);
                self.current_line = Some(line);
                None
            }
            after @ (ToolExit::AlongLine | ToolExit::Sideways { .. }) => {
                if is_spindle_stopped && !line.is_inward() && after != ToolExit::AlongLine {
                    self.report_back_boring(&line);
                }
                let free =
                    if after == ToolExit::AlongLine { line.start_level_crossing(&from, &tip) } else { from };
                self.report_line(line, after, kind == MotionKind::Feed);
                Some(free)
            }
        }
    }

    fn start_line(&mut self, event: &Event<'_>, start: Point3<f64>) {
        let rounding = self.machine.increment.size() / 2.0;
        let line = CuttingLine::begin(start, self.pose.tip, event.backtrace(), self.axis_position, rounding);
        self.current_line = line.map(|line| {
            let mut line = Box::new(line);
            line.tool_axis = self.pose.axis;
            line.cutting_state = CuttingState { tool: self.setup.tool, ..self.cutting_state };
            line.clamp_state = self.clamp_state;
            line.unknown_work_zero_axes = self.work_zero.unknown_axes();
            line.length_excess = self.length_excess();
            line.surface_depth =
                self.surface.and_then(|s| s.exit(&line.bottom(), &line.out)).map(|p| line.depth_of(&p));
            self.record_line_feed(event, &mut line);
            line
        });
    }

    /// How fast a feed inwards is, where it cuts: the way to the part may be fed faster.
    fn record_line_feed(&self, event: &Event<'_>, line: &mut CuttingLine) {
        let cuts = self.surface.is_none_or(|surface| surface.is_deeper(&self.pose.tip, TOUCH_DEPTH));
        if let EventKind::Feed { rate, .. } = event.kind
            && cuts
        {
            line.record_feed(*rate);
        }
    }

    /// The table or the head turns, or an arc: the tool's way on the part is curved.
    fn end_line_on_curve(&mut self, event: &Event<'_>, kind: MotionKind, travel: &AxisMotion<'_>) {
        if let Some(line) = self.current_line.take() {
            let after = line.curved_exit();
            self.report_line(line, after, kind == MotionKind::Feed);
        }
        match kind {
            MotionKind::Rapid => self.check_curved(event, travel, CurvedMotion::Rapid),
            MotionKind::Feed => self.check_curved(event, travel, CurvedMotion::Feed),
            MotionKind::Probe => {}
        }
        self.update_outside();
    }

    fn update_outside(&mut self) {
        if let (false, true, Some(surface)) =
            (self.has_been_outside, self.work_zero.unknown_axes() == 0, &self.surface)
        {
            self.has_been_outside = surface.value(&self.pose.tip) > 0.0;
        }
    }

    /// Something other than an axis changes where the tool is, or which tool it is.
    fn update_setup(&mut self, change: impl FnOnce(&mut Setup)) {
        let before = self.setup;
        change(&mut self.setup);
        if self.setup == before {
            return;
        }
        if let Some(line) = self.current_line.take() {
            let after = line.curved_exit();
            self.report_line(line, after, false);
        }
        self.pose = self.machine.tool_pose(&self.axis_position, &self.setup).relative_to(&self.frame);
    }
}

impl EventSink for HoleExtractor<'_> {
    fn skip_signal(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        self.probe(feed)
    }

    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            EventKind::Rapid { to } => self.motion(event, MotionKind::Rapid, to, None),
            EventKind::Feed { to, .. } => self.motion(event, MotionKind::Feed, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, MotionKind::Feed, to, Some(arc)),
            EventKind::Skip { to, .. } => self.motion(event, MotionKind::Probe, to, None),
            EventKind::ToolChange { number } => {
                self.check_tool_known(event, *number);
                self.update_setup(|setup| setup.tool = Some(*number));
            }
            EventKind::ToolLength { offset, compensation: by } => {
                self.update_setup(|setup| setup.offset = *offset);
                self.cutting_state.compensation = *by;
            }
            EventKind::WorkZeroUnknown { axes } => self.work_zero.apply_event(self.machine, *axes),
            EventKind::Spindle { direction: turning, speed } => {
                // At S0 it stands.
                let before = self.cutting_state.spindle_direction;
                self.cutting_state.spindle_direction =
                    if *speed == Rpm(0.0) { SpindleDirection::Off } else { *turning };
                self.cutting_state.speed = *speed;
                self.update_spindle_in_hole(before);
                self.builder_code = None;
            }
            EventKind::Stop { kind: StopKind::Message, text, variables: named } => {
                if let Some(angle) = self.operator_head_angle(event, text, named) {
                    self.update_setup(|setup| setup.head_angle = Some(angle));
                }
            }
            EventKind::Auxiliary { code } => {
                if !self.apply_clamp_code(*code) {
                    self.builder_code = Some(*code);
                }
            }
            EventKind::Stop { .. } | EventKind::Dwell { .. } | EventKind::Coolant { .. } => {}
        }
    }
}

impl HoleExtraction {
    /// The document that `holes` writes; `locate` names the program and the line of a block.
    pub fn list(&self, locate: impl Fn(Span) -> (String, u32)) -> HoleList {
        let holes = self.holes.iter().map(|found| found.hole(&locate)).collect();
        HoleList { unit: Unit::Mm, holes }
    }
}

impl DrilledHole {
    /// In the schema that references have too; the program alone gives no id.
    pub fn hole(&self, locate: impl Fn(Span) -> (String, u32)) -> Hole {
        let (program, line) = locate(self.backtrace.block);
        Hole {
            id: None,
            entry: self.entry.coords.into(),
            axis: self.axis.into_inner().into(),
            depth: self.depth,
            diameter: self.diameter,
            from: Some(Origin { program, line, tool: self.tool }),
        }
    }
}
