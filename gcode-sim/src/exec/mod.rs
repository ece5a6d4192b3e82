//! Operations to events: a control that can be stepped block by block, held and looked at.
mod ahead;
mod arcs;
mod arguments;
mod block;
mod calls;
mod code_calls;
mod commit;
mod cycles;
mod endless;
mod eval;
mod frames;
mod functions;
mod modal;
mod modal_calls;
mod notes;
mod offsets;
mod one_shot;
mod parameters;
mod patterns;
mod pecks;
mod plan;
mod pockets;
mod print;
mod probing;
mod state;
mod statements;
mod stroke;
mod system_vars;
mod thread;
mod transform;
mod transform_codes;
mod travel;
mod vars;
mod view;
mod words;

use std::cell::Cell;
use std::collections::BTreeMap;

pub use modal::Modal;
pub use notes::Note;
pub use print::printable;
pub use state::{Codes, State};
pub use vars::{Value, Vars};

use self::ahead::Ahead;
use self::endless::{Endless, Watch};
use self::frames::{Frame, FrameKind};
use self::modal_calls::ModalCall;
use self::offsets::Offsets;
use self::plan::{Flow, Plan};
use self::words::Given;
use crate::alarm::Alarm;
use crate::control::{ParameterPlace, Settings};
use crate::motion::{Place, Sink, StopKind};
use crate::program::{Form, Library, Memory, OpKind, ProgramId};
use crate::source::{Span, Spanned};

/// How long a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Blocks executed, macro statements included.
    pub blocks: u64,
}

/// A run ends after so many moves, and so many for every block that it may execute: a cycle with K or with small
/// pecks is one block, and a loop round it must end as well.
const MOVES: u64 = 1_000_000;
const MOVES_PER_BLOCK: u64 = 20;

impl Default for Limits {
    fn default() -> Self {
        Self { blocks: 10_000_000 }
    }
}

/// How a run ended.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// M02, M30, the M99 that ends the run, or the program's end.
    End,
    Alarm(Stopped),
    /// The limit of blocks, or a loop that provably never ends ([`Control::endless_loop`]).
    Limit,
}

/// Where and why the control stopped.
#[derive(Clone, Debug)]
pub struct Stopped {
    pub alarm: Alarm,
    /// The part of the block it is about.
    pub span: Span,
    /// The block, and the calls that led to it.
    pub place: Place,
}

/// An operator stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    pub kind: StopKind,
    pub text: String,
    /// The variables that the text names, with their values.
    pub named: Vec<(u32, f64)>,
}

/// As many operator stops are kept; a program that loops over M00 must not fill the memory.
const STOPS: usize = 10_000;

/// A control with programs in its memory: everything a run is.
#[derive(Debug)]
pub struct Control {
    memory: Memory,
    core: Core,
    plan: Plan,
    given: Given,
    main: ProgramId,
    outcome: Option<Outcome>,
    watch: Watch,
    endless: Option<Endless>,
}

/// Everything but the programs.
#[derive(Clone, Debug)]
pub(crate) struct Core {
    settings: Settings,
    state: State,
    vars: Vars,
    offsets: Offsets,
    /// What has been read and waits for the next move.
    ahead: Ahead,
    frames: Vec<Frame>,
    modal_calls: Vec<ModalCall>,
    /// Names given by SETVN.
    names: BTreeMap<String, u32>,
    outputs: u32,
    /// What #3001 and #3002 have been set off by: milliseconds, hours.
    clocks: (f64, f64),
    /// #3003 and #3004.
    switches: [f64; 2],
    /// #3901 and #3902.
    parts: [f64; 2],
    /// M99 of the main program, counted.
    cycles: u32,
    seconds: f64,
    /// Seconds that the clocks have gone on while the program waited for them.
    idle: f64,
    /// A clock was read since the last jump back.
    clock_read: Cell<bool>,
    /// What a function of the block at hand has to tell.
    told: Cell<Option<Note>>,
    blocks: u64,
    moves: u64,
    stops: Vec<Stop>,
    printed: print::Printed,
    /// M codes that went to the machine builder's logic, with the block of the first of each.
    passed_on: BTreeMap<u32, Span>,
    notes: BTreeMap<Note, Span>,
    /// Parameters that the program has written and that have no effect.
    parameters: BTreeMap<ParameterPlace, f64>,
    block: Span,
}

