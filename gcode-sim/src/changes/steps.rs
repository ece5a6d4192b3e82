//! What a machine was told, step by step, in a form that two runs can be compared by.
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::conditions::Condition;
use super::record::{MOST_STEPS, is_same_place};
use crate::exec::{Control, Modal, Remainder, RemainderKind, Silent, Watcher};
use crate::motion::{Arc2, Event, EventKind, MAX_AXES, Place, Position, Sink, Spindle, StopKind};

/// Variables that outlive a program.
const COMMON: RangeInclusive<u32> = 100..=999;

/// One thing the machine was told.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub kind: Kind,
    /// Where the axes stand before and after it, the tool length offset taken out: a longer tool is one difference, not
    /// one in every move.
    pub from: Position,
    pub to: Position,
    /// Where the axes stand after it, in machine coordinates.
    pub at: Position,
    /// The block it comes from, by its number in the record.
    pub place: usize,
    /// What is in force, by its number in the record.
    pub under: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Rapid,
    /// With its feed in mm/min.
    Feed(f64),
    Arc(Arc2, f64),
    /// G31 with its feed.
    Probe(f64),
    /// Seconds.
    Dwell(f64),
    Tool(u32),
    Length(Position),
    Spindle(Spindle, f64),
    /// On or off, and by which M code; a file may not say by which.
    Coolant(bool, Option<u32>),
    /// An M code for the machine builder's logic.
    Auxiliary(u32),
    /// With its text, and the variables that the text names with their values.
    Stop(StopKind, String, Vec<(u32, f64)>),
    /// What a block says that moves nothing here.
    Silent(Quiet, String),
}

/// What moves nothing here and means something on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Quiet {
    /// A block skip in front of a block that is done, or inside.
    Skip,
    /// How exactly corners are cut in this block, how far is read ahead.
    Path,
    /// Another G code without effect here.
    GCode,
    /// An M code without effect here.
    MCode,
}

/// What can be paired with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Category {
    Move,
    Dwell,
    Tool,
    Length,
    Spindle,
    Coolant,
    Auxiliary,
    Stop,
    Silent(Quiet),
}

impl Kind {
    pub(super) fn category(&self) -> Category {
        match self {
            Self::Rapid | Self::Feed(_) | Self::Arc(..) | Self::Probe(_) => Category::Move,
            Self::Dwell(_) => Category::Dwell,
            Self::Tool(_) => Category::Tool,
            Self::Length(_) => Category::Length,
            Self::Spindle(..) => Category::Spindle,
            Self::Coolant(..) => Category::Coolant,
            Self::Auxiliary(_) => Category::Auxiliary,
            Self::Stop(..) => Category::Stop,
            Self::Silent(what, _) => Category::Silent(*what),
        }
    }

    /// The feed of a cut.
    pub(super) fn rate(&self) -> Option<f64> {
        match self {
            Self::Feed(rate) | Self::Arc(_, rate) | Self::Probe(rate) => Some(*rate),
            _ => None,
        }
    }

    /// With its article.
    pub(super) fn one(&self) -> String {
        let article = if matches!(self, Self::Arc(..)) { "an" } else { "a" };
        format!("{article} {}", self.name())
    }

    /// As people say it.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Feed(_) => "feed",
            Self::Arc(..) => "arc",
            Self::Probe(_) => "probing move",
            Self::Dwell(_) => "dwell",
            Self::Tool(_) => "tool change",
            Self::Length(_) => "tool length offset",
            Self::Spindle(..) => "spindle command",
            Self::Coolant(..) => "coolant command",
            Self::Auxiliary(_) => "M code",
            Self::Stop(..) => "stop",
            Self::Silent(Quiet::Skip, _) => "block skip",
            Self::Silent(Quiet::Path | Quiet::GCode, _) => "G code",
            Self::Silent(Quiet::MCode, _) => "M code",
        }
    }
}

impl Step {
    pub(super) fn is_move(&self) -> bool {
        self.kind.category() == Category::Move
    }

    pub(super) fn is_rapid(&self) -> bool {
        self.kind == Kind::Rapid
    }

    /// The same thing done: a move to the same point in the same way, at whatever feed.
    pub(super) fn is_same(&self, other: &Self, tolerance: f64) -> bool {
        match (&self.kind, &other.kind) {
            (Kind::Rapid, Kind::Rapid)
            | (Kind::Feed(_), Kind::Feed(_))
            | (Kind::Probe(_), Kind::Probe(_)) => near(&self.to, &other.to, tolerance),
            (Kind::Arc(a, _), Kind::Arc(b, _)) => {
                near(&self.to, &other.to, tolerance) && is_same_arc(a, b, tolerance)
            }
            (Kind::Length(a), Kind::Length(b)) => near(a, b, tolerance),
            (Kind::Stop(kind, text, named), Kind::Stop(other, words, values)) => {
                let same = |(a, b): (&(u32, f64), &(u32, f64))| a.0 == b.0 && (a.1 - b.1).abs() <= tolerance;
                let alike = named.len() == values.len() && named.iter().zip(values).all(same);
                kind == other && text == words && alike
            }
            (Kind::Coolant(on, a), Kind::Coolant(is, b)) => {
                on == is && (a.is_none() || b.is_none() || a == b)
            }
            (a, b) => a == b,
        }
    }

