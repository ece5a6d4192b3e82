//! A plain move: a block of axis words, G00 or G01 and F while nothing is in force that makes more of them. Most steps
//! of a block have nothing to do for it, and of the state it changes little.
use super::Core;
use super::eval::{Checked, at};
use super::travel::Goal;
use super::words::{Given, letters};
use crate::motion::{EventKind, Sink};
use crate::program::Words;
use crate::program::modes::{CutterSide, Motion, Polar};
use crate::units::MmPerMin;

impl Core {
    /// Does a block that is a plain move; whether it is one. All checks come first.
    #[inline(always)]
    pub(super) fn step<S: Sink>(
        &mut self,
        words: &Words,
        given: &Given,
        number: Option<u32>,
        sink: &mut S,
    ) -> Checked<bool> {
        let state = &*self.state;
        let Some(zero) = &self.plain_zero else { return Ok(false) };
        let motion = self.plain_motion(words, given);
        if !matches!(motion, Some(Motion::Rapid | Motion::Linear)) {
            return Ok(false);
        }
        let f = if given.has(b'F') { self.feed_word(given, state)? } else { None };
        let f = f.unwrap_or(state.codes.f);
        let mut goal = Goal::here(state);
        let led = self.lead(given, state, zero, &mut goal)?;
        if led.reach > self.farthest() {
            self.beyond_range(given, &goal.machine)?;
        }
        let (rate, seconds) = match motion {
            Some(Motion::Rapid) => (MmPerMin::ZERO, self.rapid_seconds(&state.machine, &goal.machine)),
            _ => at(self.time_of(state, f, led.way, given.has(b'F')), self.block)?,
        };

        let Goal { programmed, machine, unplaced } = goal;
        let before = state.unplaced;
        let state = &mut *self.state;
        (state.programmed, state.machine, state.unplaced) = (programmed, machine, unplaced);
        (state.modal.motion, state.codes.f) = (motion.unwrap_or_default(), f);
        state.codes.n = number.unwrap_or(state.codes.n);
        self.note_work(self.state.modal.work, true);
        if unplaced != before {
            self.tell(&EventKind::Unplaced { axes: unplaced }, 0.0, sink);
        }
        match motion {
            _ if !led.way.is_some() => {}
            Some(Motion::Rapid) => self.tell(&EventKind::Rapid { to: machine }, seconds, sink),
            _ => self.tell(&EventKind::Feed { to: machine, rate }, seconds, sink),
        }
        Ok(true)
    }

    /// The code of group 01 by which a block moves that has nothing but axis words, F and such codes, while no modal call
    /// waits for it.
    #[inline(always)]
    fn plain_motion(&self, words: &Words, given: &Given) -> Option<Motion> {
        let axes = self.settings.axes.mask();
        let alone = given.has_of(axes)
            && !given.has_of(!(axes | letters(b"F")))
            && !given.has_more_than_moves()
            && !given.has_corner()
            && given.m_count == 0
            && words.call.is_none()
            && !self.waits_for_moves();
        alone.then(|| given.motion.unwrap_or(self.state.modal.motion))
    }

    /// Finds out, behind everything that could change it, whether the next block can be a plain move, and what its axes
    /// count from.
    pub(super) fn see_if_plain(&mut self) {
        self.plain_zero = self.is_plain().then(|| self.zeros(&self.state));
    }

    /// Whether nothing is in force between two blocks that could make more of axis words than a move of those axes.
    fn is_plain(&self) -> bool {
        let modal = &self.state.modal;
        modal.cycle.is_none()
            && modal.cutter == CutterSide::Off
            && modal.polar == Polar::Off
            && self.state.ended.is_none()
            && self.ahead.is_idle()
            && self.settings.code_calls.is_empty()
            && self.settings.stroke.is_none()
            && self.is_placed()
    }
}
