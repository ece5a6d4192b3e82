//! Line of a cutting feed on the part while the tool stays on it: strokes, pecks and the retract.
use nalgebra::{Point3, Unit, Vector3};

use super::cut_states::{CutStates, StateCut};
use super::cutting::{CuttingState, FeedAtSpeed, PeckExtent};
use super::drill_pass::{DrillPass, PITCH_TOLERANCE, PassCut, TapRetract};
use super::{HoleExtractor, MotionKind};
use gcode_lang::motion::{Backtrace, Event, Position, SpindleDirection, UnknownAxes};
use gcode_lang::source::Span;
use gcode_lang::units::MmPerMin;

/// Least additional depth of a stroke that cuts, mm.
const MIN_DEPTH_GAIN: f64 = 0.001;

/// Largest shift of a boring bar off the wall, mm.
pub(super) const MAX_BAR_SHIFT: f64 = 5.0;

/// Position of the tool relative to its line after a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ToolExit {
    /// On the line.
    OnLine,
    /// The tool left along the line, past the start of the feed.
    AlongLine,
    /// The tool left sideways below the start of the feed, after a retract of `back` mm.
    Sideways { back: f64 },
}

/// The current line. Depths count from `start`, positive into the part, mm.
#[derive(Debug)]
pub(super) struct CuttingLine {
    /// Place of its pass among all.
    pub order: u32,
    pub start: Point3<f64>,
    pub out: Unit<Vector3<f64>>,
    /// Direction of the tool on the part; `None` if unknown.
    pub tool_axis: Option<Unit<Vector3<f64>>>,
    /// Direction of a tool that stands upright, if that of this one is unknown.
    pub upright: Option<Unit<Vector3<f64>>>,
    /// Block of the first feed.
    pub first_block: Span,
    /// True if a cycle makes the stroke: its block also positions the tool or retracts it.
    pub is_cycle: bool,
    /// True if the motion before the first feed was a feed too.
    pub is_reached_by_feed: bool,
    /// Modal state of the last feed that cuts, else that at the start.
    pub cutting_state: CuttingState,
    /// Feeds that cut, by their modal states.
    pub cuts: CutStates,
    /// Axes of unknown position on the part.
    pub unknown_axes: UnknownAxes,
    /// Distance of the tip beyond the programmed point; `None` if they agree.
    pub length_excess: Option<f64>,
    /// Number of sweeps that had removed metal before it.
    sweeps_before: u32,
    /// Depth at which the part begins; `None` if its surface is unknown.
    pub surface_depth: Option<f64>,
    /// Finished strokes.
    pecks: PeckExtent,
    /// True if the spindle has reversed after the last feed that cuts.
    pub is_tapping: bool,
    /// Deepest motion out of the hole, after the reversal, at another feed a revolution than that of the last feed that cuts.
    uneven_retract: Option<TapRetract>,
    /// True if a tool that only widens or threads a hole is fed into solid metal.
    pub enters_solid: bool,
    /// Start of the feed inside a hole that it widens.
    pub start_inside: Option<StartInside>,
    /// Largest change of the spindle while the tool was in the hole.
    pub spindle: SpindleInHole,
    /// Deepest point of the finished strokes.
    deepest: StrokeEnd,
    /// Current stroke.
    stroke: Option<PeckStroke>,
    /// Pass that repeats the line, as far as it has come, and its depth.
    repeated: Option<(f64, Box<DrillPass>)>,
    /// Last stroke of a tap, with those before it that are like it.
    tapped: Option<Box<DrillPass>>,
    /// Depth by which rapids have moved the tool along the line: a tap turns in feeds alone.
    rapid_depth: f64,
    /// Current depth of the tool.
    depth: f64,
    /// Shift of a boring bar off the wall.
    bar_shift: Vector3<f64>,
    /// Largest rounding of a programmed point, mm.
    half_increment: f64,
}

/// Change of the spindle while the tool is in the hole, in order of severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SpindleInHole {
    #[default]
    Unchanged,
    Stopped,
    /// Stopped, and started again in its former direction.
    Restarted,
    Reversed,
}

