//! Which strokes drill: a tool that mills, or a feed along another line than the tool's, makes no hole by going there and
//! back.
use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::arc_run::Ring;
use super::drill_pass::{DrillPass, PassCut};
use super::group::MAX_LINE_OFFSET;
use super::line::CuttingLine;
use super::per_block::with_count_note;
use super::start_holes::StartHoles;
use crate::findings::{FEED_NO_HOLE, FEED_WITHOUT_RETRACT};
use crate::machine::{COS_30, Machine, ToolKind};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, Position};
use gcode_part::{MAX_BREAK_THROUGH, NominalAxes, NominalAxis, PARALLEL_COSINE};

/// Differences of height that come from rounding, mm.
pub(super) const LEVEL_TOLERANCE: f64 = 0.003;

/// Sine of the largest angle between a stroke and the plane square to Z: 0.5°.
const MAX_SQUARE_SINE: f64 = 0.01;

/// Cosine of the largest angle between Z and a stroke along an upright tool: 2.5°.
const MIN_UPRIGHT_COSINE: f64 = 0.999;

/// Cosine of the largest angle between a stroke and a known tool axis: 30°. A larger one is milling.
pub(super) const MIN_TOOL_COSINE: f64 = COS_30;

/// Largest distance of a stroke of a mill from the nominal axis on which it drills, mm.
const MAX_AXIS_DISTANCE: f64 = 1.0;

/// Origin of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) enum CutKind {
    /// A stroke of a cycle, one in a known surface, or a milled circle: it is a hole's.
    Drilled,
    /// A stroke along the tool.
    AlongTool {
        /// True if a rapid leads to it and another one away.
        is_between_rapids: bool,
    },
    /// A stroke square to Z while the direction of the tool is unknown: the head may be tilted.
    Across {
        /// True if a rapid leads to it and another one away.
        is_between_rapids: bool,
    },
    /// A stroke oblique to the tool.
    Oblique,
    /// A stroke of a mill square to its known direction: it makes no hole.
    Side,
}

/// Passes, and strokes for which later motion decides.
#[derive(Debug, Default)]
pub(super) struct Strokes {
    /// Passes of holes; the order of each is that among all strokes.
    passes: Vec<DrillPass>,
    /// Strokes along the current tool, true between rapids.
    along_tool: Vec<(u32, DrillPass, bool)>,
    /// Strokes across the upright tool, those of the current tool from `across_begin`.
    across: Vec<(u32, DrillPass)>,
    across_begin: usize,
    /// Strokes at nominal holes along which the tool doesn't retract.
    unretracted: Vec<(u32, DrillPass)>,
    next: u32,
    max_passes: usize,
    /// First pass beyond `max_passes`.
    first_excess: Option<Backtrace>,
    /// Lowest feed across the current tool, by its height along the tool; `None` without one.
    milled_level: Option<f64>,
    /// True if the current tool stands upright.
    is_upright: bool,
    /// True if the current tool has moved along Z alone after a stroke across Z.
    has_moved_along_z: bool,
    /// True if any stroke of the program runs along Z.
    has_upright_stroke: bool,
    nominal: Arc<NominalAxes>,
    /// Strokes that are milling.
    milled: Option<MilledStrokes>,
    /// Holes at which the reference has none.
    pub start_holes: StartHoles,
}

/// Feeds that make no hole.
#[derive(Clone, Debug, Default)]
pub(super) struct Uncounted {
    /// Feeds without retract: their number, the first and its length.
    pub unretracted: Option<(u64, Backtrace, f64)>,
    /// Curved feeds: their number and the first.
    pub curved: Option<(u64, Backtrace)>,
}

impl Uncounted {
    pub(super) fn add_unretracted(&mut self, place: &Backtrace, length: f64) {
        self.unretracted.get_or_insert_with(|| (0, place.clone(), length)).0 += 1;
    }