    /// Two moves that go the same way from wherever they begin.
    pub(super) fn is_parallel(&self, other: &Self, tolerance: f64) -> bool {
        self.is_move() && other.is_move() && near(&self.way(), &other.way(), tolerance)
    }

    /// It ends on the line that `feed` runs along.
    pub(super) fn is_on_line_of(&self, feed: &Self) -> bool {
        let (along, aside) = (feed.way(), difference(&self.to, &feed.to));
        let dot = |a: &Position, b: &Position| (0..MAX_AXES).map(|axis| a[axis] * b[axis]).sum::<f64>();
        let part = dot(&aside, &along) / dot(&along, &along).max(f64::MIN_POSITIVE);
        // Rounded end points stand this far beside a slanting line.
        (0..MAX_AXES).all(|axis| (aside[axis] - part * along[axis]).abs() <= 0.002)
    }

    /// From where it ends to where `other` ends, all axes as equal numbers.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        norm(&difference(&self.to, &other.to))
    }

    /// From where it begins to where it ends.
    pub(super) fn way(&self) -> Position {
        difference(&self.to, &self.from)
    }

    /// The length of its way, straight, all axes as equal numbers.
    pub(super) fn length(&self) -> f64 {
        norm(&self.way())
    }
}

/// The same curve about the same centre.
pub(super) fn is_same_arc(a: &Arc2, b: &Arc2, tolerance: f64) -> bool {
    let off = (a.centre.0 - b.centre.0).abs().max((a.centre.1 - b.centre.1).abs());
    a.plane == b.plane && off <= tolerance && (a.sweep.0 - b.sweep.0).abs() <= 1e-3
}

/// How far each axis of `to` is from that of `from`.
pub(super) fn difference(to: &Position, from: &Position) -> Position {
    let mut way = Position::default();
    for axis in 0..MAX_AXES {
        way[axis] = to[axis] - from[axis];
    }
    way
}

fn norm(way: &Position) -> f64 {
    (0..MAX_AXES).map(|axis| way[axis] * way[axis]).sum::<f64>().sqrt()
}

pub(super) fn near(a: &Position, b: &Position, tolerance: f64) -> bool {
    (0..MAX_AXES).all(|axis| (a[axis] - b[axis]).abs() <= tolerance)
}

/// Writes the steps down as the control tells them.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    pub steps: Vec<Step>,
    pub places: Vec<Place>,
    /// There were more than [`MOST_STEPS`].
    pub too_many: bool,
    pub conditions: Vec<Condition>,
    /// The block that has put a mode in force, by its group.
    pub set: BTreeMap<u32, usize>,
    /// The block that has written a common variable last.
    pub assigned: BTreeMap<u32, Place>,
    /// The block that has changed an offset, a parameter, an output or a counter last, by its name.
    pub written: BTreeMap<String, Place>,
    block: Option<Block>,
    at: Position,
    length: Position,
    /// What the conditions were read from.
    seen: Option<Seen>,
    /// Steps whose conditions are known.
    settled: usize,
}

/// A block that is about to be done.
#[derive(Debug)]
struct Block {
    place: Place,
    silent: Silent,
    /// Common variables that it assigns.
    assigned: Vec<u32>,
    /// What stands in the tables before it, where it may write there.
    tables: Vec<Remainder>,
}

/// What of a control's state conditions depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    modal: Modal,
    h: u32,
    d: u32,
    q: Option<f64>,
}

impl Recorder {
    /// The number of a place.
    fn place(&mut self, place: Place) -> usize {
        if !self.places.last().is_some_and(|last| is_same_place(last, &place)) {
            self.places.push(place);
        }
        self.places.len() - 1
    }

    /// A block is about to be done.
    fn look(&mut self, control: &mut Control) {
        self.block = control.next_block().map(|block| {
            let silent = control.next_silent();
            let tables = if silent.writes { control.left_behind() } else { Vec::new() };
            let mut assigned = control.will_assign();
            assigned.retain(|number| COMMON.contains(number));
            Block { place: Place { block, ..control.place() }, silent, assigned, tables }
        });
    }

