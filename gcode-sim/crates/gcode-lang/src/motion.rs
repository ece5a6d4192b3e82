//! Interface between control and machine: absolute motion in machine coordinates, mm and degrees.
//!
//! Events carry no modes, cycles, inches or variables; the control has resolved them.
use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use crate::length_compensation::LengthCompensation;
use crate::source::Span;
use crate::units::{Deg, MmPerMin, Rpm, Seconds};
pub use crate::unknown_axes::UnknownAxes;

/// Largest number of axes of a control.
pub const MAX_AXES: usize = 8;

/// Index of an axis in the control's axis table, counted from 0 (the manuals count from 1).
pub type AxisIndex = usize;

/// Letters of a control's axes, axis 1 first: `#5001` refers to the first, `#5002` to the second.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axes {
    letters: [u8; MAX_AXES],
    count: usize,
    /// Axis of each letter, [`Axes::NO_AXIS`] if the letter names none.
    axis_of_letter: [u8; 256],
    /// Letters as bits, A the lowest.
    letter_bits: u32,
    /// Rotary axes as bits, axis 1 the lowest.
    rotary_bits: u32,
}

impl Axes {
    const NO_AXIS: u8 = MAX_AXES as u8;

    /// Creates the table from letters out of `XYZABCUVWE`; E is linear, as U, V and W.
    ///
    /// `None` if a letter is repeated, names no axis, or if there are more than [`MAX_AXES`].
    pub fn new(letters: &str) -> Option<Self> {
        let bytes = letters.as_bytes();
        let has_valid_letters = bytes.len() <= MAX_AXES && bytes.iter().all(|b| b"XYZABCUVWE".contains(b));
        let has_unique_letters = bytes.iter().enumerate().all(|(i, b)| !bytes[..i].contains(b));
        (has_valid_letters && has_unique_letters).then(|| Self::from_letters(bytes))
    }

    fn from_letters(axis_letters: &[u8]) -> Self {
        let (mut letters, mut axis_of_letter, mut mask, mut rotary) =
            ([0; MAX_AXES], [Self::NO_AXIS; 256], 0, 0);
        for (axis, letter) in axis_letters.iter().enumerate() {
            letters[axis] = *letter;
            axis_of_letter[usize::from(*letter)] = axis as u8;
            mask |= 1 << (letter - b'A');
            rotary |= u32::from(matches!(letter, b'A' | b'B' | b'C')) << axis;
        }
        Self { letters, count: axis_letters.len(), axis_of_letter, letter_bits: mask, rotary_bits: rotary }
    }

    /// Returns the axis with this letter.
    #[inline]
    pub fn find(&self, letter: u8) -> Option<AxisIndex> {
        let axis = usize::from(self.axis_of_letter[usize::from(letter)]);
        (axis < MAX_AXES).then_some(axis)
    }

    /// Returns the letter of an axis, `?` if there is no such axis.
    pub fn letter(&self, axis: AxisIndex) -> char {
        self.letters[..self.count].get(axis).map_or('?', |l| char::from(*l))
    }

    /// Returns true for A, B and C; all other axes are linear.
    pub fn is_rotary(&self, axis: AxisIndex) -> bool {
        axis < MAX_AXES && self.rotary_bits >> axis & 1 == 1
    }

    /// Returns the number of axes.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Returns true if the control has no axis.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the letters as bits, A the lowest.
    pub fn letter_bits(&self) -> u32 {
        self.letter_bits
    }

    /// Returns the letters of axes given as bits, as in `X, Y and Z`.
    pub fn names(&self, axes: u8) -> String {
        let named = self.iter().filter(|(axis, _)| axes >> axis & 1 == 1);
        let letters: Vec<_> = named.map(|(_, letter)| letter.to_string()).collect();
        match letters.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => letters.concat(),
        }
    }

    /// Iterates over the axes with their letters as characters.
    pub fn iter(&self) -> impl Iterator<Item = (AxisIndex, char)> + '_ {
        self.letters().map(|(axis, letter)| (axis, char::from(letter)))
    }

    /// Iterates over the axes with their letters as bytes.
    pub fn letters(&self) -> impl Iterator<Item = (AxisIndex, u8)> + '_ {
        self.letters[..self.count].iter().copied().enumerate()
    }
}

impl Default for Axes {
    /// X Y Z A B C as axes 1 to 6.
    fn default() -> Self {
        Self::from_letters(b"XYZABC")
    }
}

/// One coordinate per axis: mm for linear axes, degrees for rotary axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Position(pub [f64; MAX_AXES]);

impl PartialEq for Position {
    /// Compares all axes without an early exit, so that several are compared at a time.
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).fold(true, |same, (one, other)| same & (one == other))
    }
}

impl std::ops::Index<AxisIndex> for Position {
    type Output = f64;
    fn index(&self, axis: AxisIndex) -> &f64 {
        &self.0[axis]
    }
}

