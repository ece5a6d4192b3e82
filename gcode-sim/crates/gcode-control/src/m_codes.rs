//! What the M codes of a block do, each at its time, and a new S.
use super::Executor;
use super::eval::Checked;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan};
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, SpindleDirection, StopKind};
use gcode_lang::program::m_codes::{self, MEffect};
use gcode_lang::units::Rpm;

impl Executor {
    /// 2., 5. and 6. What M codes do, each at its time.
    pub(super) fn m_codes(&self, given: &BlockWords, plan: &mut BlockPlan) -> Checked<()> {
        plan.notes.extend(given.lost_m.iter().map(|code| Note::MCodeLost { code: *code }));
        for (code, span) in given.m[..given.m_count].iter().flatten().copied() {
            plan.state.codes.m = code;
            let speed = Rpm(plan.state.codes.s);
            let Some(effect) = m_codes::find(code, self.settings.codes) else {
                plan.passed_on.push(code);
                plan.push_event(EventKind::Auxiliary { code });
                if code > 9999 {
                    plan.notes.push(Note::LongMCode { code });
                }
                continue;
            };
            match effect {
                MEffect::Stop => plan.stops.push(StopKind::M00),
                MEffect::OptionalStop if self.settings.optional_stop => plan.stops.push(StopKind::M01),
                MEffect::OptionalStop | MEffect::NoEffect => {}
                MEffect::End => plan.flow = BlockFlow::End,
                MEffect::SpindleForward => self.turn(plan, SpindleDirection::Clockwise, speed),
                MEffect::SpindleReverse => self.turn(plan, SpindleDirection::Counterclockwise, speed),
                MEffect::SpindleStop | MEffect::Orient => {
                    if effect == MEffect::Orient {
                        given.accept(b"PR");
                    }
                    plan.state.spindle = SpindleDirection::Off;
                    plan.events_after_motion
                        .push((EventKind::Spindle { turning: SpindleDirection::Off, speed }, 0.0));
                }
                MEffect::ToolChange => {
                    let stops = self.settings.unsure.tool_change_stops_spindle;
                    if stops && plan.state.spindle != SpindleDirection::Off {
                        self.turn(plan, SpindleDirection::Off, speed);
                    }
                    plan.state.tool = plan.state.codes.t;
                    plan.push_event(EventKind::ToolChange { number: plan.state.codes.t });
                }
                MEffect::CoolantOn => {
                    plan.state.coolant = true;
                    plan.push_event(EventKind::Coolant { on: true, code });
                }
                MEffect::CoolantOff => {
                    plan.state.coolant = false;
                    plan.events_after_motion.push((EventKind::Coolant { on: false, code }, 0.0));
                }
                MEffect::InterruptOn => {
                    given.accept(b"P");
                    plan.notes.push(Note::InterruptNeverComes);
                }
                MEffect::InterruptOff => {}
                MEffect::Call | MEffect::NotSimulated => {
                    return Err(Alarm::NotSimulated { what: format!("M{code:02} here") }.at(span));
                }
            }
        }
        let told = || plan.events.iter().any(|(kind, _)| matches!(kind, EventKind::Spindle { .. }));
        if given.has(b'S') && plan.state.spindle != SpindleDirection::Off && !told() {
            self.turn(plan, plan.state.spindle, Rpm(plan.state.codes.s));
        }
        Ok(())
    }

    fn turn(&self, plan: &mut BlockPlan, turning: SpindleDirection, speed: Rpm) {
        plan.state.spindle = turning;
        plan.push_event(EventKind::Spindle { turning, speed });
    }
}
