//! A drilling block, checked: where its holes are, and its moves one by one, the steps of the cycle at every hole.
use super::data::ControlData;
use super::pecks::for_each_peck;
use super::state::{PolarPoint, State};
use gcode_lang::motion::{AxisIndex, EventKind, Position, SpindleDirection, StopKind};
use gcode_lang::program::cycles::{Cycle, CycleStep};
use gcode_lang::program::modes::ReturnTo;
use gcode_lang::units::{Deg, MmPerMin, Rpm, Seconds};

/// A drilling block, checked: telling it can't fail.
#[derive(Clone, Debug)]
pub(super) struct CyclePlan {
    pub(super) cycle: &'static Cycle,
    /// Where the block begins; after it the plan's state stands where it ends.
    pub(super) start_state: State,
    /// The first hole, as programmed, and from hole to hole.
    pub(super) first_hole: Position,
    pub(super) hole_step: Position,
    pub(super) polar_repeats: Option<PolarRepeats>,
    pub(super) pattern: Option<BoltHolePattern>,
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

impl CyclePlan {
    /// Emits the moves of the block one by one.
    pub(super) fn expand(&self, data: &ControlData, emit: &mut impl FnMut(EventKind, f64)) {
        let state = &self.start_state;
        let mut motion = CycleMotion {
            data,
            at: state.machine,
            unknown_axes: state.work_zero_unknown,
            rate: self.rate,
            emit,
        };
        let cycle = &state.cycle;
        let (r, z) = (cycle.r_level(), cycle.z_level());
        let mut hole = self.first_hole;
        for repeat in 0..self.repeats {
            self.move_to_hole(data, repeat, &mut hole);
            let level = |value: f64| {
                let mut point = hole;
                point[self.axis] = value;
                data.to_machine(state, &point)
            };
            let mut over = level(r);
            over[self.axis] = motion.at[self.axis];
            motion.rapid(over);
            if self.cycle.starts_at_r {
                motion.set_work_zero(self.axis, cycle.is_r_unknown());
                motion.rapid(level(r));
            }
            for step in self.cycle.steps {
                self.drill_step(*step, data, &level, (r, z), &mut motion);
            }
        }
    }

    fn drill_step<T: FnMut(EventKind, f64)>(
        &self,
        step: CycleStep,
        data: &ControlData,
        level: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        motion: &mut CycleMotion<'_, T>,
    ) {
        let state = &self.start_state;
        let initial = state.cycle.initial;
        let to_initial = state.modal.return_to == ReturnTo::Initial;
        let turning = |turning| EventKind::Spindle { direction: turning, speed: Rpm(state.codes.s) };
        let goes_back = match step {
            CycleStep::RapidBack | CycleStep::RapidToInitial => to_initial,
            CycleStep::RapidToInitialAlways => true,
            _ => false,
        };
        if goes_back {
            motion.set_work_zero(self.axis, state.cycle.is_initial_unknown);
        }
        match step {
            CycleStep::FeedToBottom => motion.feed(level(z)),
            CycleStep::PeckFull => {
                for_each_peck((r, z), &state.cycle.unscaled(self.stretch), |last, next, done| {
                    if last != r {
                        let clearance = (data.settings.g83_clearance / self.stretch).min((r - last).abs());
                        motion.rapid(level(last + clearance.copysign(r - z)));
                    }
                    motion.feed(level(next));
                    if !done {
                        motion.rapid(level(r + data.settings.g83_above_r.copysign(r - z)));
                    }
                });
            }
            CycleStep::PeckShort => {
                let retract = (data.settings.g73_retract / self.stretch).copysign(r - z);
                for_each_peck((r, z), &state.cycle.unscaled(self.stretch), |_, next, done| {
                    motion.feed(level(next));
                    if !done {
                        motion.rapid(level(next + retract));
                    }
                });
            }
            CycleStep::Dwell => motion.dwell(self.dwell),
            CycleStep::DwellAtR if data.settings.undocumented.tap_dwells_at_r => motion.dwell(self.dwell),
            CycleStep::DwellAtR => {}
            CycleStep::FeedToR => motion.feed(level(r)),
            CycleStep::RapidBack => {
                motion.rapid_along_axis(level(if to_initial { initial } else { r }), self.axis)
            }
            CycleStep::RapidToInitial if to_initial => motion.rapid(level(initial)),
            CycleStep::RapidToInitial => {}
            CycleStep::RapidToInitialAlways => motion.rapid_along_axis(level(initial), self.axis),
            CycleStep::RapidToR => motion.rapid_along_axis(level(r), self.axis),
            CycleStep::Shift => {
                let mut to = motion.at;
                to[self.shift.0] = data.remove_residue(to[self.shift.0] + self.shift.1);
                motion.rapid(to);
            }
            CycleStep::ShiftBack => {
                let mut to = motion.at;
                to[self.shift.0] = data.remove_residue(to[self.shift.0] - self.shift.1);
                motion.rapid(to);
            }
            CycleStep::SpindleStop => (motion.emit)(turning(SpindleDirection::Off), 0.0),
            CycleStep::SpindleForward => (motion.emit)(turning(SpindleDirection::Clockwise), 0.0),
            CycleStep::SpindleReverse => (motion.emit)(turning(SpindleDirection::Counterclockwise), 0.0),
            CycleStep::ManualRetract => {
                let stop = EventKind::Stop {
                    kind: StopKind::M00,
                    text: "retract by hand to R".into(),
                    variables: Vec::new(),
                };
                (motion.emit)(stop, 0.0);
                motion.rapid(level(r));
            }
        }
    }

