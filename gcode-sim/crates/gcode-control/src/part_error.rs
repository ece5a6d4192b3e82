//! G54.2 and G54.4: where the part stands on the table, by values of the control, and what follows for X, Y and Z.
use super::data::{ControlData, FIXTURES, SETTING_ERRORS};
use super::functions::ExecResult;
use super::kinematics::{Alignment, Frame, Matrix, PartError, cross, dot, scaled, sum};
use super::plan::{BlockPlan, TableWrite};
use super::plane::Plane as TiltedPlane;
use super::planner::Planner;
use super::registers::Registers;
use super::state::State;
use super::tip_control::Aligned;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::Position;
use gcode_lang::program::modes::{CutterSide, DynamicOffset, Motion, Plane};

impl ControlData {
    /// Returns the error that P of G54.2 or G54.4 selects: `None` inside if nothing states its values or the machine's axes;
    /// an alarm for a number beyond the table.
    fn part_error(&self, mode: DynamicOffset, number: u32) -> Result<Option<PartError>, Alarm> {
        let index = number as usize - 1;
        let unknown = Alarm::OffsetNumber { number: i64::from(number) };
        if self.settings.kinematics.is_none() {
            return Ok(None);
        }
        Ok(match mode {
            DynamicOffset::Fixture => {
                let row = self.offsets.fixtures.get(index).ok_or(unknown)?;
                let axes = self.linear_axes().unwrap_or_default();
                row.map(|row| PartError { shift: axes.map(|axis| row[axis]), rotation: Matrix::IDENTITY })
            }
            DynamicOffset::SettingError => {
                let row = self.offsets.setting_errors.get(index).ok_or(unknown)?;
                row.and_then(|[x, y, z, a, b, c]| {
                    let plane = TiltedPlane::by_roll_pitch_yaw([0.0; 3], [a, b, c], 123)?;
                    Some(PartError { shift: [x, y, z], rotation: plane.matrix })
                })
            }
            DynamicOffset::Off | DynamicOffset::On => None,
        })
    }

    /// Returns the frame of a displaced part: X, Y and Z of the program keep their directions, and the error turns with
    /// the table.
    pub(super) fn error_alignment(&self, state: &State, error: &PartError, at: &Position) -> Option<Aligned> {
        let axes = self.linear_axes()?;
        let zeros = self.zeros(state);
        let zero = axes.map(|axis| zeros[axis]);
        let table = Alignment::of_table(self.settings.kinematics.as_ref()?, at);
        // On the part: x goes to zero + shift + R·(x − zero), with the table at 0.
        let back = scaled(error.rotation.apply(zero), -1.0);
        let stands = Frame { rotation: error.rotation, shift: sum(sum(zero, error.shift), back) };
        let frame = table.after(&stands).after(&table.inverse());
        Some(Aligned { axes, frame, length: axes.map(|axis| state.length_offset[axis]) })
    }
}

