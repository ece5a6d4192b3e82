//! What a G code is to those that don't execute it: its words, what it makes of axis words, how it stands to lookahead and to
//! transforms of the coordinates.

/// Letters of addresses as bits, A the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Letters(u32);

impl Letters {
    /// No letter.
    pub const NONE: Self = Self(0);

    /// These letters, A to Z.
    pub const fn of(letters: &[u8]) -> Self {
        let (mut bits, mut place) = (0, 0);
        while place < letters.len() {
            bits |= 1 << (letters[place] - b'A');
            place += 1;
        }
        Self(bits)
    }

    /// The letters as bits, A the lowest.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether a letter is one of them.
    pub const fn has(self, letter: u8) -> bool {
        letter.is_ascii_uppercase() && self.0 >> (letter - b'A') & 1 == 1
    }
}

/// What a code makes of the axis words of its block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisWords {
    /// They are a move by the modal codes.
    Move,
    /// A drilling cycle: they are a hole.
    Hole,
    /// The axes end at a place that doesn't depend on where they stood.
    Position,
    /// In G90 they end where the words say; in G91 that depends on where they stood.
    PositionInAbsolute,
    /// Offsets or parameters: nothing moves, and coordinates stay what they are.
    Tables,
    /// Coordinates, times, an intermediate point: where the axes end, the words alone don't say.
    Other,
}

/// What a control does with a code in a block that names no axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WithoutAxes {
    /// What it does with others: the code needs no axis.
    Same,
    /// Nothing, and a programmer hardly means that.
    Nothing,
    /// It takes the point where the program stands for the centre.
    CentreDefaulted,
    /// Some controls take all axes, others none.
    AllOrNothing,
}

/// Which words of a code's block are lengths, angles or seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measured {
    /// Axes, centres and radii, as in a move.
    AsInMove,
    /// Axes only: the other words are factors.
    Axes,
    /// What the table has that L names: axes of work offsets, R of tool offsets.
    ByTable,
    /// X and U, in seconds.
    Seconds,
    /// None.
    Nothing,
}

/// The words that belong to a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeWords {
    /// Letters that are refused in a block without such a code.
    pub own: Letters,
    /// Letters that may stand beside it and change nothing in a run.
    pub without_effect: Letters,
    /// Letters that are angles here and lengths elsewhere.
    pub angles: Letters,
    /// T must not stand beside it.
    pub refuses_tool: bool,
    /// Measured words.
    pub measured: Measured,
}

impl CodeWords {
    /// A code without words of its own.
    pub const NONE: Self = Self {
        own: Letters::NONE,
        without_effect: Letters::NONE,
        angles: Letters::NONE,
        refuses_tool: false,
        measured: Measured::AsInMove,
    };
}

/// Use of a code under cutter compensation and corner words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookaheadUse {
    /// Its block is one of the path, with a move or without.
    Path,
    /// Its block moves without compensation, and nothing is read before it is done.
    Suspends,
    /// It can't stand in cutter compensation here.
    Refused,
    /// It can't stand in cutter compensation on any control.
    Alarms,
    /// The one block that may stand between a corner word and the next move.
    Dwell,
    /// An arc at the corner before the next move.
    CornerArc,
}

/// Coordinate transforms under which a code is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateUse {
    /// All.
    Free,
    /// Not while G51 is on (operator's manual, scaling).
    NotScaled,
    /// Nor while G68 or G51.1 is on: reference returns and what changes the coordinate system (operator's manual, coordinate
    /// system rotation and programmable mirror image).
    NotTransformed,
}

/// Order of a block with the code relative to the moves before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timing {
    /// It is read while they are under way.
    ReadAhead,
    /// It is read once they are done.
    Waits,
    /// Like [`Timing::ReadAhead`]; the axis words move nothing.
    MovesNothing,
}

/// Effect of a code on a machine that the events of a run do not show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsimulated {
    /// Nothing: the events say it all.
    No,
    /// How exactly corners are cut or how far is read ahead, with the values of these letters.
    Path(Letters),
    /// The code itself, with the values of these letters.
    Code(Letters),
    /// It may change offsets or parameters.
    Writes,
}

