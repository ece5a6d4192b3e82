//! Alarms that stop a control: each variant holds the facts, `table.rs` the number and wording.
//!
//! Numbers and triggers follow the alarm list of the 30i / 0i-F class; the wording is this project's own.
mod code;
mod digit_limit;
pub mod kinds;
mod lacking_code;
mod table;
mod typos;

use crate::source::{Span, Spanned};
pub use code::{AlarmCode, AlarmRow};
pub use digit_limit::DigitLimit;
pub use lacking_code::{OtherControl, lacking_code_help};
pub use typos::{missing_macro_help, missing_macros_help, remedy, repeats_in_p_help};

/// Reason for the stop of a control. Variants hold facts; `table.rs` has the sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum Alarm {
    /// A number has too many digits.
    TooManyDigits(DigitLimit),
    /// Text is neither a word nor a macro statement.
    NotAWord {
        /// First characters of the text.
        text: String,
    },
    /// The block has lower-case letters, which the control refuses.
    LowerCase,
    /// A keyword is abbreviated (`WH`, `GO`), which the control refuses.
    ShortWord,
    /// A block follows a `;` in its line.
    TwoBlocksInOneLine,
    /// An address has no number.
    NoDataAfterAddress {
        /// Letter of the address.
        letter: char,
    },
    /// A code lacks a word that it requires.
    MissingWord {
        /// The code.
        code: &'static str,
        /// Letter of the missing word.
        letter: char,
    },
    /// A tilted plane is commanded in a wrong form; the rule that it breaks.
    PlaneFormat(&'static str),
    /// G53.1 is commanded where it is not allowed; the rule that it breaks.
    ToolAxisCode(&'static str),
    /// G43.5 with I J K in its own block on a machine whose table turns.
    DirectionWithTipControl,
    /// No angles of the rotary axes point the tool along Z of the tilted plane.
    ToolAxisUnreachable,
    /// A function is commanded that the parameters of the machine rule out.
    MachineParameter(&'static str),
    /// A rotation in space is commanded in a wrong form; the rule that it breaks.
    SpaceRotation(&'static str),
    /// Polar coordinate interpolation is commanded in a wrong form; the rule that it breaks.
    PolarInterpolationFormat(&'static str),
    /// A code that polar coordinate interpolation excludes.
    CodeInPolarInterpolation(String),
    /// Cylindrical interpolation is commanded in a wrong form; the rule that it breaks.
    CylinderFormat(&'static str),
    /// A code that cylindrical interpolation excludes.
    CodeInCylinder(String),
    /// A pattern of holes has no canned cycle.
    NoCycle(&'static str),
    /// An address does not allow a minus sign.
    IllegalMinus {
        /// Letter of the address.
        letter: char,
    },
    /// A number has two signs.
    TwoSigns {
        /// Letter of the address.
        letter: char,
    },
    /// A system variable does not allow a negative value.
    NegativeVariable {
        /// Number of the variable.
        number: u32,
    },
    /// An address does not allow a decimal point, or a number has two.
    IllegalPoint {
        /// Letter of the address; `None` for a number with two points.
        letter: Option<char>,
    },
    /// An address is not allowed in its block.
    ImproperAddress {
        /// Letter of the address.
        letter: char,
    },
    /// The control has no such G code.
    ImproperGCode {
        /// Code without its letter.
        code: String,
        /// A control that has it.
        other: Option<OtherControl>,
    },
    /// A cutting feed has no feed rate.
    FeedZero,
    /// F is per revolution and S is 0.
    NoSpeedForFeed,
    /// R of an arc is less than half the distance of its ends.
    RadiusTooSmall {
        /// Specified radius, mm.
        radius: f64,
        /// Half the distance of the ends, mm.
        half_chord: f64,
    },
    /// The radii at the start and end of an arc differ too much.
    RadiusTolerance {
        /// Radius at the start, mm.
        start: f64,
        /// Radius at the end, mm.
        end: f64,
        /// Permitted difference, mm.
        tolerance: f64,
    },
    /// The centre of an arc is not in the selected plane.
    PlaneSelect,
    /// An arc has neither R nor I, J, K.
    NoRadiusOrCentre,
    /// An arc has no feed rate.
    ArcFeedZero,
    /// An offset number is out of range.
    OffsetNumber {
        /// Offset number.
        number: i64,
    },
    /// The value of an offset is out of range.
    OffsetValue {
        /// Value.
        value: f64,
    },
    /// In G41 or G42 the tool centre paths inside a corner do not intersect.
    NoIntersection,
    /// Cutter compensation starts or ends with an arc.
    ArcAtStartOrEnd,
    /// G31 is commanded in cutter compensation.
    SkipInCompensation,
    /// G31 ended without a signal, and the setting makes that an alarm.
    SkipMissed,
    /// A G31 with M78 got a skip signal.
    SkipReceived,
    /// The stylus is deflected beyond its overtravel.
    StylusBroken {
        /// Deflection, mm.
        deflection: f64,
        /// Largest permitted deflection, mm.
        overtravel_limit: f64,
    },
    /// G31 P or G04 Q is not 1 to 4.
    SkipSignals {
        /// Letter of the word.
        letter: char,
    },
    /// G31 Q is not 1 to 99.
    SkipTorque,
    /// A cutting block in G93 has no F.
    NoInverseTime,
    /// A code in G51 changes the coordinate system or moves to the reference position.
    CodeInScaling(String),
    /// The circular pocket of G12 or G13 is smaller than the tool.
    PocketTooSmall {
        /// Code.
        code: &'static str,
        /// Radius of the pocket, mm.
        radius: f64,
        /// Radius of the tool, mm.
        tool: f64,
    },
    /// A cycle taps in rigid mode (M29) while S is 0.
    NoSpeedInRigidTapping,
    /// An axis moves between M29 and the tapping cycle.
    MoveBeforeRigidTapping,
    /// The plane changes between M29 and the end of the cycle.
    PlaneInRigidTapping,
    /// The plane changes in cutter compensation.
    PlaneInCompensation,
    /// `,R` or `,C` is in a block where cutter compensation starts, ends or changes sides.
    CornerInStartUp,
    /// The tool centre path runs against the programmed path.
    Interference,
    /// G45 to G48 are commanded in cutter compensation.
    ToolOffsetInCompensation,
    /// `,R` or `,C` is in a block of G33.
    CornerInThread,
    /// No move in the plane follows `,R` or `,C`.
    NoMoveAfterCorner,
    /// The move after `,R` or `,C` is not G01, G02 or G03.
    NoCutAfterCorner,
    /// A block has two corner words, or another letter follows a comma.
    CornerWords,
    /// A move is shorter than the part that `,R` or `,C` replaces.
    CornerTooLarge,
    /// An axis is not at the reference position at G27.
    NotAtReference {
        /// Letter of the axis.
        letter: char,
    },
    /// T is in a block with G04, G10 or G50.
    TNotAllowed,
    /// The scaling factor is out of range.
    ScaleRate {
        /// Factor.
        value: f64,
    },
    /// The plane changes in coordinate system rotation.
    PlaneInRotation,
    /// No G28 with an intermediate point precedes G29.
    NoIntermediatePoint,
    /// Another M code follows M00, M01, M02 or M30 and replaces it.
    PluralM {
        /// Code that is replaced.
        first: u32,
        /// Code that replaces it.
        second: u32,
    },
    /// A program is not found by its name.
    FileNotFound {
        /// Name.
        name: String,
        /// Failure to read a file during the search.
        read_error: Option<String>,
    },
    /// A block of G10 has an error.
    G10Format {
        /// Description of the error.
        what: String,
    },
    /// G27 to G30 are commanded in a canned cycle.
    ReferenceReturnInCycle,
    /// G73 or G83 has no peck depth Q.
    NoPeckDepth,
    /// P of G30 is not 2, 3 or 4.
    ReferenceReturnP {
        /// Value of P.
        p: i64,
    },
    /// A program number is not 1 to 99999999.
    ProgramNumber,
    /// A call has no P.
    ProgramNotNamed,
    /// M98 has no P, and the control reports an invalid name.
    NoNameInCall,
    /// A program is not found by its number.
    ProgramNotFound {
        /// O number.
        number: u32,
        /// Failure to read a file during the search, or what else was found.
        read_error: Option<String>,
    },
    /// The file of M198 is not found.
    DeviceFileNotFound {
        /// O number.
        number: u32,
        /// Failure to read a file during the search.
        read_error: Option<String>,
    },
    /// M198 is commanded in a program that M198 called.
    DeviceCallInDeviceCall,
    /// Calls are nested too deeply.
    TooManyCalls {
        /// Permitted levels.
        limit: usize,
    },
    /// The sequence number of a return or call is not found.
    SequenceNumberNotFound {
        /// Sequence number.
        number: u32,
    },
    /// P of G08 is neither 0 nor 1.
    LookAheadFormat,
    /// A whole number is out of range.
    IntegerOverflow,
    /// The result of arithmetic is out of range.
    FloatOverflow,
    /// A divisor is 0.
    DivideByZero,
    /// An expression has an error.
    Expression {
        /// First characters from the error on.
        text: String,
    },
    /// The control has no such variable.
    NoSuchVariable {
        /// Number of the variable.
        number: i64,
    },
    /// A variable cannot be written.
    WriteProtected {
        /// Number of the variable.
        number: u32,
    },
    /// A variable cannot be read.
    ReadProtected {
        /// Number of the variable.
        number: u32,
    },
    /// Brackets are nested too deeply.
    TooManyBrackets,
    /// A function is undefined for its argument.
    OutOfRange {
        /// Name of the function.
        function: String,
        /// Argument.
        value: f64,
    },
    /// A program name has an error.
    NameFormat,
    /// The argument of AXNUM is not an axis.
    AxisAddress {
        /// Argument as written.
        text: String,
    },
    /// No axis has this number.
    AxisNumber {
        /// Axis number.
        number: i64,
    },
    /// A block between G10 L52 and G11 has an error.
    ParameterFormat {
        /// Description of the error.
        what: String,
    },
    /// The drilling axis is ambiguous.
    DrillingAxis,
    /// Macro calls are nested too deeply.
    TooManyMacroCalls {
        /// Permitted levels.
        limit: usize,
    },
    /// A DO or WHILE has no END.
    MissingEnd {
        /// Loop number.
        number: u8,
    },
    /// An END has no DO.
    MissingDo {
        /// Loop number.
        number: u8,
    },
    /// A macro statement has an error.
    MacroFormat {
        /// Description of the error.
        what: String,
    },
    /// The number of a loop is not 1, 2 or 3.
    LoopNumber {
        /// Loop number.
        number: i64,
    },
    /// Words and a macro statement are in one block.
    MixedStatements,
    /// The target of a GOTO is not found.
    JumpTargetNotFound {
        /// Sequence number.
        number: u32,
    },
    /// A macro call has a G code among its arguments.
    GAsArgument,
    /// A block has two subprogram calls.
    TwoSubprogramCalls,
    /// A block has two macro calls.
    TwoMacroCalls,
    /// M99 has other words in its block while a modal macro call is pending.
    WordsWithReturn {
        /// Letter of the first such word.
        letter: char,
    },
    /// I, J, K occur more than ten times in a macro call.
    TooManyArgumentSets,
    /// G67 is commanded without G66.
    CancelWithoutModalCall,
    /// A variable name belongs to another type of tool offset memory.
    VariableName {
        /// Name.
        name: String,
    },
    /// The suffix in brackets after a variable name is missing, superfluous or out of range.
    Suffix {
        /// Name.
        name: String,
    },
    /// No variable has this name.
    NoVariableName {
        /// Name.
        name: String,
    },
    /// An address is repeated in a block.
    RepeatedAddress {
        /// Letter of the address.
        letter: char,
    },
    /// The arguments of a function have an error.
    ArgumentFormat {
        /// Name of the function.
        function: String,
    },
    /// A computed sequence number is out of range.
    SequenceNumberRange {
        /// Sequence number.
        number: i64,
    },
    /// An opening bracket is missing.
    MissingOpenBracket,
    /// A comment takes the place of a value after an address, or of the `[` of a function or a condition.
    RoundBrackets {
        /// Letter of the address; `None` for a function or a condition.
        letter: Option<char>,
    },
    /// A comment takes the place of a value in an expression.
    RoundBracketsForValue,
    /// A condition has a relation sign that the control refuses, such as `<=`.
    RelationSymbol,
    /// A closing bracket is missing.
    MissingCloseBracket,
    /// An equals sign is missing.
    MissingEquals,
    /// A comma between two arguments is missing.
    MissingComma,
    /// An IF statement has an error.
    IfFormat,
    /// `IF[…]THEN GOTO 5` on a control that takes an assignment behind THEN.
    ThenGoto,
    /// Words behind THEN on such a control.
    ThenWords,
    /// A WHILE statement has an error.
    WhileFormat,
    /// A SETVN statement has an error.
    SetNamesFormat,
    /// A variable name has an invalid character.
    NameCharacter,
    /// A variable name is too long.
    NameTooLong {
        /// Name.
        name: String,
    },
    /// A DPRNT or BPRNT statement has an error.
    PrintFormat,
    /// A position is out of range.
    PositionOverflow {
        /// Letter of the axis.
        letter: char,
        /// Position.
        value: f64,
    },
    /// The program ends without M02, M30 or M99.
    EndOfRecord,
    /// A move ends beyond a stroke limit.
    Overtravel {
        /// Letter of the axis.
        letter: char,
        /// True for the limit on the plus side.
        is_plus: bool,
        /// Machine coordinate of the end point.
        value: f64,
        /// Limit.
        limit: f64,
    },
    /// `#3000=n(TEXT)` stops the program.
    UserAlarm {
        /// The n of the statement.
        number: u16,
        /// Text of the comment.
        text: String,
        /// MCA 6008#1: the alarm is shown as MC n, not as MC 3000 + n.
        has_no_base: bool,
    },
    /// The simulator does not execute a code or function that a control may have.
    NotSimulated {
        /// The code or function.
        what: String,
    },
    /// The simulator executes no word of this letter in its block.
    WordNotSimulated(char),
    /// A code, the mode that rules it out, and the code that ends the mode.
    CodeInMode(String, &'static str, &'static str),
    /// A feed with the F of another mode: the code × 10 of the mode in which F was commanded, and that of the feed.
    FeedOfOtherMode(u32, u32),
}

/// Alarm with its span. Boxed, because almost every step of a run returns a result without an alarm.
pub type LocatedAlarm = Box<Spanned<Alarm>>;

impl Alarm {
    /// Returns the designation.
    pub fn code(&self) -> AlarmCode {
        self.row().code
    }

    /// Attaches the span.
    #[cold]
    pub fn located_at(self, span: Span) -> LocatedAlarm {
        Box::new(Spanned::new(self, span))
    }
}
