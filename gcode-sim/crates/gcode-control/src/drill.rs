//! A drilling block, checked: where its holes are, and its moves one by one, the steps of the cycle at every hole.
use super::Executor;
use super::patterns::Pattern;
use super::state::{PolarPoint, State};
use gcode_lang::motion::{AxisIndex, EventKind, Position, SpindleDirection, StopKind};
use gcode_lang::program::cycles::{Cycle, Step};
use gcode_lang::program::modes::ReturnTo;
use gcode_lang::units::{Deg, MmPerMin, Rpm, Seconds};

/// A drilling block, checked: telling it can't fail.
#[derive(Clone, Debug)]
pub(super) struct CyclePlan {
    pub(super) cycle: &'static Cycle,
    /// Where the block begins; after it the plan's state stands where it ends.
    pub(super) from: State,
    /// The first hole, as programmed, and from hole to hole.
    pub(super) hole: Position,
    pub(super) step: Position,
    pub(super) circle: Option<PolarRepeats>,
    pub(super) pattern: Option<Pattern>,
    pub(super) repeats: u32,
    pub(super) axis: AxisIndex,
    pub(super) shift: (AxisIndex, f64),
    pub(super) rate: MmPerMin,
    /// Seconds.
    pub(super) dwell: f64,
    /// What G51 makes of a millimetre along the drilling axis; Q, 5114 and 5115 are not scaled.
    pub(super) stretch: f64,
}

/// Holes that K repeats in polar coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct PolarRepeats {
    pub(super) plane: (AxisIndex, AxisIndex),
    pub(super) first: PolarPoint,
    /// Degrees from hole to hole.
    pub(super) angle_step: f64,
}

impl Executor {
    /// Tells a drilling block move by move.
    pub(super) fn expand_cycle(&self, drill: &CyclePlan, tell: &mut impl FnMut(EventKind, f64)) {
        let state = &drill.from;
        let mut way = CycleMotion {
            core: self,
            at: state.machine,
            unplaced: state.work_zero_unknown,
            rate: drill.rate,
            tell,
        };
        let data = &state.drilling;
        let (r, z) = (data.r_level(), data.z_level());
        let mut hole = drill.hole;
        for turn in 0..drill.repeats {
            drill.advance(self, turn, &mut hole);
            let level = |value: f64| {
                let mut point = hole;
                point[drill.axis] = value;
                self.to_machine(state, &point)
            };
            let mut over = level(r);
            over[drill.axis] = way.at[drill.axis];
            way.rapid(over);
            if drill.cycle.starts_at_r {
                way.set_work_zero(drill.axis, data.r_unplaced());
                way.rapid(level(r));
            }
            for step in drill.cycle.steps {
                self.drill_step(*step, drill, &level, (r, z), &mut way);
            }
        }
    }

    fn drill_step<T: FnMut(EventKind, f64)>(
        &self,
        step: Step,
        drill: &CyclePlan,
        level: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        way: &mut CycleMotion<'_, T>,
    ) {
        let state = &drill.from;
        let initial = state.drilling.initial;
        let to_initial = state.modal.return_to == ReturnTo::Initial;
        let turning = |turning| EventKind::Spindle { turning, speed: Rpm(state.codes.s) };
        let goes_back = match step {
            Step::RapidBack | Step::RapidToInitial => to_initial,
            Step::RapidToInitialAlways => true,
            _ => false,
        };
        if goes_back {
            way.set_work_zero(drill.axis, state.drilling.initial_unplaced);
        }
        match step {
            Step::FeedToBottom => way.feed(level(z)),
            Step::PeckFull => {
                self.peck((r, z), &state.drilling.unscaled(drill.stretch), |last, next, done| {
                    if last != r {
                        let clearance = (self.settings.g83_clearance / drill.stretch).min((r - last).abs());
                        way.rapid(level(last + clearance.copysign(r - z)));
                    }
                    way.feed(level(next));
                    if !done {
                        way.rapid(level(r + self.settings.g83_above_r.copysign(r - z)));
                    }
                });
            }
            Step::PeckShort => {
                let retract = (self.settings.g73_retract / drill.stretch).copysign(r - z);
                self.peck((r, z), &state.drilling.unscaled(drill.stretch), |_, next, done| {
                    way.feed(level(next));
                    if !done {
                        way.rapid(level(next + retract));
                    }
                });
            }
            Step::Dwell => way.dwell(drill.dwell),
            Step::DwellAtR if self.settings.unsure.tap_dwells_at_r => way.dwell(drill.dwell),
            Step::DwellAtR => {}
            Step::FeedToR => way.feed(level(r)),
            Step::RapidBack => way.shifted_to(level(if to_initial { initial } else { r }), drill.axis),
            Step::RapidToInitial if to_initial => way.rapid(level(initial)),
            Step::RapidToInitial => {}
            Step::RapidToInitialAlways => way.shifted_to(level(initial), drill.axis),
            Step::RapidToR => way.shifted_to(level(r), drill.axis),
            Step::Shift => {
                let mut to = way.at;
                to[drill.shift.0] = self.clean(to[drill.shift.0] + drill.shift.1);
                way.rapid(to);
            }
            Step::ShiftBack => {
                let mut to = way.at;
                to[drill.shift.0] = self.clean(to[drill.shift.0] - drill.shift.1);
                way.rapid(to);
            }
            Step::SpindleStop => (way.tell)(turning(SpindleDirection::Off), 0.0),
            Step::SpindleForward => (way.tell)(turning(SpindleDirection::Clockwise), 0.0),
            Step::SpindleReverse => (way.tell)(turning(SpindleDirection::Counterclockwise), 0.0),
            Step::ManualRetract => {
                let stop = EventKind::Stop {
                    kind: StopKind::M00,
                    text: "retract by hand to R".into(),
                    named: Vec::new(),
                };
                (way.tell)(stop, 0.0);
                way.rapid(level(r));
            }
        }
    }
}

