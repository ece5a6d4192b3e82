//! Expands a checked block of a canned cycle: its holes, and the steps of the cycle at each of them.
use super::data::ControlData;
use super::state::{CycleState, PeckSchedule, State};
use gcode_lang::motion::{AxisIndex, EventKind, Position, SpindleDirection, StopKind};
use gcode_lang::program::cycles::{Cycle, CycleStep};
use gcode_lang::program::modes::ReturnTo;
use gcode_lang::units::{MmPerMin, Rpm, Seconds};

/// Checked block of a canned cycle; its expansion can't fail.
#[derive(Clone, Debug)]
pub(super) struct CyclePlan {
    pub(super) cycle: &'static Cycle,
    /// State at the start of the block; that of the plan is at its end.
    pub(super) start_state: State,
    /// Holes as programmed, at the initial level.
    pub(super) holes: Vec<Position>,
    pub(super) axis: AxisIndex,
    pub(super) shift: (AxisIndex, f64),
    pub(super) rate: MmPerMin,
    /// Dwell, seconds.
    pub(super) dwell: f64,
    /// Scale factor of G51 along the drilling axis; Q, 5114 and 5115 are not scaled.
    pub(super) scale_factor: f64,
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
        for hole in &self.holes {
            let level = |value: f64| {
                let mut point = *hole;
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

    /// Emits the pecks of G83: each begins above the last depth and ends with a retract to R.
    fn peck<T: FnMut(EventKind, f64)>(
        &self,
        data: &ControlData,
        level: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        motion: &mut CycleMotion<'_, T>,
    ) {
        for_each_peck((r, z), &self.start_state.cycle.unscaled(self.scale_factor), |from, to, is_last| {
            if from != r {
                let clearance = (data.settings.g83_clearance / self.scale_factor).min((r - from).abs());
                motion.rapid(level(from + clearance.copysign(r - z)));
            }
            motion.feed(level(to));
            if !is_last {
                motion.rapid(level(r + data.settings.g83_above_r.copysign(r - z)));
            }
        });
    }

    /// Emits the pecks of G73: each ends with a retract of parameter 5114.
    fn high_speed_peck<T: FnMut(EventKind, f64)>(
        &self,
        data: &ControlData,
        level: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        motion: &mut CycleMotion<'_, T>,
    ) {
        let retract = (data.settings.g73_retract / self.scale_factor).copysign(r - z);
        for_each_peck((r, z), &self.start_state.cycle.unscaled(self.scale_factor), |_, to, is_last| {
            motion.feed(level(to));
            if !is_last {
                motion.rapid(level(to + retract));
            }
        });
    }

    /// Emits one step of the cycle; `level` is the point of the hole at a height.
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
        let spindle = |direction| EventKind::Spindle { direction, speed: Rpm(state.codes.s) };
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
            CycleStep::Peck => self.peck(data, level, (r, z), motion),
            CycleStep::HighSpeedPeck => self.high_speed_peck(data, level, (r, z), motion),
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
            CycleStep::Shift | CycleStep::ShiftBack => {
                let (axis, distance) = self.shift;
                let distance = if step == CycleStep::Shift { distance } else { -distance };
                let mut to = motion.at;
                to[axis] = data.remove_residue(to[axis] + distance);
                motion.rapid(to);
            }
            CycleStep::SpindleStop => (motion.emit)(spindle(SpindleDirection::Off), 0.0),
            CycleStep::SpindleForward => (motion.emit)(spindle(SpindleDirection::Clockwise), 0.0),
            CycleStep::SpindleReverse => (motion.emit)(spindle(SpindleDirection::Counterclockwise), 0.0),
            CycleStep::ManualRetract => {
                let (text, variables) = ("retract by hand to R".into(), Vec::new());
                (motion.emit)(EventKind::Stop { kind: StopKind::M00, text, variables }, 0.0);
                motion.rapid(level(r));
            }
        }
    }
}

/// Motion of the tool through a cycle, in machine coordinates.
struct CycleMotion<'c, T> {
    data: &'c ControlData,
    at: Position,
    unknown_axes: u8,
    rate: MmPerMin,
    emit: &'c mut T,
}

