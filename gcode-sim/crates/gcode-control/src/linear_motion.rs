//! Straight moves: end points of axis words, distances and times.
use std::hint::cold_path;

use super::coordinates::shortest_rotation;
use super::data::ControlData;
use super::quantities::Measure;
use super::state::State;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position, UnknownAxes};
use gcode_lang::program::modes::{Distance, FeedMode, Plane, Unit};
use gcode_lang::units::{Deg, MmPerMin};

/// End point of a move: as programmed, and in machine coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Endpoint {
    pub(super) programmed: Position,
    pub(super) machine: Position,
    /// [`State::unknown`] at the end point.
    pub(super) unknown: UnknownAxes,
}

/// Origin and units of the axis words of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoordinateBasis {
    /// [`ControlData::zeros`].
    zero: Position,
    /// Axes whose zero and tool length are 0, as bits, axis 1 the lowest.
    unshifted_axes: u8,
    pub(super) is_incremental: bool,
    /// Axes that an absolute word would make known, as bits; none in G91.
    pub(super) learnable_axes: u8,
    pub(super) measure: Measure,
    /// Largest coordinate: nine digits in increments, as in a word.
    pub(super) max_coordinate: f64,
}

/// Distance of a move: sums of the squares of linear axes, mm, and of rotary axes, degrees.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SquaredTravel {
    linear: f64,
    rotary: f64,
}

impl SquaredTravel {
    #[inline(always)]
    pub(super) fn add(&mut self, distance: f64, is_rotary: bool) {
        if is_rotary {
            self.rotary += distance * distance;
        } else {
            self.linear += distance * distance;
        }
    }

    /// Returns the duration at a rate, seconds.
    pub(super) fn seconds_at(self, rate: MmPerMin) -> f64 {
        (self.linear + self.rotary).sqrt() / rate.0 * 60.0
    }

    /// Returns true if an axis moves; increments are too large for their squares to underflow.
    pub(super) fn is_some(self) -> bool {
        self.linear + self.rotary > 0.0
    }
}

impl ControlData {
    /// Returns the two axes of the plane in right-handed order.
    pub(super) fn plane_axes(&self, plane: Plane) -> Result<(AxisIndex, AxisIndex), Alarm> {
        let (first, second) = match plane {
            Plane::Xy => (b'X', b'Y'),
            Plane::Zx => (b'Z', b'X'),
            Plane::Yz => (b'Y', b'Z'),
        };
        Ok((self.axis_with_letter(first)?, self.axis_with_letter(second)?))
    }

    /// Returns the origin and units of axis words in a state.
    pub(super) fn coordinate_basis(&self, state: &State) -> CoordinateBasis {
        let zero = self.zeros(state);
        let unshifted = |axis: &AxisIndex| zero[*axis] == 0.0 && state.length_offset[*axis] == 0.0;
        CoordinateBasis {
            zero,
            unshifted_axes: (0..MAX_AXES).filter(unshifted).fold(0, |axes, axis| axes | 1 << axis),
            is_incremental: state.modal.distance == Distance::Incremental,
            learnable_axes: match state.modal.distance {
                Distance::Incremental => 0,
                Distance::Absolute => state.learnable_axes(),
            },
            measure: self.measure(state.modal.unit),
            max_coordinate: 999_999_999.0 / self.settings.increment.per_unit(),
        }
    }

    /// Returns the end of one axis word, as programmed and on the machine; the latter is valid without a transform.
    #[inline(always)]
    pub(super) fn axis_end(
        &self,
        axis: AxisIndex,
        value: f64,
        state: &State,
        basis: &CoordinateBasis,
    ) -> (f64, f64) {
        let programmed = if basis.is_incremental {
            // Keeps the compiler from computing it in G90 too.
            cold_path();
            self.without_residue(state, state.programmed_position[axis] + value)
        } else {
            value
        };
        // A sum with 0 has no residue to remove.
        let machine = match basis.unshifted_axes >> axis & 1 == 1 {
            true => programmed + 0.0,
            false => self.on_machine(programmed, basis.zero[axis], state.length_offset[axis]),
        };
        (programmed, machine)
    }

    /// Returns the end of one word of an axis that rolls over, as programmed and on the machine.
    pub(super) fn rollover_axis_end(
        &self,
        axis: AxisIndex,
        value: f64,
        state: &State,
        basis: &CoordinateBasis,
    ) -> (f64, f64) {
        let from = state.programmed_position[axis];
        let travel = if basis.is_incremental { value } else { shortest_rotation(from, value) };
        (self.wrap_angle(axis, from + travel), self.remove_residue(state.machine_position[axis] + travel))
    }