    pub(super) fn add_curved(&mut self, place: Backtrace) {
        self.curved.get_or_insert((0, place)).0 += 1;
    }
}

/// Strokes that make no hole because they are milling.
#[derive(Debug)]
pub(super) struct MilledStrokes {
    count: u64,
    first: Backtrace,
    /// Length of the first, mm.
    length: f64,
}

impl Strokes {
    pub(super) fn new(max_passes: usize) -> Self {
        Self { max_passes, ..Self::default() }
    }

    pub(super) fn set_nominal_axes(&mut self, axes: &Arc<NominalAxes>) {
        self.nominal = Arc::clone(axes);
        // Most programs make one pass of each hole.
        self.passes.reserve(axes.len().min(self.max_passes));
    }

    pub(super) fn nominal_axes(&self) -> &NominalAxes {
        &self.nominal
    }

    /// Records a feed across the tool at a height along it.
    pub(super) fn note_milling(&mut self, level: f64) {
        self.milled_level = Some(self.milled_level.map_or(level, |lowest| lowest.min(level)));
    }

    /// Returns true if the current tool has made strokes across Z.
    pub(super) fn has_across(&self) -> bool {
        self.across_begin < self.across.len()
    }

    /// Records a motion along Z alone after strokes across it: with a further stroke across it the tool stands upright.
    fn note_motion_along_z(&mut self) {
        self.has_moved_along_z = true;
    }

    /// Takes the strokes across Z as milling: the tool stands upright.
    fn note_upright(&mut self) {
        self.is_upright = true;
        for (order, pass) in self.across.split_off(self.across_begin) {
            self.push_milled(order, pass);
        }
    }

    /// Returns true if a pass lies on a nominal axis.
    pub(super) fn is_nominal(&self, pass: &DrillPass) -> bool {
        let PassCut { start, bottom, .. } = &pass.cut;
        let is_along = PARALLEL_COSINE <= pass.feed_direction.dot(&pass.axis);
        is_along && self.nominal.nearest([start, bottom], &pass.axis, MAX_AXIS_DISTANCE).is_some()
    }

    /// Returns the nominal axis nearest to a circle; of a hole whose entry is above the circle if `is_below`.
    pub(super) fn nominal_of_ring(&self, ring: &Ring, is_below: bool) -> Option<&NominalAxis> {
        // Below a through hole a tool breaks out.
        let start = ring.centre + ring.out.into_inner() * (ring.height() + MAX_BREAK_THROUGH);
        let pass = [&start, &ring.centre];
        match is_below {
            true => self.nominal.nearest_above(pass, &ring.out, MAX_AXIS_DISTANCE),
            false => self.nominal.nearest(pass, &ring.out, MAX_AXIS_DISTANCE).map(|(axis, _)| axis),
        }
    }

    /// Returns true if a circle of a mill cuts the wall of a hole on its axis that an earlier pass has made.
    pub(super) fn is_at_drilled_wall(&self, ring: &Ring, cutter: Option<f64>, machine: &Machine) -> bool {
        let Some(cutter) = cutter else { return false };
        let [inner, outer] = [ring.radius - cutter / 2.0, ring.radius + cutter / 2.0];
        self.passes.iter().any(|pass| {
            let to = ring.centre - pass.cut.bottom;
            let level = to.dot(&ring.out);
            let is_wall = pass.diameter(machine).is_some_and(|hole| inner < hole / 2.0 && hole / 2.0 < outer);
            is_wall
                && pass.cut.thread().is_none()
                && PARALLEL_COSINE <= pass.axis.dot(&ring.out)
                && (to - ring.out.into_inner() * level).norm() <= MAX_LINE_OFFSET
                && -LEVEL_TOLERANCE <= level
                && ring.centre.coords.dot(&ring.out) <= pass.cut.start.coords.dot(&ring.out)
        })
    }

