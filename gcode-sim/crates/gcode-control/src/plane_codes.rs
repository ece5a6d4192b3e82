//! Tilted planes: G68.2, G68.4 and G68.3, G268 of a Haas, and G68 about a direction in space.
use super::functions::ExecResult;
use super::kinematics::{Alignment, Matrix, Vector, unit_vector};
use super::plan::BlockPlan;
use super::plane::{Plane, PlaneEntry, Tilt};
use super::planner::Planner;
use super::state::State;
use super::words::WordNumber;

use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::Rotation;

/// The other way round than `TIP_IN_PLANE`.
pub(super) const PLANE_IN_TIP_CONTROL: &str =
    "a tilted plane in tool centre point control (command G49 before it)";

impl State {
    /// Returns X, Y and Z with the alignment of part and tool that G53.1 has set.
    #[inline]
    pub(super) fn alignment(&self) -> Option<([AxisIndex; 3], &Alignment)> {
        let tilt = self.transform.tilt.as_ref()?;
        tilt.alignment.as_ref().map(|alignment| (tilt.axes, alignment))
    }

    /// Turns the tool length back along the head's position 0, where no plane holds the tool.
    pub(super) fn end_alignment(&mut self) {
        if let Some(tilt) = &mut self.transform.tilt
            && let Some(alignment) = tilt.alignment.take()
        {
            let axes = tilt.axes;
            let length = axes.map(|axis| self.length_offset[axis]);
            for (axis, value) in axes.into_iter().zip(alignment.tool.transposed().apply(length)) {
                self.length_offset[axis] = (value * 1e9).round() / 1e9;
            }
        }
    }
}