/// Start of a feed inside a hole that it widens.
#[derive(Clone, Copy, Debug)]
pub(super) struct StartInside {
    /// Depth at which it begins, mm.
    pub depth: f64,
    /// Radius to which it widens the hole, mm.
    pub radius: f64,
}

/// Feeds inwards without a retract between them.
#[derive(Debug)]
struct PeckStroke {
    from_depth: f64,
    end: StrokeEnd,
}

/// Deepest point of a stroke.
#[derive(Clone, Debug)]
struct StrokeEnd {
    depth: f64,
    /// Height above the start of the line at which the stroke begins.
    rise: f64,
    /// Run of rigid tapping.
    rigid_run: u32,
    backtrace: Backtrace,
    axis_position: Position,
}

impl CuttingLine {
    /// Starts a line with its first feed; `None` if the feed is too short to have a direction.
    pub(super) fn begin(
        start: Point3<f64>,
        end: Point3<f64>,
        backtrace: Backtrace,
        at: Position,
        rounding: f64,
    ) -> Option<Self> {
        let out = Unit::try_new(start - end, 1e-9)?;
        let depth = (start - end).norm();
        let end = StrokeEnd { depth, rise: 0.0, rigid_run: 0, backtrace, axis_position: at };
        Some(Self {
            order: 0,
            start,
            out,
            tool_axis: None,
            upright: None,
            first_block: end.backtrace.block,
            is_cycle: false,
            is_reached_by_feed: false,
            cutting_state: CuttingState::default(),
            cuts: CutStates::default(),
            unknown_axes: UnknownAxes::default(),
            length_excess: None,
            sweeps_before: 0,
            surface_depth: None,
            pecks: PeckExtent::default(),
            is_tapping: false,
            uneven_retract: None,
            enters_solid: false,
            start_inside: None,
            spindle: SpindleInHole::default(),
            deepest: StrokeEnd { depth: 0.0, ..end.clone() },
            stroke: Some(PeckStroke { from_depth: 0.0, end }),
            repeated: None,
            tapped: None,
            rapid_depth: 0.0,
            depth,
            bar_shift: Vector3::zeros(),
            half_increment: rounding,
        })
    }

    /// Records rate and modal state of a feed inwards that cuts, or enters a hole that is cut. A reversal before it taps no
    /// thread.
    pub(super) fn record_feed(
        &mut self,
        feed: MmPerMin,
        state: CuttingState,
        cuts: bool,
        first: impl FnOnce() -> StateCut,
    ) {
        self.cuts.record(&state, feed, cuts, first);
        self.cutting_state = state;
        self.is_tapping = false;
        self.uneven_retract = None;
    }

    /// Records a motion out of the hole of a tap, by its feed and speed and the direction of the spindle; a rapid has no feed.
    pub(super) fn record_retract(
        &mut self,
        from: &Point3<f64>,
        feed: Option<FeedAtSpeed>,
        direction: SpindleDirection,
    ) {
        let Some(into) = self.cuts.last_feed().filter(|_| self.is_tapping) else { return };
        let (into, speed) =
            (into.0 / self.cutting_state.speed.0, |(feed, speed): FeedAtSpeed| feed.0 / speed.0);
        let is_even = feed.map(speed).is_some_and(|out| (out - into).abs() <= PITCH_TOLERANCE * into);
        let is_reversed =
            direction != SpindleDirection::Off && direction != self.cutting_state.spindle_direction;
        let is_deepest =
            self.uneven_retract.is_none_or(|known| self.depth_of(&known.from) < self.depth_of(from));
        if !(is_even && is_reversed) && is_deepest {
            self.uneven_retract = Some(TapRetract { from: *from, feed, direction });
        }
        // A stroke that goes on is none of those before.
        if let Some(tapped) = self.tapped.as_mut().filter(|_| self.stroke.is_none()) {
            tapped.cut.uneven_retract = self.uneven_retract;
        }
    }

