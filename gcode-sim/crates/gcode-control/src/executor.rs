//! Everything of a control but its programs.
use super::flow::ProgramFlow;
use super::planner::Planner;
use super::registers::Registers;
use super::run_log::RunLog;
use gcode_lang::control::Settings;
use gcode_lang::program::ProgramId;

/// What a run changes: what programs read, where they are, and what is recorded of them.
#[derive(Clone, Debug)]
pub(super) struct Executor {
    pub(super) registers: Registers,
    pub(super) flow: ProgramFlow,
    pub(super) log: RunLog,
}

impl Executor {
    pub(super) fn new(settings: Settings) -> Self {
        let flow = ProgramFlow::new(ProgramId::default());
        Self { registers: Registers::new(settings), flow, log: RunLog::default() }
    }

    /// Plans blocks as the control stands now.
    #[inline(always)]
    pub(super) fn planner(&self) -> Planner<'_> {
        let Self { registers, flow, log: _ } = self;
        Planner { registers, data: &registers.data, flow }
    }
}
