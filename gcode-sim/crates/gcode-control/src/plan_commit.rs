//! Carries out what a block has planned, and tells the machine.
use super::cycle_expansion::CyclePlan;
use super::plan::{BlockPlan, TableWrite};
use super::run::RunEnd;
use super::variables::VariableClass;
use super::{Executor, MAX_STOPS, OperatorStop};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Event, EventKind, EventSink, StopKind};
use gcode_lang::units::Seconds;

impl Executor {
    /// Everything a plan says, in the order it says it.
    pub(super) fn commit<S: EventSink>(&mut self, plan: &mut BlockPlan, sink: &mut S) {
        std::mem::swap(&mut self.state, &mut plan.state);
        self.record_work_use(plan.state.modal.work, plan.commands_axes);
        let before = plan.state.work_zero_unknown;
        // What a cycle does along its axis it tells itself.
        let still =
            before & plan.cycle_plan.as_ref().map_or(self.state.work_zero_unknown, CyclePlan::unknown_axes);
        if still != before {
            self.emit(&EventKind::WorkZeroUnknown { axes: still }, 0.0, sink);
        }
        if plan.uses_lookahead {
            self.take_lookahead(&mut plan.lookahead, sink);
        }
        for (kind, seconds) in &plan.events {
            self.emit(kind, *seconds, sink);
        }
        if let Some(drill) = plan.cycle_plan.take() {
            self.emit_cycle(&drill, sink);
        }
        for (kind, seconds) in &plan.events_after_motion {
            self.emit(kind, *seconds, sink);
        }
        for write in &plan.writes {
            match *write {
                TableWrite::Work { system, axis, value } => {
                    self.offsets.work_mut(system)[axis] = value;
                    self.record_system_set(system);
                }
                TableWrite::Tool { register, number, value } => {
                    self.offsets.register(register)[number as usize] = value;
                }
                TableWrite::Parameter { id: place, value, has_no_effect: kept } => {
                    self.set_parameter(place, value, kept)
                }
                TableWrite::Variable { number, value } => {
                    if let VariableClass::Common(place) = self.vars.classify(number) {
                        self.vars.set(place, value);
                    }
                }
            }
            self.update_after_offset_change();
        }
        for kind in &plan.stops {
            let stop = EventKind::Stop { kind: *kind, text: String::new(), variables: Vec::new() };
            self.emit(&stop, 0.0, sink);
        }
        for note in &plan.notes {
            self.notes.entry(*note).or_insert(self.block);
        }
        for code in &plan.auxiliary_codes {
            self.auxiliary_codes.entry(*code).or_insert(self.block);
        }
        self.update_is_plain();
    }

    fn emit_cycle<S: EventSink>(&mut self, drill: &CyclePlan, sink: &mut S) {
        let (mut seconds, mut moves) = (0.0, 0);
        let block = self.block;
        let calls = self.frame.calls.clone();
        self.expand_cycle(drill, &mut |kind, time| {
            seconds += time;
            moves += u64::from(kind.end().is_some());
            sink.event(&Event { kind: &kind, seconds: Seconds(time), block, calls: &calls });
        });
        self.seconds += seconds;
        self.count_moves(moves);
    }

    /// Tells the machine one thing and counts it.
    #[inline(always)]
    pub(super) fn emit<S: EventSink>(&mut self, kind: &EventKind, seconds: f64, sink: &mut S) {
        self.count_event(kind, seconds);
        let block = self.block;
        sink.event(&Event { kind, seconds: Seconds(seconds), block, calls: &self.frame.calls });
    }

    /// Counts what is told.
    #[inline(always)]
    pub(super) fn count_event(&mut self, kind: &EventKind, seconds: f64) {
        self.seconds += seconds;
        self.count_moves(u64::from(kind.end().is_some()));
        if let EventKind::Stop { kind, text, variables: named } = kind {
            self.count_stop(*kind, text, named);
        }
    }

    /// Counts a move that nobody is told of.
    #[inline(always)]
    pub(super) fn count_move(&mut self, seconds: f64) {
        self.seconds += seconds;
        self.count_moves(1);
    }

    #[inline(always)]
    fn count_moves(&mut self, moves: u64) {
        self.moves += moves;
        if self.moves > self.max_moves {
            self.block_effects.end_run(RunEnd::MoveLimit);
        }
    }

    #[inline(never)]
    fn count_stop(&mut self, kind: StopKind, text: &str, named: &[(u32, f64)]) {
        if self.stops.len() < MAX_STOPS {
            self.stops.push(OperatorStop { kind, text: text.to_owned(), variables: named.to_vec() });
        }
    }

    pub(super) fn set_names(&mut self, first: u32, names: &[String]) -> Result<(), Alarm> {
        let numbered = || {
            let number = |place: usize| first.saturating_add(place as u32);
            names.iter().enumerate().map(move |(place, name)| (number(place), name))
        };
        if let Some((number, _)) = numbered().find(|(number, _)| !(500..=549).contains(number)) {
            return Err(Alarm::NoSuchVariable { number: i64::from(number) });
        }
        for (number, name) in numbered() {
            // A variable has one name: the last.
            self.names.retain(|_, named| *named != number);
            self.names.insert(name.clone(), number);
        }
        Ok(())
    }

    pub(super) fn named_variable(&self, name: &str) -> Result<u32, Alarm> {
        let unknown = || Alarm::NoVariableName { name: name.to_owned() };
        self.names.get(name).copied().ok_or_else(unknown)
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
        let named: Vec<_> =
            control.executor.names.iter().map(|(name, number)| (name.as_str(), *number)).collect();
        assert_eq!(named, [("A", 548), ("B", 549)]);
    }
}
