//! Steps of a run: moves and commands in a form in which two runs are compared.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::kinds;
use gcode_lang::diag::FindingKind;
use gcode_lang::motion::{MAX_AXES, PlanarArc, Position, SpindleDirection, StopKind};

/// A move or a command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<'a> {
    pub kind: &'a StepKind,
    /// Axis positions before and after it without the tool length offset: a longer tool is one difference, not one
    /// in every move.
    pub from: Position,
    pub to: Position,
    /// Axis positions after it, in machine coordinates.
    pub at: Position,
    /// Number of its block in the record.
    pub block_number: usize,
    /// Block of the T, S or F word that the step uses, if that is another; `None` in an earlier accepted result.
    pub set_by: Option<usize>,
    /// Number of its modal conditions in the record.
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
    Length(Box<Position>),
    Spindle(SpindleDirection, f64),
    /// On or off, and the M code; `None` in files that do not have it.
    Coolant(bool, Option<u32>),
    /// An M code for the machine builder's logic.
    Auxiliary(u32),
    /// With its text, and the values of the variables that the text names.
    Stop(StopKind, String, Vec<(u32, f64)>),
    /// A command without simulated effect, as written.
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

/// Name of a step of each kind, its change, and all of them in a list of what a record lacks.
pub(super) const UNSIMULATED: [(UnsimulatedKind, &str, &FindingKind, &str); 8] = [
    (UnsimulatedKind::Skip, "block skip", &kinds::BLOCK_SKIP, "block skips"),
    (UnsimulatedKind::Path, "G code", &kinds::PATH_MODE, "exact stops and look-ahead of single blocks"),
    (UnsimulatedKind::GCode, "G code", &kinds::G_CODE, "G codes without effect here"),
    (UnsimulatedKind::MCode, "M code", &kinds::M_CODE, "M codes without effect here"),
    (UnsimulatedKind::Tool, "tool call", &kinds::TOOL, "T without M06"),
    (UnsimulatedKind::Speed, "spindle speed", &kinds::SPINDLE, "S without M03 or M04"),
    (UnsimulatedKind::Switch, "switch", &kinds::SWITCH, "#3003 and #3004"),
    (UnsimulatedKind::Signal, "output signal", &kinds::SIGNAL, "output signals"),
];

impl StepKind {
    /// Returns the kind of a change of such a command, which can be paired with all commands of the same; `None`
    /// for a move.
    pub(super) fn change(&self) -> Option<&'static FindingKind> {
        self.names().1
    }

    /// Returns the name of such a step.
    pub(super) fn name(&self) -> &'static str {
        self.names().0
    }

    fn names(&self) -> (&'static str, Option<&'static FindingKind>) {
        match self {
            Self::Rapid => ("rapid", None),
            Self::Feed(_) => ("feed", None),
            Self::Arc(..) => ("arc", None),
            Self::Probe(_) => ("probing move", None),
            Self::Dwell(_) => ("dwell", Some(&kinds::DWELL)),
            Self::Tool(_) => ("tool change", Some(&kinds::TOOL)),
            Self::Length(_) => ("tool length offset", Some(&kinds::TOOL_LENGTH)),
            Self::Spindle(..) => ("spindle command", Some(&kinds::SPINDLE)),
            Self::Coolant(..) => ("coolant command", Some(&kinds::COOLANT)),
            Self::Auxiliary(_) => ("M code", Some(&kinds::M_CODE)),
            Self::Stop(..) => ("stop", Some(&kinds::STOP)),
            Self::Silent(what, _) => {
                let (_, name, kind, _) = UNSIMULATED[*what as usize];
                (name, Some(kind))
            }
        }
    }

    pub(super) fn is_move(&self) -> bool {
        matches!(self, Self::Rapid | Self::Feed(_) | Self::Arc(..) | Self::Probe(_))
    }

    /// Returns the feed of a cut, mm/min.
    pub(super) fn rate(&self) -> Option<f64> {
        match self {
            Self::Feed(rate) | Self::Arc(_, rate) | Self::Probe(rate) => Some(*rate),
            _ => None,
        }
    }

    /// Returns the letter of the word whose value the step uses, from its own block or an earlier one.
    pub(super) fn letter(&self) -> Option<char> {
        match self {
            Self::Tool(_) => Some('T'),
            Self::Spindle(direction, _) if *direction != SpindleDirection::Off => Some('S'),
            Self::Feed(_) | Self::Arc(..) | Self::Probe(_) => Some('F'),
            Self::Rapid
            | Self::Dwell(_)
            | Self::Length(_)
            | Self::Spindle(..)
            | Self::Coolant(..)
            | Self::Auxiliary(_)
            | Self::Stop(..)
            | Self::Silent(..) => None,
        }
    }

    /// Returns the name with its article.
    pub(super) fn one(&self) -> String {
        with_article(self.name())
    }
}

/// Returns a name with its article.
pub(super) fn with_article(name: &str) -> String {
    format!("{} {name}", if name.starts_with('a') { "an" } else { "a" })
}

