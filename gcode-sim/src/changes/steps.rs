//! What a machine was told, step by step, in a form that two runs can be compared by.
use crate::motion::{Arc2, Event, EventKind, MAX_AXES, Place, Position, Sink, Spindle, StopKind};

use super::record::{MOST_STEPS, is_same_place};

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
    Coolant(bool),
    /// An M code for the machine builder's logic.
    Auxiliary(u32),
    /// With its text, and the variables that the text names with their values.
    Stop(StopKind, String, Vec<(u32, f64)>),
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
}

impl Kind {
    pub(super) fn category(&self) -> Category {
        match self {
            Self::Rapid | Self::Feed(_) | Self::Arc(..) | Self::Probe(_) => Category::Move,
            Self::Dwell(_) => Category::Dwell,
            Self::Tool(_) => Category::Tool,
            Self::Length(_) => Category::Length,
            Self::Spindle(..) => Category::Spindle,
            Self::Coolant(_) => Category::Coolant,
            Self::Auxiliary(_) => Category::Auxiliary,
            Self::Stop(..) => Category::Stop,
        }
    }

    /// The feed of a cut.
    pub(super) fn rate(&self) -> Option<f64> {
        match self {
            Self::Feed(rate) | Self::Arc(_, rate) | Self::Probe(rate) => Some(*rate),
            _ => None,
        }
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
            Self::Coolant(_) => "coolant command",
            Self::Auxiliary(_) => "M code",
            Self::Stop(..) => "stop",
        }
    }
}

impl Step {
    pub(super) fn is_move(&self) -> bool {
        self.kind.category() == Category::Move
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
        let way = difference(&self.to, &other.to);
        (0..MAX_AXES).map(|axis| way[axis] * way[axis]).sum::<f64>().sqrt()
    }

    fn way(&self) -> Position {
        difference(&self.to, &self.from)
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

fn near(a: &Position, b: &Position, tolerance: f64) -> bool {
    (0..MAX_AXES).all(|axis| (a[axis] - b[axis]).abs() <= tolerance)
}

/// Writes the steps down as the control tells them.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    pub steps: Vec<Step>,
    pub places: Vec<Place>,
    /// There were more than [`MOST_STEPS`].
    pub too_many: bool,
    at: Position,
    length: Position,
}

impl Recorder {
    fn push(&mut self, kind: Kind, from: Position, event: &Event<'_>) {
        self.too_many |= self.steps.len() >= MOST_STEPS;
        if !self.too_many {
            let place = event.place();
            if !self.places.last().is_some_and(|last| is_same_place(last, &place)) {
                self.places.push(place);
            }
            let (from, to) = (difference(&from, &self.length), difference(&self.at, &self.length));
            self.steps.push(Step { kind, from, to, at: self.at, place: self.places.len() - 1 });
        }
    }

    fn go(&mut self, kind: Kind, to: Position, event: &Event<'_>) {
        let from = std::mem::replace(&mut self.at, to);
        // A move to where the axes stand does nothing; a full circle ends where it begins.
        if from != to || matches!(kind, Kind::Arc(..)) {
            self.push(kind, from, event);
        }
    }
}

impl Sink for Recorder {
    fn event(&mut self, event: &Event<'_>) {
        let here = self.at;
        match event.kind {
            EventKind::Rapid { to } => self.go(Kind::Rapid, *to, event),
            EventKind::Feed { to, rate } => self.go(Kind::Feed(rate.0), *to, event),
            EventKind::Arc { to, arc, rate } => self.go(Kind::Arc(*arc, rate.0), *to, event),
            EventKind::Skip { to, rate, .. } => self.go(Kind::Probe(rate.0), *to, event),
            EventKind::Dwell { time } => self.push(Kind::Dwell(time.0), here, event),
            EventKind::Tool { number } => self.push(Kind::Tool(*number), here, event),
            EventKind::ToolLength { offset } => {
                self.length = *offset;
                self.push(Kind::Length(*offset), here, event);
            }
            EventKind::Spindle { turning, speed } => {
                // At a standstill the speed is what it will turn at later: that is told then.
                let speed = if *turning == Spindle::Off { 0.0 } else { speed.0 };
                self.push(Kind::Spindle(*turning, speed), here, event);
            }
            EventKind::Coolant { on } => self.push(Kind::Coolant(*on), here, event),
            EventKind::Auxiliary { code } => self.push(Kind::Auxiliary(*code), here, event),
            EventKind::Stop { kind, text, named } => {
                self.push(Kind::Stop(*kind, text.clone(), named.clone()), here, event);
            }
        }
    }
}
