//! Expands a checked block of a canned cycle: its holes, and the steps of the cycle at each of them.
use super::data::ControlData;
use super::kinematics::remove_noise;
use super::state::{CycleState, PeckSchedule, RigidTapping, State};
use gcode_lang::motion::{AxisIndex, EventKind, Position, SpindleDirection, StopKind, UnknownAxes};
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
    pub(super) bore_shift: [(AxisIndex, f64); 2],
    pub(super) rate: MmPerMin,
    /// Dwell, seconds.
    pub(super) dwell: f64,
    /// Scale factor of G51 along the drilling axis; Q, 5114 and 5115 are not scaled.
    pub(super) scale_factor: f64,
}

impl CyclePlan {
    /// Emits the moves of the block one by one; returns the axes that the last event has stated as unknown.
    pub(super) fn expand(&self, data: &ControlData, emit: &mut impl FnMut(EventKind, f64)) -> UnknownAxes {
        let state = &self.start_state;
        let mut motion = CycleMotion {
            data,
            position: state.machine_position,
            state,
            unknown: state.unknown,
            stated_unknown: state.stated_unknown,
            waits_for_move: false,
            rate: self.rate,
            emit,
        };
        motion.state_unknown();
        let cycle = &state.cycle;
        let (r, z) = (cycle.r_level(), cycle.z_level());
        for hole in &self.holes {
            let point_at = |value: f64| {
                let mut point = *hole;
                point[self.axis] = value;
                data.cycle_point(state, &point)
            };
            let mut above_hole = point_at(r);
            above_hole = state.at_level_of(self.axis, above_hole, &motion.position);
            motion.rapid(above_hole);
            if self.cycle.rapids_to_r_first {
                motion.set_unknown(self.axis, cycle.r_unknown(state.unknown_after_absolute(self.axis)));
                motion.rapid(point_at(r));
            }
            for step in self.cycle.steps {
                self.drill_step(*step, data, &point_at, (r, z), &mut motion);
            }
        }
        motion.stated_unknown
    }

    /// Emits one step of the cycle; `point_at` is the point of the hole at a level.
    fn drill_step<T: FnMut(EventKind, f64)>(
        &self,
        step: CycleStep,
        data: &ControlData,
        point_at: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        motion: &mut CycleMotion<'_, T>,
    ) {
        let state = &self.start_state;
        let initial = state.cycle.initial;
        let is_rigid =
            state.rigid_tapping != RigidTapping::Off || data.settings.taps_rigidly || self.cycle.is_rigid;
        let to_initial = state.modal.return_to == ReturnTo::Initial;
        let speed = Rpm(state.modal_words.s);
        let spindle = |direction| {
            // G76 and G87 stop the spindle at its angle before they shift the tool.
            let is_oriented = direction == SpindleDirection::Off;
            EventKind::Spindle { direction, speed, is_rigid, is_oriented }
        };
        let returns_to_initial = match step {
            CycleStep::RapidToReturnLevel | CycleStep::RapidToInitialInG98 => to_initial,
            CycleStep::RapidToInitial => true,
            CycleStep::FeedToBottom
            | CycleStep::Peck
            | CycleStep::HighSpeedPeck
            | CycleStep::Dwell
            | CycleStep::DwellAtR
            | CycleStep::FeedToR
            | CycleStep::Shift
            | CycleStep::ShiftBack
            | CycleStep::RapidToR
            | CycleStep::SpindleStop
            | CycleStep::SpindleForward
            | CycleStep::SpindleReverse
            | CycleStep::ForwardAgain
            | CycleStep::ReverseAgain
            | CycleStep::RigidForward
            | CycleStep::RigidReverse
            | CycleStep::ManualRetract => false,
        };
        if returns_to_initial {
            motion.set_unknown(self.axis, state.cycle.initial_unknown);
        }
        match step {
            CycleStep::FeedToBottom => motion.feed(point_at(z)),
            CycleStep::Peck => self.emit_g83_pecks(point_at, (r, z), motion),
            CycleStep::HighSpeedPeck => self.emit_g73_pecks(point_at, (r, z), motion),
            CycleStep::Dwell => motion.dwell(self.dwell),
            CycleStep::DwellAtR if data.settings.undocumented.tap_dwells_at_r => motion.dwell(self.dwell),
            CycleStep::DwellAtR => {}
            CycleStep::FeedToR => motion.feed(point_at(r)),
            CycleStep::RapidToReturnLevel => {
                motion.rapid_along_axis(point_at(if to_initial { initial } else { r }), self.axis)
            }
            CycleStep::RapidToInitialInG98 if to_initial => motion.rapid(point_at(initial)),
            CycleStep::RapidToInitialInG98 => {}
            CycleStep::RapidToInitial => motion.rapid_along_axis(point_at(initial), self.axis),
            CycleStep::RapidToR => motion.rapid_along_axis(point_at(r), self.axis),
            CycleStep::Shift | CycleStep::ShiftBack => {
                let mut to = motion.position;
                for (axis, distance) in self.bore_shift {
                    let distance = if step == CycleStep::Shift { distance } else { -distance };
                    match &state.transform.tilt {
                        _ if distance == 0.0 => {}
                        Some(tilt) => {
                            let direction = state.transform.direction_in_plane(tilt, axis);
                            for (axis, part) in tilt.axes.into_iter().zip(direction) {
                                to[axis] = remove_noise(to[axis] + part * distance);
                            }
                        }
                        None => to[axis] = data.remove_residue(to[axis] + distance),
                    }
                }
                motion.rapid(to);
            }
            CycleStep::SpindleStop => (motion.emit)(spindle(SpindleDirection::Off), 0.0),
            CycleStep::SpindleForward => (motion.emit)(spindle(SpindleDirection::Clockwise), 0.0),
            CycleStep::SpindleReverse => (motion.emit)(spindle(SpindleDirection::Counterclockwise), 0.0),
            CycleStep::ForwardAgain | CycleStep::ReverseAgain
                if is_rigid && state.spindle == SpindleDirection::Off =>
            {
                (motion.emit)(spindle(SpindleDirection::Off), 0.0)
            }
            CycleStep::ForwardAgain => (motion.emit)(spindle(SpindleDirection::Clockwise), 0.0),
            CycleStep::ReverseAgain => (motion.emit)(spindle(SpindleDirection::Counterclockwise), 0.0),
            CycleStep::RigidForward if is_rigid => (motion.emit)(spindle(SpindleDirection::Clockwise), 0.0),
            CycleStep::RigidReverse if is_rigid => {
                (motion.emit)(spindle(SpindleDirection::Counterclockwise), 0.0)
            }
            CycleStep::RigidForward | CycleStep::RigidReverse => {}
            CycleStep::ManualRetract => {
                let (text, variables) = ("retract by hand to R".into(), Vec::new());
                (motion.emit)(EventKind::Stop { kind: StopKind::M00, text, variables }, 0.0);
                motion.rapid(point_at(r));
            }
        }
    }
}

