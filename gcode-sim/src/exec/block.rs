//! A block of words: checked as a whole, then carried out.
//!
//! What one block does, in this order (operator's manual, order of execution in a block; the machine builder
//! decides about M codes, this is the usual choice):
//!  1. modal G codes, F S T D H;
//!  2. tool change, spindle and coolant on;
//!  3. tool length offset;
//!  4. dwell, G10, coordinate systems, reference return, or the move;
//!  5. spindle and coolant off;
//!  6. stop, end;
//!  7. call or return.
use super::Core;
use super::eval::{Checked, at};
use super::notes::Note;
use super::patterns::takes_l;
use super::plan::{Flow, Plan};
use super::words::Given;
use crate::alarm::Alarm;
use crate::motion::{EventKind, Spindle, StopKind};
use crate::program::codes::{Effect, OneShot};
use crate::program::m_codes::{self, MEffect};
use crate::program::modes::{CutterSide, Length, Mirror, Motion, Polar, Rotation, Scaling, StrokeCheck};
use crate::program::{Calling, Program, Words};
use crate::source::Span;
use crate::units::Rpm;

/// What uses the axis words of a block that doesn't simply move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Act {
    OneShot(OneShot),
    AdditionalWork,
    Scale,
    MirrorOn,
    MirrorOff,
    Rotate,
    Tilt,
}

impl Core {
    /// Checks a block of words and makes the plan of it. Nothing changes; an alarm leaves no trace.
    pub(super) fn prepare(
        &self,
        program: &Program,
        words: &Words,
        given: &mut Given,
        plan: &mut Plan,
        span: Span,
    ) -> Checked<()> {
        let words = match &words.short {
            Some((switch, short)) if self.skips(*switch) => short,
            _ => words,
        };
        plan.begin(&self.state);
        if self.macro_by_code(program, words, plan)? {
            return Ok(());
        }
        let calling = self.subprogram_by_code(program, words)?;
        self.collect(program, words, calling.as_ref(), given)?;
        self.beside_return(words)?;
        let act = self.modal_codes(given, plan, span)?;
        self.codes(given, plan, span)?;
        self.m_codes(given, plan)?;
        let lengthened = self.length(given, plan, span)?;
        match act {
            Some(act) => {
                if lengthened {
                    self.recompute(&mut plan.state);
                }
                self.act(act, given, plan, span)?;
            }
            None => self.motion(given, plan, lengthened, span)?,
        }
        if let Some(call) = &words.call {
            self.prepare_call(program, call, plan)?;
        }
        if let Some(calling) = calling {
            self.plan_calling_word(program, words, &calling, plan)?;
        }
        self.look_ahead(act, given, plan, span)?;
        self.check_unread(given, plan)?;
        self.check_stroke(plan, span)
    }

    /// What nothing has read may still mean something to a control: it isn't passed over in silence. M codes may take
    /// words of their own.
    fn check_unread(&self, given: &Given, plan: &Plan) -> Checked<()> {
        let for_m_code = plan.passed_on.is_some() || given.m_count > 0 && !self.names_axis(given);
        match given.unread() {
            Some((letter, span)) if !for_m_code => {
                Err(Alarm::NotSimulated { what: format!("{letter} in such a block") }.at(span))
            }
            _ => Ok(()),
        }
    }

    /// Only N, P and L may stand beside M99 while G66 is on.
    fn beside_return(&self, words: &Words) -> Checked<()> {
        let returns = words.call.as_ref().is_some_and(|call| call.kind == Calling::Return);
        match words.list.iter().find(|word| word.letter != b'L') {
            Some(word) if returns && !self.modal_calls.is_empty() => {
                Err(Alarm::WordsWithReturn { letter: char::from(word.letter) }.at(word.span))
            }
            _ => Ok(()),
        }
    }

