//! G31: the planned move, the machine's skip signal, and the position of the axes then.
use super::functions::ExecResult;
use super::notes::Note;
use super::plan::{BlockPlan, OffsetMeasurement, SkipPlan};
use super::planner::Planner;
use super::registers::Registers;
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::motion::{EventKind, EventSink, Position, SkipMove, SkipSignal};
use gcode_lang::program::code_facts::Letters;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::m_codes::{self, MCodeEffect, SkipAlarm};
use gcode_lang::program::modes::CutterSide;
use gcode_lang::units::{MmPerMin, Seconds};

impl Planner<'_> {
    /// G31: plans a straight cut to its end point. [`Registers::resolve_skip_signal`] shortens it when the rest of the block
    /// is known to be in order.
    pub(super) fn plan_skip(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        // P selects the skip signals, but beside G54.1 or G154 the work coordinate system.
        let selects_work = self.words.has_non_motion_code(|effect| effect == Effect::AdditionalWork);
        let skips_by_torque = !selects_work && self.words.count(b'P')?.is_some_and(|p| matches!(p, 98 | 99));
        if !selects_work && !skips_by_torque {
            self.check_skip_signal_set(b'P')?;
        }
        if self.data.settings.undocumented.skip_takes_r {
            self.words.mark_read(Letters::of(b"R"));
        }
        if self.words.count(b'Q')?.is_some_and(|torque| !(1..=99).contains(&torque)) {
            return Err(Alarm::SkipTorque.located_at(self.words.span(b'Q')));
        }
        if self.words.has(b'Q') && !skips_by_torque {
            return Err(self.not_simulated("G31 (torque limit skip)"));
        }
        let endpoint = self.resolve_endpoint(plan)?;
        self.push_skip(plan, endpoint.machine, None)?;
        plan.state.programmed_position = endpoint.programmed;
        Ok(())
    }

    /// Adds a straight cut to `to` that the skip signal ends, and the offset that it sets.
    pub(super) fn push_skip(
        &self,
        plan: &mut BlockPlan,
        to: Position,
        measurement: Option<OffsetMeasurement>,
    ) -> ExecResult<()> {
        if plan.state.modal.cutter != CutterSide::Off || self.registers.lookahead.is_offset() {
            return Err(Alarm::SkipInCompensation.located_at(self.block));
        }
        let from = plan.state.machine_position;
        let timed = self.data.feed_seconds(&plan.state, &from, &to, self.words.has(b'F'));
        // Without an axis there is no cut that needs a feed.
        let (rate, seconds) = match timed {
            Err(Alarm::FeedZero) if !self.names_axis() => (MmPerMin(0.0), 0.0),
            timed => self.locate(timed)?,
        };
        plan.skip_plan = Some(SkipPlan {
            event: plan.events.len(),
            from,
            to,
            rate,
            seconds,
            alarm: self.commanded_skip_alarm(),
            sets_reference: self.m_code_effects().any(|effect| effect == MCodeEffect::SkipReference),
            measurement,
            span: self.block,
        });
        plan.push_move(EventKind::Skip { to, rate, has_signal: false }, seconds);
        plan.state.skip_position = to;
        plan.commands_axes = true;
        Ok(())
    }

    /// Returns the alarm that M78 or M79 of the block commands.
    fn commanded_skip_alarm(&self) -> Option<SkipAlarm> {
        self.m_code_effects().find_map(|effect| match effect {
            MCodeEffect::SkipAlarm(alarm) => Some(alarm),
            _ => None,
        })
    }

    fn m_code_effects(&self) -> impl Iterator<Item = MCodeEffect> + '_ {
        let codes = self.data.settings.codes;
        self.words.m_codes.iter().filter_map(move |(code, _)| m_codes::find(*code, codes))
    }

    /// Checks the set of skip signals that G31 P or G04 Q names.
    pub(super) fn check_skip_signal_set(&self, letter: u8) -> ExecResult<()> {
        match self.words.count(letter)? {
            Some(set) if !(1..=4).contains(&set) => {
                Err(Alarm::SkipSignals { letter: char::from(letter) }.located_at(self.words.span(letter)))
            }
            _ => Ok(()),
        }
    }
}

impl Registers {
    /// Ends the planned motion where the skip signal comes; returns the alarm that follows the motion.
    pub(super) fn resolve_probe_skip<S: EventSink>(
        &self,
        plan: &mut BlockPlan,
        sink: &mut S,
    ) -> Option<LocatedAlarm> {
        let SkipPlan { event, from, to, rate, seconds, alarm, sets_reference, measurement, span } =
            plan.skip_plan.take()?;
        let signal = match self.data.settings.skip_signal {
            Some(fraction) => SkipSignal::Received { latched: fraction, stop_fraction: fraction },
            None => {
                match sink.skip_signal(&SkipMove { from: &from, to: &to, rate, seconds: Seconds(seconds) }) {
                    Some(signal) => {
                        // The next signal may come elsewhere, so a loop with this block may end.
                        self.clock.has_been_read.set(true);
                        signal
                    }
                    // Without a source of signals nothing is known of this one.
                    None => {
                        plan.notes.push(Note::NoSkipSignal);
                        return self
                            .data
                            .settings
                            .missed_skip_alarms
                            .then(|| Alarm::SkipMissed.located_at(span));
                    }
                }
            }
        };
        let (latched, stopped, alarm) = match signal {
            SkipSignal::Received { latched, stop_fraction } => {
                let refused = alarm == Some(SkipAlarm::OnSignal);
                (latched, stop_fraction, refused.then(|| Alarm::SkipReceived.located_at(span)))
            }
            SkipSignal::Missed => {
                let alarms = self.data.settings.missed_skip_alarms || alarm == Some(SkipAlarm::OnMiss);
                return alarms.then(|| Alarm::SkipMissed.located_at(span));
            }
            SkipSignal::StylusBroken { stopped, deflection, overtravel_limit } => {
                let alarm = Alarm::StylusBroken { deflection, overtravel_limit }.located_at(span);
                (stopped, stopped, Some(alarm))
            }
        };
        let point_at = |fraction: f64| {
            let at = |axis| self.data.remove_residue(from[axis] + fraction * (to[axis] - from[axis]));
            Position(std::array::from_fn(at))
        };
        let end = point_at(stopped);
        plan.events[event] = (EventKind::Skip { to: end, rate, has_signal: true }, stopped * seconds);
        plan.state.skip_position = point_at(latched);
        plan.state.machine_position = end;
        if !self.data.settings.undocumented.skip_keeps_end {
            self.data.recompute_position(&mut plan.state);
        }
        if sets_reference {
            plan.state.skip_reference = Some(plan.state.skip_position);
        }
        if let Some(measurement) = measurement.filter(|_| alarm.is_none()) {
            plan.writes.extend(measurement.writes(&self.data, &plan.state));
        }
        alarm
    }
}