impl CyclePlan {
    /// Emits the pecks of G83, each from the clearance above the last depth and back to R.
    fn emit_g83_pecks<T: FnMut(EventKind, f64)>(
        &self,
        point_at: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        motion: &mut CycleMotion<'_, T>,
    ) {
        let settings = &motion.data.settings;
        let clearance = settings.g83_clearance / self.scale_factor;
        let above_r = settings.g83_above_r;
        for_each_peck(
            (r, z),
            &self.start_state.cycle.with_unscaled_pecks(self.scale_factor),
            |from, to, is_last| {
                if from != r {
                    motion.rapid(point_at(from + clearance.min((r - from).abs()).copysign(r - z)));
                }
                motion.feed(point_at(to));
                if !is_last {
                    motion.rapid(point_at(r + above_r.copysign(r - z)));
                }
            },
        );
    }

    /// Emits the pecks of G73, each with a short retract.
    fn emit_g73_pecks<T: FnMut(EventKind, f64)>(
        &self,
        point_at: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        motion: &mut CycleMotion<'_, T>,
    ) {
        let retract = (motion.data.settings.g73_retract / self.scale_factor).copysign(r - z);
        let cycle = &self.start_state.cycle.with_unscaled_pecks(self.scale_factor);
        let mut retracted_at = r;
        for_each_peck((r, z), cycle, |_, to, is_last| {
            motion.feed(point_at(to));
            let is_deep =
                cycle.depth_to_retract.is_some_and(|depth| (to - retracted_at).abs() >= depth - 1e-9);
            if is_deep && !is_last {
                retracted_at = to;
                motion.rapid(point_at(r));
            }
            if !is_last {
                motion.rapid(point_at(to + retract));
            }
        });
    }
}

/// Motion of the tool through a cycle, in machine coordinates.
struct CycleMotion<'c, T> {
    data: &'c ControlData,
    position: Position,
    /// State at the start of the block.
    state: &'c State,
    /// Axes of unknown position, in programmed coordinates, and those that the last event has stated.
    unknown: UnknownAxes,
    stated_unknown: UnknownAxes,
    /// No move has followed that event.
    waits_for_move: bool,
    rate: MmPerMin,
    emit: &'c mut T,
}

