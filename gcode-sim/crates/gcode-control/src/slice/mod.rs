//! Values that a run reads and nothing in its program sets, and the motion that each of them can touch.
//!
//! [`Slice`] observes a run. For every variable, axis and mode it carries the set of outside values on which it depends: by
//! the values that a block reads, and by the conditions, jumps and block skips that decide whether a block is executed
//! (`branches`). Where an exact set would need more than one run, the set is larger, never smaller.
mod branches;
mod marks;
mod moves;
mod possible;
mod possible_motion;
mod power_on;
mod reads;
mod words;

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

pub use self::marks::Marks;
pub use self::power_on::KEPT_GROUPS;

use self::branches::Branches;
use self::marks::{LOCALS, MachineMarks, VariableMarks};
use self::reads::OffsetEntry;
use super::control::{Control, Observer};
use super::data::{Register, SystemAxes, system_index};
use super::flow::ProgramFlow;
use super::registers::Registers;
use gcode_lang::control::{Dialect, Settings};
use gcode_lang::motion::Backtrace;
use gcode_lang::program::g_codes::name;
use gcode_lang::program::modes::{ModalGroup, WorkSystem};
use gcode_lang::program::{Assign, AssignmentTarget, Op, OpKind, Statement};

/// Value that comes from outside the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OutsideValue {
    /// Common or system variable.
    Variable(u32),
    /// Parameter of the control; `None` if only part of it is read.
    Parameter(Option<u32>),
    /// Block skip switch, counted from 1.
    BlockSkip(u8),
    /// Work offset that nothing has set; of one axis where others are set.
    WorkOffset(WorkSystem, Option<char>),
    /// External work offset, which shifts all others.
    ExternalOffset,
    /// Tool length, by its H.
    ToolLength(u32),
    /// Cutter radius, by its D.
    CutterRadius(u32),
    /// Setting 40 of a Haas, ODI: an offset that the program sets is a radius or a diameter.
    DiameterOffsets,
    /// EVO 5001#6: the length offset counts behind G53 from the next block, or from the next H.
    RestoredLength,
    /// Position at which the skip signal of G31 comes.
    SkipSignal,
    /// M code of the machine builder.
    Auxiliary(u32),
    /// Modal G code × 10 that holds because no block has commanded its group.
    PowerOnMode(u32),
}

impl OutsideValue {
    /// Returns the value's name as programs of a dialect write it: `#510`, `/2`, `G55`, `G55 B`, `H3`, `M21`.
    pub fn name(self, dialect: Dialect) -> String {
        match self {
            Self::Variable(number) => format!("#{number}"),
            Self::Parameter(Some(number)) => format!("PRM[{number}]"),
            Self::Parameter(None) => "PRM".to_owned(),
            Self::BlockSkip(1) => "/".to_owned(),
            Self::BlockSkip(switch) => format!("/{switch}"),
            Self::WorkOffset(system, None) => system.name(dialect),
            Self::WorkOffset(system, Some(letter)) => format!("{} {letter}", system.name(dialect)),
            Self::ExternalOffset => "EXT".to_owned(),
            Self::ToolLength(number) => format!("H{number}"),
            Self::CutterRadius(number) => format!("D{number}"),
            Self::DiameterOffsets => "ODI".to_owned(),
            Self::RestoredLength => "EVO".to_owned(),
            Self::SkipSignal => "G31".to_owned(),
            Self::Auxiliary(code) => format!("M{code:02}"),
            Self::PowerOnMode(code) => name(code),
        }
    }
}

/// Outside value that the run has read.
#[derive(Clone, Debug)]
pub struct OutsideRead {
    /// Value.
    pub source: OutsideValue,
    /// Number that the run has read; `None` for vacant, and for what is no number.
    pub value: Option<f64>,
    /// Block of the first read.
    pub place: Backtrace,
    /// Another value may make the run cut where it has not cut, or change a feed.
    pub decides_further_cuts: bool,
}

/// Values that the machine file states: they are given, not assumed.
#[derive(Clone, Debug, Default)]
pub struct StatedValues {
    /// H numbers of tools with a length.
    pub lengths: BTreeSet<u32>,
    /// D numbers of tools with a cutter radius.
    pub radii: BTreeSet<u32>,
    /// Work offsets of the machine, each with its axes as bits.
    pub work_systems: BTreeMap<WorkSystem, u8>,
    /// M codes with a known effect, such as those of the clamp.
    pub codes: BTreeSet<u32>,
    /// A part decides where G31 stops.
    pub has_part: bool,
    /// The unit at power-on.
    pub has_unit: bool,
}

