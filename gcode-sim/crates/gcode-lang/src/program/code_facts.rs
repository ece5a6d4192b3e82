//! Facts of G codes for readers that do not execute them: words, use of axis words, lookahead, transforms, timing.

/// Set of address letters, one bit each, A the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Letters(u32);

impl Letters {
    /// No letter.
    pub const NONE: Self = Self(0);

    /// Returns the set of some letters A to Z.
    pub const fn of(letters: &[u8]) -> Self {
        let (mut bits, mut index) = (0, 0);
        while index < letters.len() {
            bits |= 1 << (letters[index] - b'A');
            index += 1;
        }
        Self(bits)
    }

    /// Returns the bits of the set, A the lowest.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Returns true if the letter is in the set.
    pub const fn has(self, letter: u8) -> bool {
        letter.is_ascii_uppercase() && self.0 >> (letter - b'A') & 1 == 1
    }
}

/// Use that a code makes of the axis words of its block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisWords {
    /// Move by the modal codes.
    Move,
    /// Hole of a canned cycle.
    Hole,
    /// End position that does not depend on the start position.
    Position,
    /// End position in G90; in G91 the end depends on the start position.
    PositionInAbsolute,
    /// Offsets or parameters; no axis moves.
    Tables,
    /// Coordinates, times or an intermediate point; the words alone do not determine the end position.
    Other,
}

/// Behaviour of a code in a block that names no axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WithoutAxes {
    /// Normal: the code needs no axis.
    Same,
    /// No effect, which is rarely intended.
    Nothing,
    /// Wait for the motion before it, if the block is written without an axis; no effect if its axes are vacant.
    Waits,
    /// The current position is the centre.
    CentreDefaulted,
    /// All axes on some controls, no effect on others.
    AllOrNothing,
}

/// Words of a block that are lengths, angles or seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measured {
    /// Axes, centres and radii, as in a move.
    AsInMove,
    /// Axes only; the other words are factors.
    Axes,
    /// Values of the table that L selects: axes of work offsets, R of tool offsets.
    ByTable,
    /// X and U, in seconds.
    Seconds,
    /// None.
    Nothing,
}

/// Words that belong to a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeWords {
    /// Letters that a control refuses in a block without such a code.
    pub own: Letters,
    /// Letters permitted beside the code and without effect in a run.
    pub without_effect: Letters,
    /// Letters that are angles beside the code and lengths elsewhere.
    pub angles: Letters,
    /// True if a control refuses T in the same block.
    pub refuses_tool: bool,
    /// Words that are lengths, angles or seconds.
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

/// Effect of a code on cutter compensation and corner words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookaheadUse {
    /// The block is part of the path, with or without a move.
    Path,
    /// The block moves without compensation and ends lookahead.
    Suspends,
    /// The simulator does not execute the code in cutter compensation.
    Refused,
    /// A control raises an alarm for the code in cutter compensation.
    Alarms,
    /// Dwell: one such block may stand between a corner word and the next move.
    Dwell,
    /// Arc at the corner before the next move.
    CornerArc,
    /// The block waits for the end of the moves before it, as M00 does.
    Blocks,
}

/// Transforms of coordinates under which a code is permitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateUse {
    /// Any transform.
    Free,
    /// Any but G51 (operator's manual, scaling).
    NotScaled,
    /// None of G51, G68 and G51.1, as for reference returns and changes of the coordinate system (operator's
    /// manual, coordinate system rotation and programmable mirror image).
    NotTransformed,
}

/// Order of a block relative to the preceding moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timing {
    /// The block is read while they are in progress.
    ReadAhead,
    /// The block waits for their end.
    Waits,
    /// As [`Timing::ReadAhead`]; its axis words move no axis.
    MovesNothing,
}

/// Effect on a machine that the events of a run do not show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsimulated {
    /// None.
    No,
    /// Corner accuracy or lookahead, with the values of these letters.
    Path(Letters),
    /// Effect of the code itself, or of an offset that may be 0 in a run, with the values of these letters.
    Code(Letters),
    /// Possible change of offsets or parameters.
    Writes,
}

/// Facts of one code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeFacts {
    /// Use of axis words.
    pub axis_words: AxisWords,
    /// Behaviour without axis words.
    pub without_axes: WithoutAxes,
    /// Other words.
    pub words: CodeWords,
    /// Effect on lookahead.
    pub lookahead: LookaheadUse,
    /// Permitted transforms.
    pub coordinates: CoordinateUse,
    /// Order relative to preceding moves.
    pub timing: Timing,
    /// Effect on a machine that the events do not show.
    pub unsimulated: Unsimulated,
    /// True for a code that some machine builders add.
    pub is_of_builder: bool,
    /// True for a code that is a turning cycle on a lathe.
    pub is_turning_cycle: bool,
}

