//! Observer of a run that records its steps, their modal conditions, and the block that wrote each value of the
//! final state.
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ops::RangeInclusive;

use super::block_list::BlockNumbers;
use super::first_command::{CommandKind, FirstCommand};
use super::modal_conditions::{ModalAspect, ModalConditions};
use super::step_list::{NewStep, StepList};
use super::steps::{StepKind, UnsimulatedKind};
use gcode_control::{
    BlockCommands, Control, Modal, Observer, ResidualKind, ResidualValue, UnsimulatedCodes, Value,
    modal_code, mode_name,
};
use gcode_lang::motion::{Backtrace, Event, EventKind, EventSink, Position, SpindleDirection, UnknownAxes};
use gcode_lang::program::modes::GROUPS;
use gcode_lang::source::Span;

/// Largest number of recorded steps: a loop that never ends must not fill the memory.
pub(super) const MOST_STEPS: usize = 5_000_000;

/// Group of G00 to G03, which blocks repeat most.
const MOVES: u32 = 1;

/// Variables that outlive a program.
const COMMON: RangeInclusive<u32> = 100..=999;

/// Largest number of blocks that cutter compensation reads ahead.
const LOOKAHEAD: usize = 16;

/// #3003 single block and wait for M codes; #3004 feed hold, override and exact stop.
const SWITCHES: RangeInclusive<u32> = 3003..=3004;

/// Output signals, one by one, and sixteen and thirty-two at a time.
const OUTPUTS: RangeInclusive<u32> = 1100..=1135;

/// Recorder of a run.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    pub steps: StepList,
    /// Steps whose conditions are not known yet, with their blocks.
    pending: Vec<(NewStep, Span)>,
    pub numbers: BlockNumbers,
    /// The run has more than [`MOST_STEPS`].
    pub is_truncated: bool,
    pub conditions: Vec<ModalConditions>,
    /// Last block that wrote each mode, common variable, offset, parameter, output and counter, by name.
    pub written: BTreeMap<String, Backtrace>,
    /// First command of each mode, axis and offset.
    pub first_commands: BTreeMap<(CommandKind, String), FirstCommand>,
    /// Groups of modes and letters of axes that have a first command.
    commanded_modes: BTreeSet<u32>,
    commanded_axes: BTreeSet<char>,
    moves: usize,
    block: Option<PendingBlock>,
    at: Position,
    length: Position,
    /// Axes whose position on the part is unknown after the next step.
    unknown: UnknownAxes,
    pub start: RunStart,
    /// Last executed block, and the way in which the run ends there.
    pub last: Option<Backtrace>,
    pub end: &'static str,
    /// Last T and S.
    called: (u32, f64),
    /// Last block with each of F, S and T, and its number.
    set_by: BTreeMap<char, (Span, usize)>,
    /// Inputs of the last conditions: modal codes, H, D, Q.
    seen: Option<(Modal, u32, u32, Option<f64>)>,
    /// Aspects that the block before its execution commands, and the groups of its modal codes without moves.
    commanded: ([bool; 6], Vec<u32>),
    /// Last blocks with what they leave: a move may wait until the blocks after it are read.
    recent: VecDeque<(Span, BlockContext)>,
}

/// Axes before the first step of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RunStart {
    /// Machine position; 0 for the unknown ones.
    pub at: Position,
    /// Axes whose position on the part is unknown.
    pub unknown: UnknownAxes,
}

/// What a block leaves: the number of its modal conditions, and the work zero.
#[derive(Clone, Copy, Debug)]
struct BlockContext {
    condition: usize,
    zero: Position,
}

/// A block before its execution.
#[derive(Debug)]
struct PendingBlock {
    backtrace: Backtrace,
    /// Axis positions and tool length offset before it.
    before: (Position, Position),
    unsimulated: UnsimulatedCodes,
    /// Common variables, switches and outputs that it assigns.
    assigned: Vec<u32>,
    /// Final state before it, if it may write to tables.
    tables: Vec<ResidualValue>,
}

impl Recorder {
    fn step_count(&self) -> usize {
        self.steps.len() + self.pending.len()
    }