    /// Moves a point to the position of a radius and an angle.
    pub(super) fn polar_point(&self, state: &State, plane: (AxisIndex, AxisIndex), point: &mut Position) {
        let polar = &state.polar;
        let centre = if polar.is_incremental { (point[plane.0], point[plane.1]) } else { (0.0, 0.0) };
        let radius = polar.radius.unwrap_or(0.0);
        let end = [centre.0 + radius * Deg(polar.angle).cos(), centre.1 + radius * Deg(polar.angle).sin()];
        for (axis, value) in [plane.0, plane.1].into_iter().zip(end) {
            point[axis] = self.round_to_increment(state, axis, value);
        }
    }

    /// Returns the seconds of a rapid: all axes start together at their own rates, the slowest determines the time.
    pub(super) fn rapid_seconds(&self, from: &Position, to: &Position) -> f64 {
        self.rapid_seconds_of(0..self.settings.axes.len(), from, to)
    }

    /// Returns the seconds of a rapid of these axes.
    #[inline]
    pub(super) fn rapid_seconds_of(
        &self,
        axes: impl Iterator<Item = AxisIndex>,
        from: &Position,
        to: &Position,
    ) -> f64 {
        let mut minutes = 0.0_f64;
        for axis in axes {
            let rotary = self.settings.axes.is_rotary(axis);
            let rate = if rotary { self.settings.rapid_rotary } else { self.settings.rapid.0 };
            minutes = minutes.max((to[axis] - from[axis]).abs() / rate);
        }
        minutes * 60.0
    }

    /// Returns the rate along the path and the seconds of a straight cut: the composite of all axes, mm and degrees as equal
    /// numbers (operator's manual, feed rate in G94).
    #[inline]
    pub(super) fn feed_seconds(
        &self,
        state: &State,
        from: &Position,
        to: &Position,
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        let mut travel = SquaredTravel::default();
        for axis in 0..self.settings.axes.len() {
            let is_rotary = self.settings.axes.is_rotary(axis) && !state.is_virtual(axis);
            travel.add(to[axis] - from[axis], is_rotary);
        }
        self.travel_time(state, state.modal_words.f, travel, f_in_block)
    }

    /// Returns the distance of a move of these axes.
    #[inline]
    pub(super) fn squared_travel(
        &self,
        axes: impl Iterator<Item = AxisIndex>,
        from: &Position,
        to: &Position,
    ) -> SquaredTravel {
        let mut squared_travel = SquaredTravel::default();
        axes.for_each(|axis| squared_travel.add(to[axis] - from[axis], self.settings.axes.is_rotary(axis)));
        squared_travel
    }

    /// Returns rate and seconds as [`ControlData::feed_seconds`], of an F that may not be active yet.
    #[inline(always)]
    pub(super) fn travel_time(
        &self,
        state: &State,
        f: f64,
        SquaredTravel { linear, rotary }: SquaredTravel,
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        let in_inches = || inch_length(linear.sqrt(), rotary);
        self.path_feed_time(state, f, ((linear + rotary).sqrt(), in_inches), f_in_block)
    }

    /// Returns the rate and the seconds of a path of `length` mm without rotary axes.
    #[inline]
    pub(super) fn path_time(
        &self,
        state: &State,
        length: f64,
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        self.path_feed_time(state, state.modal_words.f, (length, || inch_length(length, 0.0)), f_in_block)
    }

    #[inline(always)]
    fn path_feed_time(
        &self,
        state: &State,
        f: f64,
        (length, in_inches): (f64, impl Fn() -> f64),
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        if state.modal.feed_mode == FeedMode::InverseTime {
            if !f_in_block {
                return Err(Alarm::NoInverseTime);
            }
            if f <= 0.0 {
                return Err(Alarm::FeedZero);
            }
            return Ok((MmPerMin(length * f), 60.0 / f));
        }
        // Manuals don't say what the number of another mode becomes; one control wants a new F.
        if !f_in_block && state.modal_words.mode_of_f != state.modal.feed_mode && f != 0.0 {
            let [commanded, active] =
                [state.modal_words.mode_of_f, state.modal.feed_mode].map(FeedMode::code);
            return Err(Alarm::FeedOfOtherMode(commanded, active));
        }
        let per_minute = match state.modal.feed_mode {
            FeedMode::PerRevolution => f * state.modal_words.s,
            FeedMode::PerMinute | FeedMode::InverseTime => f,
        };
        if per_minute <= 0.0 {
            let no_speed = state.modal.feed_mode == FeedMode::PerRevolution && f > 0.0;
            return Err(if no_speed { Alarm::NoSpeedForFeed } else { Alarm::FeedZero });
        }
        let counted = match state.modal.unit {
            Unit::Metric => length,
            Unit::Inch => in_inches(),
        };
        let minutes = counted / per_minute;
        let rate = if minutes > 0.0 { length / minutes } else { per_minute };
        Ok((MmPerMin(rate), minutes * 60.0))
    }
}

/// Returns the composite of a path of `linear` mm and the squared degrees of rotary axes, in inches and degrees.
fn inch_length(linear: f64, rotary: f64) -> f64 {
    (linear / 25.4 * (linear / 25.4) + rotary).sqrt()
}
