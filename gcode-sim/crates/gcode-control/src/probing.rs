//! G31 and the machine's answer to it: where the skip signal comes, and where the axes stand then.
use super::checked::{ExecResult, locate};
use super::modal_codes::not_simulated;
use super::notes::Note;
use super::plan::{BlockPlan, SkipPlan};
use super::planner::Planner;
use super::registers::Registers;
use super::words::BlockWords;
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::motion::{EventKind, EventSink, MAX_AXES, Position, SkipMove, SkipSignal};
use gcode_lang::program::modes::CutterSide;
use gcode_lang::source::Span;
use gcode_lang::units::Seconds;

impl Planner<'_> {
    /// G31: a straight cut that ends where the skip signal comes. It is planned to its end; whether the signal comes
    /// is asked when everything is known to be in order.
    pub(super) fn plan_skip(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if plan.state.modal.cutter != CutterSide::Off || self.registers.lookahead.is_offset() {
            return Err(Alarm::SkipInCompensation.located_at(span));
        }
        self.check_skip_signal_set(block_words, b'P')?;
        if block_words.count(b'Q')?.is_some_and(|torque| !(1..=99).contains(&torque)) {
            return Err(Alarm::SkipTorque.located_at(block_words.span(b'Q')));
        }
        if block_words.has_any(b"PQ") {
            return Err(not_simulated(310, "multi-step and torque limit skip").located_at(span));
        }
        let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
        let (from, to) = (plan.state.machine, endpoint.machine);
        let (rate, seconds) =
            locate(self.data.feed_seconds(&plan.state, &from, &to, block_words.has(b'F')), span)?;
        plan.skip_plan = Some(SkipPlan { event: plan.events.len(), from, to, rate, seconds, span });
        plan.events.push((EventKind::Skip { to, rate, has_signal: false }, seconds));
        plan.state.machine = to;
        plan.state.skip_position = to;
        plan.state.programmed = endpoint.programmed;
        plan.commands_axes = true;
        Ok(())
    }

    /// G31 P and G04 Q name a set of skip signals.
    pub(super) fn check_skip_signal_set(&self, block_words: &BlockWords, letter: u8) -> ExecResult<()> {
        match block_words.count(letter)? {
            Some(set) if !(1..=4).contains(&set) => {
                Err(Alarm::SkipSignals { letter: char::from(letter) }.located_at(block_words.span(letter)))
            }
            _ => Ok(()),
        }
    }
}

impl Registers {
    /// Asks where the signal comes and ends the planned motion there. The alarm, if any, is raised after the motion.
    pub(super) fn resolve_skip_signal<S: EventSink>(
        &self,
        plan: &mut BlockPlan,
        sink: &mut S,
    ) -> Option<LocatedAlarm> {
        let skip_plan = plan.skip_plan.take()?;
        let SkipPlan { from, to, rate, seconds, span, .. } = skip_plan;
        let signal = match self.data.settings.skip_signal {
            Some(part) => SkipSignal::Received { latched: part, stop_fraction: part },
            None => {
                match sink.skip_signal(&SkipMove { from: &from, to: &to, rate, seconds: Seconds(seconds) }) {
                    Some(signal) => {
                        // The next touch may come elsewhere, so a loop round this block may end.
                        self.clock.has_been_read.set(true);
                        signal
                    }
                    None => {
                        plan.notes.push(Note::NoSkipSignal);
                        SkipSignal::Missed
                    }
                }
            }
        };
        let (noted, stopped, alarm) = match signal {
            SkipSignal::Received { latched: noted, stop_fraction: stopped } => (noted, stopped, None),
            SkipSignal::Missed => {
                return self.data.settings.missed_skip_alarms.then(|| Alarm::SkipMissed.located_at(span));
            }
            SkipSignal::StylusBroken { stopped, deflection: pushed, overtravel_limit: give } => (
                stopped,
                stopped,
                Some(Alarm::StylusBroken { deflection: pushed, overtravel_limit: give }.located_at(span)),
            ),
        };
        let point_at = |part: f64| {
            let mut place = Position::default();
            for axis in 0..MAX_AXES {
                place[axis] = self.data.remove_residue(from[axis] + part * (to[axis] - from[axis]));
            }
            place
        };
        let end = point_at(stopped);
        plan.events[skip_plan.event] =
            (EventKind::Skip { to: end, rate, has_signal: true }, stopped * seconds);
        plan.state.skip_position = point_at(noted);
        plan.state.machine = end;
        if !self.data.settings.undocumented.skip_keeps_end {
            self.data.recompute_position(&mut plan.state);
        }
        alarm
    }
}