    /// Records the commands of the next block.
    fn before_block(&mut self, control: &mut Control) {
        let next = control.next_block();
        if next.is_none() {
            self.end = " where its text does, without M30";
        }
        self.block = next.map(|block| {
            let is_whole = control.is_next_unconditional();
            self.numbers.reach(control.memory(), block, self.step_count(), is_whole);
            let unsimulated = control.next_unsimulated();
            let tables = if unsimulated.writes { control.residual_values() } else { Vec::new() };
            let mut assigned = control.next_assigned_variables();
            assigned.retain(|number| [COMMON, SWITCHES, OUTPUTS].iter().any(|some| some.contains(number)));
            let backtrace = Backtrace { block, ..control.backtrace() };
            self.begin(control.next_commands(), &backtrace);
            PendingBlock { backtrace, before: (self.at, self.length), unsimulated, assigned, tables }
        });
    }

    /// Records first commands, and the block of F, S and T.
    fn begin(&mut self, commands: BlockCommands, backtrace: &Backtrace) {
        let groups = commands.modes.iter().map(|(group, _)| *group).filter(|group| *group != MOVES);
        self.commanded = (ModalAspect::commanded_by(&commands), groups.collect());
        let BlockCommands { modes, axes, offsets, valued_letters, is_circle_pocket: _ } = commands;
        for letter in valued_letters {
            let number = self.numbers.number(backtrace);
            self.set_by.insert(letter, (backtrace.block, number));
        }
        for (group, code) in modes {
            if self.commanded_modes.insert(group) {
                self.add_first(CommandKind::Mode, format!("{group:02}"), modal_code(code), backtrace);
            }
        }
        for letter in axes {
            if self.commanded_axes.insert(letter) {
                self.add_first(CommandKind::Axis, letter.to_string(), letter.to_string(), backtrace);
            }
        }
        for name in offsets {
            if !self.first_commands.contains_key(&(CommandKind::Offset, name.clone())) {
                self.add_first(CommandKind::Offset, name.clone(), name, backtrace);
            }
        }
    }

    /// Records the first command of a mode, an axis or an offset.
    fn add_first(&mut self, what: CommandKind, name: String, text: String, backtrace: &Backtrace) {
        let block_number = self.numbers.number(backtrace);
        let first = FirstCommand { what, name: name.clone(), text, moves: self.moves, block_number };
        self.first_commands.insert((what, name), first);
    }

    /// Records the unsimulated commands of an executed block, and the values that it wrote.
    fn note(&mut self, control: &Control) {
        let Some(block) = self.block.take() else { return };
        let PendingBlock { backtrace, before, unsimulated, assigned, tables } = block;
        self.note_called(control, &backtrace, before);
        self.last = Some(backtrace.clone());
        self.end = match unsimulated.end_code {
            None => " by M99",
            Some(2) => " by M02",
            Some(_) => "",
        };
        for (what, texts) in [
            (UnsimulatedKind::Skip, unsimulated.block_skips),
            (UnsimulatedKind::Path, unsimulated.path_codes),
            (UnsimulatedKind::GCode, unsimulated.g_codes),
            (UnsimulatedKind::MCode, unsimulated.m_codes),
        ] {
            for text in texts {
                self.push(StepKind::Silent(what, text), &backtrace);
            }
        }
        for number in assigned {
            if COMMON.contains(&number) {
                self.written.insert(format!("#{number}"), backtrace.clone());
            } else {
                let is_output = OUTPUTS.contains(&number);
                let what = if is_output { UnsimulatedKind::Signal } else { UnsimulatedKind::Switch };
                let value = control.variable(number).map_or(0.0, Value::number);
                self.push(StepKind::Silent(what, format!("#{number}={value}")), &backtrace);
            }
        }
        if !unsimulated.writes {
            return;
        }
        let value = |all: &[ResidualValue], name: &str| all.iter().find(|r| r.name == name).map(|r| r.value);
        let now = control.residual_values();
        let names = tables.iter().chain(&now).filter(|r| r.kind != ResidualKind::Variable);
        for name in names.map(|r| &r.name) {
            if value(&tables, name) != value(&now, name) {
                self.written.insert(name.clone(), backtrace.clone());
            }
        }
    }