    /// Returns the extent of all strokes, the current one included.
    pub(super) fn pecks(&self) -> PeckExtent {
        match &self.stroke {
            Some(stroke) if stroke.end.depth > self.deepest.depth + MIN_DEPTH_GAIN => {
                self.pecks_with_stroke(stroke.from_depth, stroke.end.depth)
            }
            _ => self.pecks,
        }
    }

    fn pecks_with_stroke(&self, from_depth: f64, reach: f64) -> PeckExtent {
        let PeckExtent { strokes, max_fed: fed, max_cut: cut } = self.pecks;
        // A stroke that begins behind a gap cuts from there.
        let deepest = self.deepest.depth.max(from_depth);
        let solid = deepest.max(self.surface_depth.unwrap_or(deepest));
        PeckExtent {
            strokes: strokes + 1,
            max_fed: fed.max(reach - deepest),
            max_cut: cut.max(reach - solid),
        }
    }

    /// Returns true if the tool is below the start of the feed.
    pub(super) fn is_below_start(&self) -> bool {
        self.depth > 2.0 * self.half_increment
    }

    /// Returns the depth to which the line is cut.
    pub(super) fn cut_depth(&self) -> f64 {
        self.stroke.as_ref().map_or(self.deepest.depth, |stroke| stroke.end.depth.max(self.deepest.depth))
    }

    pub(super) fn bottom(&self) -> Point3<f64> {
        self.start - self.out.into_inner() * self.cut_depth()
    }

    /// Returns the block of the deepest point.
    pub(super) fn backtrace(&self) -> &Backtrace {
        match &self.stroke {
            Some(stroke) if stroke.end.depth > self.deepest.depth => &stroke.end.backtrace,
            _ => &self.deepest.backtrace,
        }
    }

    pub(super) fn depth_of(&self, p: &Point3<f64>) -> f64 {
        (self.start - p).dot(&self.out)
    }

    /// Returns true if a point is off the line by more than the rounding of its two end points, extrapolated.
    fn is_off_line(&self, p: &Point3<f64>) -> bool {
        let depth = self.depth_of(p);
        let aside = (p - self.start - self.bar_shift + self.out.into_inner() * depth).norm();
        aside > 3.0 * self.half_increment * (1.0 + depth.abs() / self.cut_depth().max(1e-3)) + 1e-9
    }

    /// Returns true if the feed leads into the part along the tool, not out of it.
    pub(super) fn is_inward(&self) -> bool {
        self.tool_axis.is_none_or(|axis| axis.dot(&self.out) > 0.0)
    }

    /// Applies a rapid with the spindle stopped that shifts a boring bar perpendicular to the line, off the wall or back
    /// (G76), by less than its radius: the bar stands in the wall else. Returns false for other rapids.
    pub(super) fn try_bar_shift(&mut self, to: &Point3<f64>, radius: Option<f64>) -> bool {
        let depth = self.depth_of(to);
        let aside = to - self.start + self.out.into_inner() * depth;
        let is_square = (depth - self.depth).abs() <= 2.0 * self.half_increment;
        let is_shift = is_square
            && self.is_below_start()
            && self.is_off_line(to)
            && aside.norm() <= MAX_BAR_SHIFT
            && radius.is_none_or(|radius| aside.norm() < radius);
        if is_shift {
            self.bar_shift = aside;
        }
        is_shift
    }

    /// Returns true if a boring bar is shifted off the wall.
    pub(super) fn is_bar_shifted(&self) -> bool {
        self.bar_shift.norm() > 0.0
    }

    /// Returns true if a rapid continues the feed from its end: out of the part, or deeper into it.
    pub(super) fn is_overrun(&self, to: &Point3<f64>) -> bool {
        let ended_deepest = self.cut_depth() - self.depth <= 2.0 * self.half_increment;
        ended_deepest && self.cut_depth() + MIN_DEPTH_GAIN < self.depth_of(to) && !self.is_off_line(to)
    }

