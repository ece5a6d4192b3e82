//! The seam between the control and the machine: what the control asks for, absolute, in machine coordinates,
//! in mm and degrees. Below this line there are no modes, no cycles, no inches and no variables.
use std::sync::Arc;

use crate::source::Span;
use crate::units::{Deg, MmPerMin, Rpm, Seconds};

/// How many axes a control can have here.
pub const MAX_AXES: usize = 8;

/// The place of an axis in the control's axis table, counted from 0 (the manuals count from 1).
pub type AxisIndex = usize;

/// The letters of a control's axes, axis 1 first: `#5001` is the first, `#5002` the second.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axes {
    letters: [u8; MAX_AXES],
    count: usize,
    /// The axis of each letter, [`Axes::NONE`] where it is none's.
    axis_of_letter: [u8; 256],
    /// The letters as bits, A the lowest.
    letter_bits: u32,
    /// The axes that turn as bits, axis 1 the lowest.
    rotary_bits: u32,
}

impl Axes {
    const NO_AXIS: u8 = MAX_AXES as u8;

    /// At most [`MAX_AXES`] letters; more are an error of the machine file and refused there.
    pub fn new(letters: &str) -> Option<Self> {
        let bytes = letters.as_bytes();
        let has_valid_letters = bytes.len() <= MAX_AXES && bytes.iter().all(|b| b"XYZABCUVW".contains(b));
        let has_unique_letters = bytes.iter().enumerate().all(|(i, b)| !bytes[..i].contains(b));
        (has_valid_letters && has_unique_letters).then(|| Self::from_letters(bytes))
    }

    fn from_letters(axis_letters: &[u8]) -> Self {
        let (mut letters, mut places, mut mask, mut rotary) = ([0; MAX_AXES], [Self::NO_AXIS; 256], 0, 0);
        for (axis, letter) in axis_letters.iter().enumerate() {
            letters[axis] = *letter;
            places[usize::from(*letter)] = axis as u8;
            mask |= 1 << (letter - b'A');
            rotary |= u32::from(matches!(letter, b'A' | b'B' | b'C')) << axis;
        }
        Self {
            letters,
            count: axis_letters.len(),
            axis_of_letter: places,
            letter_bits: mask,
            rotary_bits: rotary,
        }
    }

    /// The axis of an address.
    #[inline]
    pub fn find(&self, letter: u8) -> Option<AxisIndex> {
        let axis = usize::from(self.axis_of_letter[usize::from(letter)]);
        (axis < MAX_AXES).then_some(axis)
    }

    pub fn letter(&self, axis: AxisIndex) -> char {
        self.letters[..self.count].get(axis).map_or('?', |l| char::from(*l))
    }

    /// A B C turn; all others slide.
    pub fn is_rotary(&self, axis: AxisIndex) -> bool {
        axis < MAX_AXES && self.rotary_bits >> axis & 1 == 1
    }

    pub fn len(&self) -> usize {
        self.count
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The letters as bits, A the lowest.
    pub fn letter_bits(&self) -> u32 {
        self.letter_bits
    }

    pub fn iter(&self) -> impl Iterator<Item = (AxisIndex, char)> + '_ {
        self.letters().map(|(axis, letter)| (axis, char::from(letter)))
    }

    /// The axes with the letters of their addresses.
    pub fn letters(&self) -> impl Iterator<Item = (AxisIndex, u8)> + '_ {
        self.letters[..self.count].iter().copied().enumerate()
    }
}

impl Default for Axes {
    /// X Y Z A B C: axis 1 to 6 of the default control.
    fn default() -> Self {
        Self::from_letters(b"XYZABC")
    }
}

/// One number per axis: mm for those that slide, degrees for those that turn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Position(pub [f64; MAX_AXES]);

impl PartialEq for Position {
    /// All places are looked at, whichever differs: several are compared at a time.
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

/// One call on the way to a block: the block that called, and the call it was itself made from.
#[derive(Debug, PartialEq)]
pub struct Call {
    /// The calling block (`G65 P8101 …`).
    pub calling_block: Span,
    pub outer_calls: CallChain,
}

/// The chain of calls that led to a block, innermost first; `None` in the main program.
pub type CallChain = Option<Arc<Call>>;

/// Where an event comes from: the block, and the calls that led to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backtrace {
    pub block: Span,
    pub calls: CallChain,
}

/// What the machine is told by one block, or by one step of a cycle.
#[derive(Clone, Debug)]
pub struct Event<'a> {
    pub kind: &'a EventKind,
    /// How long it takes: path over feed, rapid rates of the control's parameters, no acceleration.
    pub seconds: Seconds,
    pub block: Span,
    pub calls: &'a CallChain,
}

