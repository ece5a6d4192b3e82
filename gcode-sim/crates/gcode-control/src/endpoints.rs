//! Where the axis words of a block lead.
use super::checked::ExecResult;
use super::linear_motion::Endpoint;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, EventKind, Position};
use gcode_lang::program::modes::{Distance, Polar};

impl Planner<'_> {
    /// The end point of the block's axis words, from where `state` stands.
    pub(super) fn resolve_endpoint(
        &self,
        block_words: &BlockWords,
        state: &mut State,
    ) -> ExecResult<Endpoint> {
        let mut endpoint = Endpoint::at_current_position(state);
        let basis = self.data.coordinate_basis(state);
        self.data.resolve_axes(block_words, state, &basis, &mut endpoint)?;
        state.work_zero_unknown = endpoint.work_zero_unknown;
        if state.modal.polar == Polar::On {
            self.data.resolve_polar(block_words, state, &mut endpoint.programmed)?;
        }
        if state.last_end_point.is_some() && state.modal.distance == Distance::Absolute {
            self.note_axes_left_out(block_words, state);
        }
        let machine = self.data.to_machine(state, &endpoint.programmed);
        let rolled_machine = std::mem::replace(&mut endpoint.machine, machine);
        for axis in self
            .data
            .settings
            .rollover_axes()
            .filter(|axis| block_words.has(self.data.settings.axes.letter(*axis) as u8))
        {
            endpoint.machine[axis] = rolled_machine[axis];
        }
        if endpoint.machine.0.iter().any(|at| at.abs() > basis.max_coordinate) {
            self.check_coordinate_range(block_words, &endpoint.machine, basis.max_coordinate)?;
        }
        Ok(endpoint)
    }

    /// An axis that the block doesn't name keeps still, though its coordinate is another since a transform was switched.
    #[cold]
    fn note_axes_left_out(&self, block_words: &BlockWords, state: &State) {
        let is_left_out = |(axis, letter): (AxisIndex, char)| {
            !block_words.has(letter as u8) && self.data.move_end(state)[axis] != state.programmed[axis]
        };
        if self.data.settings.axes.iter().any(is_left_out) {
            self.registers.block_effects.record_note(Note::AxisLeftOut);
        }
    }

    /// The alarm of an axis beyond the largest coordinate, if one is there; one that rolls over begins anew with each turn.
    #[cold]
    fn check_coordinate_range(
        &self,
        block_words: &BlockWords,
        machine: &Position,
        most: f64,
    ) -> ExecResult<()> {
        for (axis, letter) in self.data.settings.axes.iter() {
            if machine[axis].abs() > most && !self.data.settings.rolls_over[axis] {
                let alarm = Alarm::PositionOverflow { letter, value: machine[axis] };
                let named = block_words.has(letter as u8);
                return Err(alarm.located_at(if named {
                    block_words.span(letter as u8)
                } else {
                    self.flow.block
                }));
            }
        }
        Ok(())
    }

    /// Tells a rapid to a point in machine coordinates; nothing where the tool already is there.
    pub(super) fn push_rapid(&self, plan: &mut BlockPlan, to: &Position) {
        let from = &plan.state.machine;
        if to != from {
            plan.events.push((EventKind::Rapid { to: *to }, self.data.rapid_seconds(from, to)));
            plan.state.machine = *to;
        }
    }

    /// Tells a straight cut; alarms where there is no feed, even if it leads nowhere.
    pub(super) fn push_feed(
        &self,
        plan: &mut BlockPlan,
        to: &Position,
        block_words: &BlockWords,
    ) -> Result<(), Alarm> {
        let from = &plan.state.machine;
        let (rate, seconds) = self.data.feed_seconds(&plan.state, from, to, block_words.has(b'F'))?;
        if to != from {
            plan.events.push((EventKind::Feed { to: *to, rate }, seconds));
            plan.state.machine = *to;
        }
        Ok(())
    }
}
