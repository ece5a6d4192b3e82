//! Looks on at a run and writes down its steps, what they are made under, and which block wrote what it leaves behind.
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ops::RangeInclusive;
use std::sync::Arc;

use super::first_command::{CommandKind as What, FirstCommand};
use super::modal_conditions::ModalConditions;
use super::steps::{Step, StepKind, UnsimulatedKind, difference};
use gcode_control::{
    BlockCommands, Control, Modal, Observer, ResidualKind, ResidualValue, UnsimulatedCodes, Value, modal_code,
};
use gcode_lang::motion::{Backtrace, Event, EventKind, EventSink, Position, SpindleDirection};
use gcode_lang::source::{SourceId, Span};

/// More steps than this aren't written down: a loop that never ends must not fill the memory.
pub const MOST_STEPS: usize = 1_000_000;

/// Variables that outlive a program.
const COMMON: RangeInclusive<u32> = 100..=999;

/// Compensation reads no more blocks ahead than this.
const HELD_BACK: usize = 16;

/// Single block and waiting for M codes; feed hold, override and exact stop.
const SWITCHES: RangeInclusive<u32> = 3003..=3004;

/// Output signals, one by one and sixteen and thirty-two at a time.
const OUTPUTS: RangeInclusive<u32> = 1100..=1135;

/// Writes the steps down as the control tells them.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    pub steps: Vec<Step>,
    pub places: Vec<Backtrace>,
    /// There were more than [`MOST_STEPS`].
    pub too_many: bool,
    pub conditions: Vec<ModalConditions>,
    /// The block that has put a mode in force, by its group.
    pub set: BTreeMap<u32, usize>,
    /// The block that has written a common variable last.
    pub assigned: BTreeMap<u32, Backtrace>,
    /// The block that has changed an offset, a parameter, an output or a counter last, by its name.
    pub written: BTreeMap<String, Backtrace>,
    /// What is commanded, each at its first time.
    pub begun: BTreeMap<(What, String), FirstCommand>,
    /// The blocks that were done whole.
    pub done: ExecutedBlocks,
    /// When each block was first executed.
    pub reached: FirstExecutions,
    moves: usize,
    block: Option<PendingBlock>,
    at: Position,
    length: Position,
    /// The block done last, and how the run ends if it ends there.
    pub last: Option<Backtrace>,
    pub end: EndCause,
    /// The last T and S.
    called: (u32, f64),
    /// The block that has said F, S and T last, and the numbers of these blocks.
    said: BTreeMap<char, (Span, usize)>,
    /// What the conditions were read from.
    seen: Option<ConditionInputs>,
    /// The last blocks and what was in force in them: a move may be held back until the blocks behind it are read.
    recent: VecDeque<(Span, usize)>,
    /// Steps whose conditions are known.
    settled: usize,
}

/// How many steps a run has made when it first executes each block, by text and place.
pub(super) type FirstExecutions = BTreeMap<(SourceId, u32), usize>;

/// The blocks that a run has done whole, by text and place.
pub(super) type ExecutedBlocks = BTreeSet<(SourceId, u32)>;

/// How a run comes to its end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum EndCause {
    /// There is no block any more.
    #[default]
    OfText,
    /// By M02 or M30.
    Code(u32),
    /// By the main program's M99.
    Return,
}

/// A block that is about to be done.
#[derive(Debug)]
struct PendingBlock {
    place: Backtrace,
    /// Where the axes stand before it, and the tool length offset.
    before: (Position, Position),
    silent: UnsimulatedCodes,
    /// Common variables and switches that it assigns.
    assigned: Vec<u32>,
    /// What stands in the tables before it, where it may write there.
    tables: Vec<ResidualValue>,
}

/// What of a control's state conditions depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ConditionInputs {
    modal: Modal,
    h: u32,
    d: u32,
    q: Option<f64>,
}

impl Recorder {
    /// The number of a place.
    fn place(&mut self, place: Backtrace) -> usize {
        if !self.places.last().is_some_and(|last| is_same_place(last, &place)) {
            self.places.push(place);
        }
        self.places.len() - 1
    }

    /// A block is about to be done.
    fn before_block(&mut self, control: &mut Control) {
        let next = control.next_block();
        if next.is_none() {
            self.end = EndCause::OfText;
        }
        self.block = next.map(|block| {
            self.reached.entry((block.source, block.start)).or_insert(self.steps.len());
            let silent = control.next_unsimulated();
            let tables = if silent.writes { control.residual_values() } else { Vec::new() };
            let mut assigned = control.next_assigned_variables();
            assigned.retain(|number| [COMMON, SWITCHES, OUTPUTS].iter().any(|some| some.contains(number)));
            if control.is_next_unconditional() {
                self.done.insert((block.source, block.start));
            }
            let place = Backtrace { block, ..control.backtrace() };
            self.begin(control.next_commands(), &place);
            PendingBlock { place, before: (self.at, self.length), silent, assigned, tables }
        });
    }

