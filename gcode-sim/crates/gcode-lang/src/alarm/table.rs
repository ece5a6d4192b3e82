//! Table of alarm numbers, wordings and remedies.
use super::{Alarm, AlarmCode, AlarmRow};

impl Alarm {
    /// Returns designation, wording and remedy.
    pub fn row(&self) -> AlarmRow {
        let (code, message, help) = self.parts();
        AlarmRow { code, message, help: help.map(str::to_owned) }
    }

    #[rustfmt::skip]
    fn parts(&self) -> (AlarmCode, String, Option<&'static str>) {
        use AlarmCode::{Mc, Ot, Ps, Sim};
        match self {
            Self::TooManyDigits => (Ps(3), "too many digits".into(), Some("write at most 9 digits; 12 in a macro expression")),
            Self::Overtravel { letter, is_plus: true, value, limit } => (Ot(500), format!("{letter} would go to {value} of the machine, beyond its limit {limit} on the plus side"), Some("check the work offset, the tool length and the target")),
            Self::Overtravel { letter, is_plus: false, value, limit } => (Ot(501), format!("{letter} would go to {value} of the machine, beyond its limit {limit} on the minus side"), Some("check the work offset, the tool length and the target")),
            Self::NotAWord { text } => (Ps(4), format!("'{text}' is not a word the control knows"), Some("write a letter followed by a number, \
                                                                                                          #variable or [expression]")),
            Self::LowerCase => (Ps(4), "letters in lower case".into(), Some("write capitals; comments may use both")),
            Self::ShortWord => (Ps(4), "a statement keyword is abbreviated".into(), Some("write WHILE, GOTO, END, THEN in full")),
            Self::TwoBlocksInOneLine => (Ps(4), "text after ';' is ambiguous: a block or a comment".into(), Some("write the block on a line of its own, \
                                                                                                                  the comment in round brackets")),
            Self::NoDataAfterAddress { letter } => (Ps(5), format!("address {letter} has no number"), Some("write its value, or remove the letter")),
            Self::MissingWord { code, letter } => (Ps(5), format!("{code} needs {letter}"), Some("write it in the same block")),
            Self::NoCycle { code } => (Ps(10), format!("{code} without a drilling cycle"), Some("command G81 or another cycle before it, with L0 if the centre has no hole")),
            Self::IllegalMinus { letter } => (Ps(6), format!("address {letter} takes no minus sign"), None),
            Self::IllegalPoint { letter: Some(letter) } => (Ps(7), format!("address {letter} takes no decimal point"), Some("write the number without a decimal point")),
            Self::IllegalPoint { letter: None } => (Ps(7), "a number has two decimal points".into(), Some("remove one of them")),
            Self::ImproperAddress { letter: letter @ ('D'..='T') } => (Ps(9), format!("address {letter} is not allowed here"), Some("remove it, or write the code that uses it")),
            Self::ImproperAddress { letter } => (Ps(9), format!("address {letter} is not allowed here"), Some("check the axes of the machine file")),
            Self::ImproperGCode { code } => (Ps(10), format!("the control has no G{code}"), None),
            Self::FeedZero => (Ps(11), "cutting feed without a feed rate".into(), Some("command F before or in this block")),
            Self::NoSpeedForFeed => (Ps(11), "cutting feed per revolution (G95) while S is 0".into(), Some("command S before or in this block, or G94 for a feed per minute")),
            Self::RadiusTooSmall { radius, half_chord: half } => (Ps(20), format!("R is {radius} mm, less than half the \
                                                                       distance from start to end, {half:.4} mm"), Some("write a larger R, or another end point")),
            Self::RadiusTolerance { start, end, tolerance: allowed } => (Ps(20), format!("the arc starts {start:.4} mm from its \
                                                                               centre and ends {end:.4} mm from it \
                                                                               (tolerance {allowed})"), Some("correct I, J, K or the end point")),
            Self::PlaneSelect => (Ps(21), "the arc's centre is not in the plane".into(), Some("select the plane with G17, G18 or G19")),
            Self::NoRadiusOrCentre => (Ps(22), "arc without R and without I, J, K".into(), None),
            Self::ArcFeedZero => (Ps(25), "an arc without a feed rate".into(), Some("command F before or in this block")),
            Self::OffsetNumber { number } => (Ps(30), format!("no offset number {number}"), None),
            Self::OffsetValue { value } => (Ps(32), format!("{value} is beyond the range of offsets"), Some("an offset has at most nine digits in increments")),
            Self::NoIntersection => (Ps(33), "the tool centre paths do not intersect inside the corner".into(), Some("use a smaller tool, or round the corner")),
            Self::ArcAtStartOrEnd => (Ps(34), "cutter compensation starts or ends with an arc".into(), Some("start and cancel it in a straight move, G00 or G01")),
            Self::SkipInCompensation => (Ps(35), "G31 while cutter compensation is on".into(), Some("command G40 first")),
            Self::PlaneInCompensation => (Ps(37), "the plane changes while cutter compensation is on".into(), Some("command G40 and a move first")),
            Self::CornerInStartUp => (Ps(39), ",R or ,C where cutter compensation starts, ends or changes sides".into(), Some("remove the corner word from this move")),
            Self::Interference => (Ps(41), "the tool is too large for the contour: its centre would move \
                                            against the programmed path".into(), Some("use a smaller tool, or correct the \
                                                                                       radius in D")),
            Self::ToolOffsetInCompensation => (Ps(42), "G45 to G48 while cutter compensation is on".into(), Some("command G40 first")),
            Self::G10Format { what } => (Ps(1144), format!("G10: {what}"), None),
            Self::ReferenceReturnInCycle => (Ps(44), "G27 to G30 in a drilling cycle".into(), Some("command G80 first")),
            Self::NoPeckDepth => (Ps(45), "G73 or G83 without a peck depth Q".into(), None),
            Self::ReferenceReturnP { p } => (Ps(46), format!("G30 P{p}: P must be 2, 3 or 4"), None),
            Self::CornerInThread => (Ps(50), ",R or ,C in a block of G33".into(), Some("write the corner as a move of its own")),
            Self::NoMoveAfterCorner => (Ps(51), "no move follows ,R or ,C that forms a corner in the plane".into(), Some("write the move that forms the corner in \
                                                                                                                          the next block; only a G04 may be in \
                                                                                                                          between")),
            Self::NoCutAfterCorner => (Ps(52), "the move after ,R or ,C is not G01, G02 or G03".into(), None),
            Self::CornerWords => (Ps(53), "only R or C is allowed after a comma, once in a block".into(), None),
            Self::CornerTooLarge => (Ps(55), "the corner is larger than the moves that form it".into(), Some("write a smaller ,R or ,C")),
            Self::ProgramNumber => (Ps(74), "a program number is 1 to 99999999".into(), None),
            Self::ProgramNotNamed => (Ps(76), "a call without a program number".into(), Some("write the program number after P")),
            Self::NoNameInCall => (Ps(311), "a call without a program number or name".into(), Some("write the program number after P")),
            Self::ProgramNotFound { number, read_error: unread } => (Ps(76), not_here(format!("program O{number:04}"), unread), Some("give the folder that holds it with --lib")),
            Self::TooManyCalls { limit } => (Ps(77), format!("more than {limit} nested calls"), Some("check for a program that calls itself")),
            Self::SequenceNumberNotFound { number } => (Ps(78), format!("sequence number N{number}, the return \
                                                                         target, is not found"), None),
            Self::NotAtReference { letter } => (Ps(92), format!("G27: {letter} is not at the reference position"), None),
            Self::LookAheadFormat => (Ps(109), "G08 needs P0 or P1".into(), None),
            Self::IntegerOverflow => (Ps(110), "the number is too large for an integer".into(), None),
            Self::FloatOverflow => (Ps(111), "the result is out of the range of numbers".into(), None),
            Self::DivideByZero => (Ps(112), "division by zero".into(), Some("check the divisor: a vacant variable \
                                                                             counts as 0")),
            Self::Expression { text } if text.is_empty() => (Ps(1125), "a value is missing".into(), None),
            Self::Expression { text } => (Ps(1125), format!("the expression is not valid at '{text}'"), None),
            Self::NoSuchVariable { number } => (Ps(115), format!("the control has no variable #{number}"), None),
            Self::WriteProtected { number } => (Ps(116), format!("#{number} cannot be written"), None),
            Self::ReadProtected { number } => (Ps(1115), format!("#{number} cannot be read"), None),
            Self::TooManyBrackets => (Ps(118), "more than five nested brackets".into(), Some("compute a part of it in a block of its own")),
            Self::OutOfRange { function, value } => (Ps(119), format!("{function} is not defined for {value}"), None),
            Self::TooManyMacroCalls { limit } => (Ps(122), format!("more than {limit} nested macro calls"), Some("check for a macro that calls itself")),
            Self::ParameterFormat { what } => (Ps(231), format!("G10 L52: {what}"), Some("write N5114 R2.5, with P for an axis and Q for a bit, and G11 at the end")),
            Self::AxisNumber { number } => (Ps(331), format!("axis number {number} does not exist"), Some("use a valid axis number; AXNUM[X] gives it")),
            Self::AxisAddress { text } => (Ps(332), format!("AXNUM: the control has no axis '{text}'"), Some("check the axes of the machine file")),
            Self::DrillingAxis => (Ps(1196), "the drilling axis is ambiguous".into(), Some("specify one axis along the plane \
                                                                                            normal, and command G80 before another \
                                                                                            plane")),
            Self::NameFormat => (Ps(311), "a program's name is 1 to 32 letters, digits, + - _ . between < and >".into(), None),
            Self::MissingEnd { number } => (Ps(124), format!("DO{number} has no END{number}"), None),
            Self::MissingDo { number } => (Ps(1124), format!("END{number} without a DO{number} before it"), None),
            Self::MacroFormat { what } => (Ps(125), format!("macro statement: {what}"), None),
            Self::LoopNumber { number } => (Ps(126), format!("DO{number}: a loop's number is 1, 2 or 3"), None),
            Self::MixedStatements => (Ps(127), "NC words and a macro statement in one block".into(), Some("write them in two blocks")),
            Self::JumpTargetNotFound { number } => (Ps(128), format!("sequence number N{number} is not found"), None),
            Self::GAsArgument => (Ps(129), "G is not allowed as an argument".into(), None),
            Self::ScaleRate { value } => (Ps(142), format!("G51: scale factor {value} is not allowed"), None),
            Self::PlaneInRotation => (Ps(144), "the plane changes while G68 is on".into(), Some("command G69 first")),
            Self::TNotAllowed => (Ps(245), "T is not allowed in a block with G04, G10 or G50".into(), Some("command T in a block of its own")),
            Self::CodeInScaling { code } => (Ps(300), format!("G{code} while scaling is on"), Some("command G50 first")),
            Self::NoIntermediatePoint => (Ps(305), "G29 without a preceding G28 with an intermediate point".into(), None),
            Self::FileNotFound { name, read_error: unread } => (Ps(310), not_here(format!("program <{name}>"), unread), None),
            Self::PluralM { first, second } => (Ps(335), format!("M{second:02} after M{first:02} in one \
                                                                  block: only the last M code counts"), Some("write the other code in the preceding \
                                                                                                              block")),
            Self::SkipTorque => (Ps(369), "G31: Q, the torque limit, is 1 to 99".into(), None),
            Self::SkipSignals { letter } => (Ps(370), format!("{letter}, the set of skip signals, is 1 to 4"), None),
            Self::DeviceFileNotFound { number, read_error: unread } => (Ps(1079), not_here(format!("file {number} of M198"), unread), Some("give the folder that holds it with --lib")),
            Self::DeviceCallInDeviceCall => (Ps(1080), "M198 in a program that M198 called".into(), Some("call it with M98 from there")),
            Self::TwoSubprogramCalls => (Ps(1091), "two subprogram calls in one block".into(), None),
            Self::TwoMacroCalls => (Ps(1092), "two macro calls in one block".into(), None),
            Self::WordsWithReturn { letter } => (Ps(1093), format!("{letter} in a block with M99 while a \
                                                                    modal macro call is on"), Some("write it in the preceding block")),
            Self::TooManyArgumentSets => (Ps(1095), "more than ten sets of I J K".into(), None),
            Self::VariableName { name } => (Ps(1096), format!("{name} belongs to another type of tool \
                                                               offset memory"), Some("use the names of memory C: _OFSHG, \
                                                                                      _OFSHW, _OFSDG, _OFSDW")),
            Self::Suffix { name } => (Ps(1099), format!("the index of {name} is missing, not allowed, or \
                                                         out of range"), Some("write [#_ABSMT[1]] for the first axis, [#_CLOCK1] without a number")),
            Self::NoVariableName { name } => (Ps(1098), format!("variable name {name} is not defined"), Some("name it with SETVN")),
            Self::CancelWithoutModalCall => (Ps(1100), "G67 without G66".into(), None),
            Self::ArgumentFormat { function } => (Ps(1120), format!("{function}: wrong arguments"), None),
            Self::SequenceNumberRange { number } => (Ps(1128), format!("GOTO {number}: no such sequence number"), Some("1 to 99999999")),
            Self::MissingOpenBracket => (Ps(1131), "an opening bracket '[' is missing".into(), Some("write it, or remove the unmatched ']'")),
            Self::RoundBrackets { letter: Some(letter) } => (Ps(5), format!("address {letter} has no number: round brackets are a comment"), Some("write '[' and ']'")),
            Self::RoundBrackets { letter: None } => (Ps(1131), "an opening bracket '[' is missing: round brackets are a comment".into(), Some("write '[' and ']'")),
            Self::RelationSymbol => (Ps(1125), "'=', '<', '>', '&' and '|' are not operators of a \
                                                condition here".into(), Some("write EQ, NE, LT, LE, GT, GE, AND or \
                                                                              OR; SIGNS=1 is for a control that \
                                                                              accepts them")),
            Self::MissingCloseBracket => (Ps(1132), "a closing bracket ']' is missing".into(), None),
            Self::MissingEquals => (Ps(1133), "'=' is missing".into(), None),
            Self::MissingComma => (Ps(1134), "a comma is missing".into(), None),
            Self::IfFormat => (Ps(1137), "IF must be followed by a condition in brackets and GOTO or THEN".into(), Some("write IF[#1 EQ 0]GOTO 10 or IF[#1 EQ 0]THEN #2=3")),
            Self::WhileFormat => (Ps(1138), "WHILE must be followed by a condition in brackets and DO 1, 2 or 3".into(), Some("write WHILE[#1 LT 10]DO1")),
            Self::SetNamesFormat => (Ps(1139), "SETVN needs a variable's number and names in brackets".into(), Some("write SETVN510[NAME,NAME]")),
            Self::NameCharacter => (Ps(1141), "a variable name consists of letters, digits and _".into(), None),
            Self::NameTooLong { name } => (Ps(1142), format!("the name {name} is longer than 8 characters"), None),
            Self::PrintFormat => (Ps(1143), "DPRNT and BPRNT need a text in square brackets, each variable with its digits".into(), Some("write DPRNT[TEXT#1[44]] or BPRNT[TEXT#1[3]]; eight digits at most")),
            Self::NoInverseTime => (Ps(1202), "no F in a cutting block of G93".into(), Some("write F, one divided by the minutes the block takes, in every such block")),
            Self::PositionOverflow { letter, value } => (Ps(1160), format!("{letter}{value} is beyond the range of positions"), None),
            Self::EndOfRecord => (Ps(5010), "the program ends without M02, M30 or M99".into(), None),
            Self::RepeatedAddress { letter } => (Ps(5074), format!("address {letter} is repeated in the block"), None),
            Self::UserAlarm { number, text, has_no_base: plain } if text.is_empty() => (Mc(if *plain { *number } else { 3000u16.saturating_add(*number) }), "the program raises an alarm without a text".into(), Some("write a text after the number: \
                                                                                                                                                                                                       #3000=1(TEXT)")),
            Self::UserAlarm { number, text, has_no_base: true } => (Mc(*number), text.clone(), None),
            Self::UserAlarm { number, text, has_no_base: false } => (Mc(3000u16.saturating_add(*number)), text.clone(), None),
            Self::SkipMissed => (Sim(2), "G31 ended without a skip signal".into(), Some("probe farther, or check the position of \
                                                                                         the part")),
            Self::StylusBroken { deflection: pushed, overtravel_limit: give } => (Sim(3), format!("the stylus is deflected by {pushed:.3} \
                                                                     mm, limit {give:.3} mm"), Some("probe with a lower feed, and back off before the next touch")),
            Self::NotSimulated { what } => (Sim(1), format!("{what} is not simulated"), Some("avoid it, or check it on a control that \
                                                                                              has it: this simulator does not execute it")),
        }
    }
}

/// Returns the message for a missing program, with the failure to read a file if there is one.
fn not_here(what: String, unread: &Option<String>) -> String {
    match unread {
        Some(unread) => format!("{what} is not found: {unread}"),
        None => format!("{what} is not found"),
    }
}