use AxisWords::{Hole, Move, Other, Position, PositionInAbsolute, Tables};
use CoordinateUse::{Free, NotScaled, NotTransformed};
use LookaheadUse::{Alarms, Blocks, CornerArc, Dwell, Path, Refused, Suspends};
use Timing::{MovesNothing, ReadAhead, Waits};
use WithoutAxes::{AllOrNothing, CentreDefaulted, Nothing, Same};

const VALUES: Letters = Letters::of(b"EIPQR");
const NO_LETTERS: Letters = Letters::NONE;

/// Modal code.
pub(super) const MODAL: CodeFacts = CodeFacts {
    axis_words: Move,
    without_axes: Same,
    words: CodeWords::NONE,
    lookahead: Path,
    coordinates: Free,
    timing: ReadAhead,
    unsimulated: Unsimulated::No,
    is_of_builder: false,
    is_turning_cycle: false,
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
    CodeFacts { words: CodeWords { angles: Letters::of(b"IJKR"), ..CodeWords::NONE }, ..MODAL };

/// Mode that takes no words and has no effect in a run.
pub(super) const MODE_WITHOUT_EFFECT: CodeFacts =
    CodeFacts { unsimulated: Unsimulated::Code(NO_LETTERS), ..MODAL };

/// Code with words and without effect in a run.
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
/// Accuracy mode of some machine builders, with the values of its words.
pub(super) const ACCURACY_MODE: CodeFacts = CodeFacts { is_of_builder: true, ..SMOOTH_CONTOUR_CONTROL };
pub(super) const LOOK_AHEAD: CodeFacts = CodeFacts { unsimulated: Unsimulated::Path(VALUES), ..MODAL };
pub(super) const SMOOTHNESS: CodeFacts = CodeFacts {
    words: CodeWords { own: Letters::of(b"E"), without_effect: Letters::of(b"EP"), ..CodeWords::NONE },
    ..LOOK_AHEAD
};
/// Code that the user declares to be without effect, with all its words.
pub(super) const DECLARED: CodeFacts = CodeFacts {
    words: CodeWords {
        own: Letters::of(b"ABCELOUVW"),
        without_effect: Letters::of(b"ABCEIJKLOPQRUVW"),
        ..CodeWords::NONE
    },
    unsimulated: Unsimulated::Code(Letters::of(b"IJKPQR")),
    ..MODAL
};
pub(super) const DECLARED_WAIT: CodeFacts = CodeFacts { lookahead: Blocks, timing: Waits, ..DECLARED };

/// Code of group 00: axis words are not a move.
const ONE_SHOT: CodeFacts = CodeFacts { axis_words: Other, ..MODAL };

/// G45 to G48.
pub(super) const TOOL_OFFSET: CodeFacts = CodeFacts {
    without_axes: Nothing,
    lookahead: Alarms,
    coordinates: NotTransformed,
    unsimulated: Unsimulated::Code(Letters::of(b"D")),
    ..ONE_SHOT
};
pub(super) const DWELL: CodeFacts = CodeFacts {
    words: CodeWords {
        own: Letters::of(b"U"),
        refuses_tool: true,
        measured: Measured::Seconds,
        ..CodeWords::NONE
    },
    lookahead: Dwell,
    timing: Waits,
    ..ONE_SHOT
};
pub(super) const DATA_INPUT: CodeFacts = CodeFacts {
    axis_words: Tables,
    words: CodeWords {
        own: Letters::of(b"L"),
        refuses_tool: true,
        measured: Measured::ByTable,
        ..CodeWords::NONE
    },
    timing: Waits,
    unsimulated: Unsimulated::Writes,
    ..ONE_SHOT
};
/// G10.6.
pub(super) const RETRACT_POINT: CodeFacts = CodeFacts { axis_words: Tables, ..ONE_SHOT };
pub(super) const DATA_INPUT_END: CodeFacts = ONE_SHOT;

/// G30.
pub(super) const SECOND_REFERENCE: CodeFacts = CodeFacts {
    axis_words: Position,
    without_axes: Nothing,
    lookahead: Suspends,
    coordinates: NotTransformed,
    unsimulated: Unsimulated::Code(Letters::of(b"P")),
    ..ONE_SHOT
};
pub(super) const CHECK_REFERENCE: CodeFacts =
    CodeFacts { unsimulated: Unsimulated::Code(NO_LETTERS), ..SECOND_REFERENCE };
pub(super) const REFERENCE: CodeFacts = CodeFacts { without_axes: AllOrNothing, ..CHECK_REFERENCE };
pub(super) const FROM_REFERENCE: CodeFacts = CodeFacts { axis_words: Other, ..CHECK_REFERENCE };

pub(super) const SKIP: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    without_axes: Nothing,
    words: CodeWords { measured: Measured::Axes, ..CodeWords::NONE },
    lookahead: Suspends,
    timing: Waits,
    ..ONE_SHOT
};
/// G266 of a Haas.
pub(super) const STRAIGHT_RAPID: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    without_axes: Nothing,
    words: CodeWords { own: Letters::of(b"E"), without_effect: Letters::of(b"E"), ..CodeWords::NONE },
    lookahead: Refused,
    ..ONE_SHOT
};
/// G35, G36, G37 and G136 of a Haas.
pub(super) const MEASURE: CodeFacts = CodeFacts {
    words: CodeWords::NONE,
    coordinates: NotTransformed,
    unsimulated: Unsimulated::Writes,
    ..SKIP
};
pub(super) const MACHINE_COORDINATE_SYSTEM: CodeFacts = CodeFacts {
    without_axes: WithoutAxes::Waits,
    coordinates: NotTransformed,
    unsimulated: Unsimulated::Code(NO_LETTERS),
    ..SKIP
};
/// G53.1.
pub(super) const TOOL_AXIS: CodeFacts = CodeFacts {
    lookahead: Refused,
    timing: Waits,
    unsimulated: Unsimulated::Code(Letters::of(b"P")),
    ..ONE_SHOT
};
pub(super) const SINGLE_DIRECTION: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    without_axes: Nothing,
    lookahead: Refused,
    coordinates: NotScaled,
    unsimulated: Unsimulated::Path(NO_LETTERS),
    ..ONE_SHOT
};
/// G52, G92 and G92.1.
pub(super) const SET_COORDINATE_SYSTEM: CodeFacts = CodeFacts {
    without_axes: Nothing,
    coordinates: NotTransformed,
    timing: MovesNothing,
    unsimulated: Unsimulated::Writes,
    ..ONE_SHOT
};
pub(super) const CORNER_ARC: CodeFacts =
    CodeFacts { lookahead: CornerArc, coordinates: NotScaled, ..ONE_SHOT };
