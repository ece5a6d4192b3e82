//! Which work coordinate systems a run has moved in before anything set them: they are zero then, whatever the machine has.
use super::control::Control;
use super::executor::Executor;
use super::plan::BlockPlan;
use super::planner::Planner;
use gcode_lang::motion::{Backtrace, EventKind};
use gcode_lang::program::modes::WorkSystem;

impl Planner<'_> {
    /// Axes are about to go where machine coordinates say. What the machine's zero is to the part, the work offset in effect
    /// says, if anything has set it.
    pub(super) fn note_unknown_work_zero(&self, plan: &mut BlockPlan, axes: u8) {
        if axes == 0 || self.data.set_systems.contains(&number(plan.state.modal.work)) {
            return;
        }
        plan.state.work_zero_unknown |= axes;
        plan.push_event(EventKind::WorkZeroUnknown { axes: plan.state.work_zero_unknown });
    }
}

impl Executor {
    /// A block has been carried out. G54 is what counts where nothing is selected: its zero is the part's.
    #[inline]
    pub(super) fn record_work_use(&mut self, before: WorkSystem, has_moved: bool) {
        let work = self.registers.state.modal.work;
        if work != WorkSystem::default() {
            self.record_other_work(work, before, has_moved);
        }
    }

    #[inline(never)]
    fn record_other_work(&mut self, work: WorkSystem, before: WorkSystem, has_moved: bool) {
        if work != before {
            self.log.work_selected = self.flow.backtrace();
        }
        let is_recorded = self.log.unset_systems.iter().any(|(other, _)| *other == work);
        if has_moved && !is_recorded && !self.registers.data.set_systems.contains(&number(work)) {
            self.log.unset_systems.push((work, self.log.work_selected.clone()));
        }
    }
}

impl Control {
    /// Work coordinate systems other than G54 that the run has moved in while nothing had set them, each with the block that
    /// first selected it.
    pub fn unset_work_systems(&self) -> &[(WorkSystem, Backtrace)] {
        &self.executor.log.unset_systems
    }
}

/// 1 to 6 are G54 to G59, 7 and up G54.1 P1….
pub(super) fn number(work: WorkSystem) -> usize {
    match work {
        WorkSystem::Standard(number) => usize::from(number),
        WorkSystem::Additional(number) => 6 + usize::from(number),
    }
}