impl CyclePlan {
    /// From a hole to the one that K repeats as number `turn`; 0 is the block's own.
    fn advance(&self, core: &Executor, turn: u32, hole: &mut Position) {
        if let Some(Pattern { radius, start, turn: angle, .. }) = self.pattern {
            let angle = Deg(start + f64::from(turn) * angle);
            hole[0] = core.clean(self.hole[0] + radius * angle.cos());
            hole[1] = core.clean(self.hole[1] + radius * angle.sin());
            return;
        }
        if turn == 0 {
            return;
        }
        let from = *hole;
        for (place, _) in core.settings.axes.iter() {
            hole[place] = core.clean(self.hole[place] + f64::from(turn) * self.step[place]);
        }
        if let Some(PolarRepeats { plane, first, angle_step: angle }) = self.circle {
            (hole[plane.0], hole[plane.1]) = (from[plane.0], from[plane.1]);
            let here = PolarPoint { angle: first.angle + f64::from(turn) * angle, ..first };
            core.polar_point(&here, plane, hole);
        }
    }

    /// The axes whose place on the part isn't known when it begins.
    pub(super) fn unplaced(&self) -> u8 {
        self.from.work_zero_unknown
    }

    /// The tool comes from here.
    pub(super) fn begins_at(&mut self, machine: Position) {
        self.from.machine = machine;
    }

    /// Where the last hole is.
    pub(super) fn last(&self, core: &Executor) -> Position {
        let mut hole = self.hole;
        for turn in 0..self.repeats {
            self.advance(core, turn, &mut hole);
        }
        hole
    }
}

/// The tool on its way through a cycle, in machine coordinates.
struct CycleMotion<'c, T> {
    core: &'c Executor,
    at: Position,
    unplaced: u8,
    rate: MmPerMin,
    tell: &'c mut T,
}

impl<T: FnMut(EventKind, f64)> CycleMotion<'_, T> {
    /// From the next move's end on the axis stands where its place on the part is known, or isn't.
    fn set_work_zero(&mut self, axis: AxisIndex, unplaced: bool) {
        let axes = self.unplaced & !(1 << axis) | u8::from(unplaced) << axis;
        if axes != self.unplaced {
            self.unplaced = axes;
            (self.tell)(EventKind::WorkZeroUnknown { axes }, 0.0);
        }
    }

    fn rapid(&mut self, to: Position) {
        if to != self.at {
            (self.tell)(EventKind::Rapid { to }, self.core.rapid_seconds(&self.at, &to));
            self.at = to;
        }
    }

    /// Along the drilling axis only: the plane keeps its shift.
    fn shifted_to(&mut self, to: Position, axis: AxisIndex) {
        let mut there = self.at;
        there[axis] = to[axis];
        self.rapid(there);
    }

    fn feed(&mut self, to: Position) {
        if to != self.at {
            let squares: f64 = (0..to.0.len()).map(|a| (to[a] - self.at[a]) * (to[a] - self.at[a])).sum();
            (self.tell)(EventKind::Feed { to, rate: self.rate }, squares.sqrt() / self.rate.0 * 60.0);
            self.at = to;
        }
    }

    fn dwell(&mut self, seconds: f64) {
        if seconds > 0.0 {
            (self.tell)(EventKind::Dwell { time: Seconds(seconds) }, seconds);
        }
    }
}
