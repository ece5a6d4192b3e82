//! G68, G51 and G51.1: their words to a [`Transform`], and the codes that manuals rule out beside them.
use super::functions::ExecResult;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::{Modal, State};
use super::transform::{PlaneRotation, Scale, Transform};
use super::words::WordNumber;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Dialect;
use gcode_lang::motion::{MAX_AXES, Position};
use gcode_lang::program::code_facts::CoordinateUse;
use gcode_lang::program::g_codes::{Effect, OneShot, spelled};
use gcode_lang::program::modes::{Mirror, Rotation, Scaling};

impl Planner<'_> {
    /// G68: rotates the plane about a point.
    pub(super) fn plan_rotation(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        if self.words.has_any(b"IJK") {
            return self.plan_rotation_in_space(plan);
        }
        let state = &mut plan.state;
        let plane = self.locate(self.data.active_plane(state))?;
        let first = self.axis_dimension(plane.0, state)?.unwrap_or(state.programmed_position[plane.0]);
        let second = self.axis_dimension(plane.1, state)?.unwrap_or(state.programmed_position[plane.1]);
        let angle = self.angle(b'R')?;
        if angle.is_none() {
            plan.notes.push(Note::NoAngle);
        }
        let angle = angle.unwrap_or(0.0);
        // Mirror and scaling act before the rotation, on its centre too; a mirror image rotates in the other direction.
        let mut centre = state.programmed_position;
        (centre[plane.0], centre[plane.1]) = (first, second);
        let centre = Transform { rotation: None, tilt: None, ..state.transform }.work_position(centre);
        let (mirrored, _) = state.transform.arc_effect(plane);
        let angle = if mirrored { -angle } else { angle };
        let axes = [plane.0, plane.1].into_iter().filter(|axis| !self.names(*axis));
        if axes.fold(0, |bits, axis| bits | 1 << axis) & state.unknown.all() != 0 {
            state.transform.unknown_centre |= 1 << plane.0 | 1 << plane.1;
        }
        state.transform.rotation = Some(PlaneRotation::new(plane, (centre[plane.0], centre[plane.1]), angle));
        self.data.apply_transform_change(state);
        Ok(())
    }

    /// G51: by P, or by I J K for X Y Z, in 0.001 or 0.00001; on a Haas by P as written.
    pub(super) fn plan_scaling(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let is_haas = self.data.settings.codes == Dialect::HaasNgc;
        let unit = match self.data.settings.has_coarse_scaling {
            _ if is_haas => 1.0,
            true => 1000.0,
            false => 100_000.0,
        };
        let common =
            if is_haas { self.scale_factor_of_haas()? } else { self.words.count(b'P')?.map(f64::from) };
        let mut scale = Scale { centre: plan.state.programmed_position, factor: Position([1.0; MAX_AXES]) };
        for (axis, letter) in self.data.settings.axes.iter() {
            match self.axis_dimension(axis, &plan.state)? {
                Some(value) => scale.centre[axis] = value,
                None => plan.state.transform.unknown_centre |= plan.state.unknown.all() & 1 << axis,
            }
            let own = match letter {
                'X' | 'Y' | 'Z' if is_haas => None,
                'X' => self.factor(b'I')?,
                'Y' => self.factor(b'J')?,
                'Z' => self.factor(b'K')?,
                _ => continue,
            };
            let factor = own.or(common).unwrap_or(self.data.settings.scale_factor * unit);
            if factor == 0.0 || factor.abs() > 999_999_999.0 {
                return Err(Alarm::ScaleRate { value: factor }.located_at(self.block));
            }
            scale.factor[axis] = factor / unit;
        }
        plan.state.transform.scaling = Some(scale);
        self.data.apply_transform_change(&mut plan.state);
        Ok(())
    }

    /// Returns P of G51 of a Haas, a factor with a decimal point.
    fn scale_factor_of_haas(&self) -> ExecResult<Option<f64>> {
        match self.words.get(b'P') {
            Some((WordNumber::Literal(number), span)) if number.places.is_none() => {
                let what = "P of G51 without a decimal point (its unit is undocumented)".into();
                Err(Alarm::NotSimulated { what }.located_at(span))
            }
            Some((WordNumber::Literal(number), _)) => Ok(Some(number.value())),
            Some((WordNumber::Computed(factor), _)) => Ok(Some(factor)),
            None => Ok(None),
        }
    }

    /// G51.1 mirrors the named axes, G50.1 ends that; G50.1 alone ends it for all axes.
    pub(super) fn plan_mirror(&self, is_on: bool, plan: &mut BlockPlan) -> ExecResult<()> {
        let state = &mut plan.state;
        if !is_on && !self.names_axis() {
            state.transform.mirrored_axes = 0;
            plan.notes.push(Note::MirrorEnded);
        }
        for axis in 0..self.data.settings.axes.len() {
            let Some(value) = self.axis_dimension(axis, state)? else { continue };
            state.transform.mirrored_axes &= !(1 << axis);
            if is_on {
                state.transform.mirrored_axes |= 1 << axis;
                state.transform.mirror_position[axis] = value;
            }
        }
        state.modal.mirror = if state.transform.mirrored_axes == 0 { Mirror::Off } else { Mirror::On };
        self.data.apply_transform_change(state);
        Ok(())
    }

    /// Raises the alarm of a code that manuals rule out while mirror, scaling or rotation is active: reference returns, other
    /// coordinate systems, and a change out of order. The order is mirror, scale, rotate, and back the other way.
    ///
    /// `before` is the modal state before the block; `state` has the modal codes of the block, not yet its transform.
    pub(super) fn check_transform_order(&self, before: &Modal, state: &State) -> ExecResult<()> {
        let modal = &state.modal;
        let is_rotated = before.rotation == Rotation::On && modal.rotation == Rotation::On;
        let is_mirrored = before.mirror == Mirror::On;
        let was_scaled = before.scaling == Scaling::On;
        let is_scaled = was_scaled && modal.scaling == Scaling::On;
        for row in self.words.g_codes() {
            // G53 without an axis only waits.
            if row.effect == Effect::OneShot(OneShot::MachineCoordinateSystem) && !self.names_axis() {
                continue;
            }
            let returns = match row.effect {
                Effect::OneShot(OneShot::CheckReference | OneShot::FromReference) => true,
                Effect::OneShot(one) => one.moves_on_machine(),
                _ => false,
            };
            if returns && self.data.settings.undocumented.returns_in_transforms {
                continue;
            }
            let is_bound = row.facts.coordinates == CoordinateUse::NotTransformed;
            let is_mirror = |mirror| row.effect == Effect::Mirror(mirror);
            let is_scaling = |scaling| row.effect == Effect::Scaling(scaling);
            let sets_position = matches!(
                row.effect,
                Effect::OneShot(OneShot::SetWorkCoordinateSystem | OneShot::PresetWorkCoordinateSystem)
            );
            let (active, cancel) = if sets_position && state.alignment().is_some() {
                ("G53.1", "G69")
            } else if is_rotated
                && (is_bound
                    || is_mirror(Mirror::On)
                    || is_scaling(Scaling::On)
                    || is_mirror(Mirror::Off) && is_mirrored
                    || is_scaling(Scaling::Off) && was_scaled)
            {
                ("G68", "G69")
            } else if is_bound && is_mirrored {
                match self.data.settings.codes {
                    Dialect::HaasNgc => ("G101", "G100"),
                    Dialect::Fanuc31i | Dialect::Fanuc0iF => ("G51.1", "G50.1"),
                }
            } else if is_scaled && (is_mirror(Mirror::On) || is_mirror(Mirror::Off) && is_mirrored) {
                ("G51", "G50")
            } else {
                continue;
            };
            return Err(self.code_in_mode(spelled(row.code), (active, cancel)));
        }
        Ok(())
    }
}