    /// A block is about to command this.
    fn begin(&mut self, commanded: BlockCommands, place: &Backtrace) {
        let BlockCommands { modes, axes, offsets, valued_letters: values } = commanded;
        for letter in values {
            let number = self.place(place.clone());
            self.said.insert(letter, (place.block, number));
        }
        let modes =
            modes.into_iter().map(|(group, code)| (What::Mode, format!("{group:02}"), modal_code(code)));
        let axes = axes.into_iter().map(|letter| (What::Axis, letter.to_string(), letter.to_string()));
        let offsets = offsets.into_iter().map(|name| (What::Offset, name.clone(), name));
        for (what, name, text) in modes.chain(axes).chain(offsets) {
            if !self.begun.contains_key(&(what, name.clone())) {
                let place = self.place(place.clone());
                let begun = FirstCommand { what, name: name.clone(), text, moves: self.moves, place };
                self.begun.insert((what, name), begun);
            }
        }
    }

    /// A block is done: what it said that moves nothing, and what it has written.
    fn note(&mut self, control: &Control) {
        let Some(PendingBlock { place, before, silent, assigned, tables }) = self.block.take() else {
            return;
        };
        let UnsimulatedCodes {
            block_skips: skips,
            path_codes: path,
            g_codes,
            m_codes,
            writes,
            end_code: ends,
        } = silent;
        self.note_called(control, &place, before);
        self.last = Some(place.clone());
        self.end = ends.map_or(EndCause::Return, EndCause::Code);
        let all = [
            (UnsimulatedKind::Skip, skips),
            (UnsimulatedKind::Path, path),
            (UnsimulatedKind::GCode, g_codes),
            (UnsimulatedKind::MCode, m_codes),
        ];
        for (what, texts) in all {
            for text in texts {
                self.push(StepKind::Silent(what, text), self.at, place.clone());
            }
        }
        for number in assigned {
            if !COMMON.contains(&number) {
                let what =
                    if OUTPUTS.contains(&number) { UnsimulatedKind::Signal } else { UnsimulatedKind::Switch };
                let value = control.variable(number).map_or(0.0, Value::number);
                self.push(StepKind::Silent(what, format!("#{number}={value}")), self.at, place.clone());
            } else {
                self.assigned.insert(number, place.clone());
            }
        }
        if !writes {
            return;
        }
        let value = |all: &[ResidualValue], name: &str| all.iter().find(|r| r.name == name).map(|r| r.value);
        let now = control.residual_values();
        let names = tables.iter().chain(&now).filter(|r| r.kind != ResidualKind::Variable);
        for name in names.map(|r| &r.name) {
            if value(&tables, name) != value(&now, name) {
                self.written.insert(name.clone(), place.clone());
            }
        }
    }

    /// T and S that no M06, M03 or M04 has taken up yet: said before the block does anything.
    fn note_called(&mut self, control: &Control, place: &Backtrace, (at, length): (Position, Position)) {
        let state = control.state();
        let (tool, speed) = (state.codes.t, state.codes.s);
        let before = std::mem::replace(&mut self.called, (tool, speed));
        let is_called = before.0 != tool && tool != state.tool;
        let is_speed = before.1 != speed && state.spindle == SpindleDirection::Off;
        let called = is_called.then(|| (UnsimulatedKind::Tool, format!("T{tool}")));
        let set = is_speed.then(|| (UnsimulatedKind::Speed, format!("S{speed}")));
        let to = difference(&at, &length);
        for (what, text) in called.into_iter().chain(set) {
            let place = self.place(place.clone());
            let kind = StepKind::Silent(what, text);
            self.steps
                .insert(self.settled, Step { kind, from: to, to, at, place, set_by: None, condition: 0 });
        }
    }

    /// The run is over: a T that M06 has put in, and an S that the spindle has turned with, are told by that.
    pub(super) fn forget_taken_up(&mut self) {
        let (mut tool, mut speed) = (String::new(), String::new());
        let mut stays = vec![true; self.steps.len()];
        for (step, stays) in self.steps.iter().zip(&mut stays).rev() {
            match &step.kind {
                StepKind::Tool(number) => tool = format!("T{number}"),
                StepKind::Spindle(turning, rate) if *turning != SpindleDirection::Off => {
                    speed = format!("S{rate}")
                }
                StepKind::Silent(UnsimulatedKind::Tool, text) => *stays = std::mem::take(&mut tool) != *text,
                StepKind::Silent(UnsimulatedKind::Speed, text) => {
                    *stays = std::mem::take(&mut speed) != *text
                }
                _ => {}
            }
        }
        // Blocks count the steps that are left.
        let left: Vec<usize> = std::iter::once(0)
            .chain(stays.iter().scan(0, |left, stays| {
                *left += usize::from(*stays);
                Some(*left)
            }))
            .collect();
        self.reached.values_mut().for_each(|step| *step = left[*step]);
        let mut stays = stays.into_iter();
        self.steps.retain(|_| stays.next() == Some(true));
    }

