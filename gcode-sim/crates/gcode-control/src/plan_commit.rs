//! Carries out what a block has planned, and tells the machine.
use super::block_effects::RunEnd;
use super::checked::ExecResult;
use super::cycle_expansion::CyclePlan;
use super::executor::Executor;
use super::lookahead::{Lookahead, ReadyEvent};
use super::plan::{BlockPlan, TableWrite};
use super::variables::VariableClass;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Event, EventKind, EventSink};
use gcode_lang::source::{Span, Spanned};
use gcode_lang::units::Seconds;

impl Executor {
    /// Everything a plan says, in the order it says it.
    pub(super) fn commit<S: EventSink>(&mut self, plan: &mut BlockPlan, sink: &mut S) {
        std::mem::swap(&mut self.registers.state, &mut plan.state);
        self.record_work_use(plan.state.modal.work, plan.commands_axes);
        let before = plan.state.work_zero_unknown;
        // What a cycle does along its axis it tells itself.
        let still = before
            & plan
                .cycle_plan
                .as_ref()
                .map_or(self.registers.state.work_zero_unknown, CyclePlan::unknown_axes);
        if still != before {
            self.emit(&EventKind::WorkZeroUnknown { axes: still }, 0.0, sink);
        }
        if plan.uses_lookahead {
            self.take_lookahead(&mut plan.lookahead, sink);
        }
        for (kind, seconds) in &plan.events {
            self.emit(kind, *seconds, sink);
        }
        if let Some(cycle_plan) = plan.cycle_plan.take() {
            self.emit_cycle(&cycle_plan, sink);
        }
        for (kind, seconds) in &plan.events_after_motion {
            self.emit(kind, *seconds, sink);
        }
        for write in &plan.writes {
            match *write {
                TableWrite::Work { system, axis, value } => {
                    self.registers.data.set_work_offset(system, axis, value);
                }
                TableWrite::Tool { register, number, value } => {
                    self.registers.data.offsets.register(register)[number as usize] = value;
                }
                TableWrite::Parameter { id: place, value, has_no_effect: kept } => {
                    self.registers.data.set_parameter(place, value, kept)
                }
                TableWrite::Variable { number, value } => {
                    if let VariableClass::Common(place) = self.registers.variables.classify(number) {
                        self.registers.variables.set(place, value);
                    }
                }
            }
            self.registers.update_after_offset_change();
        }
        for kind in &plan.stops {
            let stop = EventKind::Stop { kind: *kind, text: String::new(), variables: Vec::new() };
            self.emit(&stop, 0.0, sink);
        }
        for note in &plan.notes {
            self.log.note(*note, self.flow.block);
        }
        for code in &plan.auxiliary_codes {
            self.log.auxiliary_codes.entry(*code).or_insert(self.flow.block);
        }
        self.registers.update_is_plain();
    }

    fn emit_cycle<S: EventSink>(&mut self, cycle_plan: &CyclePlan, sink: &mut S) {
        let (mut seconds, mut moves) = (0.0, 0);
        let block = self.flow.block;
        let calls = self.flow.frame.calls.clone();
        cycle_plan.expand(&self.registers.data, &mut |kind, time| {
            seconds += time;
            moves += u64::from(kind.end().is_some());
            sink.event(&Event { kind: &kind, seconds: Seconds(time), block, calls: &calls });
        });
        self.registers.clock.motion_seconds += seconds;
        self.count_moves(moves);
    }

    /// Tells the machine one thing and counts it.
    #[inline(always)]
    pub(super) fn emit<S: EventSink>(&mut self, kind: &EventKind, seconds: f64, sink: &mut S) {
        self.count_event(kind, seconds);
        let block = self.flow.block;
        sink.event(&Event { kind, seconds: Seconds(seconds), block, calls: &self.flow.frame.calls });
    }