/// Observer that follows outside values through a run.
#[derive(Debug, Default)]
pub struct Slice {
    stated: StatedValues,
    reads: Vec<OutsideRead>,
    index: BTreeMap<OutsideValue, usize>,
    variables: VariableMarks,
    machine: MachineMarks,
    branches: Branches,
    /// Marks of the arguments of the call in the current block.
    arguments: Option<[Marks; LOCALS]>,
    /// Marks of the arguments of modal calls, and of the words of the current block.
    modal_arguments: Marks,
    block_marks: Marks,
    /// The current block drills by a canned cycle.
    is_in_cycle: bool,
    /// The current block moves in rapid.
    is_rapid: bool,
    /// Tool offsets that the program has set, by [`Register`] and number.
    set_tools: [BTreeSet<u32>; 4],
    /// Axes of the work offsets that the machine file states or the program has set.
    set_offsets: SystemAxes,
    /// Modal codes of power-on that the run has read: each is one of its group.
    power_on_modes: Marks,
    /// Values that decide whether the run cuts elsewhere.
    further: Marks,
    motion: Rc<Cell<Marks>>,
    /// Values that decide the length offset behind a G53, from the next move on that commands no length.
    restored_length: Marks,
    /// Marks of a motion from or to the position behind the last block.
    machine_motion: Marks,
    /// Marks of moves that wait for the next one.
    waiting: Marks,
}

impl Slice {
    /// Returns the observer of a run. `variables` are set before its start; an offset that they set is not stated.
    pub fn new(mut stated: StatedValues, settings: &Settings, variables: &[(u32, f64)]) -> Self {
        let mut set_offsets = SystemAxes::default();
        stated.work_systems.iter().for_each(|(system, axes)| set_offsets.add(system_index(*system), *axes));
        for (number, _) in variables {
            match reads::offset_of(*number, settings) {
                Some(OffsetEntry::Tool(Register::HGeometry | Register::HWear, tool)) => {
                    stated.lengths.remove(&tool);
                }
                Some(OffsetEntry::Tool(Register::DGeometry | Register::DWear, tool)) => {
                    stated.radii.remove(&tool);
                }
                Some(OffsetEntry::Work(system, axes)) => set_offsets.remove(system, axes),
                None => {}
            }
        }
        let mut slice = Self { stated, set_offsets, ..Self::default() };
        if slice.stated.has_unit {
            slice.machine.settle_group(ModalGroup::Unit, Marks::NONE);
        }
        slice
    }

    /// Returns the marks of the current block's motion, shared with the sink of the run.
    pub fn motion(&self) -> Rc<Cell<Marks>> {
        Rc::clone(&self.motion)
    }

    /// Returns the values read, in the order of their indices in [`Marks`].
    pub fn into_reads(self) -> Vec<OutsideRead> {
        let further = self.further;
        let read = |(index, read)| OutsideRead { decides_further_cuts: further.contains(index), ..read };
        self.reads.into_iter().enumerate().map(read).collect()
    }

    /// Marks everything from now on, and cuts that the run does not reach.
    fn leave(&mut self, marks: Marks) {
        self.branches.stay(marks);
        self.further |= marks;
    }

    /// Returns the marks of an outside value, recorded at its first read.
    fn outside(&mut self, source: OutsideValue, value: Option<f64>, flow: &ProgramFlow, op: &Op) -> Marks {
        let next = self.reads.len();
        let index = *self.index.entry(source).or_insert(next);
        if index == next {
            let place = Backtrace { block: op.span, calls: flow.frame.calls.clone() };
            self.reads.push(OutsideRead { source, value, place, decides_further_cuts: false });
        }
        Marks::of(index)
    }

    fn follow(&mut self, block: &Block<'_>) {
        if let Some(switch) = block.op.skip() {
            let switch = switch.max(1);
            let is_on = block.registers.data.is_skip_on(switch);
            let value = Some(f64::from(u8::from(is_on)));
            let marks = self.outside(OutsideValue::BlockSkip(switch), value, block.flow, block.op);
            return self.follow_guarded(block, block.op.kind(), marks, !is_on);
        }
        self.follow_kind(block, block.op.kind());
    }

    fn follow_kind(&mut self, block: &Block<'_>, kind: &OpKind) {
        match kind {
            OpKind::Empty | OpKind::Alarm(_) => {}
            OpKind::AssignDirect(assign) => self.assign_free(block, assign),
            OpKind::Statement(statement) => self.follow_statement(block, statement),
            OpKind::Words(words) => self.follow_words(block, words),
            OpKind::If { condition, then } => {
                let marks = self.code_marks(block, condition);
                self.follow_guarded(block, then, marks, block.is_true(condition));
            }
        }
    }

