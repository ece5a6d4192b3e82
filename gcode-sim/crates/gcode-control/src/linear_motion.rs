//! Straight moves: where a block's axis words lead, and how long the way takes.
use std::hint::cold_path;

use super::checked::{ExecResult, locate};
use super::data::ControlData;
use super::quantities::Measure;
use super::state::{PolarPoint, State};
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};
use gcode_lang::program::modes::{Distance, FeedMode, Plane, Polar, Unit};
use gcode_lang::units::{Deg, MmPerMin};

/// Where a move ends: as programmed, and in machine coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Endpoint {
    pub(super) programmed: Position,
    pub(super) machine: Position,
    /// As [`State::work_zero_unknown`], there.
    pub(super) work_zero_unknown: u8,
}

/// What axis words count from and in, the same for all of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoordinateBasis {
    /// [`ControlData::zeros`].
    zero: Position,
    /// The axes whose zero and tool length are none, as bits, axis 1 the lowest.
    unshifted_axes: u8,
    is_incremental: bool,
    pub(super) measure: Measure,
    /// The largest coordinate: nine digits in increments, as a word has.
    pub(super) max_coordinate: f64,
}

/// How far axes move: the sums of the squares of those that slide, in mm, and of those that turn, in degrees.
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

    /// Whether one of the axes moves; the increments are far too large for squares that vanish.
    pub(super) fn is_some(self) -> bool {
        self.linear + self.rotary > 0.0
    }
}

impl Endpoint {
    /// Where the program stands.
    #[inline]
    pub(super) fn at_current_position(state: &State) -> Self {
        Self {
            programmed: state.programmed,
            machine: state.machine,
            work_zero_unknown: state.work_zero_unknown,
        }
    }
}

impl ControlData {
    /// Whether a block names an axis.
    pub(super) fn names_axis(&self, block_words: &BlockWords) -> bool {
        block_words.has_letters(self.settings.axes.letter_bits())
    }

    /// The two axes of the plane, first axis first.
    pub(super) fn plane_axes(&self, plane: Plane) -> Result<(AxisIndex, AxisIndex), Alarm> {
        let (first, second) = match plane {
            Plane::Xy => (b'X', b'Y'),
            Plane::Zx => (b'Z', b'X'),
            Plane::Yz => (b'Y', b'Z'),
        };
        let find = |letter: u8| {
            let missing = Alarm::ImproperAddress { letter: char::from(letter) };
            self.settings.axes.find(letter).ok_or(missing)
        };
        Ok((find(first)?, find(second)?))
    }

    /// What axis words count from where `state` stands.
    pub(super) fn coordinate_basis(&self, state: &State) -> CoordinateBasis {
        let zero = self.zeros(state);
        let unshifted = |axis: &AxisIndex| zero[*axis] == 0.0 && state.length_offset[*axis] == 0.0;
        CoordinateBasis {
            zero,
            unshifted_axes: (0..MAX_AXES).filter(unshifted).fold(0, |axes, axis| axes | 1 << axis),
            is_incremental: state.modal.distance == Distance::Incremental,
            measure: self.measure(state.modal.unit),
            max_coordinate: 999_999_999.0 / self.settings.increment.per_unit(),
        }
    }

    /// Takes a goal to where the block's axis words lead, but for those of a plane in which G16 is on.
    pub(super) fn resolve_axes(
        &self,
        block_words: &BlockWords,
        state: &State,
        basis: &CoordinateBasis,
        endpoint: &mut Endpoint,
    ) -> ExecResult<()> {
        let is_polar = state.modal.polar == Polar::On;
        for (axis, letter) in self.settings.axes.letters() {
            if is_polar && self.in_plane(state, axis) {
                continue;
            }
            let Some((raw, span)) = block_words.get(letter) else { continue };
            let value = locate(self.dimension_of(&raw, letter, &basis.measure), span)?;
            (endpoint.programmed[axis], endpoint.machine[axis]) = match self.settings.rolls_over[axis] {
                true => self.rollover_axis_end(axis, value, state, basis),
                false => self.axis_end(axis, value, state, basis),
            };
            if !basis.is_incremental {
                endpoint.work_zero_unknown &= !(1 << axis);
            }
        }
        Ok(())
    }

    /// Where the value of one axis word leads: as programmed, and on the machine. There that is right as long as the other
    /// axes [stand where they should](Executor::is_placed).
    #[inline(always)]
    pub(super) fn axis_end(
        &self,
        axis: AxisIndex,
        value: f64,
        state: &State,
        basis: &CoordinateBasis,
    ) -> (f64, f64) {
        let programmed = if basis.is_incremental {
            // Else the compiler computes it in G90 too, for nothing.
            cold_path();
            self.remove_residue(state.programmed[axis] + value)
        } else {
            value
        };
        // What is clean needn't be cleaned where nothing is added to it.
        let machine = match basis.unshifted_axes >> axis & 1 == 1 {
            true => programmed + 0.0,
            false => self.on_machine(programmed, basis.zero[axis], state.length_offset[axis]),
        };
        (programmed, machine)
    }

