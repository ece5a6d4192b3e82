//! A plain move: a block of axis words, G00 or G01 and F while nothing is in force that makes more of them. Most steps
//! of a block have nothing to do for it, and of the state it changes little.
use super::Core;
use super::eval::{Checked, at};
use super::travel::Goal;
use super::words::{Given, letters};
use crate::motion::{EventKind, Sink};
use crate::program::Words;
use crate::program::codes::Effect;
use crate::program::modes::{CutterSide, Motion, Polar};
use crate::source::Span;
use crate::units::MmPerMin;

/// A plain move, planned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    goal: Goal,
    motion: Motion,
    f: f64,
    rate: MmPerMin,
    seconds: f64,
}

impl Core {
    /// The plan of a block that is a plain move; `None` where it isn't one.
    #[inline(always)]
    pub(super) fn step(&self, words: &Words, given: &Given, span: Span) -> Checked<Option<Step>> {
        let state = &*self.state;
        if !self.is_plain || !self.moves_plainly(words, given) {
            return Ok(None);
        }
        let coded = given.g_codes().filter_map(|row| match row.effect {
            Effect::Motion(motion) => Some(motion),
            _ => None,
        });
        let motion = coded.last().unwrap_or(state.modal.motion);
        if !matches!(motion, Motion::Rapid | Motion::Linear) {
            return Ok(None);
        }
        let f = if given.has(b'F') { self.feed_word(given, state)? } else { None };
        let f = f.unwrap_or(state.codes.f);
        let mut goal = Goal::here(state);
        self.lead(given, state, &mut goal)?;
        self.in_range(given, &goal.machine)?;
        let way = (&state.machine, &goal.machine);
        let (rate, seconds) = match motion {
            Motion::Rapid => (MmPerMin::ZERO, self.rapid_seconds(way.0, way.1)),
            _ => at(self.feed_seconds(state, f, way, given.has(b'F')), span)?,
        };
        Ok(Some(Step { goal, motion, f, rate, seconds }))
    }

    /// Whether a block has nothing but axis words, codes of group 01 and F, and no modal call waits for it.
    #[inline(always)]
    fn moves_plainly(&self, words: &Words, given: &Given) -> bool {
        let axes = self.settings.axes.mask();
        given.has_of(axes)
            && !given.has_of(!(axes | letters(b"F")))
            && !given.has_more_than_moves()
            && !given.has_corner()
            && given.m_count == 0
            && words.call.is_none()
            && !self.waits_for_moves()
    }

    /// Whether nothing is in force between two blocks that could make more of axis words than a move of those axes.
    pub(super) fn is_plain(&self) -> bool {
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

    /// Carries out a plain move.
    #[inline(always)]
    pub(super) fn take_step<S: Sink>(&mut self, step: &Step, number: Option<u32>, sink: &mut S) {
        let Step { goal: Goal { programmed, machine, unplaced }, motion, f, rate, seconds } = step;
        let state = &mut *self.state;
        let (moves, before) = (*machine != state.machine, state.unplaced);
        (state.programmed, state.machine, state.unplaced) = (*programmed, *machine, *unplaced);
        (state.modal.motion, state.codes.f) = (*motion, *f);
        if let Some(number) = number {
            state.codes.n = number;
        }
        self.note_work(self.state.modal.work, true);
        if *unplaced != before {
            self.tell(&EventKind::Unplaced { axes: *unplaced }, 0.0, sink);
        }
        let to = *machine;
        match motion {
            _ if !moves => {}
            Motion::Rapid => self.tell(&EventKind::Rapid { to }, *seconds, sink),
            _ => self.tell(&EventKind::Feed { to, rate: *rate }, *seconds, sink),
        }
    }
}