    /// Follows an operation that is executed only if something outside, marked `marks`, allows it.
    fn follow_guarded(&mut self, block: &Block<'_>, kind: &OpKind, marks: Marks, is_executed: bool) {
        if branches::leaves_block(kind) {
            self.leave(marks);
        } else if !marks.is_none() {
            // A called program belongs to the block.
            self.branches.request_jump(marks, Some(block.flow.frame.next + 1));
        }
        if is_executed {
            let before = self.branches.set_guard(marks);
            self.follow_kind(block, kind);
            self.branches.set_guard(before);
        }
    }

    fn follow_statement(&mut self, block: &Block<'_>, statement: &Statement) {
        match statement {
            Statement::AssignDirect(assign) => self.assign_free(block, assign),
            Statement::Assign { target, value, .. } => {
                let marks = self.operand_marks(block, value) | self.branches.marks();
                self.assign(block, target, marks);
            }
            Statement::Assignments(all) => all.iter().for_each(|one| self.follow_statement(block, one)),
            Statement::Goto(to) => {
                let marks = self.operand_marks(block, &to.node);
                self.leave(marks);
            }
            Statement::IfGoto { condition, to } => {
                let marks = self.code_marks(block, condition);
                let target = self.operand_marks(block, &to.node);
                self.leave(target);
                if !marks.is_none() {
                    self.branches.request_jump(marks, block.jump_target(&to.node));
                }
            }
            Statement::IfThen { condition, then } => {
                let marks = self.code_marks(block, condition);
                if !marks.is_none() {
                    if branches::jumps(then) {
                        self.leave(marks);
                    }
                    self.add_possible_assignment(block.registers, then, marks);
                }
                if block.is_true(condition) {
                    let before = self.branches.set_guard(marks);
                    self.follow_statement(block, then);
                    self.branches.set_guard(before);
                }
            }
            Statement::While { condition, end, .. } => {
                let marks = self.code_marks(block, condition);
                if !marks.is_none() {
                    self.branches.request_loop(marks, *end);
                }
            }
            Statement::Do { .. }
            | Statement::End { .. }
            | Statement::SetNames { .. }
            | Statement::Print { .. }
            | Statement::OpenOutput
            | Statement::CloseOutput
            | Statement::Alarm(_) => {}
        }
    }

    fn assign_free(&mut self, block: &Block<'_>, assign: &Assign) {
        let marks = self.code_marks(block, &assign.code) | self.branches.marks();
        self.variables.set(usize::from(assign.variable), marks);
    }

    fn assign(&mut self, block: &Block<'_>, target: &AssignmentTarget, marks: Marks) {
        if let AssignmentTarget::Computed(number) = target {
            let number = self.operand_marks(block, number);
            self.variables.add_to_any(number);
        }
        let Ok(slot) = block.registers.resolve_target(target) else { return };
        self.write(block.registers, slot.number(), marks);
    }
}

/// Block about to be executed.
struct Block<'c> {
    registers: &'c Registers,
    flow: &'c ProgramFlow,
    program: &'c gcode_lang::program::Program,
    op: &'c Op,
}

impl Observer for Slice {
    fn before_block(&mut self, control: &mut Control) {
        if control.next_block().is_none() {
            return;
        }
        self.branches.enter(&control.executor.flow);
        self.block_marks = Marks::NONE;
        (self.is_in_cycle, self.is_rapid) = (false, false);
        let before = self.machine_motion;
        {
            let Control { memory, executor, .. } = &*control;
            let frame = &executor.flow.frame;
            let program = memory.get(frame.program);
            let Some(op) = program.op(frame.next) else { return };
            let (registers, flow) = (&executor.registers, &executor.flow);
            self.follow(&Block { registers, flow, program, op });
        }
        self.open_branch(control);
        // A cycle drills where its block leads, wherever it comes from.
        let before = if self.is_in_cycle { Marks::NONE } else { before };
        self.machine_motion = self.machine.motion();
        let feed = if self.is_rapid { Marks::NONE } else { self.machine.code(b'F') };
        let marks = before | self.machine_motion | feed | self.block_marks | self.branches.marks();
        self.waiting =
            if control.executor.registers.lookahead.is_idle() { marks } else { marks | self.waiting };
        self.motion.set(self.waiting);
    }

    fn after_block(&mut self, control: &Control) {
        let level = control.vars().level();
        while level < self.variables.level() {
            self.variables.pop_level();
        }
        while self.variables.level() < level {
            let all = self.block_marks | self.modal_arguments | self.branches.marks();
            self.variables.push_level(self.arguments.take().unwrap_or([all; LOCALS]));
        }
        self.arguments = None;
    }
}
