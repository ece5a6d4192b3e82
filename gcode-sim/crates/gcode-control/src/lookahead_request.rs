//! What a block commands of compensation and corner words, read off its plan.
use super::checked::{ExecResult, locate};
use super::lookahead::{CornerArc, LookaheadRequest};
use super::modal_codes::AxisWordUse;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan};
use super::planner::Planner;
use super::state::State;
use super::words::BlockWords;
use crate::contour::Point;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::Backtrace;
use gcode_lang::program::code_facts::LookaheadUse;
use gcode_lang::program::g_codes::{self, Effect};
use gcode_lang::program::modes::{CutterSide, Motion, Plane};
use gcode_lang::source::Span;

impl Planner<'_> {
    /// Whether compensation, a corner word or a move that waits could concern a block.
    #[inline(always)]
    pub(crate) fn needs_lookahead(&self, block_words: &BlockWords, state: &State) -> bool {
        let is_commanded = state.modal.cutter != CutterSide::Off || block_words.has_corner();
        is_commanded || block_words.has_any(b"IJK") || !self.registers.lookahead.is_idle()
    }

    /// Lets a block's plan go by way of what is read ahead, where compensation or a corner word is in use.
    pub(crate) fn plan_lookahead(
        &self,
        axis_use: Option<AxisWordUse>,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if block_words.has_corner() && plan.corner.is_none() {
            plan.notes.push(Note::CornerIgnored);
        }
        let cancels_compensation =
            block_words.g_codes().any(|row| row.effect == Effect::Cutter(CutterSide::Off));
        let towards =
            if cancels_compensation { self.plane_vector(block_words, &plan.state, span)? } else { None };
        let distance = locate(self.cutter_distance(&plan.state), span)?;
        if self.registers.lookahead.is_idle() && distance.is_none() && plan.corner.is_none() {
            return Ok(());
        }
        if plan.state.transform.tilt.is_some() && distance.is_some_and(|d| d != 0.0) {
            let what = "cutter compensation in a tilted plane".into();
            return Err(Alarm::NotSimulated { what }.located_at(span));
        }
        let motion = plan.state.modal.motion;
        let uses =
            |lookahead: LookaheadUse| block_words.g_codes().find(|row| row.facts.lookahead == lookahead);
        let threads = axis_use.is_none() && motion == Motion::Thread && plan.commands_axes;
        let thread = threads.then(|| g_codes::name(motion.code()));
        let refused_code = uses(LookaheadUse::Refused).map(|row| g_codes::name(row.code)).or(thread);
        if let Some(code) = refused_code
            && (distance.is_some() || self.registers.lookahead.is_offset())
        {
            return Err(
                Alarm::NotSimulated { what: format!("{code} in cutter compensation") }.located_at(span)
            );
        }
        let plane = locate(self.data.plane_axes(plan.state.modal.plane), span)?;
        let names_plane_axis = |axis| block_words.has(self.data.settings.axes.letter(axis) as u8);
        let restates_side = block_words.g_codes().any(|row| {
            matches!(row.effect, Effect::Cutter(side) if side != CutterSide::Off)
                && self.registers.state.modal.cutter == plan.state.modal.cutter
        });
        let corner_arc = match uses(LookaheadUse::CornerArc) {
            Some(_) => Some(self.corner_arc(block_words, plan, span)?),
            None => None,
        };
        let request = LookaheadRequest {
            plane,
            distance,
            wall_direction: towards,
            is_restated: restates_side,
            suspends_compensation: plan.cycle_plan.is_some()
                || uses(LookaheadUse::Suspends).is_some()
                || plan.commands_axes && plan.state.modal.cycle.is_some(),
            blocks_lookahead: !plan.stops.is_empty() || matches!(plan.flow, BlockFlow::End),
            counts_as_block: matches!(plan.flow, BlockFlow::Next | BlockFlow::End) && corner_arc.is_none(),
            has_zero_length: axis_use.is_none() && (names_plane_axis(plane.0) || names_plane_axis(plane.1)),
            is_cut: axis_use.is_none()
                && matches!(motion, Motion::Linear | Motion::Clockwise | Motion::Counterclockwise),
            is_dwell: uses(LookaheadUse::Dwell).is_some(),
            blend: plan.corner,
            corner_arc,
            backtrace: Backtrace { block: span, calls: self.flow.frame.calls.clone() },
        };
        plan.lookahead.clone_from(&self.registers.lookahead);
        plan.lookahead.start_at(self.registers.state.machine);
        if plan.cycle_plan.is_none() {
            plan.events.append(&mut plan.events_after_motion);
        }
        plan.lookahead.process_block(self.data, &request, &plan.events)?;
        plan.events.clear();
        plan.uses_lookahead = true;
        if let Some(drill) = &mut plan.cycle_plan {
            drill.set_start(plan.lookahead.end_path());
        }
        Ok(())
    }

    /// How far the tool's centre is to be to the left of the path.
    fn cutter_distance(&self, state: &State) -> Result<Option<f64>, Alarm> {
        let side = match state.modal.cutter {
            CutterSide::Off => return Ok(None),
            CutterSide::Left => 1.0,
            CutterSide::Right => -1.0,
        };
        if state.codes.d == 0 {
            return Ok(None);
        }
        let (mirrored, _) = state.transform.arc_effect(self.data.plane_axes(state.modal.plane)?);
        Ok(Some(if mirrored { -side } else { side } * state.cutter_radius))
    }

    /// I, J, K of the plane as a direction in machine coordinates.
    fn plane_vector(&self, block_words: &BlockWords, state: &State, span: Span) -> ExecResult<Option<Point>> {
        let letters = match state.modal.plane {
            Plane::Xy => (b'I', b'J'),
            Plane::Zx => (b'K', b'I'),
            Plane::Yz => (b'J', b'K'),
        };
        let first = self.data.dimension(block_words, letters.0, state)?.unwrap_or(0.0);
        let second = self.data.dimension(block_words, letters.1, state)?.unwrap_or(0.0);
        let plane = locate(self.data.plane_axes(state.modal.plane), span)?;
        if first == 0.0 && second == 0.0 {
            return Ok(None);
        }
        let mut tip = state.programmed;
        tip[plane.0] += first;
        tip[plane.1] += second;
        let (from, to) = (state.transform.forward(state.programmed), state.transform.forward(tip));
        Ok(Some(Point::new(to[plane.0] - from[plane.0], to[plane.1] - from[plane.1])))
    }

    /// G39: a cutting feed round the corner.
    fn corner_arc(&self, block_words: &BlockWords, plan: &BlockPlan, span: Span) -> ExecResult<CornerArc> {
        let timed = self.data.path_time(&plan.state, 1.0, block_words.has(b'F'));
        let (rate, _) = timed.map_err(|_| Alarm::ArcFeedZero.located_at(span))?;
        Ok(CornerArc { direction: self.plane_vector(block_words, &plan.state, span)?, rate })
    }
}
