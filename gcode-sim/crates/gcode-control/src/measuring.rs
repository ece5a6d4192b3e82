//! G35, G36, G37 and G136 of a Haas: a skip whose signal sets an offset, and the point of M75 that two of them need.
use super::data::{ControlData, Register, system_index};
use super::functions::ExecResult;
use super::plan::{BlockPlan, OffsetMeasurement, TableWrite};
use super::planner::Planner;
use super::state::State;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::g_codes::MeasuringCode;
use gcode_lang::program::modes::Length;

/// Settings 59 to 62 of a Haas: offsets of the probe in four directions.
const PROBE_OFFSETS: std::ops::RangeInclusive<u32> = 20_059..=20_062;

/// Setting 63 of a Haas: the width of the tool probe.
const TOOL_PROBE_WIDTH: u32 = 20_063;

impl OffsetMeasurement {
    /// Returns the offsets that a signal at the skip position of a state sets.
    pub(super) fn writes(&self, data: &ControlData, state: &State) -> Vec<TableWrite> {
        let at = &state.skip_position;
        match *self {
            Self::WorkZero { axes, shift, other } => {
                let system = system_index(state.modal.work);
                let named = (0..data.settings.axes.len()).filter(|axis| axes >> axis & 1 == 1);
                let write = |axis: AxisIndex| {
                    let point = other.map_or(at[axis], |other| (at[axis] + other[axis]) / 2.0);
                    let moved = point - data.zero(state, axis) + shift[axis];
                    let value = data.remove_residue(data.offsets.work[system][axis] + moved);
                    TableWrite::Work { system, axis, value, is_set: true }
                };
                named.map(write).collect()
            }
            Self::ToolDiameter { number, other, width } => {
                let axes = data.settings.axes.len();
                let linear = (0..axes).filter(|axis| !data.settings.axes.is_rotary(*axis));
                let square: f64 = linear.map(|axis| at[axis] - other[axis]).map(|way| way * way).sum();
                let diameter = square.sqrt() - width;
                let value = if data.settings.has_diameter_offsets() { diameter } else { diameter / 2.0 };
                let register = data.table(Register::DGeometry);
                vec![TableWrite::Tool { register, number, value: data.remove_residue(value) }]
            }
            Self::ToolLength { number, axis, target, sign } => {
                let length = sign * (at[axis] - data.zero(state, axis) - target);
                let register = data.table(Register::HGeometry);
                vec![TableWrite::Tool { register, number, value: data.remove_residue(length) }]
            }
        }
    }
}

impl Planner<'_> {
    /// Plans a code that measures: a skip to the words of its block, G37 down to the stroke limit of Z.
    pub(super) fn plan_measuring(&self, code: MeasuringCode, plan: &mut BlockPlan) -> ExecResult<()> {
        let name = code.name();
        let measurement = match code {
            MeasuringCode::ToolLength => return self.plan_tool_length(plan),
            MeasuringCode::WorkZero | MeasuringCode::WorkCentre => {
                if plan.state.modal.length != Length::Off {
                    return Err(self.not_simulated(format!("{name} with a tool length offset (G49 ends it)")));
                }
                self.check_probe_offsets()?;
                let other = match code {
                    MeasuringCode::WorkCentre => Some(self.point_of_m75(name, &plan.state)?),
                    _ => None,
                };
                let axes = self.named_axes().fold(0, |axes, axis| axes | 1 << axis);
                OffsetMeasurement::WorkZero { axes, shift: self.measured_shift(&plan.state)?, other }
            }
            MeasuringCode::ToolDiameter => {
                let number = plan.state.modal_words.d;
                if number == 0 {
                    return Err(Alarm::OffsetNumber { number: 0 }.located_at(self.block));
                }
                let other = self.point_of_m75(name, &plan.state)?;
                let width = self.registers.machine_value(TOOL_PROBE_WIDTH, None);
                OffsetMeasurement::ToolDiameter { number, other, width }
            }
        };
        let endpoint = self.resolve_endpoint(plan)?;
        self.push_skip(plan, endpoint.machine, Some(measurement))?;
        plan.state.programmed_position = endpoint.programmed;
        Ok(())
    }

    /// G37: Z goes down until the signal, and H becomes the length with which the tip is at the Z of the block.
    fn plan_tool_length(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let state = &plan.state;
        let sign = match state.modal.length {
            Length::Plus => 1.0,
            Length::Minus => -1.0,
            _ => return Err(self.not_simulated("G37 without G43 or G44")),
        };
        let number = state.modal_words.h;
        if number == 0 {
            return Err(Alarm::OffsetNumber { number: 0 }.located_at(self.block));
        }
        let axis = self.data.settings.axes.find(b'Z').filter(|z| self.named_axes().eq([*z]));
        let axis = axis.ok_or_else(|| self.not_simulated("G37 without Z, or with another axis"))?;
        let target = self.axis_dimension(axis, state)?.unwrap_or_default();
        let limit = self.data.settings.stroke_limits.as_ref().and_then(|limits| limits.min[axis]);
        let missing = || self.not_simulated("G37 without the end of Z's stroke (state 1321=Z-500.)");
        let mut to = state.machine_position;
        to[axis] = limit.ok_or_else(missing)?;
        self.push_skip(plan, to, Some(OffsetMeasurement::ToolLength { number, axis, target, sign }))?;
        self.data.recompute_position(&mut plan.state);
        Ok(())
    }

    /// Returns I, J and K as a shift of X, Y and Z.
    fn measured_shift(&self, state: &State) -> ExecResult<Position> {
        let mut shift = Position::default();
        for (letter, axis) in [(b'I', b'X'), (b'J', b'Y'), (b'K', b'Z')] {
            let Some(axis) = self.data.settings.axes.find(axis) else { continue };
            shift[axis] = self.dimension(letter, state)?.unwrap_or_default();
        }
        Ok(shift)
    }

    fn point_of_m75(&self, name: &str, state: &State) -> ExecResult<Position> {
        let missing = || self.not_simulated(format!("{name} without a signal at a G31 with M75 before it"));
        state.skip_reference.ok_or_else(missing)
    }

    /// Raises an alarm where settings 59 to 62 are not 0: manuals leave open which of them counts in which direction.
    fn check_probe_offsets(&self) -> ExecResult<()> {
        for number in PROBE_OFFSETS {
            if self.registers.machine_value(number, None) != 0.0 {
                let setting = number - 20_000;
                return Err(self.not_simulated(format!("the probe's offset in setting {setting}")));
            }
        }
        Ok(())
    }
}
