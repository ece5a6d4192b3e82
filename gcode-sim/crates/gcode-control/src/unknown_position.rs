//! Axes whose position on the part is unknown: commands that make it known, and the events that state the unknown ones.
use super::control::Control;
use super::executor::Executor;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::transform::Transform;
use gcode_lang::motion::{AxisIndex, EventKind, EventSink, UnknownAxes};

impl State {
    /// Returns what remains unknown of an axis after an absolute command.
    pub(super) fn unknown_after_absolute(&self, axis: AxisIndex) -> UnknownAxes {
        let shifted = (self.unknown_g92_shift | self.transform.unknown_centre) & 1 << axis;
        UnknownAxes { shifted, ..UnknownAxes::default() }
    }

    /// Returns the axes, as bits, of which an absolute command changes what is unknown.
    pub(super) fn learnable_axes(&self) -> u8 {
        let UnknownAxes { uncommanded, at_machine_position, shifted, at_known_machine_position } =
            self.unknown;
        let remains = self.unknown_g92_shift | self.transform.unknown_centre;
        uncommanded | at_machine_position | at_known_machine_position | shifted & !remains
    }

    /// Applies an absolute command of an axis to the unknown ones.
    pub(super) fn apply_absolute(&self, axis: AxisIndex, unknown: UnknownAxes) -> UnknownAxes {
        unknown.with_axes_of(1 << axis, self.unknown_after_absolute(axis))
    }

    /// Records whether the coordinates of an axis count from an unknown position, after G92 has set them there.
    pub(super) fn set_shift_origin(&mut self, axis: AxisIndex) {
        self.unknown_g92_shift = self.unknown_g92_shift & !(1 << axis) | self.unknown.all() & 1 << axis;
    }

    /// Returns the axes that are unknown on the machine.
    pub(super) fn unknown_on_machine(&self) -> UnknownAxes {
        self.transform.spread(self.unknown)
    }
}

impl Transform {
    /// Returns the unknown axes on the machine for those of the programmed position: each axis of a rotated plane depends
    /// on all of them.
    pub(super) fn spread(&self, unknown: UnknownAxes) -> UnknownAxes {
        let bits = |axes: &[AxisIndex]| axes.iter().fold(0_u8, |bits, axis| bits | 1 << axis);
        let plane = self.rotation.map_or(0, |rotation| bits(&[rotation.plane.0, rotation.plane.1]));
        let tilt = self.tilt.map_or(0, |tilt| bits(&tilt.axes));
        let spread = |axes: u8, group: u8| if axes & group == 0 { axes } else { axes | group };
        unknown.map(|axes| spread(spread(axes, plane), tilt))
    }
}

impl Planner<'_> {
    /// Plans the event of the axes that are unknown after the next move, if they have changed.
    pub(super) fn push_unknown_axes(&self, plan: &mut BlockPlan) {
        let axes = plan.state.unknown_on_machine();
        if axes != plan.state.stated_unknown {
            plan.state.stated_unknown = axes;
            plan.push_event(EventKind::PositionUnknown { axes });
        }
    }
}

impl Executor {
    /// Emits the position at the start of a run, before every other event.
    pub(super) fn state_start<S: EventSink>(&mut self, sink: &mut S) {
        let unknown = self.registers.state.unknown_on_machine();
        self.registers.state.stated_unknown = unknown;
        let at = self.registers.state.machine_position;
        self.emit(&EventKind::Start { at, unknown }, 0.0, sink);
    }
}

impl Control {
    /// Sets the position of an axis at the start of the run, in the active work coordinate system, mm or degrees.
    pub fn set_start(&mut self, axis: AxisIndex, position: f64) {
        let registers = &mut self.executor.registers;
        let (data, state) = (&registers.data, &mut registers.state);
        state.machine_position[axis] = data.on_machine(position, data.zero(state, axis), 0.0);
        data.recompute_position(state);
        state.unknown = state.unknown.without(1 << axis);
    }

    /// Returns the axes whose position on the part is unknown now.
    pub fn unknown_axes(&self) -> UnknownAxes {
        self.executor.registers.state.unknown_on_machine()
    }
}
