//! G68, G68.2, G51 and G51.1: their words to a [`super::transform::Transform`].
use super::checked::{ExecResult, locate};
use super::modal_codes::not_simulated;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::transform::{Rotation, Scale, Tilt, Transform};
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{MAX_AXES, Position};
use gcode_lang::program::modes::Mirror;
use gcode_lang::source::Span;

impl Planner<'_> {
    /// G68: the plane turns about a point.
    pub(super) fn plan_rotation(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let state = &mut plan.state;
        let plane = locate(self.data.plane_axes(state.modal.plane), span)?;
        let letter = |axis| self.data.settings.axes.letter(axis) as u8;
        let first =
            self.data.dimension(block_words, letter(plane.0), state)?.unwrap_or(state.programmed[plane.0]);
        let second =
            self.data.dimension(block_words, letter(plane.1), state)?.unwrap_or(state.programmed[plane.1]);
        let angle = self.data.angle(block_words, b'R')?;
        if angle.is_none() {
            plan.notes.push(Note::NoAngle);
        }
        let angle = angle.unwrap_or(0.0);
        // Mirror and scaling act before the rotation, on its centre too; a mirror image turns the other way round.
        let mut centre = state.programmed;
        (centre[plane.0], centre[plane.1]) = (first, second);
        let centre = Transform { rotation: None, tilt: None, ..state.transform }.forward(centre);
        let (mirrored, _) = state.transform.arc_effect(plane);
        let angle = if mirrored { -angle } else { angle };
        state.transform.rotation = Some(Rotation::new(plane, (centre[plane.0], centre[plane.1]), angle));
        self.data.apply_transform_change(state);
        Ok(())
    }

    /// G68.2 by Euler angles; its other forms have a P.
    pub(super) fn plan_tilt(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if block_words.has_any(b"PQR") {
            return Err(not_simulated(682, "tilted plane other than by Euler angles").located_at(span));
        }
        let (mut axes, mut origin, mut angles) = ([0; 3], [0.0; 3], [0.0; 3]);
        for (place, (letter, angle)) in [(b'X', b'I'), (b'Y', b'J'), (b'Z', b'K')].into_iter().enumerate() {
            let missing = Alarm::ImproperAddress { letter: char::from(letter) };
            axes[place] = locate(self.data.settings.axes.find(letter).ok_or(missing), span)?;
            origin[place] = self.data.dimension(block_words, letter, &plan.state)?.unwrap_or(0.0);
            angles[place] = self.data.angle(block_words, angle)?.unwrap_or(0.0);
        }
        plan.state.transform.tilt = Some(Tilt::new(axes, origin, angles));
        self.data.apply_transform_change(&mut plan.state);
        Ok(())
    }

    /// G51: by P, or by I J K for X Y Z, in 0.001 or 0.00001.
    pub(super) fn plan_scaling(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let unit = if self.data.settings.has_coarse_scaling { 1000.0 } else { 100_000.0 };
        let mut scale = Scale { centre: plan.state.programmed, factor: Position([1.0; MAX_AXES]) };
        for (axis, letter) in self.data.settings.axes.iter() {
            if let Some(value) = self.data.dimension(block_words, letter as u8, &plan.state)? {
                scale.centre[axis] = value;
            }
            let own = match letter {
                'X' => self.data.factor(block_words, b'I')?,
                'Y' => self.data.factor(block_words, b'J')?,
                'Z' => self.data.factor(block_words, b'K')?,
                _ => continue,
            };
            let common = block_words.count(b'P')?.map(f64::from);
            let factor = own.or(common).ok_or_else(|| {
                Alarm::NotSimulated { what: "G51 without P (parameter 5411)".into() }.located_at(span)
            })?;
            if factor == 0.0 || factor.abs() > 999_999_999.0 {
                return Err(Alarm::ScaleRate { value: factor }.located_at(span));
            }
            scale.factor[axis] = factor / unit;
        }
        plan.state.transform.scaling = Some(scale);
        self.data.apply_transform_change(&mut plan.state);
        Ok(())
    }

    /// G51.1 mirrors the named axes, G50.1 no longer; G50.1 alone ends all of it.
    pub(super) fn plan_mirror(
        &self,
        is_on: bool,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        let state = &mut plan.state;
        if !is_on && !self.data.names_axis(block_words) {
            state.transform.mirrored_axes = 0;
        }
        for (axis, letter) in self.data.settings.axes.iter() {
            let Some(value) = self.data.dimension(block_words, letter as u8, state)? else { continue };
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
}
