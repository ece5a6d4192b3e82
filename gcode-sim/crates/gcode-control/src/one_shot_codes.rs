//! Codes of group 00: dwell, coordinate systems, G53, G60, and the reference position of G27 to G30.
use super::axis_word_use::AxisWordUse;
use super::data::{STANDARD_SYSTEMS, system_index};
use super::functions::ExecResult;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::words::WordNumber;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Dialect;
use gcode_lang::motion::{EventKind, LengthCompensation, Position, UnknownAxes};
use gcode_lang::program::code_facts::{Letters, WithoutAxes};
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot};
use gcode_lang::program::modes::{Distance, Length, Motion, Polar, WorkSystem};
use gcode_lang::units::Seconds;

impl Planner<'_> {
    /// 4. Plans what a block does instead of moving by its modal codes.
    pub(super) fn plan_axis_word_use(
        &self,
        axis_word_use: AxisWordUse,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        if !self.names_axis() {
            plan.notes.extend(self.words.g_codes().filter_map(|row| self.note_without_axis(row)));
        }
        match axis_word_use {
            AxisWordUse::OneShot(one) => self.execute_one_shot(one, plan),
            AxisWordUse::AdditionalWork => {
                self.select_additional_work(&mut plan.state)?;
                self.data.recompute_position(&mut plan.state);
                self.plan_motion(plan, false)
            }
            AxisWordUse::Limits => {
                if self.names_axis() || self.words.has_any(b"IJK") {
                    plan.notes.push(Note::AreaUnchecked);
                }
                self.words.mark_read(Letters::of(b"ABCIJKUVWXYZ"));
                Ok(())
            }
            AxisWordUse::Scale => self.plan_scaling(plan),
            AxisWordUse::Rotate => self.plan_rotation(plan),
            AxisWordUse::Tilt => self.plan_tilt(plan),
            AxisWordUse::PolarInterpolation { is_on } => self.plan_polar_interpolation(is_on, plan),
            AxisWordUse::Mirror { is_on } => self.plan_mirror(is_on, plan),
        }
    }

    /// Selects the additional work coordinate system P.
    pub(super) fn select_additional_work(&self, state: &mut State) -> ExecResult<()> {
        let number = self.words.count(b'P')?.unwrap_or(1);
        if number == 0 || number as usize > self.data.offsets.work.len() - STANDARD_SYSTEMS {
            return Err(Alarm::OffsetNumber { number: i64::from(number) }.located_at(self.block));
        }
        state.modal.work = WorkSystem::Additional(number as u16);
        Ok(())
    }

    /// Returns the note of a code in a block that names no axis.
    fn note_without_axis(&self, row: &GCodeRow) -> Option<Note> {
        let code = row.code;
        match row.facts.without_axes {
            WithoutAxes::Same => None,
            WithoutAxes::AllOrNothing if self.data.settings.homes_all_axes => None,
            WithoutAxes::Waits if !self.writes_axis() => None,
            WithoutAxes::Nothing | WithoutAxes::Waits | WithoutAxes::AllOrNothing => Some(Note::NoAxis(code)),
            WithoutAxes::CentreDefaulted => Some(Note::CentreDefaulted(code)),
        }
    }

    /// Returns true if the block has an axis word, with or without a value.
    fn writes_axis(&self) -> bool {
        let axes = &self.data.settings.axes;
        self.lowered_words.list.iter().any(|word| word.axis.is_some() || axes.find(word.letter).is_some())
    }

    fn execute_one_shot(&self, one: OneShot, plan: &mut BlockPlan) -> ExecResult<()> {
        let is_on_path = matches!(
            one,
            OneShot::Skip
                | OneShot::StraightRapid
                | OneShot::Measure(_)
                | OneShot::SingleDirection
                | OneShot::CirclePocket(_)
                | OneShot::BoltHoles(_)
                | OneShot::Engraving
                | OneShot::Pocket
                | OneShot::AskewTapping { .. }
        );
        if is_on_path && plan.state.controls_tip() {
            return Err(self.not_simulated("G31, G60 or a pattern in tool centre point control"));
        }
        let cycle = plan.state.modal.cycle.is_some();
        match one {
            OneShot::Dwell => self.plan_dwell(plan),
            OneShot::DataInput => self.plan_data_input(plan),
            OneShot::DataInputEnd => Ok(()),
            OneShot::RetractPoint => {
                self.words.mark_read(Letters::of(b"ABCRUVWXYZ"));
                Ok(())
            }
            OneShot::CheckReference
            | OneShot::Reference
            | OneShot::FromReference
            | OneShot::SecondReference
                if cycle =>
            {
                Err(Alarm::ReferenceReturnInCycle.located_at(self.block))
            }
            OneShot::CheckReference => self.plan_reference_check(plan),
            OneShot::Reference if self.data.settings.homes_all_axes && !self.names_axis() => {
                self.plan_home_all(plan);
                Ok(())
            }
            OneShot::Reference => self.plan_reference_return(plan, &Position::default()),
            OneShot::SecondReference => match self.words.count(b'P')?.unwrap_or(2) {
                p @ 2..=4 => {
                    self.plan_reference_return(plan, &self.data.settings.reference_positions[p as usize - 2])
                }
                p => Err(Alarm::ReferenceReturnP { p: i64::from(p) }.located_at(self.block)),
            },
            OneShot::FromReference => self.plan_return_from_reference(plan),
            OneShot::StraightRapid => {
                let endpoint = self.resolve_endpoint(plan)?;
                self.push_rapid(plan, &endpoint.machine);
                plan.state.programmed_position = endpoint.programmed;
                plan.commands_axes = self.names_axis();
                Ok(())
            }
            OneShot::Skip => self.plan_skip(plan),
            OneShot::Measure(code) => self.plan_measuring(code, plan),
            OneShot::SetLocalCoordinateSystem => {
                self.shift_coordinate_system(plan, |state, axis, value| state.g52_shift[axis] = value)
            }
            // The programmed position gets these coordinates, without the length offset; G52 ends on these axes.
            OneShot::SetWorkCoordinateSystem => self.shift_coordinate_system(plan, |state, axis, value| {
                let work = state.transform.work_position(state.programmed_position)[axis];
                let shift = state.g92_shift[axis] + state.g52_shift[axis] + work - value;
                state.g92_shift[axis] = self.data.remove_residue(shift);
                state.g52_shift[axis] = 0.0;
                state.set_shift_origin(axis);
            }),
            OneShot::PresetWorkCoordinateSystem => self.shift_coordinate_system(plan, |state, axis, _| {
                (state.g92_shift[axis], state.g52_shift[axis]) = (0.0, 0.0);
                state.unknown_g92_shift &= !(1 << axis);
            }),
            OneShot::SingleDirection if cycle => Err(self.not_simulated("G60 (in a canned cycle)")),
            OneShot::SingleDirection => self.plan_single_direction(plan),
            OneShot::ToolOffset(factor) => self.plan_tool_offset_move(f64::from(factor), plan),
            OneShot::Engraving => self.plan_engraving(plan),
            OneShot::CirclePocket(direction) => self.plan_circle_pocket(direction, plan),
            OneShot::BoltHoles(holes) => self.plan_bolt_holes(holes, plan),
            OneShot::Pocket => self.plan_pocket(plan),
            OneShot::AskewTapping { is_left_handed } => self.plan_askew_tapping(is_left_handed, plan),
            OneShot::MachineCoordinateSystem => self.plan_machine_move(plan),
            OneShot::ToolAxis { keeps_tip } => self.plan_tool_axis(keeps_tip, plan),
            OneShot::Cylinder => self.plan_cylinder(plan),
            OneShot::WrappedAxis => self.plan_wrapped_axis(plan),
            OneShot::CornerArc if self.registers.lookahead.is_compensating => Ok(()),
            OneShot::CornerArc => Err(self.not_simulated("G39 without cutter compensation")),
        }
    }

    /// Applies the values of the named axes to the shifts of the coordinate system.
    fn shift_coordinate_system(
        &self,
        plan: &mut BlockPlan,
        shift: impl Fn(&mut State, usize, f64),
    ) -> ExecResult<()> {
        for axis in 0..self.data.settings.axes.len() {
            if let Some(value) = self.axis_dimension(axis, &plan.state)? {
                shift(&mut plan.state, axis, value);
            }
        }
        self.realign(&mut plan.state);
        self.data.recompute_position(&mut plan.state);
        Ok(())
    }

    fn plan_dwell(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        self.check_skip_signal_set(b'Q')?;
        if self.words.has(b'Q') {
            let what = "G04 (dwell until a skip signal)".into();
            return Err(Alarm::NotSimulated { what }.located_at(self.words.span(b'Q')));
        }
        let seconds = match self.dwell_seconds()? {
            Some(seconds) => seconds,
            None if self.data.settings.dwell_in_seconds => 0.0,
            None => match self.seconds(b'X')? {
                Some(seconds) => seconds,
                None => self.seconds(b'U')?.unwrap_or(0.0),
            },
        };
        if seconds > 0.0 {
            plan.events.push((EventKind::Dwell { time: Seconds(seconds) }, seconds));
        }
        Ok(())
    }

    /// G60, single direction positioning: by rapid to a point before the end by 5440, whose sign is the side, and on to the end.
    fn plan_single_direction(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let endpoint = self.resolve_endpoint(plan)?;
        let mut before = endpoint.machine;
        for axis in self.named_axes() {
            before[axis] =
                self.data.remove_residue(before[axis] - self.data.settings.single_direction_overrun[axis]);
        }
        self.push_rapid(plan, &before);
        self.push_rapid(plan, &endpoint.machine);
        plan.state.programmed_position = endpoint.programmed;
        plan.commands_axes = self.names_axis();
        Ok(())
    }

    /// G45 to G48: a straight move whose travel along each named axis is longer by `factor` tool offsets. A travel of 0 has the
    /// sign of its word in G91, and stays 0 in G90 (operator's manual, tool offset).
    fn plan_tool_offset_move(&self, factor: f64, plan: &mut BlockPlan) -> ExecResult<()> {
        let modal = &plan.state.modal;
        let refuse = |what: &str| Err(self.not_simulated(format!("G45 to G48 {what}")));
        if modal.cycle.is_some() {
            return refuse("in a canned cycle");
        }
        if !matches!(modal.motion, Motion::Rapid | Motion::Linear) {
            return refuse("with an arc or a thread");
        }
        if modal.polar == Polar::On || !plan.state.transform.is_identity() {
            return refuse("in G16, or in mirror image, scaling or rotation");
        }
        if self.data.settings.has_diameter_offsets() {
            return refuse("with ODI");
        }
        let words = &plan.state.modal_words;
        let is_incremental = modal.distance == Distance::Incremental;
        let number = if self.data.settings.tool_offset_is_h { words.h } else { words.d };
        if number == 0
            && let Some(row) =
                self.words.g_codes().find(|row| matches!(row.effect, Effect::OneShot(OneShot::ToolOffset(_))))
        {
            plan.notes.push(Note::CutterRadiusZero(row.code));
        }
        let offset = match self.data.settings.tool_offset_is_h {
            true => self.locate(self.data.offsets.length(number))?,
            false => self.data.offset_radius(number).unwrap_or(0.0),
        };
        let start = plan.state.programmed_position;
        let mut endpoint = self.resolve_endpoint(plan)?;
        for axis in self.named_axes() {
            let travel = endpoint.programmed[axis] - start[axis];
            let is_negative = match self.words.get(self.data.axis_letter(axis)) {
                Some((WordNumber::Literal(number), _)) if travel == 0.0 => number.negative,
                _ => travel < 0.0,
            };
            if travel == 0.0 && !is_incremental {
                continue;
            }
            let shift = if is_negative { -factor * offset } else { factor * offset };
            endpoint.programmed[axis] = self.data.remove_residue(endpoint.programmed[axis] + shift);
            endpoint.machine[axis] = self.data.remove_residue(endpoint.machine[axis] + shift);
        }
        match plan.state.modal.motion {
            Motion::Rapid => self.push_rapid(plan, &endpoint.machine),
            _ => self.locate(self.push_feed(plan, &endpoint.machine))?,
        }
        plan.state.programmed_position = endpoint.programmed;
        plan.commands_axes = self.names_axis();
        Ok(())
    }

    /// G53: by rapid to machine coordinates, without the length offset.
    fn plan_machine_move(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let mut to = plan.state.machine_position;
        let is_incremental = plan.state.modal.distance == Distance::Incremental;
        if is_incremental && !self.data.settings.undocumented.g53_moves_in_g91 {
            self.words.mark_read(Letters::of(b"ABCUVWXYZ"));
            plan.notes.push(Note::MachineMoveIgnored);
            return Ok(());
        }
        let mut positioned = 0;
        for axis in 0..self.data.settings.axes.len() {
            if let Some(value) = self.axis_dimension(axis, &plan.state)? {
                positioned |= u8::from(!is_incremental) << axis;
                to[axis] = match is_incremental {
                    true => self.data.remove_residue(to[axis] + value),
                    false => self.data.rollover_target(axis, to[axis], value),
                };
            }
        }
        self.place_at_machine_coordinates(plan, positioned);
        self.push_rapid(plan, &to);
        let settings = &self.data.settings;
        if self.moves_along_length(plan) {
            plan.restores_length |= settings.assumes_restored_length();
            if settings.restores_length == Some(false) {
                self.cancel_length(plan);
            }
        }
        self.data.recompute_position(&mut plan.state);
        plan.commands_axes = true;
        Ok(())
    }

    /// G27: by rapid to the end point, which must be the reference position.
    fn plan_reference_check(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        self.rapid_to_endpoint(plan)?;
        for axis in self.named_axes() {
            if self.data.wrap_angle(axis, plan.state.machine_position[axis]) != 0.0 {
                let letter = self.data.settings.axes.letter(axis);
                return Err(Alarm::NotAtReference { letter }.located_at(self.block));
            }
        }
        Ok(())
    }

    /// Plans a rapid to the end point of the axis words.
    fn rapid_to_endpoint(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let endpoint = self.resolve_endpoint(plan)?;
        self.push_rapid(plan, &endpoint.machine);
        plan.state.programmed_position = endpoint.programmed;
        plan.commands_axes = true;
        Ok(())
    }

    /// G28 and G30: by rapid over the intermediate point to the reference position, the named axes only.
    fn plan_reference_return(&self, plan: &mut BlockPlan, reference: &Position) -> ExecResult<()> {
        self.rapid_to_endpoint(plan)?;
        let intermediate = plan.state.machine_position;
        let (mut home, mut named) = (intermediate, 0);
        for axis in self.named_axes() {
            named |= 1 << axis;
            plan.state.intermediate_point[axis] = intermediate[axis] - self.data.zero(&plan.state, axis);
            plan.state.intermediate_axes |= 1 << axis;
            let unknown = plan.state.unknown;
            plan.state.unknown_intermediate =
                plan.state.unknown_intermediate.with_axes_of(1 << axis, unknown);
            home[axis] = self.data.rollover_target(axis, home[axis], reference[axis]);
        }
        self.place_at_machine_coordinates(plan, named);
        self.push_rapid(plan, &home);
        // The length offset is cancelled where its axis reaches the reference position.
        if self.data.settings.restores_length != Some(true) && self.moves_along_length(plan) {
            self.cancel_length(plan);
        }
        self.data.recompute_position(&mut plan.state);
        Ok(())
    }

    /// Returns true if G28, G30 or G53 moves the axis of the length offset: that cancels it (operator's manual, "G53, G28, and
    /// G30 commands in tool length offset mode").
    fn moves_along_length(&self, plan: &BlockPlan) -> bool {
        let z = self.data.settings.axes.find(b'Z');
        let is_on = plan.state.length_compensation() != LengthCompensation::Off;
        z.is_some() && self.words.has(b'Z') && is_on
    }

    /// G28 of a Haas without an axis: all axes go straight home, and the length offset is cancelled.
    fn plan_home_all(&self, plan: &mut BlockPlan) {
        let mut home = plan.state.machine_position;
        let count = self.data.settings.axes.len();
        for axis in 0..count {
            home[axis] = self.data.rollover_target(axis, home[axis], 0.0);
        }
        self.place_at_machine_coordinates(plan, (0..count).fold(0, |axes, axis| axes | 1 << axis));
        self.push_rapid(plan, &home);
        self.cancel_length(plan);
        self.data.recompute_position(&mut plan.state);
        plan.commands_axes = true;
    }

    /// M06 of a Haas: Z goes straight home before the tool changes. A position on the part that is unknown stays so.
    pub(super) fn plan_z_home(&self, plan: &mut BlockPlan) {
        let Some(z) = self.data.settings.axes.find(b'Z') else { return };
        let mut home = plan.state.machine_position;
        home[z] = 0.0;
        let unknown = plan.state.unknown.all() & !self.axes_with_work_offset(plan);
        if unknown >> z & 1 == 0 {
            self.place_at_machine_coordinates(plan, 1 << z);
        }
        self.push_rapid(plan, &home);
        self.data.recompute_position(&mut plan.state);
    }

    /// G29: by rapid over the intermediate point of the last G28 to the end point.
    fn plan_return_from_reference(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let mut intermediate = plan.state.machine_position;
        for axis in self.named_axes() {
            if plan.state.intermediate_axes >> axis & 1 == 0 {
                return Err(Alarm::NoIntermediatePoint.located_at(self.block));
            }
            let point = plan.state.intermediate_point[axis] + self.data.zero(&plan.state, axis);
            intermediate[axis] = self.data.remove_residue(point);
            let unknown = plan.state.unknown_intermediate;
            plan.state.unknown = plan.state.unknown.with_axes_of(1 << axis, unknown);
        }
        self.push_unknown_axes(plan);
        self.push_rapid(plan, &intermediate);
        self.data.recompute_position(&mut plan.state);
        self.rapid_to_endpoint(plan)
    }

    /// Returns the axes, as bits, whose active work offset is set.
    fn axes_with_work_offset(&self, plan: &BlockPlan) -> u8 {
        self.data.set_offsets.axes(system_index(plan.state.modal.work))
    }

    /// Plans that axes go to machine coordinates. The position on the part is known of those whose work offset is
    /// set.
    fn place_at_machine_coordinates(&self, plan: &mut BlockPlan, axes: u8) {
        let with_offset = self.axes_with_work_offset(plan);
        let unknown = UnknownAxes {
            at_machine_position: axes & !with_offset,
            at_known_machine_position: axes & with_offset,
            ..UnknownAxes::default()
        };
        plan.state.unknown = plan.state.unknown.with_axes_of(axes, unknown);
        self.push_unknown_axes(plan);
    }

    /// Cancels the tool length offset as G28, G30 and G53 do: #4008 keeps G43 or G44, and the next H brings the offset
    /// back (operator's manual, "G53, G28, and G30 commands in tool length offset mode"). A Haas has G49 from there on;
    /// tool centre point control ends.
    fn cancel_length(&self, plan: &mut BlockPlan) {
        if plan.state.length_compensation() != LengthCompensation::Off {
            let (offset, wear) = (Position::default(), Position::default());
            plan.push_event(EventKind::ToolLength { offset, wear, compensation: LengthCompensation::Off });
        }
        (plan.state.length_offset, plan.state.length_wear) = (Position::default(), 0.0);
        if self.data.settings.codes == Dialect::HaasNgc || plan.state.controls_tip() {
            plan.state.modal.length = Length::Off;
        } else {
            plan.state.is_length_cancelled = plan.state.modal.length != Length::Off;
        }
    }
}