impl Control {
    /// A control switched on, about to run the first program of `memory`.
    pub fn new(memory: Memory, settings: Settings) -> Self {
        let offsets = Offsets::new(settings.tool_offsets, settings.work_systems);
        let vars = Vars::new(settings.more_commons, settings.aliased_commons);
        let core = Core {
            settings,
            state: State::default(),
            vars,
            offsets,
            ahead: Ahead::default(),
            frames: Vec::new(),
            modal_calls: Vec::new(),
            names: BTreeMap::new(),
            outputs: 0,
            clocks: (0.0, 0.0),
            switches: [0.0; 2],
            parts: [0.0; 2],
            cycles: 0,
            seconds: 0.0,
            idle: 0.0,
            clock_read: Cell::new(false),
            told: Cell::new(None),
            blocks: 0,
            moves: 0,
            stops: Vec::new(),
            printed: print::Printed::default(),
            passed_on: BTreeMap::new(),
            notes: BTreeMap::new(),
            parameters: BTreeMap::new(),
            block: Span::default(),
        };
        let mut control = Self {
            memory,
            core,
            plan: Plan::default(),
            given: Given::default(),
            main: ProgramId::default(),
            outcome: None,
            watch: Watch::default(),
            endless: None,
        };
        control.select(ProgramId::default());
        control
    }

    /// Makes another program of the memory the main program.
    pub fn select(&mut self, program: ProgramId) {
        self.main = program;
        self.outcome = None;
        self.core.frames.clear();
        self.core.frames.push(Frame::main(program));
        if let Some(program) = self.memory.programs().get(program.0 as usize) {
            self.core.state.codes.o = program.shown_number();
            self.core.block = program.span;
        }
    }

    /// Sets a variable before the run, as the operator would on the screen.
    pub fn set(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        let written = self.core.write(number, Value::Number(value), None, Span::default(), &mut ());
        written.map_err(|alarm| alarm.node)
    }

    /// Runs to the end, to an alarm, or to a limit.
    pub fn run<S: Sink>(&mut self, limits: Limits, library: &mut impl Library, sink: &mut S) -> Outcome {
        let moves = limits.blocks.saturating_mul(MOVES_PER_BLOCK).max(MOVES);
        while self.core.blocks < limits.blocks && self.core.moves <= moves {
            if let Some(outcome) = self.step(library, sink) {
                return outcome;
            }
        }
        self.outcome = Some(Outcome::Limit);
        Outcome::Limit
    }

    /// Does one block; `Some` when the run is over. A block that alarms has changed nothing.
    pub fn step<S: Sink>(&mut self, library: &mut impl Library, sink: &mut S) -> Option<Outcome> {
        if let Some(outcome @ (Outcome::End | Outcome::Alarm(_))) = &self.outcome {
            return Some(outcome.clone());
        }
        let mut done = self.block(library, sink);
        if matches!(done, Ok(Some(Outcome::End)))
            && let Err(alarm) = self.core.end_ahead(sink)
        {
            done = Err(alarm);
        }
        if let Some(note) = self.core.told.take() {
            self.core.notes.entry(note).or_insert(self.core.block);
        }
        let outcome = match done {
            Ok(outcome) => outcome?,
            Err(alarm) => {
                self.core.complete(&alarm, sink);
                let calls = self.core.frames.last().map(|f| f.calls.clone()).unwrap_or_default();
                let place = Place { block: self.core.block, calls };
                Outcome::Alarm(Stopped { alarm: alarm.node, span: alarm.span, place })
            }
        };
        self.outcome = Some(outcome.clone());
        Some(outcome)
    }