impl Event<'_> {
    pub fn backtrace(&self) -> Backtrace {
        Backtrace { block: self.block, calls: self.calls.clone() }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum EventKind {
    /// Every axis at its rapid rate, taken as one straight segment in axis space.
    Rapid {
        to: Position,
    },
    /// All axes linear together.
    Feed {
        to: Position,
        rate: MmPerMin,
    },
    /// A circle in the plane of two axes while all others move linearly.
    Arc {
        to: Position,
        arc: PlanarArc,
        rate: MmPerMin,
    },
    /// G31: a feed that ended at `to`, where the signal came or at its end.
    Skip {
        to: Position,
        rate: MmPerMin,
        has_signal: bool,
    },
    Dwell {
        time: Seconds,
    },
    /// M06: this tool is in the spindle now.
    ToolChange {
        number: u32,
    },
    /// The tool length offset that is part of every machine position from now on, or what it comes of, is another; moves
    /// nothing itself.
    ToolLength {
        offset: Position,
        compensation: LengthCompensation,
    },
    /// From the next move's end on these axes stand where G28, G30 or G53 sends them, as bits, axis 1 the lowest, while
    /// nothing has set the work offset in effect: where that is on the part isn't known. Moves nothing itself.
    WorkZeroUnknown {
        axes: u8,
    },
    Spindle {
        direction: SpindleDirection,
        speed: Rpm,
    },
    /// M07 and M08 switch it on, M09 off.
    Coolant {
        is_on: bool,
        code: u32,
    },
    /// An M code for the machine builder's logic: what it does isn't simulated.
    Auxiliary {
        code: u32,
    },
    /// The program waits for the operator.
    Stop {
        kind: StopKind,
        text: String,
        variables: Vec<(u32, f64)>,
    },
}

impl EventKind {
    /// Where a move ends; `None` for what moves nothing.
    pub fn end(&self) -> Option<&Position> {
        match self {
            Self::Rapid { to } | Self::Feed { to, .. } | Self::Arc { to, .. } | Self::Skip { to, .. } => {
                Some(to)
            }
            Self::Dwell { .. }
            | Self::ToolChange { .. }
            | Self::ToolLength { .. }
            | Self::WorkZeroUnknown { .. }
            | Self::Spindle { .. }
            | Self::Coolant { .. }
            | Self::Auxiliary { .. }
            | Self::Stop { .. } => None,
        }
    }
}

/// An arc of [`EventKind::Arc`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarArc {
    /// The two axes of the plane, in its right-handed order: X Y, Z X or Y Z.
    pub plane: (AxisIndex, AxisIndex),
    /// The centre in machine coordinates, in the order of `plane`.
    pub centre: (f64, f64),
    /// The angle swept; positive is counterclockwise seen from the plane's positive third axis.
    pub sweep: Deg,
}

/// What a tool length offset comes of: G43 or G44, and the H with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum LengthCompensation {
    #[default]
    Off,
    Plus(u32),
    Minus(u32),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleDirection {
    #[default]
    Off,
    Clockwise,
    Counterclockwise,
}

/// Why the program waits. `#3006=1(TEXT)` is [`StopKind::Message`]; its event names the variables that the text
/// names (`#149`) with the values they had, so that the simulated operator can do what the message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopKind {
    M00,
    M01,
    Message,
}

impl StopKind {
    /// As a program writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::M00 => "M00",
            Self::M01 => "M01",
            Self::Message => "#3006",
        }
    }
}

/// A straight cut that a skip signal may end: G31, before it moves.
#[derive(Clone, Copy, Debug)]
pub struct SkipMove<'a> {
    pub from: &'a Position,
    pub to: &'a Position,
    pub rate: MmPerMin,
    /// For the whole way.
    pub seconds: Seconds,
}

/// Whether the skip signal comes; places are parts of the way, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SkipSignal {
    /// The motion goes to its end.
    Missed,
    Received {
        /// Where the control notes the position.
        latched: f64,
        /// Where the axes stand still: there, or farther on.
        stop_fraction: f64,
    },
    /// The probe is pushed farther than it gives, in mm.
    StylusBroken { stopped: f64, deflection: f64, overtravel_limit: f64 },
}

/// Who is told what the machine does: of each event once, in order.
pub trait EventSink {
    fn event(&mut self, event: &Event<'_>);

    /// Whether anybody listens. Where nobody does, plain moves are counted and not told.
    fn is_active(&self) -> bool {
        true
    }

    /// Where the skip signal comes on a way that is about to be gone. `None`: here nothing gives such a signal.
    fn skip_signal(&mut self, _: &SkipMove<'_>) -> Option<SkipSignal> {
        None
    }
}

/// Nobody listens: only the control's end state is asked for.
impl EventSink for () {
    fn event(&mut self, _: &Event<'_>) {}

    fn is_active(&self) -> bool {
        false
    }
}

/// Two listeners side by side; the first that can answer does.
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

/// A listener that may be there.
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