impl std::ops::IndexMut<AxisIndex> for Position {
    fn index_mut(&mut self, axis: AxisIndex) -> &mut f64 {
        &mut self.0[axis]
    }
}

/// One call in the chain that led to a block.
#[derive(Debug, PartialEq)]
pub struct Call {
    /// Calling block (`G65 P8101 …`).
    pub calling_block: Span,
    /// Calls that led to the calling block.
    pub outer_calls: CallChain,
}

/// Chain of calls that led to a block, innermost first; `None` in the main program.
pub type CallChain = Option<Arc<Call>>;

/// Origin of an event: the block and the calls that led to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backtrace {
    /// Executed block.
    pub block: Span,
    /// Calls that led to it.
    pub calls: CallChain,
}

/// Action of the machine, caused by one block or by one step of a cycle.
#[derive(Clone, Debug)]
pub struct Event<'a> {
    /// Action and its operands.
    pub kind: &'a EventKind,
    /// Duration: path over feed, rapid rates from the parameters, no acceleration.
    pub seconds: Seconds,
    /// Block that causes the action.
    pub block: Span,
    /// Calls that led to the block.
    pub calls: &'a CallChain,
}

impl Event<'_> {
    /// Returns the origin of the event as an owned value.
    pub fn backtrace(&self) -> Backtrace {
        Backtrace { block: self.block, calls: self.calls.clone() }
    }
}

/// Action of the machine.
#[derive(Clone, Debug, PartialEq)]
pub enum EventKind {
    /// Rapid move: each axis at its rapid rate, modelled as one straight segment in axis space.
    Rapid {
        /// End point.
        to: Position,
    },
    /// Linear feed move of all axes.
    Feed {
        /// End point.
        to: Position,
        /// Feed along the path.
        rate: MmPerMin,
    },
    /// Circular move in the plane of two axes; all other axes move linearly.
    Arc {
        /// End point.
        to: Position,
        /// Plane, centre and angle.
        arc: PlanarArc,
        /// Feed along the path.
        rate: MmPerMin,
    },
    /// G31: a feed move that ended at the skip signal or at its programmed end.
    Skip {
        /// Point where the motion ended.
        to: Position,
        /// Feed along the path.
        rate: MmPerMin,
        /// True if the skip signal ended the motion.
        has_signal: bool,
    },
    /// Pause without motion.
    Dwell {
        /// Length of the pause.
        time: Seconds,
    },
    /// T: the tool that the next M06 puts into the spindle; causes no motion.
    ToolSelected {
        /// Tool number.
        number: u32,
    },
    /// M06: the tool is now in the spindle.
    ToolChange {
        /// Tool number.
        number: u32,
    },
    /// Change of the tool length offset or of its source; causes no motion.
    ///
    /// The offset is part of every machine position from now on.
    ToolLength {
        /// Offset of each axis.
        offset: Position,
        /// Part of it that is wear: the deviation of the tool from its measured length.
        wear: Position,
        /// Code and offset number that the offset comes from.
        compensation: LengthCompensation,
    },
    /// Start of a run, before every other event.
    Start {
        /// Machine position of the axes; 0 for those that are unknown.
        at: Position,
        /// Axes whose position on the part is unknown, by cause.
        unknown: UnknownAxes,
    },
    /// Axes whose position on the part is unknown after the next move; causes no motion.
    ///
    /// It comes where the axes change, and is repeated in place of a move without travel.
    PositionUnknown {
        /// Axes by cause.
        axes: UnknownAxes,
    },
    /// Change of spindle direction or speed.
    Spindle {
        /// Direction, or off.
        direction: SpindleDirection,
        /// Speed.
        speed: Rpm,
        /// True in rigid tapping: the feed follows the angle of the spindle.
        is_rigid: bool,
        /// The spindle stops at its orientation angle: M19, or a cycle that shifts the tool.
        is_oriented: bool,
    },
    /// M07 and M08 switch the coolant on, M09 off.
    Coolant {
        /// New state.
        is_on: bool,
        /// Number of the M code.
        code: u32,
    },
    /// M code for the machine builder's logic; its effect is not simulated.
    Auxiliary {
        /// Number of the M code.
        code: u32,
    },
    /// Stop until the operator continues.
    Stop {
        /// Code that causes the stop.
        kind: StopKind,
        /// Message text; empty without one.
        text: String,
        /// Variables named in the text, with their values at the stop.
        variables: Vec<(u32, f64)>,
    },
}

impl EventKind {
    /// Returns the end point of a motion; `None` for an event without motion.
    pub fn end(&self) -> Option<&Position> {
        match self {
            Self::Rapid { to } | Self::Feed { to, .. } | Self::Arc { to, .. } | Self::Skip { to, .. } => {
                Some(to)
            }
            Self::Dwell { .. }
            | Self::ToolSelected { .. }
            | Self::ToolChange { .. }
            | Self::ToolLength { .. }
            | Self::Start { .. }
            | Self::PositionUnknown { .. }
            | Self::Spindle { .. }
            | Self::Coolant { .. }
            | Self::Auxiliary { .. }
            | Self::Stop { .. } => None,
        }
    }