    /// Returns the position relative to the line after a straight motion.
    pub(super) fn exit_after(&self, from: &Point3<f64>, to: &Point3<f64>) -> ToolExit {
        let depth = self.depth_of(to);
        if !self.is_off_line(to) {
            return ToolExit::OnLine;
        }
        if self.depth > self.half_increment * 2.0
            && depth < 0.0
            && !self.is_off_line(&(from + (to - from) * (self.depth / (self.depth - depth))))
        {
            return ToolExit::AlongLine;
        }
        self.curved_exit()
    }

    /// Returns the point at which a motion off the line passes the level of its start; the start of the motion if that is
    /// higher.
    pub(super) fn start_level_crossing(&self, from: &Point3<f64>, to: &Point3<f64>) -> Point3<f64> {
        let depth = self.depth_of(to);
        if self.depth <= 0.0 || depth >= self.depth {
            return *from;
        }
        from + (to - from) * (self.depth / (self.depth - depth)).min(1.0)
    }

    /// Returns the position relative to the line after a curved motion or a tool change.
    pub(super) fn curved_exit(&self) -> ToolExit {
        if self.depth <= self.half_increment * 2.0 {
            ToolExit::AlongLine
        } else {
            ToolExit::Sideways { back: self.cut_depth() - self.depth }
        }
    }

    /// Applies a feed along the line; returns a repeated pass that ends with it.
    pub(super) fn feed_to(
        &mut self,
        to: &Point3<f64>,
        backtrace: Backtrace,
        at: &Position,
    ) -> Option<Box<DrillPass>> {
        let depth = self.depth_of(to);
        if depth <= self.depth {
            return self.retract_to(depth);
        }
        if depth > self.cut_depth() {
            // The direction of a longer line is more exact.
            self.out = Unit::new_normalize(self.start - to);
        }
        let from_depth = self.stroke.as_ref().map_or(self.depth, |stroke| stroke.from_depth);
        let end = StrokeEnd { depth, rise: 0.0, rigid_run: 0, backtrace, axis_position: *at };
        self.stroke = Some(PeckStroke { from_depth, end });
        self.depth = depth;
        None
    }

    /// Returns true if a point on the line is above the bottom of its strokes, by more than rounding: a feed that ends there after
    /// a peck cuts nothing.
    pub(super) fn is_above_cut(&self, to: &Point3<f64>) -> bool {
        self.depth_of(to) + 2.0 * self.half_increment + MIN_DEPTH_GAIN < self.cut_depth()
    }

    /// Returns true if a point on the line is deeper than the cut, by more than rounding.
    pub(super) fn is_beyond_cut(&self, to: &Point3<f64>) -> bool {
        self.cut_depth() + 2.0 * self.half_increment + MIN_DEPTH_GAIN < self.depth_of(to)
    }

    /// Applies a rapid along the line, which deepens the hole if it `cuts`. Returns a repeated pass that ends with it.
    pub(super) fn rapid_to(&mut self, to: &Point3<f64>, cuts: bool) -> Option<Box<DrillPass>> {
        let depth = self.depth_of(to);
        let by = depth - self.depth;
        let again = if by <= 0.0 { self.retract_to(depth) } else { self.end_stroke() };
        if cuts && 0.0 < by {
            self.deepest.depth = self.deepest.depth.max(depth);
        }
        self.depth = depth;
        self.rapid_depth += by;
        again
    }

    fn retract_to(&mut self, depth: f64) -> Option<Box<DrillPass>> {
        let again = if depth < self.depth { self.end_stroke() } else { None };
        self.depth = depth;
        again
    }

