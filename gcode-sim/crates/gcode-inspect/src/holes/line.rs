//! The line a cutting feed runs along on the part, as long as the tool stays on it: strokes in, pecks, the way out.
use nalgebra::{Point3, Unit, Vector3};

use super::DrillPass;
use super::clamping::ClampState;
use super::cutting::{CuttingState, PeckExtent};
use gcode_lang::motion::{Backtrace, Position};
use gcode_lang::units::MmPerMin;

/// A stroke counts as deeper than the last when it is so by this much, in mm.
const MIN_DEPTH_GAIN: f64 = 0.001;

/// A boring bar is shifted off the wall by no more than this, in mm.
const MAX_BAR_SHIFT: f64 = 5.0;

/// Where a tool that was on a line is after a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ToolExit {
    /// Still on it.
    OnLine,
    /// It left along the line, past the point where the feed had begun.
    AlongLine,
    /// It left to the side, from this far below where the feed had begun, having come back by `back`.
    Sideways { back: f64 },
}

/// The current line. Depths count from `start`, positive into the part.
#[derive(Debug)]
pub(super) struct CuttingLine {
    pub start: Point3<f64>,
    pub out: Unit<Vector3<f64>>,
    /// The direction of the tool on the part, where known.
    pub tool_axis: Option<Unit<Vector3<f64>>>,
    /// What was in force when the feed began, and how the clamp stood.
    pub cutting_state: CuttingState,
    pub clamp_state: ClampState,
    /// The axes whose place on the part isn't known, as bits, axis 1 the lowest.
    pub unknown_work_zero_axes: u8,
    /// How far the tip is beyond the programmed point.
    pub length_excess: Option<f64>,
    /// The slowest and the fastest of the feeds that cut.
    feed_range: Option<[MmPerMin; 2]>,
    /// How deep below the start the part begins, where its surface is known.
    pub surface_depth: Option<f64>,
    /// The most that one finished stroke has cut, air included, and of the part alone.
    pecks: PeckExtent,
    /// The spindle was reversed, or stopped, while the tool was in the hole.
    pub spindle: SpindleInHole,
    /// The depth reached by finished strokes.
    deepest: f64,
    /// The stroke being fed.
    stroke: Option<PeckStroke>,
    /// The tool's depth now.
    depth: f64,
    /// How far beside the line the tool stands: a boring bar shifted off the wall.
    bar_shift: Vector3<f64>,
    /// The block, and the axes' position, of the deepest point of the finished strokes.
    deepest_backtrace: Backtrace,
    deepest_position: Position,
    /// Half the rounding of a programmed point, mm.
    half_increment: f64,
}

/// What the spindle does while the tool is in the hole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SpindleInHole {
    #[default]
    Unchanged,
    Stopped,
    Reversed,
}

/// Feeds inwards without a way back between them.
#[derive(Debug)]
struct PeckStroke {
    from_depth: f64,
    to_depth: f64,
    backtrace: Backtrace,
    axis_position: Position,
}

impl CuttingLine {
    /// A feed from `start` to `end` that is the first on its line; `None` if it is too short to have a direction.
    pub(super) fn begin(
        start: Point3<f64>,
        end: Point3<f64>,
        place: Backtrace,
        at: Position,
        rounding: f64,
    ) -> Option<Self> {
        let out = Unit::try_new(start - end, 1e-9)?;
        let depth = (start - end).norm();
        Some(Self {
            start,
            out,
            tool_axis: None,
            cutting_state: CuttingState::default(),
            clamp_state: ClampState::default(),
            unknown_work_zero_axes: 0,
            length_excess: None,
            feed_range: None,
            surface_depth: None,
            pecks: PeckExtent::default(),
            spindle: SpindleInHole::default(),
            deepest: 0.0,
            stroke: Some(PeckStroke {
                from_depth: 0.0,
                to_depth: depth,
                backtrace: place.clone(),
                axis_position: at,
            }),
            depth,
            bar_shift: Vector3::zeros(),
            deepest_backtrace: place,
            deepest_position: at,
            half_increment: rounding,
        })
    }