impl Planner<'_> {
    /// Raises the alarm of a move that the mode which turns X, Y and Z excludes.
    pub(super) fn check_turned(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        if plan.state.controls_tip() {
            self.check_tip_control(&plan.state)?;
            self.read_posture(plan)?;
        }
        if plan.state.modal.dynamic == DynamicOffset::On {
            self.check_dynamic_offset(&plan.state)?;
        }
        if plan.state.part_error.is_some() && self.names_axis() {
            self.check_part_error(&plan.state)?;
        }
        Ok(())
    }

    /// Selects the values of G54.2 and G54.4 by P, 1 without it; P0 ends both.
    pub(super) fn select_part_error(&self, mode: DynamicOffset, state: &mut State) -> ExecResult<()> {
        let number = self.words.count(b'P')?.unwrap_or(1);
        if number == 0 {
            (state.modal.dynamic, state.part_error) = (DynamicOffset::Off, None);
            return Ok(());
        }
        state.modal.dynamic = mode;
        state.part_error = self.locate(self.data.part_error(mode, number))?;
        if state.part_error.is_some() && (state.controls_tip() || state.transform.tilt.is_some()) {
            return Err(
                self.not_simulated("G54.2 or G54.4 in a tilted plane or in tool centre point control")
            );
        }
        Ok(())
    }

    /// Raises the alarm of a block whose path leaves its plane, because the part is tilted.
    fn check_part_error(&self, state: &State) -> ExecResult<()> {
        let modal = &state.modal;
        let is_planar = modal.cycle.is_some()
            || modal.cutter != CutterSide::Off
            || self.words.corner.is_some()
            || matches!(modal.motion, Motion::Clockwise | Motion::Counterclockwise);
        let aligned = self.data.aligned(state, &state.machine_position).filter(|_| is_planar);
        let Some(Aligned { frame, .. }) = aligned else { return Ok(()) };
        let normal = match modal.plane {
            Plane::Xy => [0.0, 0.0, 1.0],
            Plane::Zx => [0.0, 1.0, 0.0],
            Plane::Yz => [1.0, 0.0, 0.0],
        };
        let leaning = cross(frame.rotation.apply(normal), normal);
        if dot(leaning, leaning).sqrt() < 1e-9 {
            return Ok(());
        }
        let what = "an arc, a canned cycle, compensation or a corner word on a part that G54.4 tilts";
        Err(self.not_simulated(what))
    }

    /// Raises the alarm of G254 where it isn't that of a Haas: on a head that turns, and with a work offset of the axis that tilts
    /// the table, which has to be 0 (Haas Mill Operator's Manual, G254).
    fn check_dynamic_offset(&self, state: &State) -> ExecResult<()> {
        let Some(kinematics) = &self.data.settings.kinematics else { return Ok(()) };
        if !kinematics.head.is_empty() {
            return Err(self.not_simulated("G254 on a machine whose head turns"));
        }
        let tilting = kinematics.table.first().filter(|_| kinematics.table.len() > 1);
        match tilting.map(|axis| axis.axis).filter(|axis| self.data.zero(state, *axis) != 0.0) {
            Some(axis) => {
                let letter = self.data.settings.axes.letter(axis);
                Err(self.not_simulated(format!("G254 with a work offset of {letter} other than 0")))
            }
            None => Ok(()),
        }
    }

    /// G10 L21: the axes of a fixture offset. G10 L23: shift X Y Z and rotations A B C of a setting error.
    pub(super) fn plan_part_error(&self, l: u32, number: u32, plan: &mut BlockPlan) -> ExecResult<()> {
        let most = if l == 21 { FIXTURES } else { SETTING_ERRORS };
        if number == 0 || number as usize > most {
            return Err(Alarm::OffsetNumber { number: i64::from(number) }.located_at(self.block));
        }
        let index = number as usize - 1;
        if l == 21 {
            let old = self.data.offsets.fixtures[index].unwrap_or_default();
            for (axis, _) in self.data.settings.axes.iter() {
                let Some(value) = self.axis_dimension(axis, &plan.state)? else { continue };
                let value = self.table_value(plan, old[axis], value)?;
                plan.writes.push(TableWrite::Fixture { index, axis, value });
            }
            return Ok(());
        }
        let old = self.data.offsets.setting_errors[index].unwrap_or_default();
        for (item, letter) in b"XYZABC".iter().enumerate() {
            let value = if item < 3 { self.dimension(*letter, &plan.state)? } else { self.angle(*letter)? };
            let Some(value) = value else { continue };
            let value = self.table_value(plan, old[item], value)?;
            plan.writes.push(TableWrite::SettingError { index, item, value });
        }
        Ok(())
    }
}

impl Registers {
    /// Sets a fixture offset of G54.2.
    pub(super) fn set_fixture(&mut self, index: usize, axis: u32, value: f64) -> Result<(), Alarm> {
        let axis = self.data.check_axis(axis)?;
        let value = self.data.check_offset_range(self.data.to_stored(&self.state, Some(axis), value))?;
        self.data.offsets.fixtures[index].get_or_insert_default()[axis] = value;
        Ok(())
    }

    /// Returns a value of a setting error of G54.4, #26010 and following: ten numbers for each, of which six are in use.
    pub(super) fn setting_error(&self, number: u32) -> Result<f64, Alarm> {
        let (index, item) = setting_error_place(number)?;
        let value = self.data.offsets.setting_errors[index].map_or(0.0, |row| row[item]);
        Ok(if item < 3 { self.data.to_program_unit(&self.state, None, value) } else { value })
    }

    /// Sets a value of a setting error.
    pub(super) fn set_setting_error(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        let (index, item) = setting_error_place(number)?;
        let stored = if item < 3 { self.data.to_stored(&self.state, None, value) } else { value };
        let stored = self.data.check_offset_range(stored)?;
        self.data.offsets.setting_errors[index].get_or_insert_default()[item] = stored;
        Ok(())
    }
}

/// Returns row and item of a variable, counted from #26010.
fn setting_error_place(number: u32) -> Result<(usize, usize), Alarm> {
    let (index, item) = ((number / 10) as usize, (number % 10) as usize);
    let unknown = Alarm::NoSuchVariable { number: i64::from(26_010 + number) };
    if item < 6 { Ok((index, item)) } else { Err(unknown) }
}