    /// Returns the axis of the nominal hole that a stroke cuts.
    fn nominal_of_stroke(&self, pass: &DrillPass) -> Option<&NominalAxis> {
        let PassCut { start, bottom, .. } = &pass.cut;
        self.nominal_along([start, bottom], &pass.axis, &pass.feed_direction)
    }

    /// Returns the axis of the nominal hole that the stroke of a line cuts.
    pub(super) fn nominal_of_line(&self, line: &CuttingLine) -> Option<&NominalAxis> {
        self.nominal_along([&line.start, &line.bottom()], &line.tool_axis.unwrap_or(line.out), &line.out)
    }

    fn nominal_along(
        &self,
        stroke: [&Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        feed: &Unit<Vector3<f64>>,
    ) -> Option<&NominalAxis> {
        let is_along = PARALLEL_COSINE <= feed.dot(axis);
        self.nominal.nearest_above(stroke, axis, MAX_AXIS_DISTANCE).filter(|_| is_along)
    }

    /// Adds a stroke at a nominal hole along which the tool doesn't retract.
    pub(super) fn push_unretracted(&mut self, order: u32, pass: DrillPass) {
        if self.unretracted.len() < self.max_passes {
            self.unretracted.push((order, pass));
        }
    }

    /// Takes the deepest stroke without a retract as the pass of each nominal hole that has no other one.
    fn finish_unretracted(&mut self) {
        let entry = |axis: &NominalAxis| axis.entry.coords.map(f64::to_bits).into();
        let mut deepest: BTreeMap<[u64; 3], (u32, DrillPass)> = BTreeMap::new();
        for (order, pass) in std::mem::take(&mut self.unretracted) {
            let Some(key) = self.nominal_of_stroke(&pass).map(entry) else { continue };
            let depth = |pass: &DrillPass| -pass.cut.bottom.coords.dot(&pass.axis);
            if deepest.get(&key).is_none_or(|(_, other)| depth(other) < depth(&pass)) {
                deepest.insert(key, (order, pass));
            }
        }
        if deepest.is_empty() {
            return;
        }
        for pass in &self.passes {
            if let Some(axis) = self.nominal_of_stroke(pass) {
                deepest.remove(&entry(axis));
            }
        }
        for (order, pass) in deepest.into_values() {
            self.push_pass(order, pass);
        }
    }

    /// Follows the holes made so far at which the reference has none. Returns false if there is none.
    pub(super) fn follow_start_holes(&mut self, machine: &Machine) -> bool {
        let mut start_holes = std::mem::take(&mut self.start_holes);
        let has_any = start_holes.follow(&self.passes, machine, |pass| self.is_nominal(pass));
        self.start_holes = start_holes;
        has_any
    }

    /// Returns the place of a pass that begins now.
    pub(super) fn begin_pass(&mut self) -> u32 {
        self.next += 1;
        self.next
    }

    /// Adds a pass that began at `order`.
    pub(super) fn push(&mut self, order: u32, pass: DrillPass, kind: CutKind) {
        match kind {
            CutKind::Drilled => self.push_pass(order, pass),
            CutKind::Oblique => self.push_milled(order, pass),
            CutKind::Side => {}
            CutKind::AlongTool { is_between_rapids } => {
                self.has_upright_stroke = true;
                if !self.is_drilled(&pass, is_between_rapids) {
                    self.push_milled(order, pass);
                } else if self.passes.len() + self.along_tool.len() < self.max_passes {
                    self.along_tool.push((order, pass, is_between_rapids));
                } else {
                    self.first_excess.get_or_insert(pass.backtrace);
                }
            }
            CutKind::Across { is_between_rapids } => {
                if self.has_moved_along_z {
                    self.note_upright();
                }
                let is_milling = self.is_upright || self.milled_level.is_some() || !is_between_rapids;
                if is_milling || self.max_passes <= self.across.len() {
                    self.push_milled(order, pass);
                } else {
                    self.across.push((order, pass));
                }
            }
        }
    }

    /// Ends the use of a tool: its strokes drill, unless it mills as deep.
    pub(super) fn end_tool(&mut self) {
        for (order, pass, is_between_rapids) in std::mem::take(&mut self.along_tool) {
            match self.is_drilled(&pass, is_between_rapids) {
                true => self.push_pass(order, pass),
                false => self.push_milled(order, pass),
            }
        }
        if self.milled_level.is_some() {
            self.note_upright();
        }
        self.across_begin = self.across.len();
        (self.milled_level, self.is_upright, self.has_moved_along_z) = (None, false, false);
    }

    /// Returns the passes in their order, the strokes that are milling, and the first pass beyond the limit.
    pub(super) fn finish(
        mut self,
        machine: &Machine,
    ) -> (Vec<DrillPass>, Option<MilledStrokes>, Option<Backtrace>) {
        self.end_tool();
        for (order, pass) in std::mem::take(&mut self.across) {
            match self.has_upright_stroke {
                true => self.push_milled(order, pass),
                false => self.push_pass(order, pass),
            }
        }
        self.finish_unretracted();
        self.drop_start_holes(machine);
        self.passes.sort_by_key(|pass| pass.cut.order);
        self.passes.iter_mut().enumerate().for_each(|(place, pass)| pass.cut.order = place);
        (self.passes, self.milled, self.first_excess)
    }

    /// Drops the start holes that feeds have removed whole, but for those of a hole that is milled on their axis.
    fn drop_start_holes(&mut self, machine: &Machine) {
        let is_removed = |pass: &mut DrillPass| self.start_holes.is_removed(pass.cut.order);
        let mut removed: Vec<DrillPass> = self.passes.extract_if(.., is_removed).collect();
        removed.retain(|start| {
            let bottom = start.cut.bottom.coords.dot(&start.axis);
            self.passes.iter().any(|wider| {
                wider.cut.milled.is_some()
                    && PARALLEL_COSINE <= wider.axis.dot(&start.axis)
                    && wider.offset_of(start) <= MAX_LINE_OFFSET
                    && wider.cut.bottom.coords.dot(&start.axis) <= bottom + LEVEL_TOLERANCE
                    && start.diameter(machine) <= wider.diameter(machine)
            })
        });
        self.passes.extend(removed);
    }

    /// Returns true if a stroke along the tool drills, as far as known: between rapids one that goes deeper than anything
    /// the tool mills, else one of a tool that never feeds across below its start.
    fn is_drilled(&self, pass: &DrillPass, is_between_rapids: bool) -> bool {
        let Some(lowest) = self.milled_level else { return true };
        let height = |p: &Point3<f64>| p.coords.dot(&pass.axis);
        match is_between_rapids {
            true => height(&pass.cut.bottom) < lowest - LEVEL_TOLERANCE,
            false => height(&pass.cut.start) <= lowest + LEVEL_TOLERANCE,
        }
    }

    fn push_pass(&mut self, order: u32, mut pass: DrillPass) {
        if self.passes.len() < self.max_passes {
            pass.cut.order = order as usize;
            self.passes.push(pass);
        } else {
            self.first_excess.get_or_insert(pass.backtrace);
        }
    }

    /// Adds a stroke of a mill: a hole only where a nominal one is.
    fn push_milled(&mut self, order: u32, pass: DrillPass) {
        if self.is_nominal(&pass) {
            self.push_pass(order, pass);
            return;
        }
        let length = (pass.cut.start - pass.cut.bottom).norm();
        let first = || MilledStrokes { count: 0, first: pass.backtrace, length };
        self.milled.get_or_insert_with(first).count += 1;
    }
}

impl MilledStrokes {
    /// Returns their number.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Returns the warning about all of them.
    pub(super) fn finding(self) -> Diagnostic {
        let message = format!(
            "the tool mills: a feed of {:.3} mm and the way back along it are not counted as a hole",
            self.length
        );
        let finding = Diagnostic::new(&FEED_NO_HOLE, message)
            .with_severity(Severity::Warning)
            .with_backtrace(self.first)
            .help("if it is a hole, drill it by a cycle, or enter it in the reference");
        with_count_note(finding, self.count)
    }
}

impl CuttingLine {
    /// Returns true for a feed square to the tool, as far as its direction is known.
    pub(super) fn is_square_to_tool(&self) -> bool {
        self.tool_axis.is_some_and(|axis| axis.dot(&self.out).abs() <= MAX_SQUARE_SINE)
    }