    /// A feed inwards that cut.
    pub(super) fn record_feed(&mut self, feed: MmPerMin) {
        let [least, most] = self.feed_range.unwrap_or([feed, feed]);
        self.feed_range =
            Some([if feed < least { feed } else { least }, if most < feed { feed } else { most }]);
    }

    pub(super) fn cutting_feeds(&self) -> Option<[MmPerMin; 2]> {
        self.feed_range
    }

    /// What its strokes have cut, the one that is being fed included.
    pub(super) fn pecks(&self) -> PeckExtent {
        match &self.stroke {
            Some(stroke) if stroke.to_depth > self.deepest + MIN_DEPTH_GAIN => {
                self.pecks_with_stroke(stroke.to_depth)
            }
            _ => self.pecks,
        }
    }

    fn pecks_with_stroke(&self, reach: f64) -> PeckExtent {
        let PeckExtent { strokes, max_fed: fed, max_cut: cut } = self.pecks;
        let solid = self.deepest.max(self.surface_depth.unwrap_or(self.deepest));
        PeckExtent {
            strokes: strokes + 1,
            max_fed: fed.max(reach - self.deepest),
            max_cut: cut.max(reach - solid),
        }
    }

    /// The tool is below where the feed began.
    pub(super) fn is_below_start(&self) -> bool {
        self.depth > 2.0 * self.half_increment
    }

    /// How deep the line is cut.
    pub(super) fn cut_depth(&self) -> f64 {
        self.stroke.as_ref().map_or(self.deepest, |stroke| stroke.to_depth.max(self.deepest))
    }

    pub(super) fn bottom(&self) -> Point3<f64> {
        self.start - self.out.into_inner() * self.cut_depth()
    }

    /// The block of the deepest point.
    pub(super) fn backtrace(&self) -> &Backtrace {
        match &self.stroke {
            Some(stroke) if stroke.to_depth > self.deepest => &stroke.backtrace,
            _ => &self.deepest_backtrace,
        }
    }

    pub(super) fn depth_of(&self, p: &Point3<f64>) -> f64 {
        (self.start - p).dot(&self.out)
    }

    /// Rounded end points let a line through two of them wander: once for each point, and more beyond them.
    fn is_off_line(&self, p: &Point3<f64>) -> bool {
        let depth = self.depth_of(p);
        let aside = (p - self.start - self.bar_shift + self.out.into_inner() * depth).norm();
        aside > 3.0 * self.half_increment * (1.0 + depth.abs() / self.cut_depth().max(1e-3)) + 1e-9
    }

    /// The feed leads along the tool into the part, and not out of it.
    pub(super) fn is_inward(&self) -> bool {
        self.tool_axis.is_none_or(|axis| axis.dot(&self.out) > 0.0)
    }

    /// A rapid to `to` while the spindle stands: whether it shifts a boring bar off the wall at the depth reached, square
    /// to the line (G76), or back. The tool then goes on along the line beside it.
    pub(super) fn try_bar_shift(&mut self, to: &Point3<f64>) -> bool {
        let depth = self.depth_of(to);
        let aside = to - self.start + self.out.into_inner() * depth;
        let is_square = (depth - self.depth).abs() <= 2.0 * self.half_increment;
        let is_shift =
            is_square && self.is_below_start() && self.is_off_line(to) && aside.norm() <= MAX_BAR_SHIFT;
        if is_shift {
            self.bar_shift = aside;
        }
        is_shift
    }

    /// A boring bar stands beside it.
    pub(super) fn is_bar_shifted(&self) -> bool {
        self.bar_shift.norm() > 0.0
    }

    /// Whether a rapid to `to` goes on in the direction of the feed from its very end: then the feed may have led
    /// out of the part, or the rapid runs into it.
    pub(super) fn is_overrun(&self, to: &Point3<f64>) -> bool {
        let ended_deepest = self.cut_depth() - self.depth <= 2.0 * self.half_increment;
        ended_deepest && self.cut_depth() + MIN_DEPTH_GAIN < self.depth_of(to) && !self.is_off_line(to)
    }

