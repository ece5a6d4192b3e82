//! Planner of a block: reads the control and the values of the block's words. It can't change the control, so a block that
//! raises an alarm has changed nothing.
use super::data::ControlData;
use super::flow::ProgramFlow;
use super::functions::{ExecResult, locate};
use super::linear_motion::{CoordinateBasis, Endpoint};
use super::registers::Registers;
use super::state::{Modal, PolarPoint, State};
use super::words::{BlockWords, WordNumber};
use crate::contour::Blend;
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::Words;
use gcode_lang::program::modes::{CutterSide, Distance, Polar, Unit};
use gcode_lang::source::Span;
use gcode_lang::units::POWERS;

/// The control and the words of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planner<'a> {
    pub(super) registers: &'a Registers,
    /// Part of the registers that most of the planning needs.
    pub(super) data: &'a ControlData,
    pub(super) flow: &'a ProgramFlow,
    /// Words as lowered, with the call of the block.
    pub(super) lowered_words: &'a Words,
    /// Evaluated words.
    pub(super) words: &'a BlockWords,
    /// Span of the block.
    pub(super) block: Span,
}

impl Planner<'_> {
    /// Locates an alarm at the block.
    pub(super) fn locate<T>(&self, result: Result<T, Alarm>) -> ExecResult<T> {
        locate(result, self.block)
    }

    /// Returns the alarm of a block that the simulator does not execute.
    pub(super) fn not_simulated(&self, what: impl Into<String>) -> LocatedAlarm {
        Alarm::NotSimulated { what: what.into() }.located_at(self.block)
    }

    /// Returns the alarm of a G code in a mode that rules it out, named with the code that ends the mode.
    pub(super) fn code_in_mode(
        &self,
        code: impl Into<String>,
        (active, cancel): (&'static str, &'static str),
    ) -> LocatedAlarm {
        Alarm::CodeInMode(code.into(), active, cancel).located_at(self.block)
    }

    /// Raises the alarm of a G code that the simulator doesn't execute in a canned cycle.
    pub(super) fn check_outside_cycle(&self, code: &str, modal: &Modal) -> ExecResult<()> {
        match modal.cycle {
            Some(_) => Err(self.code_in_mode(code, ("a canned cycle", "G80"))),
            None => Ok(()),
        }
    }

    /// Raises the alarm of a G code that the simulator executes neither in a canned cycle nor in cutter compensation.
    pub(super) fn check_outside_cycle_and_offset(&self, code: &str, modal: &Modal) -> ExecResult<()> {
        self.check_outside_cycle(code, modal)?;
        if modal.cutter != CutterSide::Off {
            return Err(self.code_in_mode(code, ("cutter compensation", "G40")));
        }
        Ok(())
    }

    pub(super) fn names_axis(&self) -> bool {
        self.words.has_letters(self.data.settings.axes.letter_bits())
    }

    pub(super) fn names(&self, axis: AxisIndex) -> bool {
        self.words.has(self.data.axis_letter(axis))
    }

    pub(super) fn named_axes(&self) -> impl Iterator<Item = AxisIndex> {
        (0..self.data.settings.axes.len()).filter(|axis| self.names(*axis))
    }

    /// Returns the length in mm or the angle in degrees of a word, a multiple of the increment of its address.
    pub(super) fn dimension(&self, letter: u8, state: &State) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = self.words.get(letter) else { return Ok(None) };
        locate(self.data.dimension_of(&raw, letter, &self.data.measure(state.modal.unit)), span).map(Some)
    }

    pub(super) fn axis_dimension(&self, axis: AxisIndex, state: &State) -> ExecResult<Option<f64>> {
        self.dimension(self.data.axis_letter(axis), state)
    }

    /// Returns the angle at an address that is a length elsewhere: R of G68.
    pub(super) fn angle(&self, letter: u8) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = self.words.get(letter) else { return Ok(None) };
        locate(self.data.metric_value(&raw), span).map(Some)
    }

    /// Returns the time of a word in seconds: X and U count increments of 0.001 s without a point.
    pub(super) fn seconds(&self, letter: u8) -> ExecResult<Option<f64>> {
        let value = self.angle(letter)?;
        if value.is_some_and(|value| value < 0.0) {
            return Err(
                Alarm::IllegalMinus { letter: char::from(letter) }.located_at(self.words.span(letter))
            );
        }
        Ok(value)
    }

    /// Returns `,R` or `,C` of a cutting move.
    pub(super) fn corner_word(&self, state: &State) -> ExecResult<Option<Blend>> {
        let Some((letter, raw, span)) = self.words.corner else { return Ok(None) };
        let decimals = self.data.decimals(b'X', state.modal.unit);
        let value = locate(self.data.increments(&raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.located_at(span));
        }
        let is_inch = state.modal.unit == Unit::Inch;
        let length = if is_inch { self.data.remove_residue(value * 25.4) } else { value };
        Ok(Some(if letter == b'R' { Blend::Round(length) } else { Blend::Chamfer(length) }))
    }

    /// Returns a whole number with a sign: I J K of G51.
    pub(super) fn factor(&self, letter: u8) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = self.words.get(letter) else { return Ok(None) };
        match raw {
            WordNumber::Literal(number) if number.places.is_some() => {
                Err(Alarm::IllegalPoint { letter: Some(char::from(letter)) }.located_at(span))
            }
            WordNumber::Literal(number) => Ok(Some(number.value())),
            WordNumber::Computed(value) => Ok(Some(value.round())),
        }
    }

    /// Returns P of a dwell in seconds: milliseconds, or on some controls seconds where it has a point.
    pub(super) fn dwell_seconds(&self) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = self.words.get(b'P') else { return Ok(None) };
        match raw {
            WordNumber::Literal(number) if self.data.settings.dwell_in_seconds && number.places.is_some() => {
                if number.negative {
                    return Err(Alarm::IllegalMinus { letter: 'P' }.located_at(span));
                }
                Ok(Some(number.value()))
            }
            WordNumber::Computed(seconds)
                if self.data.settings.dwell_in_seconds
                    && self.data.settings.undocumented.computed_dwell_is_seconds =>
            {
                if seconds < 0.0 {
                    return Err(Alarm::IllegalMinus { letter: 'P' }.located_at(span));
                }
                Ok(Some(seconds))
            }
            _ => Ok(self.words.count(b'P')?.map(|milliseconds| f64::from(milliseconds) / 1000.0)),
        }
    }

    /// Returns F in the unit of the feed mode.
    pub(super) fn feed_word(&self, state: &State) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = self.words.get(b'F') else { return Ok(None) };
        locate(self.data.feed_of(&raw, state), span).map(Some)
    }

    /// Moves an end point to where the block's axis words lead, except those of a plane in which G16 is on.
    pub(super) fn resolve_axes(
        &self,
        state: &State,
        basis: &CoordinateBasis,
        endpoint: &mut Endpoint,
    ) -> ExecResult<()> {
        let polar_plane = match state.modal.polar {
            Polar::On => self.data.active_plane(state).ok(),
            Polar::Off => None,
        };
        for (axis, letter) in self.data.settings.axes.letters() {
            if polar_plane.is_some_and(|(first, second)| axis == first || axis == second) {
                continue;
            }
            let Some((raw, span)) = self.words.get(letter) else { continue };
            let value = match &state.virtual_plane {
                // The rotary axis of a virtual plane is a length: a radius counts in the unit of X.
                Some(plane) if plane.virtual_axis() == axis => {
                    let letter = if plane.scale() == 1.0 { b'X' } else { letter };
                    locate(self.data.dimension_of(&raw, letter, &basis.measure), span)? * plane.scale()
                }
                _ => locate(self.data.dimension_of(&raw, letter, &basis.measure), span)?,
            };
            let rolls_over = self.data.settings.rolls_over[axis] && !state.is_virtual(axis);
            (endpoint.programmed[axis], endpoint.machine[axis]) = match rolls_over {
                true => self.data.rollover_axis_end(axis, value, state, basis),
                false => self.data.axis_end(axis, value, state, basis),
            };
            if !basis.is_incremental {
                endpoint.unknown = state.apply_absolute(axis, endpoint.unknown);
            }
        }
        Ok(())
    }

    /// G16: the plane's first axis is the radius, the second the angle.
    pub(super) fn resolve_polar(&self, state: &mut State, point: &mut Position) -> ExecResult<()> {
        let Ok((first, second)) = self.data.active_plane(state) else { return Ok(()) };
        let letter = self.data.axis_letter(second);
        let (radius, angle) = (self.axis_dimension(first, state)?, self.angle(letter)?);
        if radius.is_none() && angle.is_none() {
            return Ok(());
        }
        let is_incremental = state.modal.distance == Distance::Incremental;
        // Radius and angle are each absolute or incremental, as the block that commands them has it.
        if radius.is_some() {
            state.polar = PolarPoint { radius, is_incremental, ..state.polar };
        }
        if state.polar.radius.is_none() {
            let what = "an angle in G16 before any radius (write both in its first block)".into();
            return Err(Alarm::NotSimulated { what }.located_at(self.words.span(letter)));
        }
        if let Some(angle) = angle {
            state.polar.angle = if is_incremental { state.polar.angle + angle } else { angle };
        }
        if !state.polar.is_incremental {
            for axis in [first, second] {
                state.unknown = state.apply_absolute(axis, state.unknown);
            }
        }
        self.data.polar_point(state, (first, second), point);
        Ok(())
    }
}