    /// From a hole to the one that K repeats as number `turn`; 0 is the block's own.
    fn move_to_hole(&self, data: &ControlData, turn: u32, hole: &mut Position) {
        if let Some(BoltHolePattern { radius, start, angle_step: angle, .. }) = self.pattern {
            let angle = Deg(start + f64::from(turn) * angle);
            hole[0] = data.remove_residue(self.first_hole[0] + radius * angle.cos());
            hole[1] = data.remove_residue(self.first_hole[1] + radius * angle.sin());
            return;
        }
        if turn == 0 {
            return;
        }
        let from = *hole;
        for (place, _) in data.settings.axes.iter() {
            hole[place] =
                data.remove_residue(self.first_hole[place] + f64::from(turn) * self.hole_step[place]);
        }
        if let Some(PolarRepeats { plane, first, angle_step: angle }) = self.polar_repeats {
            (hole[plane.0], hole[plane.1]) = (from[plane.0], from[plane.1]);
            let here = PolarPoint { angle: first.angle + f64::from(turn) * angle, ..first };
            data.polar_point(&here, plane, hole);
        }
    }

    /// The axes whose place on the part isn't known when it begins.
    pub(super) fn unknown_axes(&self) -> u8 {
        self.start_state.work_zero_unknown
    }

    /// The tool comes from here.
    pub(super) fn set_start(&mut self, machine: Position) {
        self.start_state.machine = machine;
    }

    /// Where the last hole is.
    pub(super) fn last_hole(&self, data: &ControlData) -> Position {
        let mut hole = self.first_hole;
        for turn in 0..self.repeats {
            self.move_to_hole(data, turn, &mut hole);
        }
        hole
    }
}

/// The tool on its way through a cycle, in machine coordinates.
struct CycleMotion<'c, T> {
    data: &'c ControlData,
    at: Position,
    unknown_axes: u8,
    rate: MmPerMin,
    emit: &'c mut T,
}