    /// Where the tool is after a straight motion to `to`.
    pub(super) fn exit_after(&self, from: &Point3<f64>, to: &Point3<f64>) -> ToolExit {
        let depth = self.depth_of(to);
        if !self.is_off_line(to) {
            return ToolExit::OnLine;
        }
        if self.depth <= self.half_increment * 2.0 {
            return ToolExit::AlongLine;
        }
        if depth < 0.0 && !self.is_off_line(&(from + (to - from) * (self.depth / (self.depth - depth)))) {
            return ToolExit::AlongLine;
        }
        self.curved_exit()
    }

    /// Where a motion that leaves the line passes the level at which the feed had begun, or its start above that.
    pub(super) fn start_level_crossing(&self, from: &Point3<f64>, to: &Point3<f64>) -> Point3<f64> {
        let depth = self.depth_of(to);
        if self.depth <= 0.0 || depth >= self.depth {
            return *from;
        }
        from + (to - from) * (self.depth / (self.depth - depth)).min(1.0)
    }

    /// Left in some other way than straight.
    pub(super) fn curved_exit(&self) -> ToolExit {
        if self.depth <= self.half_increment * 2.0 {
            ToolExit::AlongLine
        } else {
            ToolExit::Sideways { back: self.cut_depth() - self.depth }
        }
    }

    /// A feed along the line. Answers a pass that was fed a second time for nothing, if that ended here.
    pub(super) fn feed_to(&mut self, to: &Point3<f64>, place: Backtrace, at: &Position) -> Option<DrillPass> {
        let depth = self.depth_of(to);
        if depth <= self.depth {
            return self.retract_to(depth);
        }
        if depth > self.cut_depth() {
            // The longer the line, the better its two ends tell its direction.
            self.out = Unit::new_normalize(self.start - to);
        }
        let from = self.stroke.as_ref().map_or(self.depth, |stroke| stroke.from_depth);
        self.stroke =
            Some(PeckStroke { from_depth: from, to_depth: depth, backtrace: place, axis_position: *at });
        self.depth = depth;
        None
    }

    /// A rapid along the line. The answer tells whether it ran deeper than the line was cut.
    pub(super) fn rapid_to(&mut self, to: &Point3<f64>) -> (Option<DrillPass>, bool) {
        let depth = self.depth_of(to);
        if depth <= self.depth {
            return (self.retract_to(depth), false);
        }
        let again = self.end_stroke();
        let uncut = depth > self.deepest + 2.0 * self.half_increment + MIN_DEPTH_GAIN;
        self.deepest = self.deepest.max(depth);
        self.depth = depth;
        (again, uncut)
    }

    fn retract_to(&mut self, depth: f64) -> Option<DrillPass> {
        let again = if depth < self.depth { self.end_stroke() } else { None };
        self.depth = depth;
        again
    }

    /// A full stroke from where the feed had begun that cuts no deeper was fed for nothing.
    fn end_stroke(&mut self) -> Option<DrillPass> {
        let stroke = self.stroke.take()?;
        if stroke.to_depth > self.deepest + MIN_DEPTH_GAIN {
            self.pecks = self.pecks_with_stroke(stroke.to_depth);
            self.deepest = stroke.to_depth;
            self.deepest_backtrace = stroke.backtrace;
            self.deepest_position = stroke.axis_position;
            return None;
        }
        let full = stroke.from_depth <= 2.0 * self.half_increment;
        full.then(|| self.drill_pass(stroke.to_depth, stroke.backtrace, stroke.axis_position))
    }

    /// The passes of the line when the tool has left it: the line's own, and one that was fed again for nothing.
    pub(super) fn finish(mut self) -> (DrillPass, Option<DrillPass>) {
        let again = self.end_stroke();
        (self.drill_pass(self.deepest, self.deepest_backtrace.clone(), self.deepest_position), again)
    }

    fn drill_pass(&self, depth: f64, place: Backtrace, at: Position) -> DrillPass {
        let bottom = self.start - self.out.into_inner() * depth;
        let axis = self.tool_axis.unwrap_or(self.out);
        DrillPass {
            start: self.start,
            bottom,
            axis,
            feed_direction: self.out,
            tool: self.cutting_state.tool,
            backtrace: place,
            axis_position: at,
        }
    }
}