    /// 1. Modal G codes in the order they stand in; the answer is what uses the axis words instead of a move.
    fn modal_codes(&self, given: &Given, plan: &mut Plan, span: Span) -> Checked<Option<Act>> {
        let state = &mut plan.state;
        let before = state.modal;
        let mut act = None;
        let mut latched = before.cycle.is_some();
        for row in given.g_codes() {
            let new = match row.effect {
                Effect::NotSimulated
                    if (450..=480).contains(&row.code) && state.modal.cutter != CutterSide::Off =>
                {
                    return Err(Alarm::ToolOffsetInCompensation.at(span));
                }
                Effect::NotSimulated | Effect::Call => return Err(not_simulated(row.code, row.help).at(span)),
                Effect::NoEffect => {
                    given.accept(b"IPQR");
                    None
                }
                Effect::Smoothness => {
                    given.accept(b"EP");
                    None
                }
                Effect::OneShot(one) => Some(Act::OneShot(one)),
                Effect::AdditionalWork => Some(Act::AdditionalWork),
                Effect::Scaling(Scaling::On) => Some(Act::Scale),
                Effect::Mirror(Mirror::On) => Some(Act::MirrorOn),
                Effect::Mirror(Mirror::Off) => Some(Act::MirrorOff),
                Effect::Rotation(Rotation::On) => Some(Act::Rotate),
                Effect::Rotation(Rotation::Tilted) => Some(Act::Tilt),
                _ => None,
            };
            if new.is_some() && act.is_some() && new != act {
                let what = "several one-shot G codes in one block".into();
                return Err(Alarm::NotSimulated { what }.at(span));
            }
            act = new.or(act);
            state.modal.apply(row);
            if matches!(row.effect, Effect::Motion(_) | Effect::Cycle(None)) {
                state.drilling = super::state::Drilling::default();
                latched = false;
            }
        }
        let modal = state.modal;
        if modal.plane != before.plane && self.ahead.is_beside() {
            return Err(Alarm::PlaneInCompensation.at(span));
        }
        if modal.plane != before.plane && state.transform.rotation.is_some() {
            return Err(Alarm::PlaneInRotation.at(span));
        }
        if before.scaling == Scaling::On
            && modal.scaling == Scaling::On
            && let Some(row) = given.g_codes().find(|row| row.effect.needs_plain_coordinates())
        {
            return Err(Alarm::CodeInScaling { code: crate::program::codes::spelled(row.code) }.at(span));
        }
        if modal.scaling == Scaling::Off {
            state.transform.scaling = None;
        }
        if modal.rotation == Rotation::Off {
            state.transform.rotation = None;
            state.transform.tilt = None;
        }
        if modal.polar == Polar::On && before.polar == Polar::Off {
            state.polar = super::state::PolarPoint::default();
        }
        if modal.work != before.work || state.transform != self.state.transform {
            self.recompute(state);
        }
        if modal.cycle.is_some() && !latched {
            let axis = at(self.drilling_axis(given, state), span)?;
            state.drilling.axis = Some(axis);
            state.drilling.initial = state.programmed[axis];
        }
        // G54 P is G54.1 P.
        let additional = given.has(b'P')
            && act.is_none()
            && modal.cycle.is_none()
            && given.g_codes().any(|row| row.effect == Effect::Work(1));
        Ok(if additional { Some(Act::AdditionalWork) } else { act })
    }