    /// Returns true for a feed across the tool, or against it, as far as its direction is known.
    pub(super) fn is_across_tool(&self) -> bool {
        self.tool_axis.is_some_and(|axis| axis.dot(&self.out) < MIN_TOOL_COSINE)
    }
}

impl CuttingLine {
    /// Returns true for a feed across an upright tool, if the direction of this one is unknown.
    pub(super) fn is_across_upright(&self) -> bool {
        self.upright.is_some_and(|upright| upright.dot(&self.out) < MIN_UPRIGHT_COSINE)
    }
}

impl HoleExtractor<'_> {
    /// Returns the kind of a stroke that the tool has left, in feed if `is_feeding`.
    pub(super) fn cut_kind(&self, line: &CuttingLine, is_feeding: bool) -> CutKind {
        if self.surface.is_some() || line.is_cycle {
            return CutKind::Drilled;
        }
        let is_between_rapids = !line.is_reached_by_feed && !is_feeding;
        let along_tool = CutKind::AlongTool { is_between_rapids };
        if line.tool_axis.is_some() {
            let kind = self.machine.kind_of(line.cutting_state.tool);
            return match line.is_across_tool() {
                true if line.is_square_to_tool() && !kind.is_some_and(ToolKind::cuts_with_end) => {
                    CutKind::Side
                }
                true => CutKind::Oblique,
                false => along_tool,
            };
        }
        let is_mill = self.machine.kind_of(line.cutting_state.tool) == Some(ToolKind::EndMill);
        match line.upright.map(|upright| upright.dot(&line.out)) {
            Some(cosine) if is_mill && cosine.abs() <= MAX_SQUARE_SINE => CutKind::Oblique,
            Some(cosine) if cosine.abs() <= MAX_SQUARE_SINE => CutKind::Across { is_between_rapids },
            Some(cosine) if cosine < MIN_UPRIGHT_COSINE => CutKind::Oblique,
            _ => along_tool,
        }
    }

