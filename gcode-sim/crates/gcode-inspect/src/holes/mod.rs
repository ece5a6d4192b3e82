//! Motion → holes: follows the tool on the part and groups feeds along one line to passes, and passes to holes.
mod arc_run;
mod axis_box;
mod bar_shift;
mod below_part;
mod box_tree;
mod chord_run;
mod circles;
mod clamping;
mod clearance;
mod cone_end;
mod core;
mod covered_entries;
mod cut_states;
mod cutting;
mod drill_pass;
#[cfg(test)]
pub(crate) mod event_script;
mod extraction;
mod features_made;
mod feed_law;
mod fine_cuts;
mod finish;
mod gouge_report;
mod group;
mod hole_circles;
mod left_stock;
mod length_mismatch;
mod line;
mod line_findings;
mod line_motion;
mod low_rapid;
mod machine_requests;
mod metal;
mod milled;
mod milled_blocks;
mod milling;
mod near_metal;
mod offset_origin;
mod open_regions;
pub(crate) mod per_block;
mod probing;
mod profile;
mod rapid_paths;
mod rapids;
mod removed_metal;
mod room;
mod shares;
mod slug;
pub(crate) mod spindle;
mod start_holes;
mod strip;
mod strokes;
mod surfaces;
mod swallowed;
mod sweep;
mod swept_tool;
#[cfg(test)]
mod tests;
mod thread_walls;
mod tool_change;
mod turned_body;
mod turning_feed;
pub(crate) mod unknown_axes;
mod unsized_tool;
mod wall_cut;

pub(crate) use clearance::{CONTACT_CLEARANCE, CloseMotion, CloseMotionKind, ROUNDING_ALLOWANCE};
pub(crate) use cone_end::AssumedCone;
pub(crate) use cutting::CutConditions;
pub(crate) use drill_pass::PITCH_TOLERANCE;
pub use drill_pass::{Helix, MilledCut, PassCut, TapRetract};
pub(crate) use extraction::BackBored;
pub use extraction::{AirStroke, HoleExtraction};
pub(crate) use group::MAX_LINE_OFFSET;
pub use group::{DrilledHole, EarlierPass, ToolPass};
pub(crate) use length_mismatch::LengthMismatch;
pub(crate) use machine_requests::unclear_head;
pub(crate) use offset_origin::OffsetOrigin;
pub(crate) use rapid_paths::{OnPath, Search, UnjudgedMotions, UnsearchedMotions};
pub(crate) use swept_tool::ring;
pub(crate) use unknown_axes::{UnknownRapids, unknown_position_finding};

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;

use self::axis_box::SearchBudget;
use self::bar_shift::BarShift;
use self::below_part::LowPlaces;
use self::clearance::CloseMotions;
use self::cutting::{CutConditionsByBlock, CuttingState};
use self::feed_law::Plunge;
use self::line::CuttingLine;
use self::low_rapid::LowRapid;
use self::metal::KnownMetal;
use self::milled::{Engagement, Path};
use self::milled_blocks::MilledBlocks;
use self::milling::Milling;
use self::per_block::Findings;
use self::profile::Profile;
use self::strokes::Strokes;
use self::thread_walls::FlankCut;
use self::tool_change::ChangeRetract;
use self::unknown_axes::PositionTracker;
use self::unsized_tool::{HoleStroke, UnsizedStroke};
use crate::machine::{AxisMotion, Frame, Machine, Pose, RapidPath, Setup, ToolPart};
use gcode_lang::control::Dialect;
use gcode_lang::motion::{
    Backtrace, Event, EventKind, EventSink, PlanarArc, Position, SkipMove, SkipSignal, SpindleDirection,
    StopKind,
};
use gcode_lang::program::m_codes::{self, MCodeEffect};
use gcode_lang::source::Span;
use gcode_lang::units::Rpm;
use gcode_part::{Metal, PartSolid, ProcessLimits, Surface};

/// Largest number of passes that are kept: an endless loop must not fill the memory.
const MAX_PASSES: usize = 200_000;