    /// Inserts T and S words that no M06, M03 or M04 has used yet before the other steps of their block.
    fn note_called(&mut self, control: &Control, backtrace: &Backtrace, (at, length): (Position, Position)) {
        let state = control.state();
        let (tool, speed) = (state.modal_words.t, state.modal_words.s);
        let before = std::mem::replace(&mut self.called, (tool, speed));
        let is_called = before.0 != tool && tool != state.tool;
        let is_speed = before.1 != speed && state.spindle == SpindleDirection::Off;
        let called = is_called.then(|| (UnsimulatedKind::Tool, format!("T{tool}")));
        let set = is_speed.then(|| (UnsimulatedKind::Speed, format!("S{speed}")));
        for (what, text) in called.into_iter().chain(set) {
            let (kind, block_number) = (StepKind::Silent(what, text), self.numbers.number(backtrace));
            let (zero, unknown) = (Position::default(), self.unknown);
            let step = NewStep { kind, at, length, zero, unknown, block_number, set_by: None, condition: 0 };
            self.pending.insert(0, (step, backtrace.block));
        }
    }

    /// Ends the record: removes T words that a later M06 used, and S words that a later M03 or M04 used.
    pub(super) fn finish(&mut self) {
        let condition = self.conditions.len().saturating_sub(1);
        let zero = self.recent.back().map_or_else(Position::default, |(_, last)| last.zero);
        self.settle(|_| BlockContext { condition, zero });
        let is_word = |kind: &StepKind| {
            matches!(kind, StepKind::Silent(UnsimulatedKind::Tool | UnsimulatedKind::Speed, _))
        };
        if self.steps.all_kinds().any(is_word) {
            let removed = self.used_words();
            self.numbers.remove_steps(&removed);
            self.steps = self.steps.filtered(|number, _| removed.binary_search(&number).is_err());
        }
        self.steps.shrink();
    }

    /// Returns the numbers of the T and S words that later commands used.
    fn used_words(&self) -> Vec<usize> {
        let (mut tool, mut speed) = (String::new(), String::new());
        let is_used = |kind: &StepKind| {
            let (known, text) = match kind {
                StepKind::Tool(number) => {
                    tool = format!("T{number}");
                    return false;
                }
                StepKind::Spindle(direction, rate) if *direction != SpindleDirection::Off => {
                    speed = format!("S{rate}");
                    return false;
                }
                StepKind::Silent(UnsimulatedKind::Tool, text) => (&mut tool, text),
                StepKind::Silent(UnsimulatedKind::Speed, text) => (&mut speed, text),
                _ => return false,
            };
            std::mem::take(known) == *text
        };
        let used: Vec<bool> = self.steps.kinds().rev().map(is_used).collect();
        (0..used.len()).filter(|number| used[used.len() - 1 - number]).collect()
    }

    /// Gives the steps of an executed block the conditions that it leaves.
    fn resolve_conditions(&mut self, control: &Control) {
        let state = control.state();
        let now = (state.modal, state.modal_words.h, state.modal_words.d, state.cycle.q);
        let (commanded, codes) = std::mem::take(&mut self.commanded);
        if self.seen != Some(now) || commanded.contains(&true) || !codes.is_empty() {
            let backtrace = control.backtrace();
            let block_number = self.numbers.number(&backtrace);
            let before = self.seen.map_or_else(Modal::default, |(modal, ..)| modal);
            let groups = GROUPS.iter().map(|group| group.number());
            let is_set =
                |group: &u32| before.code(*group) != state.modal.code(*group) || codes.contains(group);
            for group in groups.filter(is_set) {
                self.written.insert(mode_name(group), backtrace.clone());
            }
            let before = self.conditions.last().cloned().unwrap_or_else(ModalConditions::at_power_on);
            let next = before.after_block(state, control.settings().dialect, commanded, block_number);
            if self.conditions.last() != Some(&next) {
                self.conditions.push(next);
            }
            self.seen = Some(now);
        }
        let now = BlockContext { condition: self.conditions.len() - 1, zero: control.work_zeros() };
        if self.recent.len() == LOOKAHEAD {
            self.recent.pop_front();
        }
        if let Some(backtrace) = &self.last {
            self.recent.push_back((backtrace.block, now));
        }
        let recent = std::mem::take(&mut self.recent);
        self.settle(|block| {
            let known = recent.iter().rev().find(|(known, _)| *known == block);
            known.map_or(now, |(_, context)| *context)
        });
        self.recent = recent;
    }

    /// Moves the pending steps to the others, with what their blocks leave.
    fn settle(&mut self, context: impl Fn(Span) -> BlockContext) {
        for (step, block) in self.pending.drain(..) {
            let BlockContext { condition, zero } = context(block);
            self.steps.push(NewStep { condition, zero, ..step });
        }
    }