    /// Counts what is told.
    #[inline(always)]
    pub(super) fn count_event(&mut self, kind: &EventKind, seconds: f64) {
        self.registers.clock.motion_seconds += seconds;
        self.count_moves(u64::from(kind.end().is_some()));
        if let EventKind::Stop { kind, text, variables: named } = kind {
            self.log.record_stop(*kind, text, named);
        }
    }

    /// Counts a move that nobody is told of.
    #[inline(always)]
    pub(super) fn count_move(&mut self, seconds: f64) {
        self.registers.clock.motion_seconds += seconds;
        self.count_moves(1);
    }

    #[inline(always)]
    fn count_moves(&mut self, moves: u64) {
        self.log.moves += moves;
        if self.log.moves > self.log.max_moves {
            self.registers.block_effects.end_run(RunEnd::MoveLimit);
        }
    }

    /// Takes over what a plan has read ahead, and tells the machine what no longer waits.
    pub(crate) fn take_lookahead<S: EventSink>(&mut self, lookahead: &mut Lookahead, sink: &mut S) {
        std::mem::swap(&mut self.registers.lookahead, lookahead);
        self.emit_ready(sink);
    }

    /// A block with nothing but a sequence number.
    pub(crate) fn process_number_block<S: EventSink>(&mut self, block: Span, sink: &mut S) -> ExecResult<()> {
        if self.registers.lookahead.is_idle() {
            return Ok(());
        }
        let mut lookahead = self.registers.lookahead.clone();
        lookahead.count_number(&self.registers.data, block)?;
        self.registers.data.check_ready_moves(&lookahead)?;
        self.take_lookahead(&mut lookahead, sink);
        Ok(())
    }

    /// Does what waits at the end of a program that has no M30.
    pub(crate) fn finish_lookahead<S: EventSink>(&mut self, sink: &mut S) -> ExecResult<()> {
        if self.registers.lookahead.is_idle() {
            return Ok(());
        }
        let mut lookahead = self.registers.lookahead.clone();
        lookahead.finish(&self.registers.data, self.flow.block)?;
        self.registers.data.check_ready_moves(&lookahead)?;
        self.take_lookahead(&mut lookahead, sink);
        Ok(())
    }

    /// Does what waits before an alarm ends the run.
    pub(crate) fn finish_before_alarm<S: EventSink>(&mut self, alarm: &Spanned<Alarm>, sink: &mut S) {
        if self.registers.lookahead.is_idle() {
            return;
        }
        let refused = matches!(alarm.node, Alarm::Interference | Alarm::Overtravel { .. });
        let refused = refused.then_some(alarm.span);
        let mut lookahead = std::mem::take(&mut self.registers.lookahead);
        lookahead.finish_before_alarm(&self.registers.data, refused);
        self.take_lookahead(&mut lookahead, sink);
    }

    fn emit_ready<S: EventSink>(&mut self, sink: &mut S) {
        let ready: Vec<ReadyEvent> = self.registers.lookahead.take_ready();
        for (kind, seconds, place) in ready {
            self.count_event(&kind, seconds);
            let (seconds, block) = (Seconds(seconds), place.block);
            sink.event(&Event { kind: &kind, seconds, block, calls: &place.calls });
        }
        if self.registers.lookahead.is_idle() {
            self.registers.lookahead = Lookahead::default();
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Control, Limits, Outcome};
    use gcode_lang::program::{Memory, NoLibrary};

    #[test]
    fn names_are_given_all_or_none() {
        let mut memory = Memory::default();
        memory.load("names.nc", *b"O1\nSETVN548[A,B]\nSETVN549[C,D]\nM30\n");
        let mut control = Control::new(memory, gcode_lang::control::Settings::default());
        let outcome = control.run(Limits::default(), &mut NoLibrary, &mut ());
        assert!(matches!(outcome, Outcome::Alarm(_)), "550 has no name");
        let named =
            ["A", "B", "C"].map(|name| control.executor.registers.variables.named_variable(name).ok());
        assert_eq!(named, [Some(548), Some(549), None]);
    }
}