    /// 1. Codes with a number.
    fn codes(&self, given: &Given, plan: &mut Plan, span: Span) -> Checked<()> {
        if let Some(f) = self.feed_word(given, &plan.state)? {
            plan.state.codes.f = f;
        }
        if let Some(s) = given.count(b'S')? {
            plan.state.codes.s = f64::from(s);
        }
        if let Some(t) = given.count(b'T')? {
            plan.state.codes.t = t;
        }
        if let Some(d) = given.count(b'D')? {
            if d as usize > self.settings.tool_offsets {
                return Err(Alarm::OffsetNumber { number: i64::from(d) }.at(given.span(b'D')));
            }
            plan.state.codes.d = d;
        }
        if let Some(h) = given.count(b'H')? {
            if h as usize > self.settings.tool_offsets {
                return Err(Alarm::OffsetNumber { number: i64::from(h) }.at(given.span(b'H')));
            }
            plan.state.codes.h = h;
        }
        let smooth = given.g_codes().any(|row| row.effect == Effect::Smoothness);
        for letter in [b'E', b'N', b'O'] {
            if given.has(letter) && !(smooth && letter == b'E') {
                return Err(Alarm::ImproperAddress { letter: char::from(letter) }.at(given.span(letter)));
            }
        }
        if given.g_codes().any(|row| row.effect == Effect::LookAhead)
            && given.count(b'P')?.is_none_or(|p| p > 1)
        {
            return Err(Alarm::LookAheadFormat.at(span));
        }
        // The axis words behind G22 are limits, no move.
        let limits = given.g_codes().any(|row| row.effect == Effect::StrokeCheck(StrokeCheck::On));
        if limits && (self.names_axis(given) || given.has_any(b"IJK")) {
            return Err(Alarm::NotSimulated { what: "G22 with limits".into() }.at(span));
        }
        let keeps_tool = |effect| {
            use OneShot::{DataInput, Dwell};
            matches!(effect, Effect::OneShot(Dwell | DataInput) | Effect::Scaling(Scaling::Off))
        };
        if given.has(b'T') && given.g_codes().any(|row| keeps_tool(row.effect)) {
            return Err(Alarm::TNotAllowed.at(given.span(b'T')));
        }
        let repeats = given.g_codes().any(takes_l)
            || self.settings.cycle_repeats == b'L' && plan.state.modal.cycle.is_some();
        if given.has(b'L') && !repeats {
            return Err(Alarm::ImproperAddress { letter: 'L' }.at(given.span(b'L')));
        }
        let dwells = given.g_codes().any(|row| row.effect == Effect::OneShot(OneShot::Dwell));
        for letter in [b'A', b'B', b'C', b'U', b'V', b'W', b'X', b'Y', b'Z'] {
            let known = self.settings.axes.find(letter).is_some() || (letter == b'U' && dwells);
            if given.has(letter) && !known {
                return Err(Alarm::ImproperAddress { letter: char::from(letter) }.at(given.span(letter)));
            }
        }
        let compensates = plan.state.modal.cutter != CutterSide::Off;
        let sides = || given.g_codes().any(|row| matches!(row.effect, Effect::Cutter(_)));
        if given.has(b'D') || compensates && (self.settings.new_radius_at_once || sides()) {
            plan.state.radius = self.offset_radius(plan.state.codes.d).unwrap_or(0.0);
        }
        Ok(())
    }

    /// 2., 5. and 6. What M codes do, each at its time.
    fn m_codes(&self, given: &Given, plan: &mut Plan) -> Checked<()> {
        if let Some(code) = given.lost_m {
            plan.note = Some(Note::MCodeLost { code });
        }
        for (code, span) in given.m[..given.m_count].iter().flatten().copied() {
            plan.state.codes.m = code;
            let speed = Rpm(plan.state.codes.s);
            let Some(effect) = m_codes::find(code, self.settings.codes) else {
                plan.passed_on = Some(code);
                continue;
            };
            match effect {
                MEffect::Stop => plan.stop = Some(StopKind::M00),
                MEffect::OptionalStop if self.settings.optional_stop => plan.stop = Some(StopKind::M01),
                MEffect::OptionalStop | MEffect::NoEffect => {}
                MEffect::End => plan.flow = Flow::End,
                MEffect::SpindleForward => self.turn(plan, Spindle::Clockwise, speed),
                MEffect::SpindleReverse => self.turn(plan, Spindle::Counterclockwise, speed),
                MEffect::SpindleStop => {
                    plan.state.spindle = Spindle::Off;
                    plan.after.push((EventKind::Spindle { turning: Spindle::Off, speed }, 0.0));
                }
                MEffect::ToolChange => {
                    plan.state.tool = plan.state.codes.t;
                    plan.tell(EventKind::Tool { number: plan.state.codes.t });
                }
                MEffect::CoolantOn => {
                    plan.state.coolant = true;
                    plan.tell(EventKind::Coolant { on: true });
                }
                MEffect::CoolantOff => {
                    plan.state.coolant = false;
                    plan.after.push((EventKind::Coolant { on: false }, 0.0));
                }
                MEffect::InterruptOn => {
                    given.accept(b"P");
                    plan.note = Some(Note::InterruptNeverComes);
                }
                MEffect::InterruptOff => {}
                MEffect::Call | MEffect::NotSimulated => {
                    return Err(Alarm::NotSimulated { what: format!("M{code:02} here") }.at(span));
                }
            }
        }
        let told = plan.events.iter().any(|(kind, _)| matches!(kind, EventKind::Spindle { .. }));
        if given.has(b'S') && plan.state.spindle != Spindle::Off && !told {
            self.turn(plan, plan.state.spindle, Rpm(plan.state.codes.s));
        }
        Ok(())
    }

