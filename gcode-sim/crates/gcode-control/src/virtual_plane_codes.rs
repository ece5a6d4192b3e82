//! G12.1, G13.1 and G07.1, and G107 of a Haas: beginning and end of a virtual plane, and the codes that it excludes.
use super::data::ControlData;
use super::functions::{ExecResult, locate};
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::virtual_plane::{VirtualPlane, VirtualSurface};
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::code_facts::CoordinateUse;
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot, name};
use gcode_lang::program::modes::{
    CutterSide, DynamicOffset, FeedMode, Motion, Plane, Polar, PolarInterpolation,
};

/// Setting 34 of a Haas: the diameter of G107.
const FOURTH_AXIS_DIAMETER: u32 = 20_034;

impl ControlData {
    /// Returns the axes of the active plane in right-handed order, in a virtual plane its own.
    pub(super) fn active_plane(&self, state: &State) -> Result<(AxisIndex, AxisIndex), Alarm> {
        let Some(VirtualPlane { surface, linear, rotary, .. }) = state.virtual_plane else {
            return self.plane_axes(state.modal.plane);
        };
        match surface {
            VirtualSurface::Disc { .. } => Ok((linear, rotary)),
            VirtualSurface::WrappedAxis { .. } => self.plane_axes(state.modal.plane),
            VirtualSurface::Cylinder { .. } => match self.plane_axes(state.modal.plane)? {
                (first, _) if first == linear => Ok((linear, rotary)),
                (_, second) if second == linear => Ok((rotary, linear)),
                _ => Err(Alarm::CylinderFormat(
                    "the plane of an arc or of compensation contains the cylinder's axis",
                )),
            },
        }
    }

    /// Returns the position on the machine of a position of the control.
    pub(super) fn real_position(&self, state: &State, position: &Position) -> Position {
        match &state.virtual_plane {
            Some(plane) => plane.on_machine(position, plane.machine_position[plane.rotary]),
            None => *position,
        }
    }
}

impl State {
    /// Returns true if an axis is a length here and an angle on the machine.
    pub(super) fn is_virtual(&self, axis: AxisIndex) -> bool {
        self.virtual_plane.is_some_and(|plane| plane.virtual_axis() == axis)
    }
}

