//! Codes that act in their own block only: dwell, G10, coordinate systems, reference return, skip.
use super::Core;
use super::block::{Act, not_simulated};
use super::eval::{Checked, at};
use super::notes::Note;
use super::offsets::Register;
use super::plan::{Plan, Write};
use super::state::State;
use super::vars::{Kind, Value};
use super::words::Given;
use crate::alarm::Alarm;
use crate::motion::{EventKind, Position};
use crate::program::codes::OneShot;
use crate::program::modes::{Distance, Length, WorkSystem};
use crate::source::Span;
use crate::units::Seconds;

impl Core {
    /// 4. What a block does instead of moving by its modal codes.
    pub(super) fn act(&self, act: Act, given: &Given, plan: &mut Plan, span: Span) -> Checked<()> {
        if !self.names_axis(given) {
            plan.note = without_axis(act).or(plan.note);
        }
        match act {
            Act::OneShot(one) => self.one_shot(one, given, plan, span),
            Act::AdditionalWork => {
                let number = given.count(b'P')?.unwrap_or(1);
                if number == 0 || number as usize > self.offsets.additional.len() {
                    return Err(Alarm::OffsetNumber { number: i64::from(number) }.at(span));
                }
                plan.state.modal.work = WorkSystem::Additional(number as u16);
                self.recompute(&mut plan.state);
                self.motion(given, plan, false, span)
            }
            Act::Scale => self.scale(given, plan, span),
            Act::Rotate => self.rotate(given, plan, span),
            Act::Tilt => self.tilt(given, plan, span),
            Act::MirrorOn | Act::MirrorOff => self.mirror(act == Act::MirrorOn, given, plan),
        }
    }

    fn one_shot(&self, one: OneShot, given: &Given, plan: &mut Plan, span: Span) -> Checked<()> {
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
        given: &Given,
        plan: &mut Plan,
        mut with: impl FnMut(&Self, &mut State, usize, f64),
    ) -> Checked<()> {
        for (axis, letter) in self.settings.axes.iter() {
            if let Some(value) = self.dimension(given, letter as u8, &plan.state)? {
                with(self, &mut plan.state, axis, value);
            }
        }
        Ok(())
    }