    /// Returns the feed along the path; `None` for a rapid and for an event without motion.
    pub fn rate(&self) -> Option<MmPerMin> {
        match self {
            Self::Feed { rate, .. } | Self::Arc { rate, .. } | Self::Skip { rate, .. } => Some(*rate),
            _ => None,
        }
    }
}

/// Geometry of an [`EventKind::Arc`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarArc {
    /// The two axes of the plane in right-handed order: X Y, Z X or Y Z.
    pub plane: (AxisIndex, AxisIndex),
    /// Centre in machine coordinates, in the order of `plane`.
    pub centre: (f64, f64),
    /// Angle swept; positive is counterclockwise seen from the positive third axis of the plane.
    pub sweep: Deg,
}

/// State of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub enum SpindleDirection {
    #[default]
    /// Stopped.
    #[serde(rename = "off")]
    Off,
    /// Clockwise, M03.
    #[serde(rename = "M03")]
    Clockwise,
    /// Counterclockwise, M04.
    #[serde(rename = "M04")]
    Counterclockwise,
}

/// Cause of a stop.
///
/// The event of a message names the variables in its text (`#149`) with their values, so that a simulated
/// operator can follow the instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub enum StopKind {
    /// M00, program stop.
    M00,
    /// M01, optional stop.
    M01,
    /// `#3006=1(TEXT)`, stop with a message.
    #[serde(rename = "#3006")]
    Message,
}

impl StopKind {
    /// Returns the command as written in a program.
    pub fn name(self) -> &'static str {
        match self {
            Self::M00 => "M00",
            Self::M01 => "M01",
            Self::Message => "#3006",
        }
    }
}

/// Straight feed move of G31 before its execution.
#[derive(Clone, Copy, Debug)]
pub struct SkipMove<'a> {
    /// Start point.
    pub from: &'a Position,
    /// Programmed end point.
    pub to: &'a Position,
    /// Feed along the path.
    pub rate: MmPerMin,
    /// Duration of the whole path.
    pub seconds: Seconds,
}

/// Result of a G31 move; positions are fractions of the path, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SkipSignal {
    /// No signal: the motion goes to its end.
    Missed,
    /// The signal ends the motion.
    Received {
        /// Position that the control latches.
        latched: f64,
        /// Position where the axes stop: at the signal or beyond it.
        stop_fraction: f64,
    },
    /// The stylus is deflected beyond its overtravel.
    StylusBroken {
        /// Position where the axes stop.
        stopped: f64,
        /// Deflection, mm.
        deflection: f64,
        /// Largest permitted deflection, mm.
        overtravel_limit: f64,
    },
}

/// Receiver of the machine's events, each once and in order.
pub trait EventSink {
    /// Receives one event.
    fn event(&mut self, event: &Event<'_>);

    /// Returns false if events may be dropped; plain moves are then counted but not emitted.
    fn is_active(&self) -> bool {
        true
    }

    /// Returns where the skip signal ends a G31 move about to start; `None` if this sink gives no signal.
    fn skip_signal(&mut self, _: &SkipMove<'_>) -> Option<SkipSignal> {
        None
    }
}

/// Discards all events, for runs of which only the end state of the control is needed.
impl EventSink for () {
    fn event(&mut self, _: &Event<'_>) {}

    fn is_active(&self) -> bool {
        false
    }
}

/// Forwards each event to both sinks; the first skip signal counts.
impl<A: EventSink, B: EventSink> EventSink for (A, B) {
    fn event(&mut self, event: &Event<'_>) {
        self.0.event(event);
        self.1.event(event);
    }

    #[inline]
    fn is_active(&self) -> bool {
        self.0.is_active() || self.1.is_active()
    }

    fn skip_signal(&mut self, skip_move: &SkipMove<'_>) -> Option<SkipSignal> {
        self.0.skip_signal(skip_move).or_else(|| self.1.skip_signal(skip_move))
    }
}

/// Forwards to the sink if there is one.
impl<S: EventSink> EventSink for Option<S> {
    fn event(&mut self, event: &Event<'_>) {
        if let Some(sink) = self {
            sink.event(event);
        }
    }

    #[inline]
    fn is_active(&self) -> bool {
        self.as_ref().is_some_and(S::is_active)
    }

    fn skip_signal(&mut self, skip_move: &SkipMove<'_>) -> Option<SkipSignal> {
        self.as_mut().and_then(|sink| sink.skip_signal(skip_move))
    }
}

impl<S: EventSink + ?Sized> EventSink for &mut S {
    #[inline]
    fn is_active(&self) -> bool {
        (**self).is_active()
    }

    fn event(&mut self, event: &Event<'_>) {
        (**self).event(event);
    }

    fn skip_signal(&mut self, skip_move: &SkipMove<'_>) -> Option<SkipSignal> {
        (**self).skip_signal(skip_move)
    }
}
