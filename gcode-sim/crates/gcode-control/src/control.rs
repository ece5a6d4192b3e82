//! A control with programs in its memory.
use std::sync::Arc;

use super::executor::Executor;
use super::flow::Frame;
use super::loop_detection::LoopDetector;
use super::outcome::{Outcome, Progress};
use super::plan::BlockPlan;
use super::variables::Value;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::program::{Memory, ProgramId, Slot};
use gcode_lang::source::Span;

/// A control with programs in its memory: everything a run is.
#[derive(Debug)]
pub struct Control {
    pub(super) memory: Memory,
    pub(super) executor: Executor,
    pub(super) plan: BlockPlan,
    pub(super) block_words: BlockWords,
    pub(super) main: ProgramId,
    pub(super) outcome: Option<Outcome>,
    pub(super) loop_detector: LoopDetector,
    pub(super) progress: Option<Arc<Progress>>,
}

impl Control {
    /// A control switched on, about to run the first program of `memory`.
    pub fn new(memory: Memory, settings: Settings) -> Self {
        let executor = Executor::new(settings);
        let mut control = Self {
            memory,
            executor,
            plan: BlockPlan::default(),
            block_words: BlockWords::default(),
            main: ProgramId::default(),
            outcome: None,
            loop_detector: LoopDetector::default(),
            progress: None,
        };
        control.select(ProgramId::default());
        control
    }

    /// Makes another program of the memory the main program.
    pub fn select(&mut self, program: ProgramId) {
        self.main = program;
        self.outcome = None;
        self.executor.flow.callers.clear();
        self.executor.flow.frame = Frame::main(program);
        if let Some(program) = self.memory.programs().get(program.0 as usize) {
            self.executor.registers.state.codes.o = program.shown_number();
            self.executor.flow.block = program.span;
        }
    }

    /// Lets somebody see how far the run is, and end it.
    pub fn set_progress(&mut self, progress: Arc<Progress>) {
        self.progress = Some(progress);
    }

    /// Sets a variable before the run, as the operator would on the screen.
    pub fn set_variable(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        let written =
            self.executor.write(Slot::of(number), Value::Number(value), None, Span::default(), &mut ());
        written.map_err(|alarm| alarm.node)
    }
}