    /// Reports feeds that make no hole, each kind once in the program.
    pub(super) fn report_uncounted(&mut self, feeds: Uncounted) {
        if let Some((count, place, length)) = feeds.unretracted {
            self.findings.add_in_program(&FEED_WITHOUT_RETRACT, &place, 0, count, |kind| {
                let message = format!(
                    "the tool does not retract along a feed of {length:.3} mm: not counted as a hole"
                );
                Diagnostic::new(kind, message)
                    .with_severity(Severity::Warning)
                    .help("retract along it before anything else moves, if it is a hole")
            });
        }
        if let Some((count, place)) = feeds.curved {
            self.findings.add_in_program(&FEED_NO_HOLE, &place, 0, count, |kind| {
                Diagnostic::new(kind, "a curved feed on the part: not counted as a hole")
                    .with_severity(Severity::Warning)
                    .help("a hole is drilled along a straight line, or milled by full circles with the table stationary")
            });
        }
    }

    /// Follows a motion after strokes across Z: one along Z alone leads an upright tool to its next stroke. G28 to machine
    /// zero doesn't.
    pub(super) fn check_upright(&mut self, from: &Position) {
        let Some(z) = self.machine.axes.find(b'Z') else { return };
        let to = &self.axis_position;
        let is_along_z = (0..to.0.len()).all(|axis| (axis == z) == (from[axis] != to[axis]));
        if is_along_z && to[z] != 0.0 {
            self.strokes.note_motion_along_z();
        }
    }
}