    /// The same of an axis that rolls over.
    fn rollover_axis_end(
        &self,
        axis: AxisIndex,
        value: f64,
        state: &State,
        basis: &CoordinateBasis,
    ) -> (f64, f64) {
        let from = state.programmed[axis];
        let travel = if basis.is_incremental { value } else { shortest_rotation(from, value) };
        (self.wrap_angle(axis, from + travel), self.remove_residue(state.machine[axis] + travel))
    }

    fn in_plane(&self, state: &State, axis: AxisIndex) -> bool {
        self.plane_axes(state.modal.plane).is_ok_and(|(first, second)| axis == first || axis == second)
    }

    /// G16: the plane's first axis is the radius, the second the angle.
    pub(super) fn resolve_polar(
        &self,
        block_words: &BlockWords,
        state: &mut State,
        point: &mut Position,
    ) -> ExecResult<()> {
        let Ok((first, second)) = self.plane_axes(state.modal.plane) else { return Ok(()) };
        let letter = |axis| self.settings.axes.letter(axis) as u8;
        let radius = self.dimension(block_words, letter(first), state)?;
        let angle = self.angle(block_words, letter(second))?;
        if radius.is_none() && angle.is_none() {
            return Ok(());
        }
        let incremental = state.modal.distance == Distance::Incremental;
        if !incremental {
            state.work_zero_unknown &= !(1 << first | 1 << second);
        }
        // Radius and angle are each absolute or incremental, as the block that commands them has it.
        if let Some(radius) = radius {
            state.polar = PolarPoint { radius: Some(radius), is_incremental: incremental, ..state.polar };
        }
        if state.polar.radius.is_none() {
            let what = "an angle in G16 before any radius (write both in its first block)".into();
            return Err(Alarm::NotSimulated { what }.located_at(block_words.span(letter(second))));
        }
        if let Some(angle) = angle {
            state.polar.angle = if incremental { state.polar.angle + angle } else { angle };
        }
        self.polar_point(&state.polar, (first, second), point);
        Ok(())
    }

    /// Moves a point to where radius and angle lead.
    pub(super) fn polar_point(
        &self,
        polar: &PolarPoint,
        plane: (AxisIndex, AxisIndex),
        point: &mut Position,
    ) {
        let centre = if polar.is_incremental { (point[plane.0], point[plane.1]) } else { (0.0, 0.0) };
        let radius = polar.radius.unwrap_or(0.0);
        point[plane.0] = self.remove_residue(centre.0 + radius * Deg(polar.angle).cos());
        point[plane.1] = self.remove_residue(centre.1 + radius * Deg(polar.angle).sin());
    }

    /// All axes start together at their own rapid rates; the slowest decides.
    pub(super) fn rapid_seconds(&self, from: &Position, to: &Position) -> f64 {
        self.rapid_seconds_of(0..self.settings.axes.len(), from, to)
    }

    /// The same of those axes that may move.
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

    /// The rate along the path and the time of a straight cut: the composite of all axes, mm and degrees as equal
    /// numbers (operator's manual, feed rate in G94).
    #[inline]
    pub(super) fn feed_seconds(
        &self,
        state: &State,
        from: &Position,
        to: &Position,
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        let travel = self.squared_travel(0..self.settings.axes.len(), from, to);
        self.travel_time(state, state.codes.f, travel, f_in_block)
    }

    /// How far some axes move.
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

    /// As [`ControlData::feed_seconds`] of an F that may not be in force yet.
    #[inline(always)]
    pub(super) fn travel_time(
        &self,
        state: &State,
        f: f64,
        SquaredTravel { linear: sliding, rotary: turning }: SquaredTravel,
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        let in_inches = || inch_length(sliding.sqrt(), turning);
        self.path_feed_time(state, f, ((sliding + turning).sqrt(), in_inches), f_in_block)
    }

    /// The rate and the time for a path of `length` mm on which nothing turns.
    #[inline]
    pub(super) fn path_time(
        &self,
        state: &State,
        length: f64,
        f_in_block: bool,
    ) -> Result<(MmPerMin, f64), Alarm> {
        self.path_feed_time(state, state.codes.f, (length, || inch_length(length, 0.0)), f_in_block)
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
        let per_minute = match state.modal.feed_mode {
            FeedMode::PerRevolution => f * state.codes.s,
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

/// The composite of a way of `sliding` mm and of what turns, squared degrees, as it counts in inches: of inches and degrees.
fn inch_length(sliding: f64, turning: f64) -> f64 {
    (sliding / 25.4 * (sliding / 25.4) + turning).sqrt()
}

/// How an axis that rolls over gets from one angle to another: the shorter way, half a turn in the plus direction.
pub(super) fn shortest_rotation(from: f64, to: f64) -> f64 {
    let rotation = (to - from).rem_euclid(360.0);
    if rotation > 180.0 { rotation - 360.0 } else { rotation }
}

#[cfg(test)]
mod tests {
    use super::shortest_rotation;

    #[test]
    fn a_rotary_axis_takes_the_shorter_way() {
        assert_eq!(shortest_rotation(0.0, -150.0), -150.0);
        assert_eq!(shortest_rotation(210.0, 540.0), -30.0);
        assert_eq!(shortest_rotation(0.0, 180.0), 180.0);
    }
}
