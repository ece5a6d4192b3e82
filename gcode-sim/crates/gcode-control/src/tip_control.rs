//! Tool centre point control, G43.4 and G43.5: the program moves the tip on the part, and the rotary axes turn on the way.
use super::data::ControlData;
use super::functions::ExecResult;
use super::kinematics::{
    Alignment, Frame, Matrix, Vector, cross, dot, remove_noise, scaled, sum, unit_vector,
};
use super::linear_motion::Endpoint;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::{State, is_circular};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Kinematics;
use gcode_lang::motion::{AxisIndex, EventKind, PlanarArc, Position};
use gcode_lang::program::g_codes::{Effect, name};
use gcode_lang::program::modes::{CutterSide, DynamicOffset, Length, Motion, Plane};
use gcode_lang::units::MmPerMin;

/// Tool centre point control in a tilted plane: pages of the manuals that describe both are not at hand.
pub(super) const TIP_IN_PLANE: &str = "in a tilted plane (command G69 before it)";

/// Part and tool with the rotary axes at fixed angles, as G53.1 or tool centre point control sets them.
pub(super) struct Aligned {
    /// X, Y and Z.
    pub(super) axes: [AxisIndex; 3],
    /// From machine coordinates with the rotary axes at their work zeros, without the tool's length.
    pub(super) frame: Frame,
    /// Tool length offset, along the tool.
    pub(super) length: Vector,
}

impl State {
    /// Returns true if the program moves the tip of the tool on the part.
    #[inline]
    pub(super) fn controls_tip(&self) -> bool {
        matches!(self.modal.length, Length::TipByAngles | Length::TipByVector | Length::TipOfHaas)
    }

    /// Returns true if X, Y and Z depend on the angles of the rotary axes, or an angle on lengths.
    #[inline]
    pub(super) fn is_turned(&self) -> bool {
        self.controls_tip()
            || self.alignment().is_some()
            || self.modal.dynamic == DynamicOffset::On
            || self.virtual_plane.is_some()
            || self.part_error.is_some()
    }
}

impl ControlData {
    /// Returns part and tool with the rotary axes at `at`; `None` if X, Y and Z don't depend on them.
    #[inline]
    pub(super) fn aligned(&self, state: &State, at: &Position) -> Option<Aligned> {
        if state.controls_tip() {
            return match self.settings.tip_in_work_system {
                true => self.aligned_by(state, Alignment::of_head(self.settings.kinematics.as_ref()?, at)),
                false => self.part_aligned(state, at),
            };
        }
        if let Some((axes, alignment)) = state.alignment() {
            let length = axes.map(|axis| state.length_offset[axis]);
            return Some(match &self.settings.kinematics {
                Some(kinematics) if self.settings.undocumented.plane_turns_with_axes => {
                    let turned = Alignment::new(kinematics, at, &self.zeros(state));
                    let length = turned.tool.apply(alignment.tool.transposed().apply(length));
                    Aligned { axes, frame: turned.frame, length }
                }
                _ => Aligned { axes, frame: alignment.frame, length },
            });
        }
        match state.modal.dynamic {
            DynamicOffset::On => self.dynamic_alignment(state, at),
            DynamicOffset::Fixture | DynamicOffset::SettingError => {
                self.error_alignment(state, state.part_error.as_ref()?, at)
            }
            DynamicOffset::Off => None,
        }
    }

    /// G254 of a Haas: the work zero turns with the table, and X, Y and Z keep their directions.
    fn dynamic_alignment(&self, state: &State, at: &Position) -> Option<Aligned> {
        let axes = self.linear_axes()?;
        let zero = self.zeros(state);
        let Frame { rotation, shift } = Alignment::new(self.settings.kinematics.as_ref()?, at, &zero).frame;
        let here = axes.map(|axis| zero[axis]);
        let shift = sum(sum(rotation.apply(here), shift), scaled(here, -1.0));
        let frame = Frame { rotation: Matrix::IDENTITY, shift };
        Some(Aligned { axes, frame, length: axes.map(|axis| state.length_offset[axis]) })
    }