    /// Ends the current stroke; returns a repeated pass if the stroke begins a further one. A pass that repeats the line begins
    /// with a stroke from its start that cuts no deeper, and goes on with strokes that are deeper than its last. A stroke of a tap
    /// is a pass of its own, unless it goes on with the one before.
    fn end_stroke(&mut self) -> Option<Box<DrillPass>> {
        let PeckStroke { from_depth, mut end } = self.stroke.take()?;
        end.rise = if self.is_tapping { -self.rapid_depth } else { (-from_depth).max(0.0) };
        end.rigid_run = self.cutting_state.rigid_run;
        let depth = end.depth;
        let is_deeper = depth > self.deepest.depth + MIN_DEPTH_GAIN;
        if is_deeper {
            self.pecks = self.pecks_with_stroke(from_depth, depth);
            self.deepest = end.clone();
        }
        if self.is_tapping {
            let pass = Box::new(self.drill_pass(&end));
            let goes_on = |before: &DrillPass| is_deeper && pass.goes_on_tapping(before, self.half_increment);
            let before = self.tapped.take().filter(|before| !goes_on(before));
            self.tapped = Some(pass);
            return before;
        }
        if is_deeper {
            self.repeated = None;
            return self.tapped.take();
        }
        let pass = self.drill_pass(&end);
        match &mut self.repeated {
            Some((last, repeated)) if depth > *last + MIN_DEPTH_GAIN => {
                *last = depth;
                **repeated = DrillPass { cut: PassCut { start: repeated.cut.start, ..pass.cut }, ..pass };
                None
            }
            _ if from_depth <= 2.0 * self.half_increment => {
                self.repeated.replace((depth, Box::new(pass))).map(|(_, before)| before)
            }
            _ => None,
        }
    }

    /// Returns the pass of the line, and the repeated ones that end with it.
    pub(super) fn finish(&mut self) -> (DrillPass, impl Iterator<Item = DrillPass> + use<>) {
        let before = self.end_stroke();
        let last = self.repeated.take().map(|(_, pass)| pass);
        let pass = self.tapped.take().map_or_else(|| self.drill_pass(&self.deepest), |pass| *pass);
        (pass, before.into_iter().chain(last).map(|pass| *pass))
    }

    fn drill_pass(&self, end: &StrokeEnd) -> DrillPass {
        DrillPass {
            cut: PassCut {
                start: self.start + self.out.into_inner() * end.rise,
                bottom: self.start - self.out.into_inner() * end.depth,
                feed: self.cuts.last_feed(),
                extremes: self.cuts.extremes(),
                speed: self.cutting_state.speed,
                direction: self.cutting_state.spindle_direction,
                is_tapping: self.is_tapping,
                uneven_retract: self.uneven_retract,
                rigid_run: end.rigid_run,
                milled: None,
                order: 0,
                sweeps_before: self.sweeps_before,
            },
            axis: self.tool_axis.unwrap_or(self.out),
            is_tool_axis_known: self.tool_axis.is_some(),
            feed_direction: self.out,
            tool: self.cutting_state.tool,
            backtrace: end.backtrace.clone(),
            axis_position: end.axis_position,
            unknown_axes: self.unknown_axes,
        }
    }
}

impl HoleExtractor<'_> {
    /// Starts a line with a feed from `start`.
    pub(super) fn start_line(
        &mut self,
        event: &Event<'_>,
        start: Point3<f64>,
        last_motion: Option<(MotionKind, Span)>,
    ) {
        self.end_unsized_stroke();
        let rounding = self.machine.increment.size() / 2.0;
        let line = CuttingLine::begin(start, self.pose.tip, event.backtrace(), self.axis_position, rounding);
        let order = self.strokes.begin_pass();
        self.current_line = line.map(|line| {
            let mut line = Box::new(line);
            line.order = order;
            line.tool_axis = self.pose.axis;
            line.upright = self.tool_direction();
            // A block of a cycle positions, feeds and retracts.
            line.is_cycle = last_motion == Some((MotionKind::Rapid, event.block));
            line.is_reached_by_feed = last_motion.is_some_and(|(kind, _)| kind == MotionKind::Feed);
            line.cutting_state = self.tool_state();
            line.unknown_axes = self.positions.unknown_axes();
            line.length_excess = self.length_excess();
            line.sweeps_before = self.metal.removed.count();
            line.surface_depth =
                self.surface.and_then(|s| s.exit(&line.bottom(), &line.out)).map(|p| line.depth_of(&p));
            self.record_line_feed(event, &mut line, &start);
            self.record_start_inside(&mut line);
            line
        });
    }
}
