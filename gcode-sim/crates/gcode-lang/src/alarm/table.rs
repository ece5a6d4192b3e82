//! Table of alarm numbers, wordings and remedies.
use super::kinds::*;
use super::{Alarm, AlarmCode, AlarmRow};
use crate::diag::FindingKind;

impl Alarm {
    /// Returns designation, wording and remedy.
    pub fn row(&self) -> AlarmRow {
        let (kind, message, help) = self.parts();
        let raised = match self {
            Self::UserAlarm { number, has_no_base: true, .. } => Some(*number),
            Self::UserAlarm { number, has_no_base: false, .. } => Some(number.saturating_add(3000)),
            _ => None,
        };
        AlarmRow { code: AlarmCode { kind, raised }, message, help: help.map(str::to_owned) }
    }

    #[rustfmt::skip]
    fn parts(&self) -> (&'static FindingKind, String, Option<&'static str>) {
        match self {
            Self::TooManyDigits(limit) => (&PS0003, limit.message(), Some(limit.help())),
            Self::Overtravel { letter, is_plus: true, value, limit } => (&OT0500, format!("{letter} would go to machine position {value}, beyond its stroke limit {limit} on the plus side"), Some("check the work offset, the tool length and the target")),
            Self::Overtravel { letter, is_plus: false, value, limit } => (&OT0501, format!("{letter} would go to machine position {value}, beyond its stroke limit {limit} on the minus side"), Some("check the work offset, the tool length and the target")),
            Self::NotAWord { text } => (&PS0004, format!("'{text}' is neither a word nor a macro statement"), Some("write a letter followed by a number, #variable or [expression]")),
            Self::LowerCase => (&PS0004, "letters in lower case".into(), Some("write capitals; comments may use both")),
            Self::ShortWord => (&PS0004, "a statement keyword is abbreviated".into(), Some("write WHILE, GOTO, END, THEN in full")),
            Self::TwoBlocksInOneLine => (&PS0004, "a block behind ';' in a line".into(), Some("write the block on a line of its own, a comment in round brackets")),
            Self::NoDataAfterAddress { letter } => (&PS0005, format!("address {letter} has no number"), Some("write its value, or remove the letter")),
            Self::MissingWord { code, letter } => (&PS0005, format!("{code} needs {letter}"), Some("write it in the same block")),
            Self::PolarInterpolationFormat(what) => (&PS0145, format!("polar coordinate interpolation: {what}"), Some("command G12.1 alone in its block, after G40, with the axes of parameters 5460 and 5461")),
            Self::CodeInPolarInterpolation(code) => (&PS0146, format!("{code} in polar coordinate interpolation"), Some("command G13.1 before it")),
            Self::CylinderFormat(what) => (&PS0175, format!("cylindrical interpolation: {what}"), Some("command G07.1 with one rotary axis and the radius, and with 0 to end it")),
            Self::CodeInCylinder(code) => (&PS0176, format!("{code} in cylindrical interpolation"), Some("end it before with G07.1 and the rotary axis at 0")),
            Self::NoCycle(code) => (&PS0010, format!("{code} without a canned cycle"), Some("command G81 or another cycle before it, with L0 if the centre has no hole")),
            Self::IllegalMinus { letter } => (&PS0006, format!("address {letter} takes no minus sign"), Some("remove the minus sign")),
            Self::IllegalPoint { letter: Some(letter) } => (&PS0007, format!("address {letter} takes no decimal point"), Some("write the number without a decimal point")),
            Self::IllegalPoint { letter: None } => (&PS0007, "a number has two decimal points".into(), Some("remove one of them")),
            Self::ImproperAddress { letter: 'L' } => (&PS0009, "address L is not allowed in this block".into(), Some("K is the number of repeats of a canned cycle (L with --control CYCLE-REPEATS=L); elsewhere L needs a call or G10")),
            Self::ImproperAddress { letter: letter @ ('D'..='T') } => (&PS0009, format!("address {letter} is not allowed in this block"), Some("remove it, or write the code that uses it")),
            Self::ImproperAddress { letter } => (&PS0009, format!("address {letter} is not allowed in this block"), Some("check the axes of the machine file")),
            Self::ImproperGCode { code, .. } => (&PS0010, format!("the control has no G{}", two_digits(code)), None),
            Self::TwoSigns { letter } => (&PS0006, format!("address {letter} has two signs"), Some("write one sign")),
            Self::NegativeVariable { number } => (&PS0006, format!("#{number} takes no minus sign"), None),
            Self::FeedZero => (&PS0011, "cutting feed without a feed rate".into(), Some("command F before or in this block")),
            Self::NoSpeedForFeed => (&PS0011, "cutting feed per revolution (G95) while S is 0".into(), Some("command S before or in this block, or G94 for a feed per minute")),
            Self::RadiusTooSmall { radius, half_chord } => (&PS0020, format!("R is {radius} mm, less than half the distance from start to end, {half_chord:.4} mm"), Some("write a larger R, or another end point")),
            Self::RadiusTolerance { start, end, tolerance } => (&PS0020, format!("the radius of the arc is {start:.4} mm at its start and {end:.4} mm at its end (tolerance {tolerance} mm)"), Some("correct I, J, K or the end point")),
            Self::PlaneSelect => (&PS0021, "I, J or K of the arc is not in the selected plane".into(), Some("select the plane of the arc: G17 for I and J, G18 for I and K, G19 for J and K")),
            Self::NoRadiusOrCentre => (&PS0022, "an arc without R and without I, J, K".into(), Some("write R, or I, J, K: the distance from the start to the centre, not 0 in both directions of the plane")),
            Self::ArcFeedZero => (&PS0025, "an arc without a feed rate".into(), Some("command F before or in this block")),
            Self::OffsetNumber { number } => (&PS0030, format!("offset number {number} is out of range"), Some("H, D: up to --control OFFSETS=…; P of G54.1 or G154: 1 to --control WORK-SYSTEMS=…; P of G10 L2: 0 to 6")),
            Self::OffsetValue { value } => (&PS0032, format!("offset value {value} is out of range"), Some("an offset has at most nine digits in increments")),
            Self::NoIntersection => (&PS0033, "the tool centre paths do not intersect".into(), Some("use a smaller tool, or round the corner")),
            Self::ArcAtStartOrEnd => (&PS0034, "cutter compensation starts or ends with an arc".into(), Some("start and cancel it in a straight move, G00 or G01")),
            Self::SkipInCompensation => (&PS0035, "G31 in cutter compensation".into(), Some("command G40 first")),
            Self::PlaneInCompensation => (&PS0037, "the plane changes in cutter compensation".into(), Some("command G40 and a move first")),
            Self::CornerInStartUp => (&PS0039, ",R or ,C where cutter compensation starts, is cancelled or changes sides".into(), Some("remove the corner word from this move")),
            Self::Interference => (&PS0041, "the tool is too large for the contour: its centre would move against the programmed path".into(), Some("use a smaller tool, or correct the radius in D")),
            Self::ToolOffsetInCompensation => (&PS0042, "G45 to G48 in cutter compensation".into(), Some("command G40 first")),
            Self::G10Format { what } => (&PS1144, format!("G10: {what}"), None),
            Self::ReferenceReturnInCycle => (&PS0044, "G27 to G30 in a canned cycle".into(), Some("command G80 first")),
            Self::NoPeckDepth => (&PS0045, "G73 or G83 without a peck depth Q".into(), Some("write Q, the depth of one peck, in the block of the cycle: Q2.")),
            Self::ReferenceReturnP { p } => (&PS0046, format!("G30 P{p}: P must be 2, 3 or 4"), Some("write P2, P3 or P4, or leave P out for the second reference position")),
            Self::CornerInThread => (&PS0050, ",R or ,C in a block of G33".into(), Some("write the corner as a move of its own")),
            Self::NoMoveAfterCorner => (&PS0051, "no move in the plane follows ,R or ,C".into(), Some("write the move that forms the corner in the next block; only a G04 may be in between")),
            Self::NoCutAfterCorner => (&PS0052, "the move after ,R or ,C is not G01, G02 or G03".into(), Some("write G01, G02 or G03 in the block behind the corner")),
            Self::CornerWords => (&PS0053, "after a comma only R or C is allowed, once in a block".into(), Some("write one of them: ,R for a rounding or ,C for a chamfer")),
            Self::CornerTooLarge => (&PS0055, "the corner is larger than the moves that form it".into(), Some("write a smaller ,R or ,C")),
            Self::ProgramNumber => (&PS0074, "the program number is out of range".into(), Some("write 1 to 99999999")),
            Self::ProgramNotNamed => (&PS0076, "a call without a program number".into(), Some("write the program number after P")),
            Self::NoNameInCall => (&PS0311, "a call without a program number or name".into(), Some("write the program number after P")),
            Self::ProgramNotFound { number, read_error } => (&PS0076, not_found(format!("program O{number:04}"), read_error), Some("give the folder that holds it with --lib")),
            Self::TooManyCalls { limit } => (&PS0077, format!("more than {limit} nested calls"), Some("check for a program that calls itself")),
            Self::SequenceNumberNotFound { number } => (&PS0078, format!("sequence number N{number} is not found"), Some("write N with this number at the block that is meant, or correct the number")),
            Self::NotAtReference { letter } => (&PS0092, format!("G27: {letter} is not at the reference position"), Some("correct the position of G27, or return the axis with G28")),
            Self::LookAheadFormat => (&PS0109, "G08 without P0 or P1".into(), Some("write G08 P1 to switch advanced preview control on, G08 P0 to switch it off")),
            Self::IntegerOverflow => (&PS0110, "the number is too large for an integer".into(), Some("check the calculation that makes the number")),
            Self::FloatOverflow => (&PS0111, "the result of the calculation is too large".into(), Some("check the calculation: a divisor near 0, or a loop that runs too often")),
            Self::DivideByZero => (&PS0112, "division by zero".into(), Some("check the divisor: a vacant variable counts as 0")),
            Self::Expression { text } if text.is_empty() => (&PS1125, "a value is missing".into(), Some("write a number, a #variable or an [expression] there")),
            Self::Expression { text } => (&PS1125, format!("the expression is not valid at '{text}'"), None),
            Self::NoSuchVariable { number: number @ (34..=99 | 200..=499) } => (&PS0115, format!("the control has no variable #{number}"), Some("use #1 to #33, #100 to #199 or #500 to #999; for a machine that has more common variables give their range, as in --control MORE-COMMONS=400-499")),
            Self::NoSuchVariable { number: number @ (2401..=2800) } => (&PS0115, format!("the control has no variable #{number}"), Some("give --control D15=1 for a control whose D offsets are #2401 to #2800")),
            Self::NoSuchVariable { number: number @ (20_001..=99_999 | 100_201..=999_999) } => (&PS0115, format!("the control has no variable #{number}"), Some("for a machine whose builder has such common variables give their range, as in --control MORE-COMMONS=900000-907399")),
            Self::NoSuchVariable { number } => (&PS0115, format!("the control has no variable #{number}"), None),
            Self::WriteProtected { number } => (&PS0116, format!("#{number} cannot be written"), Some("it can only be read; keep the value in a common variable, as in #500=1")),
            Self::ReadProtected { number } => (&PS1115, format!("#{number} cannot be read"), None),
            Self::TooManyBrackets => (&PS0118, "more than five nested brackets".into(), Some("compute a part of it in a block of its own")),
            Self::OutOfRange { function, value } => (&PS0119, format!("{function}: {value} is out of range"), Some(range(function))),
            Self::TooManyMacroCalls { limit } => (&PS0122, format!("more than {limit} nested macro calls"), Some("check for a macro that calls itself")),
            Self::ParameterFormat { what } => (&PS0231, format!("G10 L52: {what}"), Some("write N5114 R2.5, with P for an axis and Q for a bit, and G11 at the end")),
            Self::AxisNumber { number } => (&PS0331, format!("axis number {number} does not exist"), Some("use a valid axis number; AXNUM[X] gives it")),
            Self::AxisAddress { text } => (&PS0332, format!("AXNUM: the control has no axis '{text}'"), Some("check the axes of the machine file")),
            Self::DrillingAxis => (&PS1196, "the drilling axis is ambiguous or changes without G80".into(), Some("specify one axis along the plane normal, and command G80 before another plane")),
            Self::NameFormat => (&PS0311, "a program's name is 1 to 32 letters, digits, + - _ . between < and >".into(), Some("write such a name, as in O<BOLT_CIRCLE>")),
            Self::MissingEnd { number } => (&PS0124, format!("DO{number} has no END{number}"), Some("write END with this number behind the last block of the loop")),
            Self::MissingDo { number } => (&PS1124, format!("END{number} without a DO{number} before it"), Some("write WHILE[...]DO with this number before the loop, or remove END")),
            Self::MacroFormat { what } => (&PS0125, format!("macro statement: {what}"), None),
            Self::LoopNumber { number } => (&PS0126, format!("DO{number}: a loop's number is 1, 2 or 3"), Some("number the loops DO1, DO2, DO3; loops side by side may share a number")),
            Self::MixedStatements => (&PS0127, "NC words and a macro statement in one block".into(), Some("write them in two blocks; behind THEN each needs its IF, or a jump over both")),
            Self::JumpTargetNotFound { number } => (&PS0128, format!("sequence number N{number} is not found"), Some("write N with this number at the block that is meant, or correct GOTO")),
            Self::GAsArgument => (&PS0129, "G is not allowed as an argument".into(), Some("pass the value in another letter, or write the code in a block of its own")),
            Self::ScaleRate { value } => (&PS0142, format!("G51: scale factor {value} is 0 or too large"), Some("write the factor in its unit: P2000 is 2, or P200000 with --control SCR=0")),
            Self::PocketTooSmall { code, radius, tool } => (&PS0119, format!("{code}: I, the pocket's radius, is {radius} mm, and D, the tool's, {tool} mm"), Some("write a larger I, or the D of a smaller tool; if the offset holds the tool's diameter, state --control ODI=1")),
            Self::NoSpeedInRigidTapping => (&PS0200, "rigid tapping (M29) while S is 0".into(), Some("write the spindle speed S in the block of M29")),
            Self::MoveBeforeRigidTapping => (&PS0204, "an axis moves between M29 and G84 or G74".into(), Some("write the move before M29, and G84 or G74 in the next block with axis words")),
            Self::PlaneInRigidTapping => (&PS0206, "the plane changes in rigid tapping".into(), Some("select the plane before M29, or after G80")),
            Self::PlaneInRotation => (&PS0144, "the plane changes in coordinate system rotation (G68)".into(), Some("command G69 first")),
            Self::TNotAllowed => (&PS0245, "T is not allowed in a block with G04, G10 or G50".into(), Some("command T in a block of its own")),
            Self::CodeInScaling(code) => (&PS0300, format!("G{code} is not allowed in scaling (G51)"), Some("command G50 first")),
            Self::NoIntermediatePoint => (&PS0305, "G29 without an intermediate point".into(), Some("command G28 or G30 with the same axis before it")),
            Self::FileNotFound { name, read_error } => (&PS0310, not_found(format!("program <{name}>"), read_error), None),
            Self::PluralM { first, second } => (&PS0335, format!("M{second:02} after M{first:02} in one block: only the last M code counts"), Some("write the other code in the preceding block")),
            Self::SkipTorque => (&PS0369, "the torque limit of G31 is out of range".into(), Some("write Q1 to Q99")),
            Self::SkipSignals { letter } => (&PS0370, format!("{letter}, the number of the skip signals, is out of range"), Some("write 1 to 4")),
            Self::DeviceFileNotFound { number, read_error } => (&PS1079, not_found(format!("file {number} of M198"), read_error), Some("give the folder that holds it with --lib")),
            Self::DeviceCallInDeviceCall => (&PS1080, "M198 in a program that M198 called".into(), Some("call it with M98 from there")),
            Self::TwoSubprogramCalls => (&PS1091, "two subprogram calls in one block".into(), Some("write each call in a block of its own")),
            Self::TwoMacroCalls => (&PS1092, "two macro calls in one block".into(), Some("write each call in a block of its own")),
            Self::WordsWithReturn { letter } => (&PS1093, format!("{letter} in a block with M99 during a macro modal call (G66)"), Some("write it in the preceding block")),
            Self::TooManyArgumentSets => (&PS1095, "more than ten sets of I, J, K".into(), None),
            Self::VariableName { name } => (&PS1096, format!("{name} belongs to another type of tool offset memory"), Some("use the names of memory C: _OFSHG, _OFSHW, _OFSDG, _OFSDW")),
            Self::Suffix { name } => (&PS1099, format!("the index of {name} is missing, not allowed, or out of range"), Some("write [#_ABSMT[1]] for the first axis, [#_CLOCK1] without a number")),
            Self::NoVariableName { name } => (&PS1098, format!("variable name {name} is not defined"), Some("name it with SETVN")),
            Self::CancelWithoutModalCall => (&PS1100, "G67 without G66".into(), None),
            Self::ArgumentFormat { function } => (&PS1120, format!("{function}: wrong arguments"), None),
            Self::SequenceNumberRange { number } => (&PS1128, format!("GOTO {number}: the sequence number is out of range"), Some("write 1 to 99999999")),
            Self::MissingOpenBracket => (&PS1131, "an opening bracket '[' is missing".into(), Some("write it, or remove the unmatched ']'")),
            Self::RoundBrackets { letter: Some(letter) } => (&PS0005, format!("address {letter} has no number: round brackets are a comment"), Some("write '[' and ']'")),
            Self::RoundBrackets { letter: None } => (&PS1131, "an opening bracket '[' is missing: round brackets are a comment".into(), Some("write '[' and ']'")),
            Self::RoundBracketsForValue => (&PS1125, "a value is missing: round brackets are a comment".into(), Some("write '[' and ']'")),
            Self::RelationSymbol => (&PS1125, "'=', '<', '>', '&' and '|' are not operators of a condition here".into(), Some("write EQ, NE, LT, LE, GT, GE, AND or OR, or give --control SIGNS=1 for a control that accepts them")),
            Self::MissingCloseBracket => (&PS1132, "a closing bracket ']' is missing".into(), Some("write it behind the expression, or remove the unmatched '['")),
            Self::MissingEquals => (&PS1133, "'=' is missing".into(), Some("write #1=2 for a variable that gets a value")),
            Self::MissingComma => (&PS1134, "a comma is missing".into(), Some("write it between the two values")),
            Self::IfFormat => (&PS1137, "IF must be followed by a condition in brackets and GOTO or THEN".into(), Some("write IF[#1 EQ 0]GOTO 10 or IF[#1 EQ 0]THEN #2=3")),
            Self::ThenGoto => (&PS1137, "GOTO behind THEN".into(), Some("write IF[#1 EQ 0]GOTO 10, or give --control THEN-GOTO=1 for a control that takes it")),
            Self::ThenWords => (&PS1137, "words behind THEN".into(), Some("jump over the words with IF[#1 NE 0]GOTO 10, or give --control THEN-WORDS=1 for a control that takes them")),
            Self::WhileFormat => (&PS1138, "WHILE must be followed by a condition in brackets and DO 1, 2 or 3".into(), Some("write WHILE[#1 LT 10]DO1")),
            Self::SetNamesFormat => (&PS1139, "SETVN needs a variable's number and names in brackets".into(), Some("write SETVN510[NAME,NAME]")),
            Self::NameCharacter => (&PS1141, "a variable name consists of letters, digits and _".into(), Some("write such a name, as in SETVN500[DIAM_1]")),
            Self::NameTooLong { name } => (&PS1142, format!("variable name {name} is longer than 8 characters"), Some("write at most 8 characters")),
            Self::PrintFormat => (&PS1143, "DPRNT and BPRNT need a text in square brackets, each variable with its digits".into(), Some("write DPRNT[TEXT#1[44]] or BPRNT[TEXT#1[3]]; PRINT-DIGITS states the most digits, 8 on a Fanuc")),
            Self::NoInverseTime => (&PS1202, "no F in a cutting block of G93 (inverse time feed)".into(), Some("write F, one divided by the minutes the block takes, in every such block")),
            Self::PositionOverflow { letter, value } => (&PS1160, format!("position {letter}{value} is out of range"), Some("check the work offset, the tool length and the target; a position has at most nine digits in increments")),
            Self::EndOfRecord => (&PS5010, "the program ends without M02, M30 or M99".into(), Some("write M30 at the end of a main program, M99 at the end of a subprogram")),
            Self::PlaneFormat(what) => (&PS5457, format!("tilted plane: {what}"), None),
            Self::ToolAxisCode(what) => (&PS5458, (*what).into(), Some("command G68.2 before it, then G53.1 in a block of its own")),
            Self::DirectionWithTipControl => (&PS5421, "I J K in the block of G43.5 on a machine whose table turns".into(), Some("write I J K in a block after G43.5")),
            Self::MachineParameter(what) => (&PS5459, format!("{what} is not allowed"), Some("check the parameters of the five axes")),
            Self::SpaceRotation(what) => (&PS5044, format!("G68 about I J K: {what}"), Some("write X Y Z, I J K and R; G69 ends both of two rotations")),
            Self::ToolAxisUnreachable => (&PS5459, "no angles of the rotary axes within their stroke point the tool along Z of the plane".into(), Some("check the angles of G68.2, P of G53.1 and the rotary axes of the machine file")),
            Self::RepeatedAddress { letter } => (&PS5074, format!("address {letter} is repeated in the block"), Some("remove one of the two words, or write two blocks")),
            Self::UserAlarm { text, .. } if text.is_empty() => (&MC3000, "the program raises an alarm without a text".into(), Some("write a text after the number: #3000=1(TEXT)")),
            Self::UserAlarm { text, .. } => (&MC3000, text.clone(), None),
            Self::SkipMissed => (&SIM0002, "G31 ended without a skip signal".into(), Some("probe farther, or check the position of the part")),
            Self::SkipReceived => (&SIM0004, "G31 with M78 got a skip signal".into(), Some("check the path: the probe touches something before its end")),
            Self::StylusBroken { deflection, overtravel_limit } => (&SIM0003, format!("the stylus is deflected by {deflection:.3} mm, limit {overtravel_limit:.3} mm"), Some("probe with a lower feed, and back off before the next touch")),
            Self::NotSimulated { what } => (&SIM0001, format!("{what} is not simulated"), Some(NOT_EXECUTED)),
            Self::WordNotSimulated(letter) => (&SIM0001, format!("{letter} in this block is not simulated"), Some(NOT_EXECUTED)),
            Self::FeedOfOtherMode(commanded, active) => (&SIM0001, format!("a feed in G{} with the F of G{} is not simulated", active / 10, commanded / 10), Some("command F in the block that changes the mode of the feed, or behind it: its unit is another one")),
            Self::CodeInMode(code, active, cancel) => (&SIM0001, format!("G{code} while {active} is on (command {cancel} before it) is not simulated"), Some(NOT_EXECUTED)),
        }
    }
}

