//! The reference position: G27 checks it, G28 and G30 go there, G29 comes back.
use super::checked::ExecResult;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, LengthCompensation, Position};
use gcode_lang::program::modes::Length;
use gcode_lang::source::Span;

impl Planner<'_> {
    pub(super) fn plan_reference_check(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
        self.push_rapid(plan, &endpoint.machine);
        plan.state.programmed = endpoint.programmed;
        for (axis, letter) in self.data.settings.axes.iter() {
            if block_words.has(letter as u8) && self.data.wrap_angle(axis, plan.state.machine[axis]) != 0.0 {
                return Err(Alarm::NotAtReference { letter }.located_at(span));
            }
        }
        plan.commands_axes = true;
        Ok(())
    }

    /// G28 and G30: by rapid over the intermediate point to the reference position, the named axes only.
    pub(super) fn plan_reference_return(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        reference: Position,
    ) -> ExecResult<()> {
        let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
        self.push_rapid(plan, &endpoint.machine);
        let mut home = plan.state.machine;
        let mut named = 0;
        for (axis, letter) in self.data.settings.axes.iter() {
            if block_words.has(letter as u8) {
                named |= 1 << axis;
                plan.state.intermediate[axis] = endpoint.machine[axis] - self.data.zero(&plan.state, axis);
                plan.state.has_intermediate |= 1 << axis;
                home[axis] = self.data.rollover_target(axis, home[axis], reference[axis]);
            }
        }
        self.note_unknown_work_zero(plan, named);
        self.push_rapid(plan, &home);
        // The length offset is cancelled where its axis reaches the reference position.
        let z = self.data.settings.axes.find(b'Z');
        if z.is_some() && block_words.has(b'Z') && plan.state.modal.length != Length::Off {
            cancel_length(plan);
        }
        self.data.recompute_position(&mut plan.state);
        plan.commands_axes = true;
        Ok(())
    }

    /// G28 of a Haas without an axis: all of them straight home, and no length offset any more.
    pub(super) fn plan_home_all(&self, plan: &mut BlockPlan) {
        let mut home = plan.state.machine;
        for (axis, _) in self.data.settings.axes.iter() {
            home[axis] = self.data.rollover_target(axis, home[axis], 0.0);
        }
        self.note_unknown_work_zero(
            plan,
            self.data.settings.axes.iter().fold(0, |axes, (axis, _)| axes | 1 << axis),
        );
        self.push_rapid(plan, &home);
        cancel_length(plan);
        self.data.recompute_position(&mut plan.state);
        plan.commands_axes = true;
    }

    /// G29: over the intermediate point of the last G28 to the given point.
    pub(super) fn plan_return_from_reference(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let mut intermediate = plan.state.machine;
        for (axis, letter) in self.data.settings.axes.iter() {
            if !block_words.has(letter as u8) {
                continue;
            }
            if plan.state.has_intermediate >> axis & 1 == 0 {
                return Err(Alarm::NoIntermediatePoint.located_at(span));
            }
            intermediate[axis] =
                self.data.remove_residue(plan.state.intermediate[axis] + self.data.zero(&plan.state, axis));
            plan.state.work_zero_unknown &= !(1 << axis);
        }
        self.push_rapid(plan, &intermediate);
        self.data.recompute_position(&mut plan.state);
        let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
        self.push_rapid(plan, &endpoint.machine);
        plan.state.programmed = endpoint.programmed;
        plan.commands_axes = true;
        Ok(())
    }
}

/// No tool length offset any more, nor G43 or G44.
fn cancel_length(plan: &mut BlockPlan) {
    if plan.state.modal.length != Length::Off {
        plan.push_event(EventKind::ToolLength {
            offset: Position::default(),
            compensation: LengthCompensation::Off,
        });
    }
    plan.state.length_offset = Position::default();
    plan.state.modal.length = Length::Off;
}