    fn push(&mut self, kind: StepKind, backtrace: &Backtrace) {
        self.is_truncated |= self.step_count() >= MOST_STEPS;
        if !self.is_truncated {
            let set_by = self.set_by(&kind, backtrace);
            let block_number = self.numbers.number(backtrace);
            let (at, length, zero) = (self.at, self.length, Position::default());
            let unknown = self.unknown;
            let step = NewStep { kind, at, length, zero, unknown, block_number, set_by, condition: 0 };
            self.pending.push((step, backtrace.block));
        }
    }

    /// Returns the block of the word that a step uses, if that is another; `None` for a move that waited for later
    /// blocks.
    fn set_by(&self, kind: &StepKind, backtrace: &Backtrace) -> Option<usize> {
        let letter = kind.letter()?;
        let has_waited = self.block.as_ref().is_some_and(|block| block.backtrace.block != backtrace.block);
        let set_by = self.set_by.get(&letter).filter(|(block, _)| *block != backtrace.block && !has_waited);
        set_by.map(|(_, number)| *number)
    }

    fn go(&mut self, kind: StepKind, to: Position, event: &Event<'_>) {
        let from = std::mem::replace(&mut self.at, to);
        self.moves += usize::from(from != to || matches!(kind, StepKind::Arc(..)));
        // A move to the current position has no effect, except a full circle.
        if from != to || matches!(kind, StepKind::Arc(..)) {
            self.push(kind, &event.backtrace());
        }
    }
}

/// A recorder that observes the blocks and receives the events of one run.
#[derive(Clone, Copy, Debug)]
pub(super) struct SharedRecorder<'a>(pub &'a RefCell<Recorder>);

impl Observer for SharedRecorder<'_> {
    fn before_block(&mut self, control: &mut Control) {
        self.0.borrow_mut().before_block(control);
    }

    fn after_block(&mut self, control: &Control) {
        let mut recorder = self.0.borrow_mut();
        recorder.note(control);
        recorder.resolve_conditions(control);
    }
}

impl EventSink for SharedRecorder<'_> {
    fn event(&mut self, event: &Event<'_>) {
        self.0.borrow_mut().event(event);
    }
}

impl Recorder {
    /// Removes the spindle stop that a tool change causes.
    fn forget_standstill(&mut self, change: &Event<'_>) {
        let number = self.numbers.number(&change.backtrace());
        let is_of_change = |(step, _): &mut (NewStep, Span)| {
            step.kind == StepKind::Spindle(SpindleDirection::Off, 0.0) && step.block_number == number
        };
        self.pending.pop_if(is_of_change);
    }

    fn event(&mut self, event: &Event<'_>) {
        let command = match event.kind {
            EventKind::Rapid { to } => return self.go(StepKind::Rapid, *to, event),
            EventKind::Feed { to, rate } => return self.go(StepKind::Feed(rate.0), *to, event),
            EventKind::Arc { to, arc, rate } => return self.go(StepKind::Arc(*arc, rate.0), *to, event),
            EventKind::Skip { to, rate, .. } => return self.go(StepKind::Probe(rate.0), *to, event),
            EventKind::Dwell { time } => StepKind::Dwell(time.0),
            EventKind::ToolChange { number } => {
                self.forget_standstill(event);
                StepKind::Tool(*number)
            }
            EventKind::ToolLength { offset, .. } if *offset == self.length => return,
            EventKind::ToolLength { offset, .. } => {
                self.length = *offset;
                StepKind::Length(Box::new(*offset))
            }
            EventKind::Start { at, unknown } => {
                self.start = RunStart { at: *at, unknown: *unknown };
                (self.at, self.unknown) = (*at, *unknown);
                return;
            }
            EventKind::PositionUnknown { axes } => {
                self.unknown = *axes;
                return;
            }
            EventKind::ToolSelected { .. } => return,
            EventKind::Spindle { direction, speed, .. } => {
                // The speed of a stopped spindle is recorded when it starts.
                let is_off = *direction == SpindleDirection::Off;
                StepKind::Spindle(*direction, if is_off { 0.0 } else { speed.0 })
            }
            EventKind::Coolant { is_on, code } => StepKind::Coolant(*is_on, Some(*code)),
            EventKind::Auxiliary { code } => StepKind::Auxiliary(*code),
            EventKind::Stop { kind, text, variables } => {
                StepKind::Stop(*kind, text.clone(), variables.clone())
            }
        };
        self.push(command, &event.backtrace());
    }
}
