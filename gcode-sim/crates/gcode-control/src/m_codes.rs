//! What the M codes of a block do, each at its time, and a new S.
use super::checked::ExecResult;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan};
use super::planner::Planner;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, SpindleDirection, StopKind};
use gcode_lang::program::m_codes;
use gcode_lang::program::m_codes::MCodeEffect;
use gcode_lang::units::Rpm;

impl Planner<'_> {
    /// 2., 5. and 6. What M codes do, each at its time.
    pub(super) fn plan_m_codes(&self, block_words: &BlockWords, plan: &mut BlockPlan) -> ExecResult<()> {
        plan.notes.extend(block_words.replaced_m_codes.iter().map(|code| Note::MCodeLost { code: *code }));
        for (code, span) in block_words.m_codes[..block_words.m_code_count].iter().flatten().copied() {
            plan.state.codes.m = code;
            let speed = Rpm(plan.state.codes.s);
            let Some(effect) = m_codes::find(code, self.data.settings.codes) else {
                plan.auxiliary_codes.push(code);
                plan.push_event(EventKind::Auxiliary { code });
                if code > 9999 {
                    plan.notes.push(Note::LongMCode { code });
                }
                continue;
            };
            match effect {
                MCodeEffect::Stop => plan.stops.push(StopKind::M00),
                MCodeEffect::OptionalStop if self.data.settings.stops_at_m01 => {
                    plan.stops.push(StopKind::M01)
                }
                MCodeEffect::OptionalStop | MCodeEffect::NoEffect => {}
                MCodeEffect::End => plan.flow = BlockFlow::End,
                MCodeEffect::SpindleForward => self.set_spindle(plan, SpindleDirection::Clockwise, speed),
                MCodeEffect::SpindleReverse => {
                    self.set_spindle(plan, SpindleDirection::Counterclockwise, speed)
                }
                MCodeEffect::SpindleStop | MCodeEffect::Orient => {
                    if effect == MCodeEffect::Orient {
                        block_words.mark_read(b"PR");
                    }
                    plan.state.spindle = SpindleDirection::Off;
                    plan.events_after_motion
                        .push((EventKind::Spindle { direction: SpindleDirection::Off, speed }, 0.0));
                }
                MCodeEffect::ToolChange => {
                    let stops_spindle = self.data.settings.undocumented.tool_change_stops_spindle;
                    if stops_spindle && plan.state.spindle != SpindleDirection::Off {
                        self.set_spindle(plan, SpindleDirection::Off, speed);
                    }
                    plan.state.tool = plan.state.codes.t;
                    plan.push_event(EventKind::ToolChange { number: plan.state.codes.t });
                }
                MCodeEffect::CoolantOn => {
                    plan.state.is_coolant_on = true;
                    plan.push_event(EventKind::Coolant { is_on: true, code });
                }
                MCodeEffect::CoolantOff => {
                    plan.state.is_coolant_on = false;
                    plan.events_after_motion.push((EventKind::Coolant { is_on: false, code }, 0.0));
                }
                MCodeEffect::InterruptOn => {
                    block_words.mark_read(b"P");
                    plan.notes.push(Note::InterruptNotSimulated);
                }
                MCodeEffect::InterruptOff => {}
                MCodeEffect::Call | MCodeEffect::NotSimulated => {
                    return Err(Alarm::NotSimulated { what: format!("M{code:02} here") }.located_at(span));
                }
            }
        }
        let changes_spindle =
            || plan.events.iter().any(|(kind, _)| matches!(kind, EventKind::Spindle { .. }));
        if block_words.has(b'S') && plan.state.spindle != SpindleDirection::Off && !changes_spindle() {
            self.set_spindle(plan, plan.state.spindle, Rpm(plan.state.codes.s));
        }
        Ok(())
    }

    fn set_spindle(&self, plan: &mut BlockPlan, direction: SpindleDirection, speed: Rpm) {
        plan.state.spindle = direction;
        plan.push_event(EventKind::Spindle { direction, speed });
    }
}