/// G12 and G13 of a Haas.
pub(super) const CIRCLE_POCKET: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    words: CodeWords { own: Letters::of(b"L"), ..CodeWords::NONE },
    coordinates: NotScaled,
    unsimulated: Unsimulated::Code(Letters::of(b"D")),
    ..ONE_SHOT
};
/// G70 to G72 of a Haas.
pub(super) const BOLT_HOLES: CodeFacts =
    CodeFacts { is_turning_cycle: true, unsimulated: Unsimulated::No, ..CIRCLE_POCKET };
/// G174 and G184 of a Haas.
pub(super) const ASKEW_TAPPING: CodeFacts =
    CodeFacts { axis_words: PositionInAbsolute, lookahead: Refused, coordinates: NotScaled, ..ONE_SHOT };
/// G150 of a Haas.
pub(super) const POCKET: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    words: CodeWords { without_effect: Letters::of(b"IJKQ"), ..CodeWords::NONE },
    lookahead: Suspends,
    coordinates: NotScaled,
    unsimulated: Unsimulated::Code(Letters::of(b"IJKPQR")),
    ..ONE_SHOT
};
/// G12.1 and G13.1.
pub(super) const VIRTUAL_PLANE: CodeFacts = CodeFacts { lookahead: Refused, timing: Waits, ..MODAL };
/// G07.1, and G107 of a Haas.
pub(super) const CYLINDER: CodeFacts = CodeFacts {
    axis_words: Tables,
    lookahead: Refused,
    coordinates: NotTransformed,
    timing: Waits,
    ..ONE_SHOT
};
/// G54.2 and G54.4.
pub(super) const UNSTATED_OFFSET: CodeFacts = CodeFacts { coordinates: NotTransformed, ..MODAL };
/// G47 of a Haas.
pub(super) const ENGRAVING: CodeFacts = CodeFacts {
    axis_words: PositionInAbsolute,
    words: CodeWords { own: Letters::of(b"E"), angles: Letters::of(b"I"), ..CodeWords::NONE },
    lookahead: Refused,
    coordinates: NotScaled,
    unsimulated: Unsimulated::Code(Letters::of(b"P")),
    ..ONE_SHOT
};
