//! The one table of alarm numbers, wordings and remedies.
use super::{Alarm, Code, Row};

impl Alarm {
    pub fn row(&self) -> Row {
        let (code, message, help) = self.parts();
        Row { code, message, help: help.map(str::to_owned) }
    }

    #[rustfmt::skip]
    fn parts(&self) -> (Code, String, Option<&'static str>) {
        use Code::{Mc, Ps, Sim};
        match self {
            Self::TooManyDigits => (Ps(3), "too many digits".into(), Some("write at most 9 digits; 12 in a macro expression")),
            Self::NotAWord { text } => (Ps(4), format!("'{text}' is not a word the control knows"), Some("a word is a letter followed by a number, #variable or [expression]")),
            Self::NoDataAfterAddress { letter } => (Ps(5), format!("address {letter} has no number"), Some("write its value, or leave the letter out")),
            Self::IllegalMinus { letter } => (Ps(6), format!("address {letter} takes no minus sign"), None),
            Self::IllegalPoint { letter: Some(letter) } => (Ps(7), format!("address {letter} takes no decimal point"), Some("write the number without a point")),
            Self::IllegalPoint { letter: None } => (Ps(7), "a number has two decimal points".into(), None),
            Self::ImproperAddress { letter } => (Ps(9), format!("address {letter} can't be used here"), Some("check the axes of the machine file")),
            Self::ImproperGCode { code } => (Ps(10), format!("no G code {code} on this control"), None),
            Self::FeedZero => (Ps(11), "cutting feed without a feed rate".into(), Some("command F before or in this block")),
            Self::RadiusTolerance { start, end, allowed } => (Ps(20), format!("the arc starts {start:.4} mm from its centre and ends {end:.4} mm from it ({allowed} allowed)"), Some("correct I, J, K or the end point")),
            Self::PlaneSelect => (Ps(21), "the arc's centre is not in the plane".into(), Some("select the plane with G17, G18 or G19")),
            Self::NoRadiusOrCentre => (Ps(22), "arc without R and without I, J, K".into(), None),
            Self::OffsetNumber { number } => (Ps(30), format!("no offset number {number}"), None),
            Self::SkipInCompensation => (Ps(35), "G31 while cutter compensation is on".into(), Some("command G40 first")),
            Self::G10Format { what } => (Ps(1144), format!("G10: {what}"), None),
            Self::ReferenceReturnInCycle => (Ps(44), "G27 to G30 in a drilling cycle".into(), Some("command G80 first")),
            Self::NoPeckDepth => (Ps(45), "G73 or G83 without a peck depth Q".into(), None),
            Self::ReferenceReturnP { p } => (Ps(46), format!("G30 P{p}: P must be 2, 3 or 4"), None),
            Self::ProgramNotNamed => (Ps(76), "a call without a program number".into(), Some("write the program's number behind P")),
            Self::ProgramNotFound { number } => (Ps(76), format!("program O{number:04} is not here"), Some("give the folder that holds it with --lib")),
            Self::TooManyCalls { limit } => (Ps(77), format!("more than {limit} calls inside one another"), Some("does a program call itself?")),
            Self::SequenceNumberNotFound { number } => (Ps(78), format!("no block N{number} to return to"), None),
            Self::NotAtReference { letter } => (Ps(92), format!("G27: {letter} is not at the reference position"), None),
            Self::IntegerOverflow => (Ps(110), "the number is too large for an integer".into(), None),
            Self::FloatOverflow => (Ps(111), "the result is out of the range of numbers".into(), None),
            Self::DivideByZero => (Ps(112), "division by zero".into(), Some("a vacant variable counts as 0 here")),
            Self::Expression { text } => (Ps(1125), format!("the expression can't be read at '{text}'"), None),
            Self::NoSuchVariable { number } => (Ps(115), format!("no variable #{number} on this control"), None),
            Self::WriteProtected { number } => (Ps(116), format!("#{number} can't be written"), None),
            Self::ReadProtected { number } => (Ps(1115), format!("#{number} can't be read"), None),
            Self::TooManyBrackets => (Ps(118), "more than five brackets inside one another".into(), Some("compute a part of it in a block of its own")),
            Self::OutOfRange { function, value } => (Ps(119), format!("{function} can't take {value}"), None),
            Self::TooManyMacroCalls { limit } => (Ps(122), format!("more than {limit} macro calls inside one another"), Some("does a macro call itself?")),
            Self::MissingEnd { number } => (Ps(124), format!("DO{number} has no END{number}"), None),
            Self::MissingDo { number } => (Ps(1124), format!("END{number} without a DO{number} before it"), None),
            Self::MacroFormat { what } => (Ps(125), format!("macro statement: {what}"), None),
            Self::LoopNumber { number } => (Ps(126), format!("DO{number}: a loop's number is 1, 2 or 3"), None),
            Self::MixedStatements => (Ps(127), "NC words and a macro statement in one block".into(), Some("write them in two blocks")),
            Self::JumpTargetNotFound { number } => (Ps(128), format!("no block N{number} to go to"), None),
            Self::GAsArgument => (Ps(129), "G can't be an argument".into(), None),
            Self::ScaleRate { value } => (Ps(142), format!("G51 can't scale by {value}"), None),
            Self::PlaneInRotation => (Ps(144), "the plane changes while G68 is on".into(), Some("command G69 first")),
            Self::NoIntermediatePoint => (Ps(305), "G29 without a G28 that left an intermediate point".into(), None),
            Self::FileNotFound { name } => (Ps(310), format!("program <{name}> is not here"), None),
            Self::TwoSubprogramCalls => (Ps(1091), "two subprogram calls in one block".into(), None),
            Self::TwoMacroCalls => (Ps(1092), "two macro calls in one block".into(), None),
            Self::TooManyArgumentSets => (Ps(1095), "more than ten sets of I J K".into(), None),
            Self::NoVariableName { name } => (Ps(1098), format!("no variable is named {name}"), Some("name it with SETVN")),
            Self::CancelWithoutModalCall => (Ps(1100), "G67 without G66".into(), None),
            Self::ArgumentFormat { function } => (Ps(1120), format!("{function}: wrong arguments"), None),
            Self::SequenceNumberRange { number } => (Ps(1128), format!("GOTO {number}: no such sequence number"), Some("1 to 99999999")),
            Self::MissingOpenBracket => (Ps(1131), "an opening bracket '[' is missing".into(), None),
            Self::MissingCloseBracket => (Ps(1132), "a closing bracket ']' is missing".into(), None),
            Self::MissingEquals => (Ps(1133), "'=' is missing".into(), None),
            Self::MissingComma => (Ps(1134), "a comma is missing".into(), None),
            Self::IfFormat => (Ps(1137), "IF must be followed by a condition in brackets and GOTO or THEN".into(), Some("write IF[#1 EQ 0]GOTO 10 or IF[#1 EQ 0]THEN #2=3")),
            Self::WhileFormat => (Ps(1138), "WHILE must be followed by a condition in brackets and DO 1, 2 or 3".into(), Some("write WHILE[#1 LT 10]DO1")),
            Self::PositionOverflow { letter, value } => (Ps(1160), format!("{letter}{value} is beyond the range of positions"), None),
            Self::EndOfRecord => (Ps(5010), "the program ends without M02, M30 or M99".into(), None),
            Self::RepeatedAddress { letter } => (Ps(5074), format!("address {letter} stands twice in the block"), None),
            Self::Raised { number, text, plain: true } => (Mc(*number), text.clone(), None),
            Self::Raised { number, text, plain: false } => (Mc(3000u16.saturating_add(*number)), text.clone(), None),
            Self::NotSimulated { what } => (Sim(1), format!("{what} is not simulated"), Some("a control may have it; this simulator does not execute it and will not guess")),
        }
    }
}