impl Planner<'_> {
    /// Raises the alarm of a code that a virtual plane excludes.
    pub(super) fn check_code_in_virtual_plane(&self, row: &GCodeRow) -> ExecResult<()> {
        let Some(plane) = &self.registers.state.virtual_plane else { return Ok(()) };
        if let VirtualSurface::WrappedAxis { .. } = plane.surface {
            let is_excluded = row.facts.coordinates == CoordinateUse::NotTransformed
                && row.effect != Effect::OneShot(OneShot::WrappedAxis)
                || matches!(row.effect, Effect::OneShot(OneShot::Skip | OneShot::SingleDirection));
            return match is_excluded {
                true => {
                    Err(self.not_simulated(format!("{} in G107 (command G107 before it)", name(row.code))))
                }
                false => Ok(()),
            };
        }
        let is_allowed = match row.effect {
            Effect::Motion(motion) => {
                matches!(motion, Motion::Linear | Motion::Clockwise | Motion::Counterclockwise)
            }
            Effect::Plane(_) => matches!(plane.surface, VirtualSurface::Cylinder { .. }),
            Effect::FeedMode(mode) => mode != FeedMode::InverseTime,
            Effect::OneShot(one) => match plane.surface {
                VirtualSurface::Cylinder { .. } => {
                    matches!(one, OneShot::Dwell | OneShot::Cylinder | OneShot::CornerArc)
                }
                _ => matches!(one, OneShot::Dwell | OneShot::CornerArc),
            },
            Effect::PolarInterpolation(mode) => {
                mode == PolarInterpolation::Off && matches!(plane.surface, VirtualSurface::Disc { .. })
            }
            Effect::Cycle(cycle) => cycle.is_none(),
            Effect::Distance(_)
            | Effect::Cutter(_)
            | Effect::ReturnTo(_)
            | Effect::SpindleMode(_)
            | Effect::Cutting(_)
            | Effect::NoEffect
            | Effect::LookAhead
            | Effect::Declared
            | Effect::Call => true,
            _ => false,
        };
        match (is_allowed, plane.surface) {
            (true, _) => Ok(()),
            (false, VirtualSurface::Disc { .. }) => {
                Err(Alarm::CodeInPolarInterpolation(name(row.code)).located_at(self.block))
            }
            (false, _) => Err(Alarm::CodeInCylinder(name(row.code)).located_at(self.block)),
        }
    }

    /// Raises the alarm of a rapid in polar or cylindrical interpolation.
    pub(super) fn check_motion_in_virtual_plane(&self, state: &State) -> ExecResult<()> {
        let code = || name(state.modal.motion.code());
        let is_cut =
            matches!(state.modal.motion, Motion::Linear | Motion::Clockwise | Motion::Counterclockwise);
        match state.virtual_plane {
            Some(VirtualPlane { surface: VirtualSurface::Disc { .. }, .. }) if !is_cut => {
                Err(Alarm::CodeInPolarInterpolation(code()).located_at(self.block))
            }
            Some(VirtualPlane { surface: VirtualSurface::Cylinder { .. }, .. }) => match is_cut {
                false => Err(Alarm::CodeInCylinder(code()).located_at(self.block)),
                true if self.words.has_any(b"IJK") && state.modal.motion != Motion::Linear => {
                    Err(self.cylinder_format("an arc is commanded by R, not by I, J, K"))
                }
                true => Ok(()),
            },
            Some(VirtualPlane { surface: VirtualSurface::WrappedAxis { .. }, rotary, .. })
                if self.names(rotary) =>
            {
                Err(self.not_simulated("the rotary axis of G107 in a block of its own words"))
            }
            _ => Ok(()),
        }
    }

    fn polar_format(&self, what: &'static str) -> LocatedAlarm {
        Alarm::PolarInterpolationFormat(what).located_at(self.block)
    }

    fn cylinder_format(&self, what: &'static str) -> LocatedAlarm {
        Alarm::CylinderFormat(what).located_at(self.block)
    }

    /// Returns the mode that excludes a virtual plane, if one is active.
    fn excluding_mode(&self, state: &State) -> Option<&'static str> {
        let modal = &state.modal;
        Some(if modal.cutter != CutterSide::Off || !self.registers.lookahead.is_idle() {
            "in cutter compensation or after a corner word"
        } else if modal.cycle.is_some() {
            "in a canned cycle"
        } else if modal.polar == Polar::On
            || !state.transform.is_identity()
            || state.controls_tip()
            || modal.dynamic != DynamicOffset::Off
        {
            "in G16, G51, G51.1, G68, a tilted plane, a dynamic offset or tool centre point control"
        } else {
            return None;
        })
    }

    /// G12.1 and G13.1: the plane of a linear axis and of a rotary one as its virtual axis, whose coordinate begins at 0. The
    /// work zero of the linear axis is on the rotary axis.
    pub(super) fn plan_polar_interpolation(&self, is_on: bool, plan: &mut BlockPlan) -> ExecResult<()> {
        if self.names_axis() {
            return Err(self.polar_format("an axis in the block of G12.1 or G13.1"));
        }
        if let Some(what) = self.excluding_mode(&plan.state) {
            let code = if is_on { "G12.1" } else { "G13.1" };
            return Err(self.not_simulated(format!("{code} {what}")));
        }
        if !is_on {
            self.end_virtual_plane(&mut plan.state);
            return Ok(());
        }
        let (linear, rotary) = self.polar_axes()?;
        let state = &mut plan.state;
        let zero = |axis| self.data.zero(state, axis);
        let origin = (zero(linear) + state.length_offset[linear], zero(rotary));
        let side = if state.machine_position[linear] < origin.0 { -1.0 } else { 1.0 };
        self.begin_virtual_plane(state, VirtualSurface::Disc { side }, (linear, rotary), origin);
        state.modal.plane = match self.data.settings.axes.letter(linear) {
            'Y' => Plane::Yz,
            'Z' => Plane::Zx,
            _ => Plane::Xy,
        };
        if let Some(plane) = &mut state.virtual_plane {
            plane.start_angle = plane.machine_position[rotary];
            plane.virtual_position[rotary] = origin.1;
        }
        state.machine_position[rotary] = origin.1;
        state.transform.unknown_centre |= state.unknown.all() & 1 << rotary;
        self.data.recompute_position(state);
        Ok(())
    }

    /// Returns the axes of 5460 and 5461: X and C, or the only rotary axis, where they are 0.
    fn polar_axes(&self) -> ExecResult<(AxisIndex, AxisIndex)> {
        let axes = &self.data.settings.axes;
        let [linear, rotary] = self.data.settings.polar_axes.map(|number| number.checked_sub(1));
        let linear =
            linear.or_else(|| axes.find(b'X')).filter(|axis| *axis < axes.len() && !axes.is_rotary(*axis));
        let mut rotaries = (0..axes.len()).filter(|axis| axes.is_rotary(*axis));
        let only = rotaries.next().filter(|_| rotaries.next().is_none());
        let rotary = rotary.or_else(|| axes.find(b'C')).or(only).filter(|axis| axes.is_rotary(*axis));
        let missing = || self.polar_format("the axes of 5460 and 5461 are a linear and a rotary axis");
        linear.zip(rotary).ok_or_else(missing)
    }

    /// G07.1 with a rotary axis and the radius of the cylinder; 0 ends the mode.
    pub(super) fn plan_cylinder(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let axes = &self.data.settings.axes;
        let mut named = self.named_axes();
        let rotary = named.next().filter(|axis| axes.is_rotary(*axis) && named.next().is_none());
        let rotary =
            rotary.ok_or_else(|| self.cylinder_format("G07.1 names one rotary axis with the radius"))?;
        let radius = match self.words.get(self.data.axis_letter(rotary)) {
            Some((raw, span)) => {
                locate(self.data.dimension_of(&raw, b'X', &self.data.measure(plan.state.modal.unit)), span)?
            }
            None => 0.0,
        };
        if let Some(what) = self.excluding_mode(&plan.state) {
            return Err(self.not_simulated(format!("G07.1 {what}")));
        }
        if radius == 0.0 {
            self.end_virtual_plane(&mut plan.state);
            return Ok(());
        }
        if radius < 0.0 {
            return Err(self.cylinder_format("the radius of G07.1 is not negative"));
        }
        if plan.state.virtual_plane.is_some() {
            return Err(self.cylinder_format("G07.1 while it is active; G07.1 with 0 ends it"));
        }
        let along = match self.data.axis_letter(rotary) {
            b'A' => b'X',
            b'B' => b'Y',
            _ => b'Z',
        };
        let linear = axes
            .find(along)
            .ok_or_else(|| self.cylinder_format("the control has an axis along the cylinder"))?;
        let state = &mut plan.state;
        let mm_per_degree = radius.to_radians();
        let zero = self.data.zero(state, rotary);
        let origin = (self.data.zero(state, linear), zero);
        self.begin_virtual_plane(state, VirtualSurface::Cylinder { mm_per_degree }, (linear, rotary), origin);
        let angle = state.programmed_position[rotary];
        let position = zero + angle * mm_per_degree;
        if let Some(plane) = &mut state.virtual_plane {
            plane.start_angle = plane.machine_position[rotary] - angle;
            plane.virtual_position[rotary] = position;
        }
        state.machine_position[rotary] = position;
        self.data.recompute_position(state);
        Ok(())
    }

    /// G107 of a Haas: the named linear axis, else Y, is wrapped round the named rotary axis, else A, at the radius R, half of Q,
    /// or half of setting 34; without words it ends the mode.
    pub(super) fn plan_wrapped_axis(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        if !self.names_axis() && !self.words.has_any(b"QR") {
            self.end_virtual_plane(&mut plan.state);
            return Ok(());
        }
        if let Some(what) = self.excluding_mode(&plan.state) {
            return Err(self.not_simulated(format!("G107 {what}")));
        }
        if plan.state.virtual_plane.is_some() {
            return Err(self.not_simulated("G107 while it is active"));
        }
        let axes = &self.data.settings.axes;
        let only = |is_rotary: bool, default: u8| {
            let mut named = self.named_axes().filter(|axis| axes.is_rotary(*axis) == is_rotary);
            match (named.next(), named.next()) {
                (None, _) => axes.find(default),
                (first, None) => first,
                _ => None,
            }
        };
        let (Some(linear), Some(rotary)) = (only(false, b'Y'), only(true, b'A')) else {
            return Err(self.not_simulated("G107 without one linear and one rotary axis of the control"));
        };
        for axis in [linear, rotary] {
            if self
                .axis_dimension(axis, &plan.state)?
                .is_some_and(|value| value != plan.state.programmed_position[axis])
            {
                return Err(self.not_simulated("G107 with another place than that of the tool"));
            }
        }
        let radius = match (self.dimension(b'R', &plan.state)?, self.dimension(b'Q', &plan.state)?) {
            (Some(radius), _) => radius,
            (None, Some(diameter)) => diameter / 2.0,
            (None, None) => self.registers.machine_value(FOURTH_AXIS_DIAMETER, None) / 2.0,
        };
        if radius <= 0.0 {
            return Err(self.not_simulated("G107 without a radius R or a diameter Q"));
        }
        let state = &mut plan.state;
        let rest = state.machine_position[linear];
        let surface = VirtualSurface::WrappedAxis { mm_per_degree: radius.to_radians(), rest };
        let origin = (rest, state.machine_position[rotary]);
        self.begin_virtual_plane(state, surface, (linear, rotary), origin);
        Ok(())
    }

    fn begin_virtual_plane(
        &self,
        state: &mut State,
        surface: VirtualSurface,
        (linear, rotary): (AxisIndex, AxisIndex),
        origin: (f64, f64),
    ) {
        state.virtual_plane = Some(VirtualPlane {
            surface,
            linear,
            rotary,
            origin,
            start_angle: state.machine_position[rotary],
            virtual_position: state.machine_position,
            machine_position: state.machine_position,
            selected: state.modal.plane,
        });
    }

    /// Ends a virtual plane: the axes are where the machine has left them.
    fn end_virtual_plane(&self, state: &mut State) {
        let Some(plane) = state.virtual_plane.take() else { return };
        state.machine_position = plane.machine_position;
        if let VirtualSurface::Disc { .. } = plane.surface {
            state.modal.plane = plane.selected;
        }
        self.data.recompute_position(state);
    }
}
