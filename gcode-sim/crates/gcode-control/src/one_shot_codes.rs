//! What a block does instead of moving by its modal codes, code by code: dwell, coordinate systems, G53, G60.
use super::checked::ExecResult;
use super::modal_codes::{AxisWordUse, not_simulated};
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, Position};
use gcode_lang::program::code_facts::WithoutAxes;
use gcode_lang::program::g_codes::{GCodeRow, OneShot};
use gcode_lang::program::modes::{Distance, WorkSystem};
use gcode_lang::source::Span;
use gcode_lang::units::Seconds;

impl Planner<'_> {
    /// 4. What a block does instead of moving by its modal codes.
    pub(super) fn execute_axis_use(
        &self,
        axis_use: AxisWordUse,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if !self.data.names_axis(block_words) {
            plan.notes.extend(block_words.g_codes().filter_map(|row| self.note_without_axis(row)));
        }
        match axis_use {
            AxisWordUse::OneShot(one) => self.execute_one_shot(one, block_words, plan, span),
            AxisWordUse::AdditionalWork => {
                let number = block_words.count(b'P')?.unwrap_or(1);
                if number == 0 || number as usize > self.data.offsets.additional.len() {
                    return Err(Alarm::OffsetNumber { number: i64::from(number) }.located_at(span));
                }
                plan.state.modal.work = WorkSystem::Additional(number as u16);
                self.data.recompute_position(&mut plan.state);
                self.plan_motion(block_words, plan, false, span)
            }
            AxisWordUse::Scale => self.plan_scaling(block_words, plan, span),
            AxisWordUse::Rotate => self.plan_rotation(block_words, plan, span),
            AxisWordUse::Tilt => self.plan_tilt(block_words, plan, span),
            AxisWordUse::MirrorOn | AxisWordUse::MirrorOff => {
                self.plan_mirror(axis_use == AxisWordUse::MirrorOn, block_words, plan)
            }
        }
    }

    /// The note of a code in a block that names no axis.
    fn note_without_axis(&self, row: &GCodeRow) -> Option<Note> {
        let code = row.code;
        match row.facts.without_axes {
            WithoutAxes::Same => None,
            WithoutAxes::AllOrNothing if self.data.settings.homes_all_axes => None,
            WithoutAxes::Nothing | WithoutAxes::AllOrNothing => Some(Note::NoAxis { code }),
            WithoutAxes::CentreDefaulted => Some(Note::CentreDefaulted { code }),
        }
    }

    fn execute_one_shot(
        &self,
        one: OneShot,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let cycle = plan.state.modal.cycle.is_some();
        match one {
            OneShot::Dwell => self.plan_dwell(block_words, plan),
            OneShot::DataInput => self.plan_data_input(block_words, plan, span),
            OneShot::DataInputEnd => Ok(()),
            OneShot::CheckReference
            | OneShot::Reference
            | OneShot::FromReference
            | OneShot::SecondReference
                if cycle =>
            {
                Err(Alarm::ReferenceReturnInCycle.located_at(span))
            }
            OneShot::CheckReference => self.plan_reference_check(block_words, plan, span),
            OneShot::Reference if self.data.settings.homes_all_axes && !self.data.names_axis(block_words) => {
                self.plan_home_all(plan);
                Ok(())
            }
            OneShot::Reference => self.plan_reference_return(block_words, plan, Position::default()),
            OneShot::SecondReference => {
                let p = block_words.count(b'P')?.unwrap_or(2);
                match p {
                    2..=4 => self.plan_reference_return(
                        block_words,
                        plan,
                        self.data.settings.reference_positions[p as usize - 2],
                    ),
                    _ => Err(Alarm::ReferenceReturnP { p: i64::from(p) }.located_at(span)),
                }
            }
            OneShot::FromReference => self.plan_return_from_reference(block_words, plan, span),
            OneShot::Skip => self.plan_skip(block_words, plan, span),
            OneShot::LocalSystem => {
                self.for_each_axis(block_words, plan, |_, state, axis, value| {
                    state.local_offset[axis] = value
                })?;
                self.data.recompute_position(&mut plan.state);
                Ok(())
            }
            OneShot::SetSystem => {
                // The point where the program stands gets these coordinates; the length offset stays out of it, and
                // G52 ends on these axes.
                self.for_each_axis(block_words, plan, |planner, state, axis, value| {
                    let work = state.transform.forward(state.programmed)[axis];
                    state.coordinate_shift[axis] = planner.data.remove_residue(
                        state.coordinate_shift[axis] + state.local_offset[axis] + work - value,
                    );
                    state.local_offset[axis] = 0.0;
                })?;
                self.data.recompute_position(&mut plan.state);
                Ok(())
            }
            OneShot::PresetSystem => {
                self.for_each_axis(block_words, plan, |_, state, axis, _| {
                    state.coordinate_shift[axis] = 0.0;
                    state.local_offset[axis] = 0.0;
                })?;
                self.data.recompute_position(&mut plan.state);
                Ok(())
            }
            OneShot::OneSide if cycle => Err(not_simulated(600, "in a drilling cycle").located_at(span)),
            OneShot::OneSide => self.plan_one_side(block_words, plan),
            OneShot::CirclePocket(turn) => self.plan_circle_pocket(turn, block_words, plan, span),
            OneShot::BoltHoles(holes) => self.plan_bolt_holes(holes, block_words, plan, span),
            OneShot::MachineSystem => self.plan_machine_move(block_words, plan),
            OneShot::CornerArc if self.registers.lookahead.is_on() => Ok(()),
            OneShot::CornerArc => {
                Err(Alarm::NotSimulated { what: "G39 without cutter compensation".into() }.located_at(span))
            }
        }
    }

    /// Every axis the block names, with its value.
    fn for_each_axis(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        mut with: impl FnMut(&Self, &mut State, usize, f64),
    ) -> ExecResult<()> {
        for (axis, letter) in self.data.settings.axes.iter() {
            if let Some(value) = self.data.dimension(block_words, letter as u8, &plan.state)? {
                with(self, &mut plan.state, axis, value);
            }
        }
        Ok(())
    }

    fn plan_dwell(&self, block_words: &BlockWords, plan: &mut BlockPlan) -> ExecResult<()> {
        self.check_skip_signal_set(block_words, b'Q')?;
        if block_words.has(b'Q') {
            return Err(not_simulated(40, "dwell until a skip signal").located_at(block_words.span(b'Q')));
        }
        let seconds = if let Some(seconds) = self.data.dwell_seconds(block_words)? {
            seconds
        } else if self.data.settings.dwell_in_seconds {
            0.0
        } else {
            let x = self.data.seconds(block_words, b'X')?;
            let u = if x.is_none() { self.data.seconds(block_words, b'U')? } else { None };
            x.or(u).unwrap_or(0.0)
        };
        if seconds > 0.0 {
            plan.events.push((EventKind::Dwell { time: Seconds(seconds) }, seconds));
        }
        Ok(())
    }

    /// G60: by rapid to a point before the end by 5440, whose sign is the side, and on to the end.
    fn plan_one_side(&self, block_words: &BlockWords, plan: &mut BlockPlan) -> ExecResult<()> {
        let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
        let mut before = endpoint.machine;
        for (axis, letter) in self.data.settings.axes.iter() {
            if block_words.has(letter as u8) {
                before[axis] =
                    self.data.remove_residue(before[axis] - self.data.settings.one_side_overrun[axis]);
            }
        }
        self.push_rapid(plan, &before);
        self.push_rapid(plan, &endpoint.machine);
        plan.state.programmed = endpoint.programmed;
        plan.commands_axes = self.data.names_axis(block_words);
        Ok(())
    }

    /// G53: by rapid to machine coordinates, without the length offset.
    fn plan_machine_move(&self, block_words: &BlockWords, plan: &mut BlockPlan) -> ExecResult<()> {
        let mut to = plan.state.machine;
        let incremental = plan.state.modal.distance == Distance::Incremental;
        if incremental && !self.data.settings.undocumented.g53_moves_in_g91 {
            block_words.mark_read(b"ABCUVWXYZ");
            plan.notes.push(Note::MachineMoveIgnored);
            return Ok(());
        }
        let mut named = 0;
        for (axis, letter) in self.data.settings.axes.iter() {
            if let Some(value) = self.data.dimension(block_words, letter as u8, &plan.state)? {
                named |= u8::from(!incremental) << axis;
                to[axis] = match incremental {
                    true => self.data.remove_residue(to[axis] + value),
                    false => self.data.rollover_target(axis, to[axis], value),
                };
            }
        }
        self.note_unknown_work_zero(plan, named);
        self.push_rapid(plan, &to);
        self.data.recompute_position(&mut plan.state);
        plan.commands_axes = true;
        Ok(())
    }
}