    /// Returns part and tool with the rotary axes at `at`; the tip counts on the part, which turns with the table.
    pub(super) fn part_aligned(&self, state: &State, at: &Position) -> Option<Aligned> {
        let kinematics = self.settings.kinematics.as_ref()?;
        self.aligned_by(state, Alignment::new(kinematics, at, &self.zeros(state)))
    }

    fn aligned_by(&self, state: &State, alignment: Alignment) -> Option<Aligned> {
        let axes = self.linear_axes()?;
        let length = alignment.tool.apply(axes.map(|axis| state.length_offset[axis]));
        Some(Aligned { axes, frame: alignment.frame, length })
    }

    /// Returns X, Y and Z; `None` if the control lacks one of them.
    pub(super) fn linear_axes(&self) -> Option<[AxisIndex; 3]> {
        let find = |letter| self.settings.axes.find(letter);
        Some([find(b'X')?, find(b'Y')?, find(b'Z')?])
    }

    /// Returns `at`, a position of the rotary axes, with X, Y and Z where the tip is at a work position.
    pub(super) fn with_tip_at(
        &self,
        state: &State,
        aligned: &Aligned,
        work: &Position,
        at: &Position,
    ) -> Position {
        let mut machine = *at;
        let turned = aligned.frame.apply(aligned.axes.map(|axis| work[axis] + self.zero(state, axis)));
        for (axis, value) in aligned.axes.into_iter().zip(sum(turned, aligned.length)) {
            machine[axis] = remove_noise(value);
        }
        machine
    }

    /// Replaces X, Y and Z of a work position by those of the tip on the part at a position of the machine.
    pub(super) fn move_to_part(&self, state: &State, position: &Position, work: &mut Position) {
        let Some(aligned) = self.part_aligned(state, position) else { return };
        let tip = sum(aligned.axes.map(|axis| position[axis]), scaled(aligned.length, -1.0));
        for (axis, value) in aligned.axes.into_iter().zip(aligned.frame.revert(tip)) {
            work[axis] = value - self.zero(state, axis);
        }
    }

    /// Returns the number of chords from which the tip deviates by at most the tolerance.
    ///
    /// On the part the tip is at r = T⁻¹·(p − t): the position p moves along a chord by b at most, and part and tool turn by γ in
    /// all on levers of ρ, so that |r''| ≤ 3·γ²·ρ + 2·γ·b + s²·R with an arc of sweep s and radius R.
    fn tip_chords(
        &self,
        kinematics: &Kinematics,
        ends: [&Position; 2],
        state: &State,
        arc: (f64, f64),
    ) -> u32 {
        let Some(axes) = self.linear_axes() else { return 1 };
        let [from, to] = ends;
        let turn: f64 =
            kinematics.axes().map(|axis| (to[axis.axis] - from[axis.axis]).abs().to_radians()).sum();
        let norm = |v: Vector| dot(v, v).sqrt();
        let at = |position: &Position| axes.map(|axis| position[axis]);
        let tool = norm(axes.map(|axis| state.length_offset[axis]))
            + kinematics.pivot
            + kinematics.head.iter().map(|axis| norm(axis.point)).sum::<f64>();
        let arm = |end: &Position| {
            let arms = kinematics.table.iter().map(|axis| norm(sum(at(end), scaled(axis.point, -1.0))));
            arms.fold(0.0, f64::max)
        };
        let travel = norm(sum(at(to), scaled(at(from), -1.0))) + arc.0 * arc.1;
        let lever = tool + arm(from).max(arm(to)) + travel;
        let bend = 3.0 * turn * turn * lever + 2.0 * turn * travel + arc.1 * arc.1 * arc.0;
        (bend / (8.0 * self.settings.chord_tolerance)).sqrt().ceil().clamp(1.0, 100_000.0) as u32
    }
}