/// Remedy for what the simulator does not execute.
const NOT_EXECUTED: &str =
    "avoid it, or check it on a control that has it: this simulator does not execute it";

/// Returns the remedy for a value that a function cannot have.
fn range(function: &str) -> &'static str {
    match function {
        "SQRT" => "SQRT takes 0 or more: check the value, ABS in it removes a minus sign",
        "ASIN" | "ACOS" => "ASIN and ACOS take -1 to 1: check the value, rounding can carry it just beyond",
        "LN" => "LN takes more than 0: check the value",
        "POW" => "POW takes a base of 0 or more: check the value",
        "ATAN" => "ATAN takes two values of which one is not 0: check them",
        "TAN" => "TAN has no value at 90 degrees: check the angle",
        "BCD" => "BCD takes 0 to 99999999: check the value",
        "BIN" => "BIN takes a number whose hexadecimal digits are 0 to 9: check the value",
        "AND, OR, XOR" => "AND, OR and XOR take 0 or more here: check the values",
        _ => "check the value",
    }
}

/// Returns the number of a G code with two digits before the point, as manuals write it.
fn two_digits(code: &str) -> String {
    let is_single = code.bytes().take_while(u8::is_ascii_digit).count() == 1;
    if is_single { format!("0{code}") } else { code.to_owned() }
}

/// Returns the message for a missing program, with the failure to read a file if there is one.
fn not_found(what: String, read_error: &Option<String>) -> String {
    match read_error {
        Some(read_error) => format!("{what} is not found: {read_error}"),
        None => format!("{what} is not found"),
    }
}

impl std::fmt::Display for Alarm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.row().message)
    }
}