/// All facts of one code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeFacts {
    /// Use of the axis words.
    pub axis_words: AxisWords,
    /// Meaning of a block without axis words.
    pub without_axes: WithoutAxes,
    /// Words that belong to the code.
    pub words: CodeWords,
    /// Use in lookahead.
    pub lookahead: LookaheadUse,
    /// Coordinate transforms under which the code is allowed.
    pub coordinates: CoordinateUse,
    /// Order relative to the moves before it.
    pub timing: Timing,
    /// Effect on a machine that the events of a run do not show.
    pub unsimulated: Unsimulated,
}

impl CodeFacts {
    /// Whether a block with the code says something beside its events that shows in its moves as well.
    pub const fn shows_in_moves(&self) -> bool {
        let moves =
            matches!(self.axis_words, AxisWords::Position | AxisWords::PositionInAbsolute | AxisWords::Other);
        moves && matches!(self.unsimulated, Unsimulated::Path(_) | Unsimulated::Code(_))
    }
}

use AxisWords::{Hole, Move, Other, Position, PositionInAbsolute, Tables};
use CoordinateUse::{Free, NotScaled, NotTransformed};
use LookaheadUse::{Alarms, CornerArc, Dwell, Path, Refused, Suspends};
use Timing::{MovesNothing, ReadAhead, Waits};
use WithoutAxes::{AllOrNothing, CentreDefaulted, Nothing, Same};

const VALUES: Letters = Letters::of(b"EIPQR");
const NO_LETTERS: Letters = Letters::NONE;

/// A modal code that changes what moves by other codes are.
pub(super) const MODAL: CodeFacts = CodeFacts {
    axis_words: Move,
    without_axes: Same,
    words: CodeWords::NONE,
    lookahead: Path,
    coordinates: Free,
    timing: ReadAhead,
    unsimulated: Unsimulated::No,
};

pub(super) const CYCLE: CodeFacts = CodeFacts { axis_words: Hole, ..MODAL };
pub(super) const WORK: CodeFacts = CodeFacts { coordinates: NotTransformed, ..MODAL };
pub(super) const MIRROR: CodeFacts = CodeFacts { without_axes: Nothing, ..MODAL };
pub(super) const SCALING_OFF: CodeFacts =
    CodeFacts { words: CodeWords { refuses_tool: true, ..CodeWords::NONE }, ..MODAL };
pub(super) const SCALING: CodeFacts = CodeFacts {
    without_axes: CentreDefaulted,
    words: CodeWords { measured: Measured::Axes, ..CodeWords::NONE },
    ..MODAL
};
pub(super) const ROTATION: CodeFacts = CodeFacts {
    without_axes: CentreDefaulted,
    words: CodeWords { angles: Letters::of(b"R"), ..CodeWords::NONE },
    ..MODAL
};
pub(super) const TILT: CodeFacts =
    CodeFacts { words: CodeWords { angles: Letters::of(b"IJK"), ..CodeWords::NONE }, ..MODAL };

/// A code that a run reads and that changes nothing in it.
pub(super) const WITHOUT_EFFECT: CodeFacts = CodeFacts {
    words: CodeWords { without_effect: Letters::of(b"IPQR"), ..CodeWords::NONE },
    unsimulated: Unsimulated::Code(VALUES),
    ..MODAL
};
pub(super) const EXACT_STOP: CodeFacts =
    CodeFacts { unsimulated: Unsimulated::Path(NO_LETTERS), ..WITHOUT_EFFECT };
pub(super) const CONTOUR_CONTROL: CodeFacts =
    CodeFacts { unsimulated: Unsimulated::Path(VALUES), ..WITHOUT_EFFECT };
pub(super) const SMOOTH_CONTOUR_CONTROL: CodeFacts =
    CodeFacts { words: CodeWords { measured: Measured::Nothing, ..WITHOUT_EFFECT.words }, ..CONTOUR_CONTROL };
