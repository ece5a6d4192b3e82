//! Everything of a control but its programs; carries out the plan of a block and emits its events.
use super::cycle_expansion::CyclePlan;
use super::data::{ControlData, system_index};
use super::flow::ProgramFlow;
use super::functions::ExecResult;
use super::lookahead::Lookahead;
use super::outcome::{BlockEffects, RunEnd, RunLog, UnsetWorkOffset};
use super::plan::{BlockPlan, TableWrite};
use super::planner::Planner;
use super::registers::Registers;
use super::variables::VariableClass;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::motion::{Event, EventKind, EventSink};
use gcode_lang::program::modes::{GroupSet, ModalGroup, WorkSystem};
use gcode_lang::program::{ProgramId, Words};
use gcode_lang::source::{Span, Spanned};
use gcode_lang::units::Seconds;

/// State that a run changes: registers, position in the programs, and the record.
#[derive(Clone, Debug)]
pub(super) struct Executor {
    pub(super) registers: Registers,
    pub(super) flow: ProgramFlow,
    pub(super) log: RunLog,
}

/// Record of a run to which every event adds: its moves and stops.
struct EventCounter<'a> {
    log: &'a mut RunLog,
    block_effects: &'a BlockEffects,
}

impl EventCounter<'_> {
    #[inline(always)]
    fn count_event(&mut self, kind: &EventKind) {
        self.count_moves(u64::from(kind.end().is_some()));
        if let EventKind::Stop { kind, text, variables } = kind {
            self.log.record_stop(*kind, text, variables);
        }
    }

    #[inline(always)]
    fn count_moves(&mut self, moves: u64) {
        self.log.moves += moves;
        if self.log.moves > self.log.max_moves {
            self.block_effects.end_run(RunEnd::MoveLimit);
        }
    }
}

impl Executor {
    pub(super) fn new(settings: Settings) -> Self {
        let flow = ProgramFlow::new(ProgramId::default());
        Self { registers: Registers::new(settings), flow, log: RunLog::default() }
    }

