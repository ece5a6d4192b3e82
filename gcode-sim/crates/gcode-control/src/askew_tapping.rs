//! G174 and G184 of a Haas: a thread tapped along any direction.
use super::functions::ExecResult;
use super::plan::BlockPlan;
use super::planner::Planner;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, SpindleDirection};
use gcode_lang::units::Rpm;

impl Planner<'_> {
    /// G174 and G184: the spindle turns in step with the feed from the tool's position to the end point, and the other way back.
    /// Then it turns as before.
    pub(super) fn plan_askew_tapping(&self, is_left_handed: bool, plan: &mut BlockPlan) -> ExecResult<()> {
        self.check_outside_cycle(if is_left_handed { "174" } else { "184" }, &plan.state.modal)?;
        if self.words.has(b'R') {
            return Err(self.not_simulated("G174 and G184 with R"));
        }
        let speed = plan.state.modal_words.s;
        if speed == 0.0 {
            return Err(Alarm::NoSpeedInRigidTapping.located_at(self.block));
        }
        let spindle = |direction, is_rigid| EventKind::Spindle {
            direction,
            speed: Rpm(speed),
            is_rigid,
            is_oriented: false,
        };
        let (inwards, outwards) = match is_left_handed {
            true => (SpindleDirection::Counterclockwise, SpindleDirection::Clockwise),
            false => (SpindleDirection::Clockwise, SpindleDirection::Counterclockwise),
        };
        let start = plan.state.machine_position;
        let before = plan.state.spindle;
        let endpoint = self.resolve_endpoint(plan)?;
        plan.push_event(spindle(inwards, true));
        self.locate(self.push_feed(plan, &endpoint.machine))?;
        plan.push_event(spindle(outwards, true));
        self.locate(self.push_feed(plan, &start))?;
        plan.push_event(spindle(before, false));
        plan.state.unknown = self.registers.state.unknown;
        self.push_unknown_axes(plan);
        plan.commands_axes = true;
        Ok(())
    }
}