/// Sink for the events of a run that extracts the holes.
#[derive(Debug)]
pub struct HoleExtractor<'m> {
    machine: &'m Machine,
    surface: Option<Surface>,
    probed: Option<PartSolid>,
    metal: KnownMetal,
    rapid_path: RapidPath,
    axis_position: Position,
    setup: Setup,
    /// Parts of the tool in the spindle; empty if its diameter is unknown.
    tool_body: Vec<ToolPart>,
    /// Parts of it that cut in a feed; `None` if its diameter is unknown.
    profile: Option<Profile>,
    /// Feeds along the tool on the current line.
    plunge: Option<Plunge>,
    /// Strokes of a tool of unknown diameter that have not ended.
    unsized_stroke: Option<UnsizedStroke>,
    /// Strokes in each nominal hole in which a tool of unknown diameter has been, in the order of the program.
    hole_strokes: BTreeMap<usize, Vec<HoleStroke>>,
    /// Number of feeds with a gouge.
    gouge_count: u32,
    /// Ends of the first feeds along the tool that go beside the part.
    feeds_in_air: Vec<(Point3<f64>, Backtrace)>,
    back_bored: Vec<BackBored>,
    /// Cycles that cut nothing.
    cycles_in_air: Findings,
    /// Strokes of these cycles.
    strokes_in_air: u64,
    air_strokes: Vec<AirStroke>,
    cutting_state: CuttingState,
    process_limits: ProcessLimits,
    /// Dialect of the control: which M codes it executes itself.
    dialect: Dialect,
    /// Rapids are checked; they decide no hole.
    checks_rapids: bool,
    /// Frame of the part at `axis_position`.
    frame: Frame,
    /// Pose of the tool on the part.
    pose: Pose,
    /// The spindle has turned with the tool in it.
    has_tool_turned: bool,
    /// True once the tool has stood at a known position; before that it may stand inside the part.
    has_left_start: bool,
    /// Axes whose positions were known in a cut, as bits.
    cut_axes: u8,
    current_line: Option<Box<CuttingLine>>,
    /// Block of the last motion, if metal is known.
    last_block: Option<Backtrace>,
    /// Kind of the last motion, and its block.
    last_motion: Option<(MotionKind, Span)>,
    strokes: Strokes,
    engagement: Engagement,
    positions: PositionTracker,
    findings: Findings,
    close_motions: CloseMotions,
    cut_conditions: CutConditionsByBlock,
    milling: Milling,
    /// Blocks that mill stated pockets.
    milled_blocks: MilledBlocks,
    /// Level feeds into threads, until the holes show which lead in.
    flank_cuts: Vec<FlankCut>,
    length_mismatches: Vec<LengthMismatch>,
    /// Tools that have had a length offset.
    offset_tools: BTreeSet<Option<u32>>,
    /// Block that puts the length offset in force; `None` without an offset.
    offset_origin: Option<OffsetOrigin>,
    /// Block of the last change of the length offset.
    length_change: Option<Span>,
    /// A probing move without a signal has left the tool in the metal.
    is_probe_in_metal: bool,
    probe_count: u64,
    search_budget: SearchBudget,
    /// Motions whose searches for metal have been given up.
    unsearched: BTreeMap<Search, UnsearchedMotions>,
    unjudged: UnjudgedMotions,
    /// The search for the current feed was given up.
    is_feed_unsearched: Cell<bool>,
    bar_shift: BarShift,
    change_retract: ChangeRetract,
    low_rapid: Option<LowRapid>,
    low_places: LowPlaces,
}

/// Kind of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MotionKind {
    Rapid,
    Feed,
    /// A probe moves until its signal; it does not cut.
    Probe,
}