impl Step<'_> {
    /// Returns the block to edit for another tool, speed or feed.
    pub(super) fn editable_at(&self) -> usize {
        self.set_by.unwrap_or(self.block_number)
    }

    pub(super) fn is_move(&self) -> bool {
        self.kind.is_move()
    }

    pub(super) fn is_rapid(&self) -> bool {
        *self.kind == StepKind::Rapid
    }

    /// Returns true for the same action, see [`is_same`].
    pub(super) fn is_same(&self, other: &Step<'_>, tolerance: f64) -> bool {
        is_same([self.kind, other.kind], tolerance, || [self.to, other.to])
    }

    /// Returns true for two moves of the same direction and length.
    pub(super) fn is_parallel(&self, other: &Step<'_>, tolerance: f64) -> bool {
        self.is_move() && other.is_move() && near(&self.displacement(), &other.displacement(), tolerance)
    }

    /// Returns true if the step ends on the line of `feed`.
    pub(super) fn is_on_line_of(&self, feed: &Step<'_>) -> bool {
        let (along, aside) = (feed.displacement(), difference(&self.to, &feed.to));
        let part = dot(&aside, &along) / dot(&along, &along).max(f64::MIN_POSITIVE);
        // Rounded end points are this far off an oblique line.
        (0..MAX_AXES).all(|axis| (aside[axis] - part * along[axis]).abs() <= 0.002)
    }

    /// Returns the distance between the end points of two steps, mm and degrees as equal numbers.
    pub(super) fn distance(&self, other: &Step<'_>) -> f64 {
        norm(&difference(&self.to, &other.to))
    }

    /// Returns the displacement from start to end.
    pub(super) fn displacement(&self) -> Position {
        difference(&self.to, &self.from)
    }

    /// Returns the straight distance from start to end, mm and degrees as equal numbers.
    pub(super) fn length(&self) -> f64 {
        norm(&self.displacement())
    }
}

/// Largest deviation of rounded end points of moves that are shifted together, mm or degrees.
pub(super) const ROUNDED: f64 = 0.0025;

/// Returns true if a move ends on the line of the hole's feed, as far above the bottom as before.
pub(super) fn is_as_far_above(
    (old, feed_old): (&Step<'_>, &Step<'_>),
    (new, feed_new): (&Step<'_>, &Step<'_>),
    deeper: f64,
) -> bool {
    let is_on_line = old.is_on_line_of(feed_old) && new.is_on_line_of(feed_new);
    let above = new.distance(feed_new) - old.distance(feed_old) - deeper;
    is_on_line && above.abs() <= ROUNDED
}

/// Returns true for the same action: a move of the same kind to the same point, at any feed. The ends of two moves are
/// asked for only if that needs them.
pub(super) fn is_same(kinds: [&StepKind; 2], tolerance: f64, ends: impl FnOnce() -> [Position; 2]) -> bool {
    let are_near = || {
        let [a, b] = ends();
        near(&a, &b, tolerance)
    };
    match kinds {
        [StepKind::Rapid, StepKind::Rapid]
        | [StepKind::Feed(_), StepKind::Feed(_)]
        | [StepKind::Probe(_), StepKind::Probe(_)] => are_near(),
        [StepKind::Arc(a, _), StepKind::Arc(b, _)] => is_same_arc(a, b, tolerance) && are_near(),
        [StepKind::Length(a), StepKind::Length(b)] => near(a, b, tolerance),
        [StepKind::Stop(kind, text, named), StepKind::Stop(other, words, values)] => {
            let same = |(a, b): (&(u32, f64), &(u32, f64))| a.0 == b.0 && (a.1 - b.1).abs() <= tolerance;
            let alike = named.len() == values.len() && named.iter().zip(values).all(same);
            kind == other && text == words && alike
        }
        [StepKind::Coolant(on, a), StepKind::Coolant(is, b)] => {
            on == is && (a.is_none() || b.is_none() || a == b)
        }
        [a, b] => a == b,
    }
}

/// Returns true for the same angle about the same centre.
pub(super) fn is_same_arc(a: &PlanarArc, b: &PlanarArc, tolerance: f64) -> bool {
    let off = (a.centre.0 - b.centre.0).abs().max((a.centre.1 - b.centre.1).abs());
    a.plane == b.plane && off <= tolerance && (a.sweep.0 - b.sweep.0).abs() <= 1e-3
}

/// Returns `to` less `from`, axis by axis.
pub(super) fn difference(to: &Position, from: &Position) -> Position {
    Position(std::array::from_fn(|axis| to[axis] - from[axis]))
}

fn norm(displacement: &Position) -> f64 {
    dot(displacement, displacement).sqrt()
}

/// Returns the scalar product, mm and degrees as equal numbers.
pub(super) fn dot(a: &Position, b: &Position) -> f64 {
    (0..MAX_AXES).map(|axis| a[axis] * b[axis]).sum()
}

pub(super) fn near(a: &Position, b: &Position, tolerance: f64) -> bool {
    (0..MAX_AXES).all(|axis| (a[axis] - b[axis]).abs() <= tolerance)
}