    fn dwell(&self, given: &Given, plan: &mut Plan) -> Checked<()> {
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

    /// G28 and G30: by rapid over the intermediate point to the reference position, the named axes only.
    fn reference(&self, given: &Given, plan: &mut Plan, reference: Position) -> Checked<()> {
        if !self.names_axis(given) {
            let code = given.g_codes().find(|row| row.code == 300).map_or(280, |row| row.code);
            plan.note = Some(Note::NoAxis { code });
        }
        let goal = self.goal(given, &mut plan.state)?;
        self.rapid(plan, goal.machine);
        let mut home = plan.state.machine;
        for (axis, letter) in self.settings.axes.iter() {
            if given.has(letter as u8) {
                plan.state.intermediate[axis] = goal.machine[axis] - self.zero(&plan.state, axis);
                plan.state.has_intermediate |= 1 << axis;
                home[axis] = self.turned_to(axis, home[axis], reference[axis]);
            }
        }
        self.rapid(plan, home);
        // The length offset is cancelled where its axis reaches the reference position.
        let z = self.settings.axes.find(b'Z');
        if z.is_some() && given.has(b'Z') && plan.state.modal.length != Length::Off {
            if plan.state.length != Position::default() {
                plan.tell(EventKind::ToolLength { offset: Position::default() });
            }
            plan.state.length = Position::default();
            plan.state.modal.length = Length::Off;
        }
        self.recompute(&mut plan.state);
        plan.moved = true;
        Ok(())
    }

    /// G28 of a Haas without an axis: all of them straight home, and no length offset any more.
    fn home_all(&self, plan: &mut Plan) {
        let mut home = plan.state.machine;
        for (axis, _) in self.settings.axes.iter() {
            home[axis] = self.turned_to(axis, home[axis], 0.0);
        }
        self.rapid(plan, home);
        if plan.state.length != Position::default() {
            plan.tell(EventKind::ToolLength { offset: Position::default() });
        }
        plan.state.length = Position::default();
        plan.state.modal.length = Length::Off;
        self.recompute(&mut plan.state);
        plan.moved = true;
    }

    /// G29: over the intermediate point of the last G28 to the given point.
    fn leave_reference(&self, given: &Given, plan: &mut Plan, span: Span) -> Checked<()> {
        let mut over = plan.state.machine;
        for (axis, letter) in self.settings.axes.iter() {
            if !given.has(letter as u8) {
                continue;
            }
            if plan.state.has_intermediate >> axis & 1 == 0 {
                return Err(Alarm::NoIntermediatePoint.at(span));
            }
            over[axis] = self.clean(plan.state.intermediate[axis] + self.zero(&plan.state, axis));
        }
        self.rapid(plan, over);
        self.recompute(&mut plan.state);
        let goal = self.goal(given, &mut plan.state)?;
        self.rapid(plan, goal.machine);
        plan.state.programmed = goal.programmed;
        plan.moved = true;
        Ok(())
    }

    fn check_reference(&self, given: &Given, plan: &mut Plan, span: Span) -> Checked<()> {
        let goal = self.goal(given, &mut plan.state)?;
        self.rapid(plan, goal.machine);
        plan.state.programmed = goal.programmed;
        for (axis, letter) in self.settings.axes.iter() {
            if given.has(letter as u8) && self.rolled(axis, plan.state.machine[axis]) != 0.0 {
                return Err(Alarm::NotAtReference { letter }.at(span));
            }
        }
        plan.moved = true;
        Ok(())
    }

    /// G60: by rapid to a point before the end by 5440, whose sign is the side, and on to the end.
    fn one_side(&self, given: &Given, plan: &mut Plan) -> Checked<()> {
        let goal = self.goal(given, &mut plan.state)?;
        let mut before = goal.machine;
        for (axis, letter) in self.settings.axes.iter() {
            if given.has(letter as u8) {
                before[axis] = self.clean(before[axis] - self.settings.overrun[axis]);
            }
        }
        self.rapid(plan, before);
        self.rapid(plan, goal.machine);
        plan.state.programmed = goal.programmed;
        plan.moved = self.names_axis(given);
        Ok(())
    }

    /// G53: by rapid to machine coordinates, without the length offset.
    fn machine_system(&self, given: &Given, plan: &mut Plan) -> Checked<()> {
        let mut to = plan.state.machine;
        let incremental = plan.state.modal.distance == Distance::Incremental;
        if incremental && !self.settings.unsure.g53_moves_in_g91 {
            given.accept(b"ABCUVWXYZ");
            plan.note = Some(Note::MachineMoveIgnored);
            return Ok(());
        }
        for (axis, letter) in self.settings.axes.iter() {
            if let Some(value) = self.dimension(given, letter as u8, &plan.state)? {
                to[axis] = match incremental {
                    true => self.clean(to[axis] + value),
                    false => self.turned_to(axis, to[axis], value),
                };
            }
        }
        self.rapid(plan, to);
        self.recompute(&mut plan.state);
        plan.moved = true;
        Ok(())
    }

    /// G31 P and G04 Q name a set of skip signals.
    pub(super) fn skip_signals(&self, given: &Given, letter: u8) -> Checked<()> {
        match given.count(letter)? {
            Some(set) if !(1..=4).contains(&set) => {
                Err(Alarm::SkipSignals { letter: char::from(letter) }.at(given.span(letter)))
            }
            _ => Ok(()),
        }
    }

    /// G10: L2 and L20 work offsets, L10 to L13 tool offsets, L50 and L52 parameters, L85
    /// variables.
    fn data_input(&self, given: &Given, plan: &mut Plan, span: Span) -> Checked<()> {
        let format = |what: &str| Alarm::G10Format { what: what.to_owned() }.at(span);
        let adds = plan.state.modal.distance == Distance::Incremental;
        let p = given.count(b'P')?;
        let l = given.count(b'L')?.ok_or_else(|| format("L is missing"))?;
        match l {
            3 | 14 | 50 | 52 | 85 if !self.settings.parameter_input => {
                Err(format(&format!("L{l} is not known")))
            }
            2 | 20 => {
                let p = p.ok_or_else(|| format("P is missing"))? as usize;
                let system = match l {
                    2 if p <= 6 => p,
                    20 if (1..=self.offsets.additional.len()).contains(&p) => 6 + p,
                    _ => return Err(Alarm::OffsetNumber { number: p as i64 }.at(span)),
                };
                for (axis, letter) in self.settings.axes.iter() {
                    let Some(value) = self.dimension(given, letter as u8, &plan.state)? else { continue };
                    let old = if adds { self.offsets.work(system)[axis] } else { 0.0 };
                    plan.writes.push(Write::Work {
                        system,
                        axis,
                        value: at(self.offset_in_range(self.clean(old + value)), span)?,
                    });
                }
                Ok(())
            }
            1 | 10..=13 => {
                let register = match l {
                    10 => Register::HGeometry,
                    12 => Register::DGeometry,
                    13 => Register::DWear,
                    _ => Register::HWear,
                };
                let number = p.ok_or_else(|| format("P is missing"))?;
                let old = at(self.offsets.tool(register, number), span)?;
                if number == 0 {
                    return Err(Alarm::OffsetNumber { number: 0 }.at(span));
                }
                let value =
                    self.dimension(given, b'R', &plan.state)?.ok_or_else(|| format("R is missing"))?;
                let value =
                    at(self.offset_in_range(self.clean(if adds { old + value } else { value })), span)?;
                plan.writes.push(Write::Tool { register, number, value });
                Ok(())
            }
            50 | 52 => {
                plan.state.parameter_input = true;
                Ok(())
            }
            85 => {
                let number = p.ok_or_else(|| format("P, the variable, is missing"))?;
                if !matches!(self.vars.kind(number), Kind::Common(_)) {
                    return Err(Alarm::NoSuchVariable { number: i64::from(number) }.at(given.span(b'P')));
                }
                let bits = given.punched.ok_or_else(|| format("L85 needs sixteen digits in brackets"))?;
                let value = match f64::from_bits(bits) {
                    value if value.is_finite() => Value::Number(value),
                    // All bits set are a vacant variable.
                    _ if bits == u64::MAX => Value::Vacant,
                    _ => return Err(format("the digits are no number")),
                };
                plan.writes.push(Write::Variable { number, value });
                Ok(())
            }
            3 => Err(Alarm::NotSimulated { what: "G10 L3 (tool life management)".into() }.at(span)),
            14 => Err(Alarm::NotSimulated { what: "G10 L14 (tool geometry)".into() }.at(span)),
            _ => Err(format(&format!("L{l} is not known"))),
        }
    }
}

/// What there is to tell of a code in a block that names no axis.
fn without_axis(act: Act) -> Option<Note> {
    let code = match act {
        Act::Scale => return Some(Note::CentreHere { code: 510 }),
        Act::Rotate => return Some(Note::CentreHere { code: 680 }),
        Act::MirrorOn => 511,
        Act::OneShot(one) => match one {
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
        Act::AdditionalWork | Act::MirrorOff | Act::Tilt => return None,
    };
    Some(Note::NoAxis { code })
}