impl<T: FnMut(EventKind, f64)> CycleMotion<'_, T> {
    /// Sets whether the position of an axis on the part is unknown from the end of the next move on.
    fn set_unknown(&mut self, axis: AxisIndex, unknown: UnknownAxes) {
        self.unknown = self.unknown.with_axes_of(1 << axis, unknown);
        self.state_unknown();
    }

    /// Emits the axes that are unknown after the next move, if they have changed.
    fn state_unknown(&mut self) {
        let axes = self.state.transform.spread(self.unknown);
        if axes != self.stated_unknown {
            self.stated_unknown = axes;
            self.waits_for_move = true;
            (self.emit)(EventKind::PositionUnknown { axes }, 0.0);
        }
    }

    fn rapid(&mut self, to: Position) {
        if to != self.position {
            (self.emit)(EventKind::Rapid { to }, self.data.rapid_seconds(&self.position, &to));
            self.position = to;
            self.waits_for_move = false;
        }
        self.repeat_unknown();
    }

    /// Repeats the event of the unknown axes if its move has no travel.
    fn repeat_unknown(&mut self) {
        if std::mem::take(&mut self.waits_for_move) {
            (self.emit)(EventKind::PositionUnknown { axes: self.stated_unknown }, 0.0);
        }
    }

    /// Moves along the drilling axis only; the plane keeps its shift.
    fn rapid_along_axis(&mut self, to: Position, axis: AxisIndex) {
        self.rapid(self.state.at_level_of(axis, self.position, &to));
    }

    fn feed(&mut self, to: Position) {
        if to != self.position {
            let travel = self.data.squared_travel(0..self.data.settings.axes.len(), &self.position, &to);
            (self.emit)(EventKind::Feed { to, rate: self.rate }, travel.seconds_at(self.rate));
            self.position = to;
            self.waits_for_move = false;
        }
        self.repeat_unknown();
    }

    fn dwell(&mut self, seconds: f64) {
        if seconds > 0.0 {
            (self.emit)(EventKind::Dwell { time: Seconds(seconds) }, seconds);
        }
    }
}

/// Largest number of pecks in one block; a run must end.
pub(super) const MAX_PECKS: u32 = 1_000_000;

/// Visits the pecks from R to Z with their start, end and whether they are the last; the last peck is the remainder.
pub(super) fn for_each_peck((r, z): (f64, f64), cycle: &CycleState, mut emit: impl FnMut(f64, f64, bool)) {
    let pecks = peck_count(r, z, cycle);
    let mut from = r;
    for count in 1..=pecks {
        let is_last = count == pecks;
        let to = if is_last { z } else { r + peck_depth(cycle, f64::from(count)).copysign(z - r) };
        emit(from, to, is_last);
        from = to;
    }
}

/// Returns the depth below R after a number of pecks.
fn peck_depth(cycle: &CycleState, count: f64) -> f64 {
    let Some(PeckSchedule { first, decrement, minimum }) = cycle.pecks else {
        return count * cycle.q.unwrap_or(0.0).abs();
    };
    // Pecks longer than the shortest first, then the shortest ones.
    let shortening_pecks =
        if decrement > 0.0 { ((first - minimum) / decrement + 1e-9).floor() + 1.0 } else { count };
    let shortened = count.min(shortening_pecks);
    shortened * first - decrement * shortened * (shortened - 1.0) / 2.0 + (count - shortened) * minimum
}

/// Returns the number of pecks of a hole from R to Z; the largest integer if there are more.
fn peck_count(r: f64, z: f64, cycle: &CycleState) -> u32 {
    let total_depth = (z - r).abs();
    if cycle.pecks.is_none() {
        return match cycle.q {
            Some(q) if q != 0.0 => (total_depth / q.abs() - 1e-9).ceil().max(1.0) as u32,
            _ => 1,
        };
    }
    let mut count = 1;
    while peck_depth(cycle, f64::from(count)) < total_depth - 1e-9 && count <= MAX_PECKS {
        count += 1;
    }
    count
}

/// Returns true if a block with a number of holes has more than [`MAX_PECKS`] pecks.
pub(super) fn has_too_many_pecks(cycle: &CycleState, holes: u32) -> bool {
    let pecks = u64::from(peck_count(cycle.r_level(), cycle.z_level(), cycle));
    pecks * u64::from(holes.max(1)) > u64::from(MAX_PECKS)
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
        let mut from = State {
            programmed_position: programmed,
            machine_position: machine,
            cycle: cycle_state,
            ..State::default()
        };
        from.modal.return_to = return_to;
        let plan = CyclePlan {
            cycle,
            start_state: from,
            holes: vec![at(10.0, 50.0)],
            axis: 2,
            bore_shift: [(0, 0.0); 2],
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