    fn turn(&self, plan: &mut Plan, turning: Spindle, speed: Rpm) {
        plan.state.spindle = turning;
        plan.tell(EventKind::Spindle { turning, speed });
    }

    /// 3. G43, G44, G49 and a new H; whether the offset changed.
    fn length(&self, given: &Given, plan: &mut Plan, span: Span) -> Checked<bool> {
        let commanded = given.has(b'H') || given.g_codes().any(|row| matches!(row.effect, Effect::Length(_)));
        if !commanded || (plan.state.modal.length == Length::Off && self.state.modal.length == Length::Off) {
            return Ok(false);
        }
        let offset = at(self.length_offset(&plan.state), span)?;
        if offset == plan.state.length {
            return Ok(false);
        }
        plan.state.length = offset;
        plan.tell(EventKind::ToolLength { offset });
        Ok(true)
    }

    /// 4. A move by the modal codes: a drilling cycle, or group 01.
    pub(super) fn motion(&self, given: &Given, plan: &mut Plan, lengthened: bool, span: Span) -> Checked<()> {
        if let Some(cycle) = plan.state.modal.cycle {
            if self.drills(given) {
                return self.prepare_drill(plan, given, cycle, None, span);
            }
            // P and Q are stored by blocks that drill only.
            if given.has_any(b"PQ") {
                given.accept(b"PQ");
                plan.note = Some(Note::CycleDataLost);
            }
            if lengthened {
                self.recompute(&mut plan.state);
            }
            return Ok(());
        }
        let motion = plan.state.modal.motion;
        let arcs = matches!(motion, Motion::Clockwise | Motion::Counterclockwise);
        let named = self.names_axis(given);
        // A code of group 01 behind that of a cycle: a plain move, the cycle's own words are nothing.
        let overruled = given.g_codes().any(|row| matches!(row.effect, Effect::Cycle(Some(_))));
        if overruled {
            given.accept(b"KPQR");
        }
        if !(named || arcs && given.has_any(b"IJKR")) {
            return self.settle(given, plan, lengthened, span);
        }
        // Some controls round corners by R or read I J K here; the end of cutter compensation takes a vector.
        let vector = given.g_codes().any(|row| row.effect == Effect::Cutter(CutterSide::Off));
        if let Some(letter) = b"IJKR".iter().find(|l| given.has(**l) && !arcs && !vector && !overruled) {
            let what = format!("{} beside a straight move", char::from(*letter));
            return Err(Alarm::NotSimulated { what }.at(given.span(*letter)));
        }
        let goal = self.goal(given, &mut plan.state)?;
        if motion == Motion::Thread && given.has_corner() {
            return Err(Alarm::CornerInThread.at(span));
        }
        if motion != Motion::Rapid {
            plan.corner = self.corner_word(given, &plan.state)?;
        }
        match motion {
            Motion::Rapid => self.rapid(plan, goal.machine),
            Motion::Thread => self.thread(plan, goal.machine, given, span)?,
            Motion::Linear => at(self.feed(plan, goal.machine, given), span)?,
            Motion::Clockwise | Motion::Counterclockwise => self.arc(plan, given, &goal, span)?,
        }
        plan.state.programmed = goal.programmed;
        plan.moved = true;
        Ok(())
    }

    /// The tool length changed in a block without an axis: the axis moves by the offset at once, or keeps still.
    fn settle(&self, given: &Given, plan: &mut Plan, lengthened: bool, span: Span) -> Checked<()> {
        if !lengthened {
            return Ok(());
        }
        if !self.settings.unsure.length_moves_at_once {
            self.recompute(&mut plan.state);
            return Ok(());
        }
        let to = self.to_machine(&plan.state, plan.state.programmed);
        if plan.state.modal.motion == Motion::Rapid {
            self.rapid(plan, to);
            return Ok(());
        }
        at(self.feed(plan, to, given), span)
    }

    /// Block skip: whether the switch is on.
    pub(super) fn skips(&self, switch: u8) -> bool {
        self.settings.skip_switches.get(usize::from(switch.max(1)) - 1).copied().unwrap_or(false)
    }
}

pub(super) fn not_simulated(code: u32, help: &str) -> Alarm {
    Alarm::NotSimulated { what: format!("G{} ({help})", crate::program::codes::spelled(code)) }
}