impl Planner<'_> {
    /// G68.2, and G68.4 within the plane that is active: the forms P0 to P4. G268 of a Haas, and G68.3 along the tool.
    pub(super) fn plan_tilt(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        if plan.state.controls_tip() {
            return Err(self.not_simulated(PLANE_IN_TIP_CONTROL));
        }
        let axes = self.locate(self.slides())?;
        let rotation = plan.state.modal.rotation;
        let plane = match rotation {
            Rotation::AlongTool => return self.plan_plane_along_tool(axes, plan),
            Rotation::Feature => Some(self.feature_plane(&plan.state)?),
            Rotation::On | Rotation::Off | Rotation::Tilted | Rotation::TiltedFurther => {
                self.plane_of_form(&mut plan.state)?
            }
        };
        let base = match plan.state.transform.tilt {
            Some(tilt) if rotation == Rotation::TiltedFurther => Some(tilt.plane),
            None if rotation == Rotation::TiltedFurther => {
                return Err(self.plane_format("G68.4 without G68.2"));
            }
            _ => None,
        };
        let Some(plane) = plane else { return Ok(()) };
        let plane = base.map_or(plane, |base| plane.within(&base));
        self.set_plane(plan, Tilt { axes, plane, alignment: None, is_nested: false });
        Ok(())
    }

    /// Replaces the plane, and turns the tool length back.
    fn set_plane(&self, plan: &mut BlockPlan, tilt: Tilt) {
        let before = plan.state.length_offset;
        plan.state.end_alignment();
        plan.state.transform.plane_entry = None;
        plan.state.transform.tilt = Some(tilt);
        self.push_turned_length(plan, before);
        self.data.apply_transform_change(&mut plan.state);
    }

    /// Returns X, Y and Z; PS0009 if the control lacks one.
    pub(super) fn slides(&self) -> Result<[AxisIndex; 3], Alarm> {
        let axis = |letter| self.data.axis_with_letter(letter);
        Ok([axis(b'X')?, axis(b'Y')?, axis(b'Z')?])
    }

    /// Returns the values of three letters as lengths, 0 for those that the block lacks.
    fn lengths(&self, letters: [u8; 3], state: &State) -> ExecResult<Vector> {
        let mut vector = [0.0; 3];
        for (value, letter) in vector.iter_mut().zip(letters) {
            *value = self.dimension(letter, state)?.unwrap_or(0.0);
        }
        Ok(vector)
    }

    /// Returns I, J and K as a direction of any length, 0 for those that the block lacks. A number with a decimal point, and a
    /// computed one, count with all their digits unless a setting says otherwise, one without a point in increments.
    pub(super) fn direction_ijk(&self, state: &State) -> ExecResult<Vector> {
        let has_increments = self.data.settings.undocumented.directions_have_increments;
        let mut direction = [0.0; 3];
        for (part, letter) in direction.iter_mut().zip([b'I', b'J', b'K']) {
            *part = match self.words.get(letter) {
                Some((WordNumber::Literal(number), _)) if number.places.is_some() && !has_increments => {
                    number.value()
                }
                Some((WordNumber::Computed(value), _)) if !has_increments => value,
                _ => {
                    let length = self.dimension(letter, state)?.unwrap_or(0.0);
                    self.data.to_program_unit(state, None, length)
                }
            };
        }
        Ok(direction)
    }

    /// Returns I, J and K as angles, 0 for those that the block lacks.
    fn angles_ijk(&self) -> ExecResult<Vector> {
        let mut angles = [0.0; 3];
        for (value, letter) in angles.iter_mut().zip([b'I', b'J', b'K']) {
            *value = self.angle(letter)?.unwrap_or(0.0);
        }
        Ok(angles)
    }

    /// Returns the plane of G68.2 and G68.4; `None` before the last block of P2 and P3.
    fn plane_of_form(&self, state: &mut State) -> ExecResult<Option<Plane>> {
        let form = self.words.count(b'P')?.unwrap_or(0);
        let origin = self.lengths(*b"XYZ", state)?;
        let angles = if form == 3 { [0.0; 3] } else { self.angles_ijk()? };
        match form {
            0 if !self.words.has_any(b"QR") => Ok(Some(Plane::by_euler_angles(origin, angles))),
            1 if !self.words.has(b'R') => {
                let order = self.words.count(b'Q')?.unwrap_or(123);
                let plane = Plane::by_roll_pitch_yaw(origin, angles, order);
                plane.ok_or_else(|| self.plane_format("Q of P1 is an order of 1, 2 and 3")).map(Some)
            }
            2 | 3 => self.add_plane_block(state, form, origin),
            4 if !self.words.has_any(b"QR") => {
                let plane = Plane::by_projection(origin, angles);
                plane.ok_or_else(|| self.plane_format("both directions of P4 are parallel")).map(Some)
            }
            _ => Err(self.plane_format("P is 0 to 4; Q belongs to P1, P2 and P3, R to P2")),
        }
    }

    /// Returns the plane of G268 of a Haas: I, J and K about X, Y and Z in the order of Q, 312 without it, about the axes of the
    /// work system or those that turn.
    fn feature_plane(&self, state: &State) -> ExecResult<Plane> {
        let origin = self.lengths(*b"XYZ", state)?;
        let angles = self.angles_ijk()?;
        let order = self.words.count(b'Q')?.unwrap_or(312);
        let order = match self.data.settings.undocumented.feature_axes_turn {
            // Turning axes: the last rotation acts first about the fixed ones.
            true => order % 10 * 100 + order / 10 % 10 * 10 + order / 100,
            false => order,
        };
        let plane = Plane::by_roll_pitch_yaw(origin, angles, order);
        plane.ok_or_else(|| self.plane_format("Q of G268 is an order of 1, 2 and 3"))
    }

    /// G68.3: Z of the plane points along the tool, X is square to it and to the direction of 12321. Without an origin the
    /// position is it (A-79976E).
    fn plan_plane_along_tool(&self, axes: [AxisIndex; 3], plan: &mut BlockPlan) -> ExecResult<()> {
        let named = axes.into_iter().filter(|axis| self.names(*axis)).count();
        if named == 1 || named == 2 {
            return Err(self.plane_format("G68.3 takes X, Y and Z or none of them"));
        }
        let before = plan.state.length_offset;
        plan.state.end_alignment();
        let mut here = plan.state.transform.work_position(plan.state.programmed_position);
        self.data.move_to_part(&plan.state, &plan.state.machine_position, &mut here);
        let origin = match named {
            0 => axes.map(|axis| here[axis]),
            _ => self.lengths(*b"XYZ", &plan.state)?,
        };
        let kinematics = self.data.settings.kinematics.as_ref();
        let alignment = kinematics.map(|kinematics| {
            Alignment::new(kinematics, &plan.state.machine_position, &self.data.zeros(&plan.state))
        });
        let (reference, tool) = match (kinematics, &alignment) {
            (Some(kinematics), Some(alignment)) => {
                let tool = alignment.tool.apply(kinematics.direction);
                (kinematics.direction, alignment.frame.rotation.transposed().apply(tool))
            }
            _ => ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
        };
        let vertical = match self.data.settings.vertical_axis {
            1 => [1.0, 0.0, 0.0],
            2 => [0.0, 1.0, 0.0],
            3 => [0.0, 0.0, 1.0],
            _ => reference,
        };
        let angle = self.angle(b'R')?.unwrap_or(0.0);
        let plane = Plane::along_tool(origin, tool, vertical, angle);
        plan.state.transform.plane_entry = None;
        let tilt = Tilt { axes, plane, alignment: None, is_nested: false };
        match alignment {
            Some(alignment) => self.align(plan, tilt, alignment, before),
            None => {
                let alignment = self.level_alignment(&plan.state, &tilt);
                self.align(plan, tilt, alignment, before);
                let code = self.code_of(|effect| effect == Effect::Rotation(Rotation::AlongTool));
                self.lose_position(plan, code, false);
            }
        }
        Ok(())
    }

    /// G68 with I, J or K: rotates by R about the direction I J K through X Y Z, the new origin. A second G68 counts in the
    /// first.
    pub(super) fn plan_rotation_in_space(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let format = |what| Alarm::SpaceRotation(what).located_at(self.block);
        let axes = self.locate(self.slides())?;
        let state = &plan.state;
        if state.transform.rotation.is_some() || state.controls_tip() {
            return Err(
                self.not_simulated("G68 with I J K in G68 of a plane, or in tool centre point control")
            );
        }
        let mut origin = axes.map(|axis| state.programmed_position[axis]);
        for (value, axis) in origin.iter_mut().zip(axes) {
            *value = self.axis_dimension(axis, state)?.unwrap_or(*value);
        }
        let direction =
            unit_vector(self.direction_ijk(state)?).ok_or_else(|| format("I, J and K are all 0"))?;
        let angle = self.angle(b'R')?.ok_or_else(|| format("R is missing"))?;
        let plane = Plane { origin, matrix: Matrix::about(direction, angle) };
        let plane = match (&state.transform.tilt, self.registers.state.modal.rotation) {
            (None, _) => (plane, false),
            (Some(tilt), Rotation::On) if !tilt.is_nested => (plane.within(&tilt.plane), true),
            (Some(_), Rotation::On) => return Err(format("a third G68 within two others")),
            (Some(_), _) => return Err(self.not_simulated("G68 with I J K in a tilted plane")),
        };
        self.set_plane(plan, Tilt { axes, plane: plane.0, alignment: None, is_nested: plane.1 });
        Ok(())
    }

    /// Counts the plane that the rotary axes are aligned with from their work zeros, which have changed.
    pub(super) fn realign(&self, state: &mut State) {
        let zero = self.data.zeros(state);
        let Some(mut tilt) = state.transform.tilt else { return };
        let Some(alignment) = tilt.alignment else { return };
        tilt.alignment = Some(match &self.data.settings.kinematics {
            Some(kinematics) => Alignment::new(kinematics, &alignment.at, &zero),
            None => self.level_alignment(state, &tilt),
        });
        state.transform.tilt = Some(tilt);
    }

    /// Adds a block of P2 or P3; returns the plane with the last one.
    fn add_plane_block(&self, state: &mut State, form: u32, point: Vector) -> ExecResult<Option<Plane>> {
        let vector = if form == 3 { self.direction_ijk(state)? } else { [0.0; 3] };
        let angle = self.angle(b'R')?.unwrap_or(0.0);
        let q = self.words.count(b'Q')?.unwrap_or(0);
        let mut entry = state.transform.plane_entry.unwrap_or(PlaneEntry { form, ..PlaneEntry::default() });
        let is_same_form = entry.form == form && (form == 2 || !self.words.has(b'R'));
        let added = entry.add(q, point, vector, angle).filter(|_| is_same_form);
        let plane = added.ok_or_else(|| {
            self.plane_format(match form {
                2 => "P2 takes Q1, Q2 and Q3 in this order, points that are not on one line, and Q0 before them",
                _ => "P3 takes Q1 with the vector of X and Q2 with that of Z, at right angles within 5 degrees",
            })
        })?;
        state.transform.plane_entry = Some(entry);
        Ok(plane)
    }

    fn plane_format(&self, what: &'static str) -> LocatedAlarm {
        Alarm::PlaneFormat(what).located_at(self.block)
    }

    /// Emits the tool length if it has turned with the tool.
    pub(super) fn push_turned_length(&self, plan: &mut BlockPlan, before: Position) {
        if plan.state.length_offset != before {
            plan.push_event(self.data.length_event(&plan.state));
        }
    }
}
