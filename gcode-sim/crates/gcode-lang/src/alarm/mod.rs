//! What stops a control: each alarm a fact, its number and wording in one table (`table.rs`).
//!
//! Numbers and triggers follow the alarm list of the 30i / 0i-F class; the wording is ours.
mod table;
mod typos;

use crate::source::{Span, Spanned};

pub use typos::remedy;

/// The control's own name for an alarm: `PS0112`, `MC3001`, `OT0500`; `SIM…` where the simulator, not the
/// control, cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AlarmCode {
    Ps(u16),
    Mc(u16),
    Ot(u16),
    Sim(u16),
}

impl AlarmCode {
    pub fn number(self) -> u32 {
        match self {
            Self::Ps(n) | Self::Mc(n) | Self::Ot(n) | Self::Sim(n) => u32::from(n),
        }
    }
}

impl std::fmt::Display for AlarmCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Ps(n) => write!(f, "PS{n:04}"),
            Self::Mc(n) => write!(f, "MC{n:04}"),
            Self::Ot(n) => write!(f, "OT{n:04}"),
            Self::Sim(n) => write!(f, "SIM{n:04}"),
        }
    }
}

/// Why the control stops. Variants carry facts; `table.rs` has the sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum Alarm {
    TooManyDigits,
    /// Text that is neither address and number nor a macro word.
    NotAWord {
        text: String,
    },
    /// Letters in lower case, where the control takes capitals only.
    LowerCase,
    /// `WH`, `GO`, where the control wants the whole word.
    ShortWord,
    /// A `;`, and behind it what could be a block or a remark.
    TwoBlocksInOneLine,
    NoDataAfterAddress {
        letter: char,
    },
    /// A code without a word that it needs.
    MissingWord {
        code: &'static str,
        letter: char,
    },
    /// A pattern of holes without a drilling cycle.
    NoCycle {
        code: &'static str,
    },
    IllegalMinus {
        letter: char,
    },
    IllegalPoint {
        letter: Option<char>,
    },
    ImproperAddress {
        letter: char,
    },
    ImproperGCode {
        code: String,
    },
    FeedZero,
    /// F is per revolution, and S is 0.
    NoSpeedForFeed,
    /// R of an arc against half the distance of its ends, mm.
    RadiusTooSmall {
        radius: f64,
        half_chord: f64,
    },
    RadiusTolerance {
        start: f64,
        end: f64,
        tolerance: f64,
    },
    PlaneSelect,
    NoRadiusOrCentre,
    ArcFeedZero,
    OffsetNumber {
        number: i64,
    },
    OffsetValue {
        value: f64,
    },
    /// G41, G42: inside a corner the two paths of the tool's centre don't meet.
    NoIntersection,
    ArcAtStartOrEnd,
    SkipInCompensation,
    /// G31 without a signal, where the control is set to mind.
    SkipMissed,
    /// How far a probe is pushed, and how far it gives, in mm.
    StylusBroken {
        deflection: f64,
        overtravel_limit: f64,
    },
    /// G31 P or G04 Q other than 1 to 4.
    SkipSignals {
        letter: char,
    },
    /// G31 Q other than 1 to 99.
    SkipTorque,
    /// G93 wants F in every cutting block.
    NoInverseTime,
    /// A code that changes the coordinate system or goes to the reference position, in G51.
    CodeInScaling {
        code: String,
    },
    PlaneInCompensation,
    /// `,R` or `,C` where cutter compensation starts, ends or changes sides.
    CornerInStartUp,
    Interference,
    /// G45 to G48.
    ToolOffsetInCompensation,
    /// `,R` or `,C` in a block of G33.
    CornerInThread,
    /// Behind `,R` or `,C`.
    NoMoveAfterCorner,
    NoCutAfterCorner,
    /// Two corner words, or another letter behind a comma.
    CornerWords,
    /// A move is shorter than what `,R` or `,C` takes of it.
    CornerTooLarge,
    NotAtReference {
        letter: char,
    },
    TNotAllowed,
    ScaleRate {
        value: f64,
    },
    PlaneInRotation,
    NoIntermediatePoint,
    /// M00, M01, M02 or M30, and behind it another M code that takes its place.
    PluralM {
        first: u32,
        second: u32,
    },
    FileNotFound {
        name: String,
        /// What couldn't be read while it was looked for.
        read_error: Option<String>,
    },
    G10Format {
        what: String,
    },
    ReferenceReturnInCycle,
    NoPeckDepth,
    ReferenceReturnP {
        p: i64,
    },
    ProgramNumber,
    /// A call without P.
    ProgramNotNamed,
    /// M98 without P, where the control takes that for a bad name.
    NoNameInCall,
    ProgramNotFound {
        number: u32,
        /// What couldn't be read while it was looked for.
        read_error: Option<String>,
    },
    /// M198 of a file that isn't there.
    DeviceFileNotFound {
        number: u32,
        /// What couldn't be read while it was looked for.
        read_error: Option<String>,
    },
    /// M198 in a program that M198 called.
    DeviceCallInDeviceCall,
    TooManyCalls {
        limit: usize,
    },
    SequenceNumberNotFound {
        number: u32,
    },
    /// G08 with another P than 0 and 1.
    LookAheadFormat,
    IntegerOverflow,
    FloatOverflow,
    DivideByZero,
    Expression {
        text: String,
    },
    NoSuchVariable {
        number: i64,
    },
    WriteProtected {
        number: u32,
    },
    ReadProtected {
        number: u32,
    },
    TooManyBrackets,
    OutOfRange {
        function: String,
        value: f64,
    },
    NameFormat,
    /// AXNUM of what is no axis.
    AxisAddress {
        text: String,
    },
    /// A number that no axis has.
    AxisNumber {
        number: i64,
    },
    /// A block between G10 L52 and G11.
    ParameterFormat {
        what: String,
    },
    DrillingAxis,
    TooManyMacroCalls {
        limit: usize,
    },
    MissingEnd {
        number: u8,
    },
    MissingDo {
        number: u8,
    },
    MacroFormat {
        what: String,
    },
    LoopNumber {
        number: i64,
    },
    MixedStatements,
    JumpTargetNotFound {
        number: u32,
    },
    GAsArgument,
    TwoSubprogramCalls,
    TwoMacroCalls,
    /// Words beside M99 while a modal macro call waits.
    WordsWithReturn {
        letter: char,
    },
    TooManyArgumentSets,
    CancelWithoutModalCall,
    /// A name that another tool offset memory has.
    VariableName {
        name: String,
    },
    /// The number in brackets behind a variable's name.
    Suffix {
        name: String,
    },
    NoVariableName {
        name: String,
    },
    RepeatedAddress {
        letter: char,
    },
    ArgumentFormat {
        function: String,
    },
    SequenceNumberRange {
        number: i64,
    },
    MissingOpenBracket,
    /// A comment stands where a value or `[` must, after an address or in an expression.
    RoundBrackets {
        letter: Option<char>,
    },
    /// `<=` and the like.
    RelationSymbol,
    MissingCloseBracket,
    MissingEquals,
    MissingComma,
    IfFormat,
    WhileFormat,
    SetNamesFormat,
    NameCharacter,
    NameTooLong {
        name: String,
    },
    PrintFormat,
    PositionOverflow {
        letter: char,
        value: f64,
    },
    EndOfRecord,
    /// A move beyond a stroke limit.
    Overtravel {
        letter: char,
        is_plus: bool,
        value: f64,
        limit: f64,
    },
    /// `#3000=n(TEXT)`: the program stops itself.
    UserAlarm {
        number: u16,
        text: String,
        /// MCA 6008#1: shown as MC n instead of MC 3000 + n.
        has_no_base: bool,
    },
    /// A code or function that a control may have and this simulator does not execute.
    NotSimulated {
        what: String,
    },
}

/// An alarm with its place. Nearly every step of a run hands on that there is none, so it takes no more than a pointer.
pub type LocatedAlarm = Box<Spanned<Alarm>>;

/// What the table says about an alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmRow {
    pub code: AlarmCode,
    pub message: String,
    /// One thing to do.
    pub help: Option<String>,
}

impl Alarm {
    pub fn code(&self) -> AlarmCode {
        self.row().code
    }

    #[cold]
    pub fn located_at(self, span: Span) -> LocatedAlarm {
        Box::new(Spanned::new(self, span))
    }
}

impl std::fmt::Display for Alarm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.row().message)
    }
}