    fn block<S: Sink>(
        &mut self,
        library: &mut impl Library,
        sink: &mut S,
    ) -> Result<Option<Outcome>, Spanned<Alarm>> {
        let Self { memory, core, plan, given, watch, endless, .. } = self;
        if memory.programs().is_empty() {
            return Err(Alarm::EndOfRecord.at(Span::default()));
        }
        let frame = core.frame();
        let (id, place, main) = (frame.program, frame.next, frame.kind == FrameKind::Main);
        let program = memory.get(id);
        let Some(op) = program.ops.get(place) else {
            core.block = Span { start: program.span.end, ..program.span };
            // A text may just stop; running into `%` or another program is running off the tape.
            if main && !program.closed {
                return Ok(Some(Outcome::End));
            }
            return Err(Alarm::EndOfRecord.at(core.block));
        };
        core.block = op.span;
        core.blocks += 1;
        core.frame_mut().next = place + 1;
        if op.skip.is_some_and(|switch| core.skips(switch)) {
            return Ok(None);
        }
        for form in &op.forms {
            if !form.node.is_taken(&core.settings) {
                return Err(form.node.alarm().at(form.span));
            }
            if form.node == Form::LowerCase {
                core.notes.entry(Note::LowerCase).or_insert(op.span);
            }
        }
        let mut kind = &op.kind;
        if let OpKind::If { condition, then } = kind
            && core.holds(program, *condition)?
        {
            kind = then;
        }
        match kind {
            OpKind::Empty if core.state.parameter_input && op.number.is_some() => {
                return Err(Alarm::ParameterFormat { what: "R is missing".into() }.at(op.span));
            }
            OpKind::Empty if op.number.is_some() => core.pass_number(op.span, sink)?,
            OpKind::Empty | OpKind::If { .. } => {}
            OpKind::Alarm(alarm) => return Err((**alarm).clone()),
            OpKind::Statement(statement) => {
                let outcome = core.statement(program, statement, op.span, sink)?;
                if core.frame().next <= place {
                    *endless = watch.jumped(core);
                    return Ok(endless.map(|_| Outcome::Limit));
                }
                return Ok(outcome);
            }
            OpKind::Words(words) if core.state.parameter_input => {
                let span = op.span;
                core.prepare_parameter(program, (words, op.number), given, plan, span)?;
                return self.finish(span, library, sink);
            }
            OpKind::Words(words) => {
                if core.call_by_block(program, words, op.number, op.span)? {
                    core.state.codes.o = memory.get(core.frame().program).shown_number();
                    return Ok(None);
                }
                core.prepare(program, words, given, plan, op.span)?;
                let span = op.span;
                if let Some(number) = op.number {
                    plan.state.codes.n = number;
                }
                return self.finish(span, library, sink);
            }
        }
        if let Some(number) = op.number {
            core.state.codes.n = number;
        }
        Ok(None)
    }

    /// Carries out the plan of a block of words. What can still alarm comes first.
    fn finish<S: Sink>(
        &mut self,
        span: Span,
        library: &mut impl Library,
        sink: &mut S,
    ) -> Result<Option<Outcome>, Spanned<Alarm>> {
        let mut flow = std::mem::take(&mut self.plan.flow);
        if let Flow::Call(call) = &mut flow {
            let at = call.span;
            self.resolve(call, library).map_err(|alarm| alarm.at(at))?;
        }
        let broken_off = self.core.ask_for_signal(&mut self.plan, sink);
        self.core.commit(&mut self.plan, sink);
        if let Some(alarm) = broken_off {
            return Err(alarm);
        }
        match flow {
            Flow::Next if self.plan.moved && !self.core.modal_calls.is_empty() => {
                self.core.call_after_move(span).map_err(|alarm| alarm.at(span))?;
            }
            Flow::Next => {}
            Flow::Call(call) => {
                self.core.enter(&call, span);
                let program = self.core.frame().program;
                self.core.state.codes.o = self.memory.get(program).shown_number();
            }
            Flow::Return(to) => {
                let outcome = self.go_back(to, span)?;
                let program = self.core.frame().program;
                self.core.state.codes.o = self.memory.get(program).shown_number();
                if outcome.is_none() {
                    self.endless = self.watch.jumped(&mut self.core);
                    return Ok(self.endless.map(|_| Outcome::Limit));
                }
                return Ok(outcome);
            }
            Flow::CancelModal => self.core.cancel_modal(),
            Flow::End => {
                self.core.parts[0] += 1.0;
                return Ok(Some(Outcome::End));
            }
        }
        Ok(None)
    }
}