impl<'m> HoleExtractor<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine) -> Self {
        let (axis_position, setup) = (Position::default(), Setup::default());
        let frame = machine.part_frame(&axis_position);
        Self {
            machine,
            surface: None,
            probed: None,
            metal: KnownMetal::new(Metal::default()),
            rapid_path: machine.rapid,
            axis_position,
            setup,
            tool_body: Vec::new(),
            profile: None,
            plunge: None,
            unsized_stroke: None,
            hole_strokes: BTreeMap::new(),
            gouge_count: 0,
            feeds_in_air: Vec::new(),
            back_bored: Vec::new(),
            cycles_in_air: Findings::default(),
            strokes_in_air: 0,
            air_strokes: Vec::new(),
            cutting_state: CuttingState::default(),
            process_limits: ProcessLimits::default(),
            dialect: machine.dialect,
            checks_rapids: true,
            frame,
            pose: machine.tool_pose(&axis_position, &setup).relative_to(&frame),
            has_tool_turned: false,
            has_left_start: false,
            cut_axes: 0,
            current_line: None,
            last_block: None,
            last_motion: None,
            strokes: Strokes::new(MAX_PASSES),
            engagement: Engagement::default(),
            positions: PositionTracker::default(),
            findings: Findings::default(),
            close_motions: CloseMotions::default(),
            cut_conditions: CutConditionsByBlock::default(),
            milling: Milling::default(),
            milled_blocks: MilledBlocks::default(),
            length_mismatches: Vec::new(),
            flank_cuts: Vec::new(),
            offset_tools: BTreeSet::new(),
            offset_origin: None,
            length_change: None,
            is_probe_in_metal: false,
            probe_count: 0,
            search_budget: SearchBudget::default(),
            unsearched: BTreeMap::new(),
            unjudged: UnjudgedMotions::default(),
            is_feed_unsearched: Cell::default(),
            bar_shift: BarShift::default(),
            change_retract: ChangeRetract::default(),
            low_rapid: None,
            low_places: LowPlaces::default(),
        }
    }

    /// Sets the part's surface; motion inside and near it is then checked.
    #[must_use]
    pub fn with_surface(mut self, surface: Option<Surface>) -> Self {
        self.surface = surface;
        self.probed = surface.map(PartSolid::from);
        self.metal = KnownMetal::new(Metal::from(surface));
        self
    }

    /// Sets what is known to be metal; motion in it and near it is then checked.
    #[must_use]
    pub fn with_metal(mut self, metal: Metal) -> Self {
        self.surface = metal.body;
        self.probed = metal.body.and_then(|body| PartSolid::new(body, metal.voids.clone()));
        self.metal = KnownMetal::new(metal);
        self
    }

    /// Takes every rapid as a straight line (LRP).
    #[must_use]
    pub fn with_straight_rapids(mut self, are_straight: bool) -> Self {
        if are_straight {
            self.rapid_path = RapidPath::Straight;
        }
        self
    }

    /// Sets the dialect of the control: which M codes it executes itself.
    #[must_use]
    pub fn with_dialect(mut self, dialect: Dialect) -> Self {
        self.dialect = dialect;
        self
    }

    /// Checks no rapid: for a run of which only the holes count.
    #[must_use]
    pub fn without_rapids(mut self) -> Self {
        self.checks_rapids = false;
        self
    }

    /// Sets the limits of the process with which the motion is compared.
    #[must_use]
    pub fn with_process_limits(mut self, limits: &ProcessLimits) -> Self {
        self.process_limits = limits.clone();
        self.strokes.set_nominal_axes(&limits.hole_axes);
        self
    }

    fn motion(&mut self, event: &Event<'_>, kind: MotionKind, to: &Position, arc: Option<&PlanarArc>) {
        let from = self.axis_position;
        if self.metal.is_known() {
            self.last_block = Some(event.backtrace());
        }
        self.check_idle_axes(event, &from, to);
        self.check_clamp_released(event, &from, to);
        let last_motion = self.last_motion.replace((kind, event.block));
        if kind != MotionKind::Rapid {
            self.change_retract.end();
        }
        let before = self.pose;
        let travel = AxisMotion { from: &from, to, arc };
        let is_rotating = !self.machine.is_straight(&AxisMotion { arc: None, ..travel });
        if is_rotating {
            self.end_engagement();
        }
        if self.machine.table.is_moved(&from, to) {
            self.frame = self.machine.part_frame(to);
        }
        self.axis_position = *to;
        self.pose = self.machine.tool_pose(to, &self.setup).relative_to(&self.frame);
        let (was, is) = self.positions.advance(self.machine);
        let kind = match kind {
            MotionKind::Probe if was.union(is).is_none() && !is_rotating => {
                self.kind_of_probing(event, &before.tip)
            }
            MotionKind::Feed | MotionKind::Rapid
                if self.is_probe() && was.union(is).is_none() && !is_rotating =>
            {
                self.kind_of_probe_motion(event, kind, &before.tip)
            }
            kind => kind,
        };
        let kind = if self.follow_unstopped_probe() { MotionKind::Probe } else { kind };
        if kind == MotionKind::Rapid && self.has_unknown_tip((&from, &before.tip), to) {
            self.unjudged.rapids_of_unknown_tip.count(|| event.backtrace());
            self.change_retract.end();
            self.report_low_rapid();
            self.end_line(Some(kind));
            self.end_engagement();
            self.update_start();
            return;
        }
        if !was.union(is).is_none() && kind != MotionKind::Feed {
            self.change_retract.end();
            self.report_low_rapid();
            self.report_unknown_rapid(event, kind, &travel, &before.tip, (was, is));
            if kind == MotionKind::Rapid && is.is_none() {
                self.follow_below_part(event);
            }
            // With the same axes unknown the motion itself is known.
            match was == is && !is_rotating {
                true => self.disengage(&before.tip),
                false => self.end_engagement(),
            }
            return;
        }
        if kind != MotionKind::Probe {
            self.follow_below_part(event);
        }
        if is_rotating || arc.is_some() {
            self.end_line(Some(kind));
            match kind {
                MotionKind::Rapid => self.check_rapid_motion(event, (&from, to), None, &before.tip),
                MotionKind::Feed => {
                    let is_known = was.union(is).is_none();
                    if !is_rotating {
                        self.remove_by_arc(event, &travel, is_known);
                    }
                    let is_allowed = is_rotating && self.remove_while_turning(event, &travel, is_known);
                    if !is_allowed && !self.check_curved(event, &travel, kind) && is_rotating {
                        self.check_turning_feed(event, (&from, to));
                    }
                    let arc = self.part_arc(&travel, &before.tip);
                    self.engagement.add_unknown_axes(was.union(is));
                    self.engage(event, &before.tip, Path::Curved(arc));
                }
                MotionKind::Probe => {}
            }
            self.update_start();
            return;
        }
        if (self.pose.tip - before.tip).norm() < 1e-9 {
            return;
        }
        if kind != MotionKind::Rapid || !self.check_rapid_into_thread(event, &before.tip) {
            self.check_thread_wall(event, &[before.tip, self.pose.tip]);
        }
        self.follow_low_rapid(event, kind, &before.tip);
        let free_from = self.update_line(event, kind, before.tip);
        self.follow_bar_shift(event, kind, &before.tip);
        match (kind, free_from) {
            (MotionKind::Rapid, start) => self.check_rapid_motion(event, (&from, to), start, &before.tip),
            (MotionKind::Feed, start) => {
                // What a feed cuts is recorded before it is removed.
                if let Some(start) = start {
                    self.begin_plunge();
                    self.start_line(event, start, last_motion);
                }
                self.remove_by_feed(event, &[before.tip, self.pose.tip], was.union(is).is_none());
            }
            (MotionKind::Probe, _) => {}
        }
        match kind {
            MotionKind::Feed => self.engage(event, &before.tip, Path::Straight),
            MotionKind::Rapid | MotionKind::Probe => self.disengage(&before.tip),
        }
        if self.strokes.has_across() {
            self.check_upright(&from);
        }
        self.update_start();
    }
}

