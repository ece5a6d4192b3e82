//! L of a Haas: repeats a straight move in G91.
use super::functions::ExecResult;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use gcode_lang::program::modes::{CutterSide, Distance, Motion};

/// Most repeats of a cycle or of a move: K and L have four digits.
pub(super) const MOST_REPEATS: u32 = 9999;

impl Planner<'_> {
    /// Returns true for a straight move, which L may repeat.
    pub(super) fn repeats_move(&self, state: &State) -> bool {
        matches!(state.modal.motion, Motion::Rapid | Motion::Linear)
            && state.modal.cycle.is_none()
            && self.names_axis()
    }

    /// Plans the moves of L except the last.
    pub(super) fn plan_repeated_moves(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        for _ in 1..self.move_repeats(plan)? {
            let endpoint = self.resolve_endpoint(plan)?;
            match plan.state.modal.motion {
                Motion::Rapid => self.push_rapid(plan, &endpoint.machine),
                _ => self.locate(self.push_feed(plan, &endpoint.machine))?,
            }
            plan.state.programmed_position = endpoint.programmed;
        }
        Ok(())
    }

    /// Returns the number of times that the block's move is executed: L in G91.
    fn move_repeats(&self, plan: &BlockPlan) -> ExecResult<u32> {
        let repeats = self.words.count(b'L')?.unwrap_or(1);
        let is_lookahead = plan.state.modal.cutter != CutterSide::Off || self.words.corner.is_some();
        if repeats == 0 || repeats > MOST_REPEATS || is_lookahead && repeats > 1 {
            return Err(self.not_simulated(format!("L{repeats} of a move")));
        }
        // An absolute move repeated goes nowhere.
        Ok(if plan.state.modal.distance == Distance::Incremental { repeats } else { 1 })
    }
}
