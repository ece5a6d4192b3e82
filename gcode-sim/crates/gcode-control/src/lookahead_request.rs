//! Compensation and corner words that a planned block commands, and its way through the lookahead.
use super::axis_word_use::AxisWordUse;
use super::functions::ExecResult;
use super::lookahead::{AskewPlane, CornerArc, LookaheadRequest};
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan};
use super::planner::Planner;
use super::state::State;
use crate::contour::Point;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::DeclaredEffect;
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::code_facts::LookaheadUse;
use gcode_lang::program::g_codes;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::{CutterSide, Motion, Plane};

impl Planner<'_> {
    /// Returns true if compensation, a corner word or a waiting move could concern the block.
    #[inline(always)]
    pub(super) fn needs_lookahead(&self, state: &State) -> bool {
        let is_commanded = state.modal.cutter != CutterSide::Off || self.words.corner.is_some();
        is_commanded || self.words.has_any(b"IJK") || !self.registers.lookahead.is_idle()
    }

    /// Returns true if an M code is declared to wait for the end of the moves before it.
    fn waits_for_m_code(&self) -> bool {
        let declared = &self.data.settings.declared_codes;
        self.words
            .m_codes
            .iter()
            .any(|(code, _)| declared.find(b'M', 10 * code) == Some(DeclaredEffect::Wait))
    }

    /// Passes the events of a plan through the lookahead if compensation or a corner word is active.
    pub(super) fn plan_lookahead(
        &self,
        axis_word_use: Option<AxisWordUse>,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        if self.words.corner.is_some() && plan.corner.is_none() {
            plan.notes.push(Note::CornerIgnored);
        }
        let cancels_compensation =
            self.words.g_codes().any(|row| row.effect == Effect::Cutter(CutterSide::Off));
        let wall_direction = if cancels_compensation { self.plane_vector(&plan.state)? } else { None };
        let distance = self.locate(self.cutter_distance(&plan.state))?;
        if !self.leads_through_lookahead(plan)? {
            return Ok(());
        }
        let motion = plan.state.modal.motion;
        let uses =
            |lookahead: LookaheadUse| self.words.g_codes().find(|row| row.facts.lookahead == lookahead);
        let threads = axis_word_use.is_none() && motion == Motion::Thread && plan.commands_axes;
        let thread = threads.then(|| g_codes::name(motion.code()));
        let refused_code = uses(LookaheadUse::Refused).map(|row| g_codes::name(row.code)).or(thread);
        if let Some(code) = refused_code
            && (distance.is_some() || self.registers.lookahead.is_offset())
        {
            return Err(self.not_simulated(format!("{code} in cutter compensation")));
        }
        let programmed_plane = self.locate(self.data.active_plane(&plan.state))?;
        let (plane, side, askew_plane) = self.compensation_plane(&plan.state)?;
        let distance = distance.map(|distance| distance * side);
        let is_restated = self.words.g_codes().any(|row| {
            matches!(row.effect, Effect::Cutter(side) if side != CutterSide::Off)
                && self.registers.state.modal.cutter == plan.state.modal.cutter
        });
        let corner_arc = match uses(LookaheadUse::CornerArc) {
            Some(_) => Some(self.corner_arc(plan)?),
            None => None,
        };
        let request = LookaheadRequest {
            askew_plane,
            plane,
            distance,
            wall_direction,
            is_restated,
            suspends_compensation: plan.cycle_plan.is_some()
                || uses(LookaheadUse::Suspends).is_some()
                || plan.commands_axes && plan.state.modal.cycle.is_some(),
            blocks_lookahead: !plan.stops.is_empty()
                || matches!(plan.flow, BlockFlow::End)
                || uses(LookaheadUse::Blocks).is_some()
                || self.waits_for_m_code(),
            counts_as_block: matches!(plan.flow, BlockFlow::Next | BlockFlow::End) && corner_arc.is_none(),
            has_zero_length: axis_word_use.is_none()
                && (self.names(programmed_plane.0) || self.names(programmed_plane.1)),
            is_cut: axis_word_use.is_none()
                && matches!(motion, Motion::Linear | Motion::Clockwise | Motion::Counterclockwise),
            is_dwell: uses(LookaheadUse::Dwell).is_some(),
            blend: plan.corner,
            corner_arc,
            backtrace: self.flow.backtrace(),
        };
        plan.lookahead.clone_from(&self.registers.lookahead);
        plan.lookahead.start_at(self.registers.state.machine_position, &request)?;
        if plan.cycle_plan.is_none() {
            plan.events.append(&mut plan.events_after_motion);
        }
        plan.lookahead.process_block(self.data, &request, &plan.events)?;
        plan.events.clear();
        plan.uses_lookahead = true;
        if let Some(drill) = &mut plan.cycle_plan {
            drill.start_state.machine_position = plan.lookahead.end_path();
        }
        Ok(())
    }

    /// Returns true if the moves of a block wait for the next one, or follow one that does.
    pub(super) fn leads_through_lookahead(&self, plan: &BlockPlan) -> ExecResult<bool> {
        Ok(plan.corner.is_some()
            || !self.registers.lookahead.is_idle()
            || self.locate(self.cutter_distance(&plan.state))?.is_some())
    }

    /// Returns the machine axes of the active plane, and −1 if it is seen there from behind; an askew plane with its own axes.
    fn compensation_plane(
        &self,
        state: &State,
    ) -> ExecResult<((AxisIndex, AxisIndex), f64, Option<AskewPlane>)> {
        let plane = self.locate(self.data.active_plane(state))?;
        if let Some((axes, side)) = state.machine_plane(plane) {
            return Ok((axes, side, None));
        }
        if self.data.settings.undocumented.plane_turns_with_axes {
            return Err(self.not_simulated(
                "cutter compensation or a corner word in an askew plane that turns with the axes (PLANE-TURNS)",
            ));
        }
        Ok((plane, 1.0, state.askew_plane(plane)))
    }

    /// Returns the distance of the tool centre to the left of the path; `None` without compensation.
    fn cutter_distance(&self, state: &State) -> Result<Option<f64>, Alarm> {
        let side = match state.modal.cutter {
            CutterSide::Off => return Ok(None),
            CutterSide::Left => 1.0,
            CutterSide::Right => -1.0,
        };
        if state.modal_words.d == 0 {
            return Ok(None);
        }
        let (mirrored, _) = state.transform.arc_effect(self.data.active_plane(state)?);
        Ok(Some(if mirrored { -side } else { side } * state.cutter_radius))
    }

    /// Returns I, J, K of the plane as a direction in machine coordinates.
    fn plane_vector(&self, state: &State) -> ExecResult<Option<Point>> {
        let letters = match state.modal.plane {
            Plane::Xy => (b'I', b'J'),
            Plane::Zx => (b'K', b'I'),
            Plane::Yz => (b'J', b'K'),
        };
        let first = self.dimension(letters.0, state)?.unwrap_or(0.0);
        let second = self.dimension(letters.1, state)?.unwrap_or(0.0);
        let plane = self.locate(self.data.active_plane(state))?;
        if first == 0.0 && second == 0.0 {
            return Ok(None);
        }
        let mut tip = state.programmed_position;
        tip[plane.0] += first;
        tip[plane.1] += second;
        let from = self.data.to_machine_unrounded(state, &state.programmed_position);
        let to = self.data.to_machine_unrounded(state, &tip);
        let (plane, _, askew_plane) = self.compensation_plane(state)?;
        let [from, to] = [from, to].map(|at| askew_plane.map_or(at, |askew| askew.in_plane(&at)));
        Ok(Some(Point::new(to[plane.0] - from[plane.0], to[plane.1] - from[plane.1])))
    }

    /// Returns the cutting feed of G39 round the corner.
    fn corner_arc(&self, plan: &BlockPlan) -> ExecResult<CornerArc> {
        let timed = self.data.path_time(&plan.state, 1.0, self.words.has(b'F'));
        let (rate, _) = timed.map_err(|_| Alarm::ArcFeedZero.located_at(self.block))?;
        Ok(CornerArc { direction: self.plane_vector(&plan.state)?, rate })
    }
}