    /// A block is done: what it said that moves nothing, and what it has written.
    fn note(&mut self, control: &Control) {
        let Some(Block { place, silent, assigned, tables }) = self.block.take() else { return };
        let Silent { skips, path, g_codes, m_codes, writes } = silent;
        let all =
            [(Quiet::Skip, skips), (Quiet::Path, path), (Quiet::GCode, g_codes), (Quiet::MCode, m_codes)];
        for (what, texts) in all {
            for text in texts {
                self.push(Kind::Silent(what, text), self.at, place.clone());
            }
        }
        self.assigned.extend(assigned.into_iter().map(|number| (number, place.clone())));
        if !writes {
            return;
        }
        let value = |all: &[Remainder], name: &str| all.iter().find(|r| r.name == name).map(|r| r.value);
        let now = control.left_behind();
        let names = tables.iter().chain(&now).filter(|r| r.kind != RemainderKind::Variable);
        for name in names.map(|r| &r.name) {
            if value(&tables, name) != value(&now, name) {
                self.written.insert(name.clone(), place.clone());
            }
        }
    }

    /// A block is done: what is in force now was so for its steps.
    fn settle(&mut self, control: &Control) {
        let state = control.state();
        let now = Seen { modal: state.modal, h: state.codes.h, d: state.codes.d, q: state.drilling.q };
        if self.seen != Some(now) {
            let place = self.place(control.place());
            let before = self.seen.map_or_else(Modal::default, |seen| seen.modal);
            for group in (1..=22).filter(|group| before.code(*group) != now.modal.code(*group)) {
                self.set.insert(group, place);
            }
            let before = self.conditions.last().cloned().unwrap_or_else(Condition::at_power_on);
            let next = before.follow(state, place);
            if self.conditions.last() != Some(&next) {
                self.conditions.push(next);
            }
            self.seen = Some(now);
        }
        let under = self.conditions.len() - 1;
        self.steps[self.settled..].iter_mut().for_each(|step| step.under = under);
        self.settled = self.steps.len();
    }

    fn push(&mut self, kind: Kind, from: Position, place: Place) {
        self.too_many |= self.steps.len() >= MOST_STEPS;
        if !self.too_many {
            let place = self.place(place);
            let (from, to) = (difference(&from, &self.length), difference(&self.at, &self.length));
            self.steps.push(Step { kind, from, to, at: self.at, place, under: 0 });
        }
    }

    fn go(&mut self, kind: Kind, to: Position, event: &Event<'_>) {
        let from = std::mem::replace(&mut self.at, to);
        // A move to where the axes stand does nothing; a full circle ends where it begins.
        if from != to || matches!(kind, Kind::Arc(..)) {
            self.push(kind, from, event.place());
        }
    }
}

/// A recorder that is told what the machine does, and looks on at the control.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared<'a>(pub &'a RefCell<Recorder>);

impl Watcher for Shared<'_> {
    fn before(&mut self, control: &mut Control) {
        self.0.borrow_mut().look(control);
    }

    fn after(&mut self, control: &Control) {
        let mut recorder = self.0.borrow_mut();
        recorder.note(control);
        recorder.settle(control);
    }
}

impl Sink for Shared<'_> {
    fn event(&mut self, event: &Event<'_>) {
        self.0.borrow_mut().event(event);
    }
}

impl Recorder {
    fn event(&mut self, event: &Event<'_>) {
        let here = self.at;
        match event.kind {
            EventKind::Rapid { to } => self.go(Kind::Rapid, *to, event),
            EventKind::Feed { to, rate } => self.go(Kind::Feed(rate.0), *to, event),
            EventKind::Arc { to, arc, rate } => self.go(Kind::Arc(*arc, rate.0), *to, event),
            EventKind::Skip { to, rate, .. } => self.go(Kind::Probe(rate.0), *to, event),
            EventKind::Dwell { time } => self.push(Kind::Dwell(time.0), here, event.place()),
            EventKind::Tool { number } => self.push(Kind::Tool(*number), here, event.place()),
            EventKind::ToolLength { offset, .. } if *offset == self.length => {}
            EventKind::ToolLength { offset, .. } => {
                self.length = *offset;
                self.push(Kind::Length(*offset), here, event.place());
            }
            EventKind::Unplaced { .. } => {}
            EventKind::Spindle { turning, speed } => {
                // At a standstill the speed is what it will turn at later: that is told then.
                let speed = if *turning == Spindle::Off { 0.0 } else { speed.0 };
                self.push(Kind::Spindle(*turning, speed), here, event.place());
            }
            EventKind::Coolant { on, code } => {
                self.push(Kind::Coolant(*on, Some(*code)), here, event.place())
            }
            EventKind::Auxiliary { code } => self.push(Kind::Auxiliary(*code), here, event.place()),
            EventKind::Stop { kind, text, named } => {
                self.push(Kind::Stop(*kind, text.clone(), named.clone()), here, event.place());
            }
        }
    }
}
