//! What a block does instead of moving by its modal codes, code by code: dwell, coordinate systems, G53, G60.
use super::Executor;

use super::eval::Checked;
use super::modal_codes::{AxisWordUse, not_simulated};
use super::notes::Note;
use super::plan::BlockPlan;
use super::state::State;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, Position};
use gcode_lang::program::codes::OneShot;
use gcode_lang::program::modes::{Distance, WorkSystem};
use gcode_lang::source::Span;
use gcode_lang::units::Seconds;

impl Executor {
    /// 4. What a block does instead of moving by its modal codes.
    pub(super) fn act(
        &self,
        act: AxisWordUse,
        given: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> Checked<()> {
        if !self.names_axis(given) {
            plan.notes.extend(without_axis(act));
        }
        match act {
            AxisWordUse::OneShot(one) => self.one_shot(one, given, plan, span),
            AxisWordUse::AdditionalWork => {
                let number = given.count(b'P')?.unwrap_or(1);
                if number == 0 || number as usize > self.offsets.additional.len() {
                    return Err(Alarm::OffsetNumber { number: i64::from(number) }.at(span));
                }
                plan.state.modal.work = WorkSystem::Additional(number as u16);
                self.recompute(&mut plan.state);
                self.motion(given, plan, false, span)
            }
            AxisWordUse::Scale => self.scale(given, plan, span),
            AxisWordUse::Rotate => self.rotate(given, plan, span),
            AxisWordUse::Tilt => self.tilt(given, plan, span),
            AxisWordUse::MirrorOn | AxisWordUse::MirrorOff => {
                self.mirror(act == AxisWordUse::MirrorOn, given, plan)
            }
        }
    }

    fn one_shot(&self, one: OneShot, given: &BlockWords, plan: &mut BlockPlan, span: Span) -> Checked<()> {
        let cycle = plan.state.modal.cycle.is_some();
        match one {
            OneShot::Dwell => self.dwell(given, plan),
            OneShot::DataInput => self.data_input(given, plan, span),
            OneShot::DataInputEnd => Ok(()),
            OneShot::CheckReference
            | OneShot::Reference
            | OneShot::FromReference
            | OneShot::SecondReference
                if cycle =>
            {
                Err(Alarm::ReferenceReturnInCycle.at(span))
            }
            OneShot::CheckReference => self.check_reference(given, plan, span),
            OneShot::Reference if self.settings.home_all && !self.names_axis(given) => {
                self.home_all(plan);
                Ok(())
            }
            OneShot::Reference => self.reference(given, plan, Position::default()),
            OneShot::SecondReference => {
                let p = given.count(b'P')?.unwrap_or(2);
                match p {
                    2..=4 => self.reference(given, plan, self.settings.references[p as usize - 2]),
                    _ => Err(Alarm::ReferenceReturnP { p: i64::from(p) }.at(span)),
                }
            }
            OneShot::FromReference => self.leave_reference(given, plan, span),
            OneShot::Skip => self.skip(given, plan, span),
            OneShot::LocalSystem => {
                self.each_axis(given, plan, |_, state, axis, value| state.local[axis] = value)?;
                self.recompute(&mut plan.state);
                Ok(())
            }
            OneShot::SetSystem => {
                // The point where the program stands gets these coordinates; the length offset stays out of it, and
                // G52 ends on these axes.
                self.each_axis(given, plan, |core, state, axis, value| {
                    let work = state.transform.forward(state.programmed)[axis];
                    state.shift[axis] = core.clean(state.shift[axis] + state.local[axis] + work - value);
                    state.local[axis] = 0.0;
                })?;
                self.recompute(&mut plan.state);
                Ok(())
            }
            OneShot::PresetSystem => {
                self.each_axis(given, plan, |_, state, axis, _| {
                    state.shift[axis] = 0.0;
                    state.local[axis] = 0.0;
                })?;
                self.recompute(&mut plan.state);
                Ok(())
            }
            OneShot::OneSide if cycle => Err(not_simulated(600, "in a drilling cycle").at(span)),
            OneShot::OneSide => self.one_side(given, plan),
            OneShot::CirclePocket(turn) => self.circle_pocket(turn, given, plan, span),
            OneShot::BoltHoles(holes) => self.bolt_holes(holes, given, plan, span),
            OneShot::MachineSystem => self.machine_system(given, plan),
            OneShot::CornerArc if self.ahead.is_on() => Ok(()),
            OneShot::CornerArc => {
                Err(Alarm::NotSimulated { what: "G39 without cutter compensation".into() }.at(span))
            }
        }
    }

    /// Every axis the block names, with its value.
    fn each_axis(
        &self,
        given: &BlockWords,
        plan: &mut BlockPlan,
        mut with: impl FnMut(&Self, &mut State, usize, f64),
    ) -> Checked<()> {
        for (axis, letter) in self.settings.axes.iter() {
            if let Some(value) = self.dimension(given, letter as u8, &plan.state)? {
                with(self, &mut plan.state, axis, value);
            }
        }
        Ok(())
    }

    fn dwell(&self, given: &BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        self.skip_signals(given, b'Q')?;
        if given.has(b'Q') {
            return Err(not_simulated(40, "dwell until a skip signal").at(given.span(b'Q')));
        }
        let seconds = if let Some(seconds) = self.pause(given)? {
            seconds
        } else if self.settings.dwell_in_seconds {
            0.0
        } else {
            let x = self.seconds(given, b'X')?;
            let u = if x.is_none() { self.seconds(given, b'U')? } else { None };
            x.or(u).unwrap_or(0.0)
        };
        if seconds > 0.0 {
            plan.events.push((EventKind::Dwell { time: Seconds(seconds) }, seconds));
        }
        Ok(())
    }

    /// G60: by rapid to a point before the end by 5440, whose sign is the side, and on to the end.
    fn one_side(&self, given: &BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        let goal = self.goal(given, &mut plan.state)?;
        let mut before = goal.machine;
        for (axis, letter) in self.settings.axes.iter() {
            if given.has(letter as u8) {
                before[axis] = self.clean(before[axis] - self.settings.overrun[axis]);
            }
        }
        self.rapid(plan, &before);
        self.rapid(plan, &goal.machine);
        plan.state.programmed = goal.programmed;
        plan.commands_axes = self.names_axis(given);
        Ok(())
    }

    /// G53: by rapid to machine coordinates, without the length offset.
    fn machine_system(&self, given: &BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        let mut to = plan.state.machine;
        let incremental = plan.state.modal.distance == Distance::Incremental;
        if incremental && !self.settings.unsure.g53_moves_in_g91 {
            given.accept(b"ABCUVWXYZ");
            plan.notes.push(Note::MachineMoveIgnored);
            return Ok(());
        }
        let mut named = 0;
        for (axis, letter) in self.settings.axes.iter() {
            if let Some(value) = self.dimension(given, letter as u8, &plan.state)? {
                named |= u8::from(!incremental) << axis;
                to[axis] = match incremental {
                    true => self.clean(to[axis] + value),
                    false => self.turned_to(axis, to[axis], value),
                };
            }
        }
        self.leave_work(plan, named);
        self.rapid(plan, &to);
        self.recompute(&mut plan.state);
        plan.commands_axes = true;
        Ok(())
    }
}

/// What there is to tell of a code in a block that names no axis.
fn without_axis(act: AxisWordUse) -> Option<Note> {
    let code = match act {
        AxisWordUse::Scale => return Some(Note::CentreDefaulted { code: 510 }),
        AxisWordUse::Rotate => return Some(Note::CentreDefaulted { code: 680 }),
        AxisWordUse::MirrorOn => 511,
        AxisWordUse::OneShot(one) => match one {
            OneShot::CheckReference => 270,
            OneShot::FromReference => 290,
            OneShot::Skip => 310,
            OneShot::LocalSystem => 520,
            OneShot::MachineSystem => 530,
            OneShot::OneSide => 600,
            OneShot::SetSystem => 920,
            OneShot::PresetSystem => 921,
            _ => return None,
        },
        AxisWordUse::AdditionalWork | AxisWordUse::MirrorOff | AxisWordUse::Tilt => return None,
    };
    Some(Note::NoAxis { code })
}