    /// Returns the planner of a block with these words.
    #[inline(always)]
    pub(super) fn planner<'a>(&'a self, lowered: &'a Words, words: &'a BlockWords) -> Planner<'a> {
        let Self { registers, flow, log: _ } = self;
        Planner { registers, data: &registers.data, flow, lowered_words: lowered, words, block: flow.block }
    }

    /// Carries out a plan in the order of its fields.
    pub(super) fn commit<S: EventSink>(&mut self, plan: &mut BlockPlan, sink: &mut S) {
        std::mem::swap(&mut self.registers.state, &mut plan.state);
        self.record_work_use(plan.state.modal.work, plan.placed_axes);
        self.log.restores_length |= plan.restores_length;
        if !plan.commanded_groups.is_empty() {
            self.record_groups(plan.commanded_groups);
        }
        if plan.uses_lookahead {
            self.take_lookahead(&mut plan.lookahead, sink);
        }
        for (kind, seconds) in &plan.events {
            self.emit_on_machine(kind, *seconds, sink);
        }
        // The first positioning of a cycle sends the M codes of its block.
        for (kind, seconds) in &plan.events_after_motion {
            self.emit(kind, *seconds, sink);
        }
        if let Some(cycle_plan) = plan.cycle_plan.take() {
            self.log.has_drilled = true;
            self.emit_cycle(&cycle_plan, sink);
        }
        let Registers { data, variables, panel, .. } = &mut self.registers;
        for write in &plan.writes {
            match *write {
                TableWrite::Work { system, axis, value, is_set: true } => {
                    data.set_work_offset(system, axis, value)
                }
                TableWrite::Work { system, axis, value, is_set: false } => {
                    data.offsets.work[system][axis] = value;
                }
                TableWrite::Tool { register, number, value } => {
                    data.offsets.tools[register as usize][number as usize] = value;
                }
                TableWrite::Fixture { index, axis, value } => {
                    data.offsets.fixtures[index].get_or_insert_default()[axis] = value;
                }
                TableWrite::SettingError { index, item, value } => {
                    data.offsets.setting_errors[index].get_or_insert_default()[item] = value;
                }
                TableWrite::Parameter { id, value, has_no_effect } => {
                    data.set_parameter(id, value, has_no_effect)
                }
                TableWrite::Variable { number, value } => match variables.classify(number) {
                    VariableClass::Common(index) => variables.set(index, value),
                    // An output.
                    VariableClass::System => match number {
                        1100..=1131 => panel.set_output(number - 1100, value.number() != 0.0),
                        _ => panel.store(number, value.number()),
                    },
                    VariableClass::Local(_) | VariableClass::Vacant => {}
                },
            }
        }
        if !plan.writes.is_empty() {
            self.registers.update_after_offset_change();
        }
        for kind in &plan.stops {
            let stop = EventKind::Stop { kind: *kind, text: String::new(), variables: Vec::new() };
            self.emit(&stop, 0.0, sink);
        }
        for note in &plan.notes {
            self.log.note(*note, self.flow.block);
        }
        for code in &plan.builder_m_codes {
            self.log.builder_m_codes.entry(*code).or_insert(self.flow.block);
        }
        self.registers.update_is_plain();
    }

    fn emit_cycle<S: EventSink>(&mut self, cycle_plan: &CyclePlan, sink: &mut S) {
        let Self { registers: Registers { data, state, clock, block_effects, .. }, flow, log } = self;
        let mut counter = EventCounter { log, block_effects };
        let mut cycle_seconds = 0.0;
        let (block, calls) = (flow.block, &flow.frame.calls);
        let mut pass_on = |kind: EventKind, seconds: f64| {
            cycle_seconds += seconds;
            counter.count_event(&kind);
            sink.event(&Event { kind: &kind, seconds: Seconds(seconds), block, calls });
        };
        let mut virtual_plane = state.virtual_plane;
        state.stated_unknown = cycle_plan.expand(data, &mut |kind, seconds| match &mut virtual_plane {
            Some(plane) => plane.emit(&kind, seconds, data.settings.chord_tolerance, &mut pass_on),
            None => pass_on(kind, seconds),
        });
        state.virtual_plane = virtual_plane;
        // The time of a block is one sum.
        clock.motion_seconds += cycle_seconds;
    }

    /// Emits an event; that of a virtual plane as the events of the machine.
    fn emit_on_machine<S: EventSink>(&mut self, kind: &EventKind, seconds: f64, sink: &mut S) {
        let Some(mut plane) = self.registers.state.virtual_plane else {
            return self.emit(kind, seconds, sink);
        };
        let tolerance = self.registers.data.settings.chord_tolerance;
        plane.emit(kind, seconds, tolerance, &mut |kind, seconds| self.emit(&kind, seconds, sink));
        self.registers.state.virtual_plane = Some(plane);
    }

    #[inline(always)]
    pub(super) fn emit<S: EventSink>(&mut self, kind: &EventKind, seconds: f64, sink: &mut S) {
        self.count_event(kind, seconds);
        self.pass_on(kind, seconds, sink);
    }

    /// Gives an event of the current block to a sink without counting it.
    #[inline(always)]
    pub(super) fn pass_on<S: EventSink>(&self, kind: &EventKind, seconds: f64, sink: &mut S) {
        let block = self.flow.block;
        sink.event(&Event { kind, seconds: Seconds(seconds), block, calls: &self.flow.frame.calls });
    }

    #[inline(always)]
    fn count_event(&mut self, kind: &EventKind, seconds: f64) {
        self.registers.clock.motion_seconds += seconds;
        self.counter().count_event(kind);
    }

    #[inline(always)]
    fn counter(&mut self) -> EventCounter<'_> {
        EventCounter { log: &mut self.log, block_effects: &self.registers.block_effects }
    }

    /// Counts a move without emitting it, for a sink that isn't active.
    #[inline(always)]
    pub(super) fn count_move(&mut self, seconds: f64) {
        self.registers.clock.motion_seconds += seconds;
        self.counter().count_moves(1);
    }

    /// Replaces the lookahead by that of a plan, and emits the events that no longer wait.
    fn take_lookahead<S: EventSink>(&mut self, lookahead: &mut Lookahead, sink: &mut S) {
        std::mem::swap(&mut self.registers.lookahead, lookahead);
        let tolerance = self.registers.data.settings.chord_tolerance;
        let mut virtual_plane = self.registers.state.virtual_plane;
        for (kind, seconds, backtrace) in self.registers.lookahead.take_ready() {
            let mut pass_on = |kind: EventKind, seconds: f64| {
                self.count_event(&kind, seconds);
                let (seconds, block) = (Seconds(seconds), backtrace.block);
                sink.event(&Event { kind: &kind, seconds, block, calls: &backtrace.calls });
            };
            match &mut virtual_plane {
                Some(plane) => plane.emit(&kind, seconds, tolerance, &mut pass_on),
                None => pass_on(kind, seconds),
            }
        }
        self.registers.state.virtual_plane = virtual_plane;
        if self.registers.lookahead.is_idle() {
            self.registers.lookahead = Lookahead::default();
        }
    }

    /// Advances the lookahead without a plan, if a move waits; an alarm changes nothing.
    pub(super) fn advance_lookahead<S: EventSink>(
        &mut self,
        sink: &mut S,
        advance: fn(&mut Lookahead, &ControlData, Span) -> ExecResult<()>,
    ) -> ExecResult<()> {
        if self.registers.lookahead.is_idle() {
            return Ok(());
        }
        let mut lookahead = self.registers.lookahead.clone();
        advance(&mut lookahead, &self.registers.data, self.flow.block)?;
        lookahead.check_stroke(&self.registers.data, &self.registers.state)?;
        self.take_lookahead(&mut lookahead, sink);
        Ok(())
    }

    /// Executes what waits before an alarm ends the run.
    pub(super) fn finish_before_alarm<S: EventSink>(&mut self, alarm: &Spanned<Alarm>, sink: &mut S) {
        if self.registers.lookahead.is_idle() {
            return;
        }
        let refused = matches!(alarm.node, Alarm::Interference | Alarm::Overtravel { .. });
        let refused = refused.then_some(alarm.span);
        let mut lookahead = std::mem::take(&mut self.registers.lookahead);
        lookahead.finish_before_alarm(&self.registers.data, refused);
        self.take_lookahead(&mut lookahead, sink);
    }

    /// Records the use of the work coordinate system by a block that places these axes, as bits. G54 counts as set: its zero is
    /// the part's if no system is selected.
    #[inline]
    pub(super) fn record_work_use(&mut self, before: WorkSystem, axes: u8) {
        let work = self.registers.state.modal.work;
        if work == WorkSystem::default() {
            self.log.first_placed_axes |= axes;
        } else {
            self.record_other_work(work, before, axes);
        }
    }

    /// Records modal groups that a block commands, before its moves.
    fn record_groups(&mut self, groups: GroupSet) {
        let log = &mut self.log;
        if 0 < log.moves || !self.registers.lookahead.is_idle() {
            let mut late = groups.without(log.commanded_groups);
            if !log.has_drilled {
                late = late.without(GroupSet::of(&[ModalGroup::ReturnTo]));
            }
            log.late_groups = log.late_groups.union(late);
        }
        log.commanded_groups = log.commanded_groups.union(groups);
    }

    #[inline(never)]
    fn record_other_work(&mut self, work: WorkSystem, before: WorkSystem, axes: u8) {
        if work != before {
            self.log.work_selected = self.flow.backtrace();
        }
        if axes == 0 {
            return;
        }
        *self.log.other_placed_axes.entry(work).or_default() |= axes;
        let set_axes = self.registers.data.set_offsets.axes(system_index(work));
        let axes = axes & !set_axes;
        if axes == 0 {
            return;
        }
        let unset = &mut self.log.unset_systems;
        match unset.iter_mut().find(|unset| unset.system == work) {
            Some(unset) => unset.axes |= axes,
            None => {
                let selected = self.log.work_selected.clone();
                unset.push(UnsetWorkOffset { system: work, axes, is_partly_set: set_axes != 0, selected });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Control, Limits, Outcome};
    use gcode_lang::program::{Memory, NoLibrary};

    #[test]
    fn setvn_gives_all_names_or_none() {
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
