//! What a machine was told, step by step, in a form that two runs can be compared by.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use gcode_lang::motion::{MAX_AXES, PlanarArc, Position, SpindleDirection, StopKind};

/// One thing the machine was told.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub kind: StepKind,
    /// Where the axes stand before and after it, the tool length offset taken out: a longer tool is one difference, not
    /// one in every move.
    pub from: Position,
    pub to: Position,
    /// Where the axes stand after it, in machine coordinates.
    pub at: Position,
    /// The block it comes from, by its number in the record.
    pub place: usize,
    /// The block that has said the T, the S or the feed that is taken up here, where that is another; nothing of what was read
    /// from a file.
    pub set_by: Option<usize>,
    /// What is in force, by its number in the record.
    pub condition: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum StepKind {
    Rapid,
    /// With its feed in mm/min.
    Feed(f64),
    Arc(PlanarArc, f64),
    /// G31 with its feed.
    Probe(f64),
    /// Seconds.
    Dwell(f64),
    Tool(u32),
    Length(Position),
    Spindle(SpindleDirection, f64),
    /// On or off, and by which M code; a file may not say by which.
    Coolant(bool, Option<u32>),
    /// An M code for the machine builder's logic.
    Auxiliary(u32),
    /// With its text, and the variables that the text names with their values.
    Stop(StopKind, String, Vec<(u32, f64)>),
    /// What a block says that moves nothing here.
    Silent(UnsimulatedKind, String),
}

/// A command without simulated effect that has an effect on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum UnsimulatedKind {
    /// A block skip before or inside an executed block.
    Skip,
    /// Exact stop and lookahead of a single block.
    Path,
    /// Another G code without effect here.
    GCode,
    /// An M code without effect here.
    MCode,
    /// A T whose tool is not loaded before another is called: the magazine moves, or the machine's own codes
    /// change tools.
    Tool,
    /// An S with the spindle off that no M03 or M04 uses: the machine's own codes may use it.
    Speed,
    /// #3003 or #3004: single block, waiting for M codes, feed hold, override, exact stop.
    Switch,
    /// An assignment to an output, which a pulse does not leave in the final state.
    Signal,
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
    Silent(UnsimulatedKind),
}

impl StepKind {
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
            Self::Silent(UnsimulatedKind::Tool, _) => Category::Tool,
            Self::Silent(UnsimulatedKind::Speed, _) => Category::Spindle,
            Self::Silent(UnsimulatedKind::MCode, _) => Category::Auxiliary,
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
            Self::Silent(UnsimulatedKind::Skip, _) => "block skip",
            Self::Silent(UnsimulatedKind::Path | UnsimulatedKind::GCode, _) => "G code",
            Self::Silent(UnsimulatedKind::MCode, _) => "M code",
            Self::Silent(UnsimulatedKind::Tool, _) => "tool call",
            Self::Silent(UnsimulatedKind::Speed, _) => "spindle speed",
            Self::Silent(UnsimulatedKind::Switch, _) => "switch",
            Self::Silent(UnsimulatedKind::Signal, _) => "output signal",
        }
    }
}

impl Step {
    /// The block that a reader changes for another tool, speed or feed.
    pub(super) fn editable_at(&self) -> usize {
        self.set_by.unwrap_or(self.place)
    }

    pub(super) fn is_move(&self) -> bool {
        self.kind.category() == Category::Move
    }

    pub(super) fn is_rapid(&self) -> bool {
        self.kind == StepKind::Rapid
    }

    /// The same thing done: a move to the same point in the same way, at whatever feed.
    pub(super) fn is_same(&self, other: &Self, tolerance: f64) -> bool {
        match (&self.kind, &other.kind) {
            (StepKind::Rapid, StepKind::Rapid)
            | (StepKind::Feed(_), StepKind::Feed(_))
            | (StepKind::Probe(_), StepKind::Probe(_)) => near(&self.to, &other.to, tolerance),
            (StepKind::Arc(a, _), StepKind::Arc(b, _)) => {
                near(&self.to, &other.to, tolerance) && is_same_arc(a, b, tolerance)
            }
            (StepKind::Length(a), StepKind::Length(b)) => near(a, b, tolerance),
            (StepKind::Stop(kind, text, named), StepKind::Stop(other, words, values)) => {
                let same = |(a, b): (&(u32, f64), &(u32, f64))| a.0 == b.0 && (a.1 - b.1).abs() <= tolerance;
                let alike = named.len() == values.len() && named.iter().zip(values).all(same);
                kind == other && text == words && alike
            }
            (StepKind::Coolant(on, a), StepKind::Coolant(is, b)) => {
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

/// How far rounded end points of moves that go together may be apart, mm or degrees.
pub(super) const ROUNDED: f64 = 0.0025;

/// Whether a move stands on the line of the hole's feed, as far above the hole's bottom as before.
pub(super) fn is_as_far_above(
    (old, feed_old): (&Step, &Step),
    (new, feed_new): (&Step, &Step),
    deeper: f64,
) -> bool {
    let is_on_line = old.is_on_line_of(feed_old) && new.is_on_line_of(feed_new);
    let above = new.distance(feed_new) - old.distance(feed_old) - deeper;
    is_on_line && above.abs() <= ROUNDED
}

/// The same curve about the same centre.
pub(super) fn is_same_arc(a: &PlanarArc, b: &PlanarArc, tolerance: f64) -> bool {
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
    dot(way, way).sqrt()
}

/// All axes as equal numbers.
pub(super) fn dot(a: &Position, b: &Position) -> f64 {
    (0..MAX_AXES).map(|axis| a[axis] * b[axis]).sum()
}

pub(super) fn near(a: &Position, b: &Position, tolerance: f64) -> bool {
    (0..MAX_AXES).all(|axis| (a[axis] - b[axis]).abs() <= tolerance)
}