pub(super) const LOOK_AHEAD: CodeFacts = CodeFacts { unsimulated: Unsimulated::Path(VALUES), ..MODAL };
pub(super) const SMOOTHNESS: CodeFacts = CodeFacts {
    words: CodeWords { own: Letters::of(b"E"), without_effect: Letters::of(b"EP"), ..CodeWords::NONE },
    ..LOOK_AHEAD
};
pub(super) const TOOL_OFFSET: CodeFacts = CodeFacts { lookahead: Alarms, ..MODAL };

pub(super) const DWELL: CodeFacts = CodeFacts {
    axis_words: Other,
    without_axes: Same,
    words: CodeWords {
        own: Letters::of(b"U"),
        refuses_tool: true,
        measured: Measured::Seconds,
        ..CodeWords::NONE
    },
    lookahead: Dwell,
    coordinates: Free,
    timing: Waits,
    unsimulated: Unsimulated::No,
};
pub(super) const DATA_INPUT: CodeFacts = CodeFacts {
    axis_words: Tables,
    without_axes: Same,
    words: CodeWords {
        own: Letters::of(b"L"),
        refuses_tool: true,
        measured: Measured::ByTable,
        ..CodeWords::NONE
    },
    lookahead: Path,
    coordinates: Free,
    timing: Waits,
    unsimulated: Unsimulated::Writes,
};
pub(super) const DATA_INPUT_END: CodeFacts = CodeFacts {
    axis_words: Other,
    without_axes: Same,
    words: CodeWords::NONE,
    lookahead: Path,
    coordinates: Free,
    timing: ReadAhead,
    unsimulated: Unsimulated::No,
};

/// G30.
pub(super) const SECOND_REFERENCE: CodeFacts = CodeFacts {
    axis_words: Position,
    without_axes: Nothing,
    words: CodeWords::NONE,
    lookahead: Suspends,
    coordinates: NotTransformed,
    timing: ReadAhead,
    unsimulated: Unsimulated::Code(Letters::of(b"P")),
};
pub(super) const CHECK_REFERENCE: CodeFacts =
    CodeFacts { unsimulated: Unsimulated::Code(NO_LETTERS), ..SECOND_REFERENCE };
pub(super) const REFERENCE: CodeFacts = CodeFacts { without_axes: AllOrNothing, ..CHECK_REFERENCE };
pub(super) const FROM_REFERENCE: CodeFacts = CodeFacts { axis_words: Other, ..CHECK_REFERENCE };

pub(super) const SKIP: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    without_axes: Nothing,
    words: CodeWords::NONE,
    lookahead: Suspends,
    coordinates: Free,
    timing: Waits,
    unsimulated: Unsimulated::No,
};
pub(super) const MACHINE_SYSTEM: CodeFacts = CodeFacts { coordinates: NotTransformed, ..SKIP };
pub(super) const ONE_SIDE: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    without_axes: Nothing,
    words: CodeWords::NONE,
    lookahead: Refused,
    coordinates: NotScaled,
    timing: ReadAhead,
    unsimulated: Unsimulated::Path(NO_LETTERS),
};
/// G52, G92 and G92.1.
pub(super) const SET_SYSTEM: CodeFacts = CodeFacts {
    axis_words: Other,
    without_axes: Nothing,
    words: CodeWords::NONE,
    lookahead: Path,
    coordinates: NotTransformed,
    timing: MovesNothing,
    unsimulated: Unsimulated::Writes,
};
pub(super) const CORNER_ARC: CodeFacts = CodeFacts {
    axis_words: Other,
    without_axes: Same,
    words: CodeWords::NONE,
    lookahead: CornerArc,
    coordinates: NotScaled,
    timing: ReadAhead,
    unsimulated: Unsimulated::No,
};
/// G12, G13, G70 and G71 of a Haas.
pub(super) const PATTERN: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    without_axes: Same,
    words: CodeWords { own: Letters::of(b"L"), ..CodeWords::NONE },
    lookahead: Path,
    coordinates: NotScaled,
    timing: ReadAhead,
    unsimulated: Unsimulated::No,
};