    /// A block is done: what is in force now was so for its steps.
    fn resolve_conditions(&mut self, control: &Control) {
        let state = control.state();
        let now =
            ConditionInputs { modal: state.modal, h: state.codes.h, d: state.codes.d, q: state.cycle.q };
        if self.seen != Some(now) {
            let place = self.place(control.backtrace());
            let before = self.seen.map_or_else(Modal::default, |seen| seen.modal);
            for group in (1..=22).filter(|group| before.code(*group) != now.modal.code(*group)) {
                self.set.insert(group, place);
            }
            let before = self.conditions.last().cloned().unwrap_or_else(ModalConditions::at_power_on);
            let next = before.after_block(state, place);
            if self.conditions.last() != Some(&next) {
                self.conditions.push(next);
            }
            self.seen = Some(now);
        }
        let under = self.conditions.len() - 1;
        if self.recent.len() == HELD_BACK {
            self.recent.pop_front();
        }
        let this = self.last.as_ref().map(|place| place.block);
        self.recent.extend(this.map(|block| (block, under)));
        for step in &mut self.steps[self.settled..] {
            let block = self.places[step.place].block;
            let known = self.recent.iter().rev().find(|(known, _)| *known == block);
            step.condition = known.map_or(under, |(_, under)| *under);
        }
        self.settled = self.steps.len();
    }

    fn push(&mut self, kind: StepKind, from: Position, place: Backtrace) {
        self.too_many |= self.steps.len() >= MOST_STEPS;
        if !self.too_many {
            let said = self.said(&kind, &place);
            let place = self.place(place);
            let (from, to) = (difference(&from, &self.length), difference(&self.at, &self.length));
            self.steps.push(Step { kind, from, to, at: self.at, place, set_by: said, condition: 0 });
        }
    }

    /// The block that has said what a step takes up, if that is another than its own. A feed that was held back doesn't know.
    fn said(&self, kind: &StepKind, place: &Backtrace) -> Option<usize> {
        let letter = match kind {
            StepKind::Tool(_) => 'T',
            StepKind::Spindle(turning, _) if *turning != SpindleDirection::Off => 'S',
            StepKind::Feed(_) | StepKind::Arc(..) | StepKind::Probe(_) => 'F',
            _ => return None,
        };
        let is_held_back = self.block.as_ref().is_some_and(|block| block.place.block != place.block);
        let said = self.said.get(&letter).filter(|(block, _)| *block != place.block && !is_held_back);
        said.map(|(_, number)| *number)
    }

    fn go(&mut self, kind: StepKind, to: Position, event: &Event<'_>) {
        let from = std::mem::replace(&mut self.at, to);
        self.moves += usize::from(from != to || matches!(kind, StepKind::Arc(..)));
        // A move to where the axes stand does nothing; a full circle ends where it begins.
        if from != to || matches!(kind, StepKind::Arc(..)) {
            self.push(kind, from, event.backtrace());
        }
    }
}

/// A recorder that is told what the machine does, and looks on at the control.
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
    /// The standstill that a tool change brings along is no command of its own.
    fn forget_standstill(&mut self, change: &Event<'_>) {
        let is_of_change = |step: &Step| {
            let is_off = step.kind == StepKind::Spindle(SpindleDirection::Off, 0.0);
            is_off && is_same_place(&self.places[step.place], &change.backtrace())
        };
        if self.steps.last().is_some_and(is_of_change) {
            self.steps.pop();
        }
    }

    fn event(&mut self, event: &Event<'_>) {
        let here = self.at;
        match event.kind {
            EventKind::Rapid { to } => self.go(StepKind::Rapid, *to, event),
            EventKind::Feed { to, rate } => self.go(StepKind::Feed(rate.0), *to, event),
            EventKind::Arc { to, arc, rate } => self.go(StepKind::Arc(*arc, rate.0), *to, event),
            EventKind::Skip { to, rate, .. } => self.go(StepKind::Probe(rate.0), *to, event),
            EventKind::Dwell { time } => self.push(StepKind::Dwell(time.0), here, event.backtrace()),
            EventKind::ToolChange { number } => {
                self.forget_standstill(event);
                self.push(StepKind::Tool(*number), here, event.backtrace());
            }
            EventKind::ToolLength { offset, .. } if *offset == self.length => {}
            EventKind::ToolLength { offset, .. } => {
                self.length = *offset;
                self.push(StepKind::Length(*offset), here, event.backtrace());
            }
            EventKind::WorkZeroUnknown { .. } => {}
            EventKind::Spindle { direction: turning, speed } => {
                // At a standstill the speed is what it will turn at later: that is told then.
                let speed = if *turning == SpindleDirection::Off { 0.0 } else { speed.0 };
                self.push(StepKind::Spindle(*turning, speed), here, event.backtrace());
            }
            EventKind::Coolant { is_on: on, code } => {
                self.push(StepKind::Coolant(*on, Some(*code)), here, event.backtrace())
            }
            EventKind::Auxiliary { code } => self.push(StepKind::Auxiliary(*code), here, event.backtrace()),
            EventKind::Stop { kind, text, variables: named } => {
                self.push(StepKind::Stop(*kind, text.clone(), named.clone()), here, event.backtrace());
            }
        }
    }
}

/// Blocks that were told already: most steps come from the block and the call of the one before.
pub(super) fn is_same_place(a: &Backtrace, b: &Backtrace) -> bool {
    a.block == b.block
        && match (&a.calls, &b.calls) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        }
}