impl EventSink for HoleExtractor<'_> {
    fn skip_signal(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        self.signal_of_probe(feed)
    }

    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            EventKind::Rapid { to } => self.motion(event, MotionKind::Rapid, to, None),
            EventKind::Feed { to, .. } => self.motion(event, MotionKind::Feed, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, MotionKind::Feed, to, Some(arc)),
            EventKind::Skip { to, .. } => self.probe(event, to),
            EventKind::ToolSelected { number } => self.cutting_state.selected_tool = Some(*number),
            EventKind::ToolChange { number } => self.change_tool(event, *number),
            EventKind::ToolLength { offset, wear, compensation } => {
                self.update_setup(|setup| (setup.offset, setup.wear) = (*offset, *wear));
                self.apply_compensation(event, *compensation);
            }
            EventKind::Start { at, unknown } => {
                self.axis_position = *at;
                self.frame = self.machine.part_frame(at);
                self.pose = self.machine.tool_pose(at, &self.setup).relative_to(&self.frame);
                self.positions.apply_event(self.machine, *unknown);
                self.update_start();
            }
            EventKind::PositionUnknown { axes } => {
                self.positions.apply_event(self.machine, *axes);
                self.update_outside();
            }
            EventKind::Spindle { direction, speed, is_rigid, is_oriented } => {
                // S0 stops the spindle.
                let before = self.cutting_state.spindle_direction;
                self.cutting_state.spindle_direction =
                    if *speed == Rpm(0.0) { SpindleDirection::Off } else { *direction };
                self.cutting_state.speed = *speed;
                self.cutting_state.apply_rigid(*is_rigid);
                self.has_tool_turned |= self.cutting_state.spindle_direction != SpindleDirection::Off;
                self.update_spindle_in_hole(before);
                self.bar_shift.is_oriented = *is_oriented;
                self.cutting_state.builder_code = None;
            }
            EventKind::Stop { kind: StopKind::Message, text, variables } => {
                if let Some(angle) = self.operator_head_angle(event, text, variables) {
                    self.update_setup(|setup| setup.head_angle = Some(angle));
                }
            }
            EventKind::Auxiliary { code } => {
                let is_output =
                    matches!(m_codes::find(*code, self.dialect), Some(MCodeEffect::Output { .. }));
                if !self.apply_clamp_code(*code) && !is_output {
                    self.cutting_state.builder_code = Some(*code);
                }
            }
            EventKind::Stop { .. } | EventKind::Dwell { .. } | EventKind::Coolant { .. } => {}
        }
    }
}