impl<T: FnMut(EventKind, f64)> CycleMotion<'_, T> {
    /// From the next move's end on the axis stands where its place on the part is known, or isn't.
    fn set_work_zero(&mut self, axis: AxisIndex, unplaced: bool) {
        let axes = self.unknown_axes & !(1 << axis) | u8::from(unplaced) << axis;
        if axes != self.unknown_axes {
            self.unknown_axes = axes;
            (self.emit)(EventKind::WorkZeroUnknown { axes }, 0.0);
        }
    }

    fn rapid(&mut self, to: Position) {
        if to != self.at {
            (self.emit)(EventKind::Rapid { to }, self.data.rapid_seconds(&self.at, &to));
            self.at = to;
        }
    }

    /// Along the drilling axis only: the plane keeps its shift.
    fn rapid_along_axis(&mut self, to: Position, axis: AxisIndex) {
        let mut there = self.at;
        there[axis] = to[axis];
        self.rapid(there);
    }

    fn feed(&mut self, to: Position) {
        if to != self.at {
            let squares: f64 = (0..to.0.len()).map(|a| (to[a] - self.at[a]) * (to[a] - self.at[a])).sum();
            (self.emit)(EventKind::Feed { to, rate: self.rate }, squares.sqrt() / self.rate.0 * 60.0);
            self.at = to;
        }
    }

    fn dwell(&mut self, seconds: f64) {
        if seconds > 0.0 {
            (self.emit)(EventKind::Dwell { time: Seconds(seconds) }, seconds);
        }
    }
}

/// Holes round the point where the block stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoltHolePattern {
    pub(super) count: u32,
    /// mm.
    pub(super) radius: f64,
    /// Degrees from X+ to the first hole, and from hole to hole.
    pub(super) start: f64,
    pub(super) angle_step: f64,
}

#[cfg(test)]
mod tests {
    use gcode_lang::control::Settings;
    use gcode_lang::program::cycles;

    use super::*;
    use crate::state::{CycleLevel, CycleState};

    fn at(x: f64, z: f64) -> Position {
        let mut position = Position::default();
        (position[0], position[2]) = (x, z);
        position
    }

    /// The moves of a hole at X10 from the initial level 50, R 2 and Z −10.
    fn moves(cycle: &'static Cycle, return_to: ReturnTo, q: Option<f64>) -> Vec<(&'static str, f64)> {
        let level = |value| CycleLevel { value, is_incremental: false, is_commanded: true };
        let cycle_state = CycleState {
            axis: Some(2),
            initial: 50.0,
            r: level(2.0),
            z: level(-10.0),
            q,
            ..CycleState::default()
        };
        let (programmed, machine) = (at(0.0, 50.0), at(0.0, 50.0));
        let mut from = State { programmed, machine, cycle: cycle_state, ..State::default() };
        from.modal.return_to = return_to;
        let plan = CyclePlan {
            cycle,
            start_state: from,
            first_hole: at(10.0, 50.0),
            hole_step: Position::default(),
            polar_repeats: None,
            pattern: None,
            repeats: 1,
            axis: 2,
            shift: (0, 0.0),
            rate: MmPerMin(100.0),
            dwell: 0.0,
            stretch: 1.0,
        };
        let mut moves = Vec::new();
        plan.expand(&ControlData::new(Settings::default()), &mut |kind, _| match kind {
            EventKind::Rapid { to } => moves.push(("rapid", to[2])),
            EventKind::Feed { to, .. } => moves.push(("feed", to[2])),
            _ => {}
        });
        moves
    }

    #[test]
    fn a_hole_is_drilled_from_r_to_z_and_left_for_the_level_in_force() {
        let down = [("rapid", 50.0), ("rapid", 2.0), ("feed", -10.0)];
        assert_eq!(moves(&cycles::DRILL, ReturnTo::Initial, None), [&down[..], &[("rapid", 50.0)]].concat());
        assert_eq!(moves(&cycles::DRILL, ReturnTo::R, None), [&down[..], &[("rapid", 2.0)]].concat());
    }

    #[test]
    fn pecks_go_q_deeper_each() {
        let feeds = |cycle| {
            let moves = moves(cycle, ReturnTo::R, Some(5.0)).into_iter();
            moves.filter(|(kind, _)| *kind == "feed").map(|(_, z)| z).collect::<Vec<_>>()
        };
        assert_eq!(feeds(&cycles::PECK_DRILL), [-3.0, -8.0, -10.0]);
        assert_eq!(feeds(&cycles::PECK_DRILL_SHORT), [-3.0, -8.0, -10.0]);
    }
}