impl Planner<'_> {
    /// Checks that the block can start or keep tool centre point control.
    pub(super) fn check_tip_control(&self, state: &State) -> ExecResult<()> {
        let code = name(state.modal.length.code());
        let with = if state.transform.tilt.is_some() {
            TIP_IN_PLANE
        } else if !state.transform.is_identity() {
            "with G51, G51.1 or G68"
        } else if self.is_compensating_tip(state) && !self.compensates_across_tool(state) {
            "with cutter compensation or a corner word outside G17, beside a rotary axis, or in a plane that is not square to the tool and to the machine's Z"
        } else if state.modal.cycle.is_some() && !self.drills_along_tool(state) {
            "with a canned cycle that does not drill along the tool, or with a rotary axis in its block"
        } else if state.modal.dynamic == DynamicOffset::On {
            "with G254"
        } else if state.modal.motion == Motion::Thread {
            "with G33"
        } else {
            return Ok(());
        };
        Err(self.not_simulated(format!("{code} (tool centre point control) {with}")))
    }

    /// Returns true if compensation or a corner word concerns the block.
    fn is_compensating_tip(&self, state: &State) -> bool {
        state.modal.cutter != CutterSide::Off
            || self.words.corner.is_some()
            || self.registers.lookahead.is_offset()
    }

    /// Returns true if the block's path lies in a plane of X and Y of the machine that is square to the tool.
    fn compensates_across_tool(&self, state: &State) -> bool {
        let part = self.data.aligned(state, &state.machine_position);
        let normal = part.map_or([0.0, 0.0, 1.0], |aligned| aligned.frame.rotation.apply([0.0, 0.0, 1.0]));
        state.modal.plane == Plane::Xy
            && normal[2] > 1.0 - 1e-12
            && self.drills_along_tool(state)
            && !self.points_tool(state)
    }

    /// Returns true if the block turns no rotary axis, and Z of the program is along the tool.
    fn drills_along_tool(&self, state: &State) -> bool {
        let axes = &self.data.settings.axes;
        let turns = (0..axes.len()).any(|axis| axes.is_rotary(axis) && self.names(axis));
        let Some(kinematics) = &self.data.settings.kinematics else { return !turns };
        let at = &state.machine_position;
        let part = self.data.aligned(state, at).map_or(Matrix::IDENTITY, |aligned| aligned.frame.rotation);
        let tool = Alignment::new(kinematics, at, at).tool.apply(kinematics.direction);
        let aside = cross(part.apply([0.0, 0.0, 1.0]), tool);
        !turns && dot(aside, aside).sqrt() < 1e-7
    }

    /// Returns true if the block has the direction of the tool at its end: I J K in G43.5 (A-79348E).
    pub(super) fn points_tool(&self, state: &State) -> bool {
        state.modal.length == Length::TipByVector && self.words.has_any(b"IJK")
    }

    /// P of G43.4 and G43.5: P0 turns the axes evenly, P1 is tool posture control, which has the same ends (A-79294E).
    pub(super) fn read_posture(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let is_start = |effect| matches!(effect, Effect::Length(Length::TipByAngles | Length::TipByVector));
        // P beside G54 or G54.1 is the number of the work coordinate system.
        let is_work = |effect| matches!(effect, Effect::Work(1) | Effect::AdditionalWork);
        if plan.state.modal.cycle.is_some()
            || self.words.has_non_motion_code(is_work)
            || !self.words.has_non_motion_code(is_start)
        {
            return Ok(());
        }
        match self.words.count(b'P')? {
            None | Some(0) => {}
            Some(1) => plan.notes.push(Note::PostureControl(plan.state.modal.length.code())),
            Some(_) => {
                let code = name(plan.state.modal.length.code());
                return Err(self.not_simulated(format!("P of {code} other than 0 and 1")));
            }
        }
        Ok(())
    }

    /// G234 of a Haas without H ends G43 and its H (Haas Mill Operator's Manual, G234).
    pub(super) fn cancel_length_offset(&self, plan: &mut BlockPlan) {
        let is_tip_of_haas = |effect| effect == Effect::Length(Length::TipOfHaas);
        if !self.words.has(b'H') && self.words.has_non_motion_code(is_tip_of_haas) {
            plan.state.modal_words.h = 0;
        }
    }

    /// G43.5: turns the rotary axes of an end point so that the tool points along I J K. They are no centre of an arc, which has its R
    /// (A-79348E, G43.5).
    pub(super) fn point_tool(&self, state: &State, endpoint: &mut Endpoint) -> ExecResult<()> {
        if is_circular(state.modal.motion) && !self.words.has(b'R') {
            let what = "an arc without R in G43.5, where I J K are the direction of the tool at its end";
            return Err(self.not_simulated(what));
        }
        let starts = self.words.has_non_motion_code(|effect| effect == Effect::Length(Length::TipByVector));
        let kinematics = &self.data.settings.kinematics;
        if starts && kinematics.as_ref().is_some_and(|kinematics| !kinematics.table.is_empty()) {
            return Err(Alarm::DirectionWithTipControl.located_at(self.block));
        }
        let Some(vector) = unit_vector(self.direction_ijk(state)?) else {
            return Err(self.not_simulated("G43.5 with I J K of length 0"));
        };
        if self.data.settings.tip_in_work_system {
            return Err(Alarm::MachineParameter("G43.5 with WKP 19696#5 = 1").located_at(self.block));
        }
        let Some(kinematics) = kinematics else { return Ok(()) };
        let target = self.tool_axis_target(state, kinematics, vector, &self.data.zeros(state), 0.0)?;
        for axis in kinematics.axes() {
            let axis = axis.axis;
            if self.names(axis) {
                return Err(self.not_simulated("G43.5 with I J K and a rotary axis"));
            }
            endpoint.machine[axis] = target[axis];
            let work = target[axis] - self.data.zero(state, axis);
            endpoint.programmed[axis] = self.data.wrap_angle(axis, work);
        }
        if let Some(aligned) = self.data.aligned(state, &endpoint.machine) {
            endpoint.machine =
                self.data.with_tip_at(state, &aligned, &endpoint.programmed, &endpoint.machine);
        }
        Ok(())
    }

    /// Emits the chords of a straight move of the tip on the part, or of an arc with its radius, while the rotary axes turn
    /// evenly. F is along the tip's path; where the tip stands, along the rotary axes.
    pub(super) fn push_tip_path(
        &self,
        plan: &mut BlockPlan,
        endpoint: &Endpoint,
        arc: Option<(PlanarArc, f64)>,
    ) -> ExecResult<()> {
        let (from, to) = (plan.state.machine_position, endpoint.machine);
        let (mut start, mut end) = (plan.state.programmed_position, endpoint.programmed);
        if self.data.settings.tip_in_work_system && self.turns_table(&from, &to) {
            if arc.is_some() {
                return Err(self.not_simulated("an arc while the table turns, with WKP 19696#5 = 1"));
            }
            for (point, position) in [(&mut start, &from), (&mut end, &to)] {
                self.data.move_to_part(&plan.state, position, point);
            }
        }
        if from == to && arc.is_none() {
            plan.repeat_unknown_axes();
            return Ok(());
        }
        let is_rotary = |axis: AxisIndex| self.data.settings.axes.is_rotary(axis);
        if self.is_compensating_tip(&plan.state) {
            // Nothing turns: lines and arcs stay such.
            let Some((PlanarArc { plane, centre, sweep }, radius)) = arc else {
                match plan.state.modal.motion {
                    Motion::Rapid => self.push_rapid(plan, &to),
                    _ => self.locate(self.push_feed(plan, &to))?,
                }
                return Ok(());
            };
            (start[plane.0], start[plane.1]) = centre;
            let middle = self.data.to_machine_unrounded(&plan.state, &start);
            let arc = PlanarArc { plane, centre: (middle[plane.0], middle[plane.1]), sweep };
            return self.push_arc(plan, to, arc, radius);
        }
        let squared = |axes: &dyn Fn(AxisIndex) -> bool| -> f64 {
            let travel = |axis: AxisIndex| {
                if is_rotary(axis) { to[axis] - from[axis] } else { end[axis] - start[axis] }
            };
            let count = self.data.settings.axes.len();
            (0..count).filter(|axis| axes(*axis)).map(|axis| travel(axis) * travel(axis)).sum()
        };
        let sweep = arc.map_or((0.0, 0.0), |(arc, radius)| (radius, arc.sweep.0.abs().to_radians()));
        let straight = squared(&|axis| !is_rotary(axis)).sqrt();
        let length = match (arc, straight) {
            (Some(_), _) => sweep.0 * sweep.1,
            (None, length) if length > 0.0 => length,
            (None, _) => squared(&is_rotary).sqrt(),
        };
        let feed = match plan.state.modal.motion {
            Motion::Rapid => None,
            _ => {
                let timed = self.data.path_time(&plan.state, length, self.words.has(b'F'));
                Some(self.locate(timed)?)
            }
        };
        let Some(kinematics) = &self.data.settings.kinematics else {
            match arc {
                Some((PlanarArc { plane, centre, sweep }, radius)) => {
                    let mut middle = start;
                    (middle[plane.0], middle[plane.1]) = centre;
                    let middle = self.data.to_machine_unrounded(&plan.state, &middle);
                    let arc = PlanarArc { plane, centre: (middle[plane.0], middle[plane.1]), sweep };
                    return self.push_arc(plan, to, arc, radius);
                }
                None => self.push_chord(plan, to, feed),
            }
            return Ok(());
        };
        let chords = self.data.tip_chords(kinematics, [&from, &to], &plan.state, sweep);
        let turns_table = self.turns_table(&from, &to);
        for chord in 1..=chords {
            let fraction = f64::from(chord) / f64::from(chords);
            let between = |a: f64, b: f64| a + (b - a) * fraction;
            let (mut at, mut work) = (from, start);
            for axis in 0..self.data.settings.axes.len() {
                at[axis] = between(from[axis], to[axis]);
                work[axis] = between(start[axis], end[axis]);
            }
            if let Some((PlanarArc { plane, centre, sweep }, _)) = arc {
                let (x, y, turned) = (start[plane.0] - centre.0, start[plane.1] - centre.1, sweep * fraction);
                work[plane.0] = centre.0 + x * turned.cos() - y * turned.sin();
                work[plane.1] = centre.1 + x * turned.sin() + y * turned.cos();
            }
            let aligned = match turns_table {
                true => self.data.part_aligned(&plan.state, &at),
                false => self.data.aligned(&plan.state, &at),
            };
            let at = match aligned {
                Some(aligned) if chord < chords => self.data.with_tip_at(&plan.state, &aligned, &work, &at),
                _ => to,
            };
            self.push_chord(plan, at, feed.map(|(rate, seconds)| (rate, seconds / f64::from(chords))));
        }
        Ok(())
    }

    /// Returns true if a rotary axis of the table turns between two positions.
    fn turns_table(&self, from: &Position, to: &Position) -> bool {
        let kinematics = self.data.settings.kinematics.as_ref();
        kinematics
            .is_some_and(|kinematics| kinematics.table.iter().any(|axis| from[axis.axis] != to[axis.axis]))
    }

    /// Emits a rapid, or a cut with its rate and seconds.
    fn push_chord(&self, plan: &mut BlockPlan, to: Position, feed: Option<(MmPerMin, f64)>) {
        match feed {
            Some((rate, seconds)) => plan.push_move(EventKind::Feed { to, rate }, seconds),
            None => {
                let seconds = self.data.rapid_seconds(&plan.state.machine_position, &to);
                plan.push_move(EventKind::Rapid { to }, seconds);
            }
        }
    }
}