impl<T: FnMut(EventKind, f64)> CycleMotion<'_, T> {
    /// Sets whether the position of an axis on the part is unknown from the end of the next move on.
    fn set_work_zero(&mut self, axis: AxisIndex, is_unknown: bool) {
        let axes = self.unknown_axes & !(1 << axis) | u8::from(is_unknown) << axis;
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

    /// Moves along the drilling axis only; the plane keeps its shift.
    fn rapid_along_axis(&mut self, to: Position, axis: AxisIndex) {
        let mut point = self.at;
        point[axis] = to[axis];
        self.rapid(point);
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

/// Largest number of pecks in one block; a run must end.
const MAX_PECKS: u32 = 1_000_000;

/// Visits the pecks from R to Z with their start, end and whether they are the last; the last peck is the remainder.
pub(super) fn for_each_peck((r, z): (f64, f64), data: &CycleState, mut emit: impl FnMut(f64, f64, bool)) {
    let pecks = peck_count(r, z, data);
    let mut from = r;
    let mut count = 1.0;
    while count <= pecks {
        let is_last = count == pecks;
        let to = if is_last { z } else { r + peck_depth(data, count).copysign(z - r) };
        emit(from, to, is_last);
        from = to;
        count += 1.0;
    }
}

/// Returns the depth below R after a number of pecks.
fn peck_depth(data: &CycleState, count: f64) -> f64 {
    let Some(PeckSchedule { first, decrement, minimum }) = data.pecks else {
        return count * data.q.unwrap_or(0.0).abs();
    };
    // Pecks longer than the shortest first, then the shortest ones.
    let longer_count =
        if decrement > 0.0 { ((first - minimum) / decrement + 1e-9).floor() + 1.0 } else { count };
    let shrinking = count.min(longer_count);
    shrinking * first - decrement * shrinking * (shrinking - 1.0) / 2.0 + (count - shrinking) * minimum
}

/// Returns the number of pecks of a hole from R to Z.
fn peck_count(r: f64, z: f64, data: &CycleState) -> f64 {
    let total_depth = (z - r).abs();
    if data.pecks.is_none() {
        return match data.q {
            Some(q) if q != 0.0 => (total_depth / q.abs() - 1e-9).ceil().max(1.0),
            _ => 1.0,
        };
    }
    let mut count = 1.0;
    while peck_depth(data, count) < total_depth - 1e-9 && count <= f64::from(MAX_PECKS) {
        count += 1.0;
    }
    count
}

/// Returns true if a block with a number of holes has more than [`MAX_PECKS`] pecks.
pub(super) fn has_too_many_pecks(data: &CycleState, holes: u32) -> bool {
    peck_count(data.r_level(), data.z_level(), data) * f64::from(holes.max(1)) > f64::from(MAX_PECKS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::{CycleLevel, CycleState};
    use gcode_lang::control::Settings;
    use gcode_lang::program::cycles;

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
            holes: vec![at(10.0, 50.0)],
            axis: 2,
            shift: (0, 0.0),
            rate: MmPerMin(100.0),
            dwell: 0.0,
            scale_factor: 1.0,
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
    fn a_hole_is_drilled_from_r_to_z_and_left_to_the_active_return_level() {
        let down = [("rapid", 50.0), ("rapid", 2.0), ("feed", -10.0)];
        assert_eq!(
            moves(&cycles::DRILLING, ReturnTo::Initial, None),
            [&down[..], &[("rapid", 50.0)]].concat()
        );
        assert_eq!(moves(&cycles::DRILLING, ReturnTo::R, None), [&down[..], &[("rapid", 2.0)]].concat());
    }

    #[test]
    fn pecks_go_q_deeper_each() {
        let feeds = |cycle| {
            let moves = moves(cycle, ReturnTo::R, Some(5.0)).into_iter();
            moves.filter(|(kind, _)| *kind == "feed").map(|(_, z)| z).collect::<Vec<_>>()
        };
        assert_eq!(feeds(&cycles::PECK_DRILLING), [-3.0, -8.0, -10.0]);
        assert_eq!(feeds(&cycles::HIGH_SPEED_PECK_DRILLING), [-3.0, -8.0, -10.0]);
    }
}
