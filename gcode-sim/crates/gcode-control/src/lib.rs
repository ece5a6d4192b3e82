//! Operations to events: a control that can be stepped block by block, held and looked at.
mod accessors;
mod arcs;
mod arguments;
mod block;
mod block_commands;
mod block_effects;
mod calls;
mod code_calls;
mod code_words;
mod contour;
mod cycle_expansion;
mod cycles;
mod data_input;
mod evaluation;
mod frames;
mod functions;
mod linear_motion;
mod lookahead;
mod loop_detection;
mod m_codes;
mod modal_calls;
mod modal_codes;
mod modal_state;
mod moves;
mod notes;
mod observer;
mod offsets;
mod one_shot_codes;
mod outcome;
mod parameters;
mod patterns;
mod pecks;
mod plain_move;
mod plan;
mod plan_commit;
mod pockets;
mod print;
mod probing;
mod quantities;
mod reference;
mod residual_state;
mod run;
mod state;
mod statements;
pub mod static_eval;
mod stroke_limits;
mod system_variables;
mod threading;
mod transform;
mod transform_codes;
mod transform_order;
mod unsimulated;
mod variables;
mod words;
mod work_offset_use;

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

pub use block_commands::{BlockCommands, modal_code};
pub use modal_state::Modal;
pub use notes::Note;
pub use observer::Observer;
pub use outcome::{AlarmStop, Limits, OperatorStop, Outcome, Progress};
pub use print::printable;
pub use residual_state::{ResidualKind, ResidualValue, mode_name};
pub use state::{Codes, State};
pub use unsimulated::UnsimulatedCodes;
pub use variables::{Value, Vars};

use self::block_effects::BlockEffects;
use self::evaluation::OperandStack;
use self::frames::Frame;
use self::linear_motion::CoordinateBasis;
use self::lookahead::Lookahead;
use self::loop_detection::LoopDetector;
use self::modal_calls::ModalCall;
use self::offsets::Offsets;
use self::plan::BlockPlan;
use self::words::BlockWords;
use self::work_offset_use::WorkOffsetUse;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{ParameterId, Settings};
use gcode_lang::program::{Memory, ProgramId, Slot};
use gcode_lang::source::Span;

/// As many operator stops are kept; a program that loops over M00 must not fill the memory.
const MAX_STOPS: usize = 10_000;

/// A control with programs in its memory: everything a run is.
#[derive(Debug)]
pub struct Control {
    memory: Memory,
    executor: Executor,
    plan: BlockPlan,
    block_words: BlockWords,
    main: ProgramId,
    outcome: Option<Outcome>,
    loop_detector: LoopDetector,
    progress: Option<Arc<Progress>>,
}

/// Everything but the programs.
#[derive(Clone, Debug)]
pub struct Executor {
    settings: Settings,
    state: Box<State>,
    /// While a block can be a plain move: what its axis words count from.
    plain_basis: Option<CoordinateBasis>,
    vars: Vars,
    offsets: Offsets,
    /// What has been read and waits for the next move.
    lookahead: Lookahead,
    /// The program at hand.
    frame: Frame,
    /// The programs that wait for it, the main program first.
    callers: Vec<Frame>,
    modal_calls: Vec<ModalCall>,
    /// Names given by SETVN.
    names: BTreeMap<String, u32>,
    outputs: u32,
    /// What #3001 and #3002 have been set off by: milliseconds, hours.
    clocks: (f64, f64),
    /// #3003 and #3004.
    control_switches: [f64; 2],
    /// #3901 and #3902.
    part_counters: [f64; 2],
    /// M99 of the main program, counted.
    cycles: u32,
    seconds: f64,
    /// Seconds that the clocks have gone on while the program waited for them.
    idle_seconds: f64,
    /// A clock was read since the last jump back.
    has_read_clock: Cell<bool>,
    /// For values that wait for their operators.
    operand_stack: OperandStack,
    block_effects: BlockEffects,
    blocks: u64,
    moves: u64,
    /// Beyond so many the run ends.
    max_moves: u64,
    stops: Vec<OperatorStop>,
    printed: print::PrintedLines,
    /// M codes that went to the machine builder's logic, with the block of the first of each.
    auxiliary_codes: BTreeMap<u32, Span>,
    notes: BTreeMap<Note, Span>,
    work_offset_use: WorkOffsetUse,
    /// Parameters that the program has written and that have no effect.
    parameters: BTreeMap<ParameterId, f64>,
    block: Span,
}

impl Control {
    /// A control switched on, about to run the first program of `memory`.
    pub fn new(memory: Memory, settings: Settings) -> Self {
        let offsets = Offsets::new(settings.tool_offsets, settings.work_systems);
        let vars = Vars::new(settings.extra_commons, settings.aliases_commons);
        let core = Executor {
            settings,
            state: Box::default(),
            plain_basis: None,
            vars,
            offsets,
            lookahead: Lookahead::default(),
            frame: Frame::main(ProgramId::default()),
            callers: Vec::new(),
            modal_calls: Vec::new(),
            names: BTreeMap::new(),
            outputs: 0,
            clocks: (0.0, 0.0),
            control_switches: [0.0; 2],
            part_counters: [0.0; 2],
            cycles: 0,
            seconds: 0.0,
            idle_seconds: 0.0,
            has_read_clock: Cell::new(false),
            operand_stack: OperandStack::default(),
            block_effects: BlockEffects::default(),
            blocks: 0,
            moves: 0,
            max_moves: u64::MAX,
            stops: Vec::new(),
            printed: print::PrintedLines::default(),
            auxiliary_codes: BTreeMap::new(),
            notes: BTreeMap::new(),
            work_offset_use: WorkOffsetUse::default(),
            parameters: BTreeMap::new(),
            block: Span::default(),
        };
        let mut control = Self {
            memory,
            executor: core,
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
        self.executor.callers.clear();
        self.executor.frame = Frame::main(program);
        if let Some(program) = self.memory.programs().get(program.0 as usize) {
            self.executor.state.codes.o = program.shown_number();
            self.executor.block = program.span;
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
