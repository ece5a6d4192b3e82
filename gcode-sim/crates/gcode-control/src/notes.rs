//! Notes: things that a control does without an alarm and a programmer rarely means; one finding per kind, at its first
//! block.
use gcode_lang::control::assumed_machine_value;
use gcode_lang::diag::FindingKind;
use gcode_lang::program::PROGRAM_ZERO_NOTE;
use gcode_lang::program::g_codes::{name, spelled};

gcode_lang::finding_kinds! {
    "../../../../docs/explain/";
    ATAN_OF_0 = "atan-of-0", Warning, "ATAN of 0 and 0";
    AXIS_LEFT_OUT = "axis-left-out", Warning, "a first move that omits an axis";
    BLOCK_SKIP = "block-skip", Note, "the result holds for one position of the block skip switch";
    BUILDER_CODE = "builder-code", Warning, "a code of some machine builders is taken as an accuracy mode";
    CENTRE_HERE = "centre-here", Note, "a centre at the current point";
    COMPENSATION_LEFT = "compensation-left", Warning, "G41 or G42 left in force";
    CORNER_IGNORED = "corner-ignored", Warning, ",R or ,C without effect";
    CANCEL_OF_NOTHING = "cancel-of-nothing", Note, "G67 in a block that resets modes, without G66";
    CYCLE_DATA_LOST = "cycle-data-lost", Warning, "P or Q in a block that does not drill";
    DIGITS_LOST = "digits-lost", Warning, "DPRNT without the upper digits";
    DOUBLED_NUMBER = "doubled-number", Warning, "a jump to one of several N";
    DRILL_PLANE = "drill-plane", Warning, "a cycle drills along Z while another plane is active";
    END_BEFORE_SWITCH = "end-before-switch", Warning, "a position read after a change of coordinates";
    END_IN_CALL = "end-in-call", Note, "M02 or M30 in a called program";
    ENGRAVED_TEXT = "engraved-text", Warning, "the strokes of engraved text are unknown";
    G53_IGNORED = "g53-ignored", Warning, "G53 in G91 moves nothing";
    INTO_LOOP = "into-loop", Warning, "a jump into a loop";
    LARGE_ALARM_NUMBER = "large-alarm-number", Warning, "the number of #3000 exceeds its range";
    LENGTH_OF_NOTHING = "length-of-nothing", Warning, "G43 without H";
    LEVEL_MISSING = "level-missing", Warning, "a canned cycle without R or without its depth";
    LONG_M_CODE = "long-m-code", Warning, "an M code with more than four digits";
    LOWER_CASE = "lower-case", Note, "lower-case letters are read as capitals";
    M_CODE_LOST = "m-code-lost", Warning, "only the last M code of a block counts";
    MACHINE_VALUE = "machine-value", Warning, "a value of the machine that nothing states";
    MAIN_REPEATS = "main-repeats", Error, "the main program ends with M99";
    MIRROR_ENDED = "mirror-ended", Note, "G50.1 without an axis";
    NESTED_COMMENT = "nested-comment", Warning, "a word behind a comment inside a comment";
    NO_ANGLE = "no-angle", Warning, "G68 without R";
    NO_AXIS = "no-axis", Warning, "a code without an axis";
    NO_INTERRUPT = "no-interrupt", Warning, "the macro of M96 is never called";
    NO_KINEMATICS = "no-kinematics", Warning, "rotary axes that the machine file does not describe";
    NO_PASS = "no-pass", Warning, "a call with L0";
    NO_REPEATS = "no-repeats", Note, "K0 stores a cycle and drills nothing";
    NO_SIGNAL = "no-signal", Warning, "G31 goes to its end";
    OTHER_FOLDER = "other-folder", Warning, "a called program in a folder that a control does not search";
    PARAMETER_WITHOUT_EFFECT = "parameter-without-effect", Warning, "a written parameter has no effect here";
    PARAMETER_UNSIMULATED = "parameter-unsimulated", Warning, "a written parameter may change what is not simulated";
    PARAMETER_VALUE = "parameter-value", Warning, "a parameter that nothing states";
    POCKET_CLEARING = "pocket-clearing", Warning, "the passes that clear a pocket are unknown";
    PROGRAM_ZERO = "program-zero", Note, "a program with the number 0";
    SECOND_BLOCK = "second-block", Warning, "a block behind a semicolon in its line";
    RADIUS_OF_NOTHING = "radius-of-nothing", Warning, "G41, G42 or G45 to G48 without D";
    TANGENT_OF_90 = "tangent-of-90", Warning, "TAN of 90 degrees";
    UNCLOSED_COMMENT = "unclosed-comment", Note, "a comment without its closing bracket";
    SHIFT_MISSING = "shift-missing", Warning, "a boring cycle that shifts by 0";
    POSTURE_CONTROL = "posture-control", Note, "tool posture control goes another way to the same ends";
    STROKE_AREA = "stroke-area", Warning, "the area of G22 is not checked";
    WORD_IGNORED = "word-ignored", Warning, "a word without effect in a straight move";
    WORDS_PASSED_ON = "words-passed-on", Warning, "a word beside an M code of the machine builder";
}

/// Thing that a control does without an alarm and a programmer rarely means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Note {
    /// G53 in G91 is ignored, and with it the block's motion.
    MachineMoveIgnored,
    /// A block has another M code after this one, and only the last counts.
    MCodeLost(u32),
    /// G67 stands beside other G codes in a block that resets modes, and no modal call is in force.
    NothingToCancel,
    /// A block follows another one and `;` in its line.
    SecondBlock,
    /// P or Q in cycle mode, in a block that names no axis and no R: it drills nothing and stores nothing.
    CycleDataLost,
    /// M96 lets a signal call a macro, and no signal comes in a run.
    InterruptNotSimulated,
    /// G31 gets no skip signal: there is no part to touch and no setting for the signal.
    NoSkipSignal,
    /// A word beside an M code of the machine builder that nothing else in the block reads.
    WordsPassedOn {
        /// M code.
        code: u32,
        /// Letter of the word.
        letter: char,
    },
    /// I, J, K, P, Q or R in a block with a straight move has no effect.
    WordIgnored(char),
    /// A code × 10 that some machine builders add counts as an accuracy mode.
    BuilderCode(u32),
    /// G22 sets an area that the tool must not enter, which is not checked.
    AreaUnchecked,
    /// `,R` or `,C` in a block that is no cutting move is ignored.
    CornerIgnored,
    /// A canned cycle with K0 stores its data and drills nothing, as K0 should; whether it moves to its X and Y differs
    /// between controls.
    CycleRepeatsZero,
    /// A call with L0 calls nothing.
    CallRepeatsZero,
    /// A code that acts on axes, × 10, in a block that names none. G53 then only waits.
    NoAxis(u32),
    /// G51 or G68, × 10, without axes: the programmed position is the centre.
    CentreDefaulted(u32),
    /// A called program is in a folder of the dump that a control does not search.
    ProgramOutOfReach,
    /// G68 without R rotates by 0, or by 5410 if that is set.
    NoAngle,
    /// GOTO or M99 P goes to one of several blocks with this number.
    DuplicateNumber(u32),
    /// A jump into the loop with this number, whose END will have no DO.
    JumpIntoLoop(u8),
    /// TAN of 90 degrees is a large number.
    TangentOf90,
    /// ATAN of 0 and 0 is 0.
    AtanOf0,
    /// G10 L52 has written this parameter, which has no effect in the simulator.
    ParameterWithoutEffect(u16),
    /// G10 L52 has written this parameter, whose effect is not simulated.
    ParameterUnsimulated(u16),
    /// PRM has read this parameter as 0, because nothing states it.
    ParameterUnknown(u16),
    /// The program has letters in lower case, which some controls refuse.
    LowerCase,
    /// An M code of more than four digits for the machine builder; M981000 was M98 P1000 on older controls.
    LongMCode(u32),
    /// #5001… are read after a change of G51.1, G51 or G68, with which the coordinates of the tool have changed.
    EndPointBeforeTransform,
    /// The first move after such a change omits an axis whose coordinate has changed.
    AxisLeftOut,
    /// DPRNT has printed only the lower digits of a number.
    DigitsLost,
    /// A canned cycle drills before this level, its R or its depth, is commanded.
    CycleLevelMissing(char),
    /// G76 or G87 with a shift of 0: the bar stays at the wall.
    CycleShiftZero,
    /// G43 or G44, × 10, with H0, which is no offset.
    LengthOffsetZero(u32),
    /// G41, G42 or G45 to G48, × 10, with offset 0, which is no radius.
    CutterRadiusZero(u32),
    /// G41 or G42, × 10, is in force at the tool change.
    CompensationAtToolChange(u32),
    /// G41 or G42, × 10, is in force at the end of the program.
    CompensationAtEnd(u32),
    /// G50.1 without an axis ends the mirror images of all axes.
    MirrorEnded,
    /// A value of the machine, such as a setting of a Haas, is read as 0 because nothing states it.
    MachineValueUnknown {
        /// Variable.
        number: u32,
        /// Number behind its point.
        item: Option<u32>,
    },
    /// G47 of a Haas runs as one cut below its text: number of characters, and their height in mm.
    Engraving {
        /// Number of characters.
        characters: u32,
        /// Height × 1000, mm.
        height: u32,
    },
    /// G150 of a Haas runs as one cut along its outline.
    PocketClearing,
    /// The program has the number 0, with which a control does not store it.
    ProgramZero,
    /// M99 of the main program ends the run, where a control starts again.
    MainRepeats,
    /// M02 or M30 ends the run in a called program: what follows the call is not executed.
    EndInCall,
    /// A code × 10 depends on the kinematics of the machine, which nothing states.
    NoKinematics(u32),
    /// A comment extends to the end of its block.
    UnclosedComment,
    /// A comment with a comment inside has a word behind it, which a control may read.
    NestedComment,
    /// A block, or the rest of one, after `/`, which depends on a switch of block skip.
    BlockSkip {
        /// Number of the switch.
        switch: u8,
        /// Its position.
        is_on: bool,
    },
    /// A canned cycle drills along Z while G18 or G19, × 10, is active, as with FXY 5101#0 = 0.
    DrillsAlongZ(u32),
    /// P1 of G43.4 or G43.5, × 10: tool posture control.
    PostureControl(u32),
    /// `#3000=n` with a number beyond those of the manuals.
    LargeAlarmNumber {
        /// Number in the program.
        number: u16,
        /// Largest number in the manuals.
        max: u16,
    },
}

impl Note {
    /// Returns the kind of finding, the message and the remedy.
    #[rustfmt::skip]
    pub fn describe(self) -> (&'static FindingKind, String, &'static str) {
        match self {
            Self::MachineMoveIgnored => (&G53_IGNORED, "G53 in G91 is ignored: the axes of the block do not move".into(), "command G90 with G53, or give --control G53-IN-G91=1 for a control that moves by the increment"),
            Self::MCodeLost(code) => (&M_CODE_LOST, format!("M{code:02} is lost: of several M codes in a block only the last counts"), "write each M code in a block of its own, or give --control M3B=1 for a control that accepts three"),
            Self::NothingToCancel => (&CANCEL_OF_NOTHING, "G67 without G66 is ignored in a block that resets modes: a control with 6000#0 = 0 raises PS1100".into(), "remove G67, or give --control G67-ALARM=1 for a control that raises the alarm, G67-ALARM=0 for one that does not"),
            Self::SecondBlock => (&SECOND_BLOCK, "the text behind ; is a block of its own, and it is executed".into(), "write the block on a line of its own, a comment in round brackets"),
            Self::CycleDataLost => (&CYCLE_DATA_LOST, "P or Q is not stored: the block drills nothing".into(), "write P and Q in the block of a hole"),
            Self::InterruptNotSimulated => (&NO_INTERRUPT, "the macro of M96 is never called: a run has no UINT signal".into(), "call the macro with G65 to simulate it"),
            Self::NoSkipSignal => (&NO_SIGNAL, "no skip signal is simulated: G31 moves to its end point".into(), "give the part with --part, or --control SKIP=0.5 for a signal after half of the path"),
            Self::WordsPassedOn { code, letter } => (&WORDS_PASSED_ON, format!("{letter} is passed to the machine builder's logic with M{code:02}"), "see the machine's manual for the words of this M code"),
            Self::WordIgnored(letter) => (&WORD_IGNORED, format!("{letter} has no effect in a straight move"), "remove it, or write the code that uses it"),
            Self::BuilderCode(code) => (&BUILDER_CODE, format!("{} is a code of some machine builders: it counts as an accuracy mode, without effect on the path", name(code)), "declare what the machine does with it in [codes] of the control file"),
            Self::AreaUnchecked => (&STROKE_AREA, "not checked: the area of G22, which the tool must not enter".into(), "check the area on the control; 1320 and 1321 are checked"),
            Self::CornerIgnored => (&CORNER_IGNORED, ",R and ,C are ignored: the block is not a cutting move".into(), "write them in a block of G01, G02 or G03"),
            Self::CycleRepeatsZero => (&NO_REPEATS, "K0 stores the cycle without a move to the block's X and Y".into(), "give --control K0-MOVES=1 for a control that moves there"),
            Self::CallRepeatsZero => (&NO_PASS, "L0: the program is not called".into(), "omit L to call it once"),
            Self::NoAxis(code) => (&NO_AXIS, format!("G{} without an axis: nothing moves or is set", spelled(code)), "name the axes"),
            Self::CentreDefaulted(code) => (&CENTRE_HERE, format!("G{} without an axis: the programmed position is its centre", spelled(code)), "name the axes of the centre"),
            Self::ProgramOutOfReach => (&OTHER_FOLDER, "the called program is in a folder that a control does not search: PS0076 there".into(), "move it to the folder of the main program or to //CNC_MEM/USER/LIBRARY/"),
            Self::NoAngle => (&NO_ANGLE, "G68 without R rotates by 0; a control may have an angle in 5410".into(), "write R"),
            Self::DuplicateNumber(number) => (&DOUBLED_NUMBER, format!("N{number} is defined more than once: the control decides which one a jump takes"), "give each block a number of its own"),
            Self::JumpIntoLoop(number) => (&INTO_LOOP, format!("a jump into the loop DO{number}: its END raises PS1124"), "jump to the block of its DO or WHILE"),
            Self::TangentOf90 => (&TANGENT_OF_90, "TAN of 90 degrees is undefined: some controls raise an alarm, here the result is a large number".into(), "test the angle first; give --control TAN-90-ALARM=1 for a control that raises the alarm"),
            Self::AtanOf0 => (&ATAN_OF_0, "ATAN of 0 and 0 is undefined: some controls raise an alarm, here the result is 0".into(), "test both values first; give --control ATAN-0-ALARM=1 for a control that raises the alarm"),
            Self::ParameterWithoutEffect(number) => (&PARAMETER_WITHOUT_EFFECT, format!("parameter {number} is stored for PRM and has no other effect here"), "see docs/control.md for what is not simulated"),
            Self::ParameterUnsimulated(number) => (&PARAMETER_UNSIMULATED, format!("not checked: what a change of parameter {number} does: it is stored for PRM only"), "see docs/control.md for the parameters that count"),
            Self::ParameterUnknown(number) => (&PARAMETER_VALUE, format!("PRM[{number}] reads as 0: nothing states the parameter"), "write it with G10 L52 in a program that this one calls, or compare with the control"),
            Self::LowerCase => (&LOWER_CASE, "lower case is read as capitals; some controls refuse it".into(), "write capitals; give --control LOWER-CASE=0 for a control that refuses lower case"),
            Self::LongMCode(code) => (&LONG_M_CODE, format!("M{code} calls no program: it is one M code, left to the machine builder"), "write P before the program number: M98 P1000"),
            Self::EndPointBeforeTransform => (&END_BEFORE_SWITCH, "#5001 and following are the end point of the last move as programmed, before the change of G51.1, G51 or G68".into(), "read them after the next move, or before the change"),
            Self::AxisLeftOut => (&AXIS_LEFT_OUT, "an omitted axis keeps its position here; after a change of G51.1, G51 or G68 a control may move it".into(), "name every axis in the first move after the change"),
            Self::DigitsLost => (&DIGITS_LOST, "DPRNT prints only the lower digits: the format has too few places".into(), "give the format more places, or --control PRINT-EXPANDS=1 for a control that prints all digits"),
            Self::CycleLevelMissing(letter) => (&LEVEL_MISSING, format!("the cycle drills with {letter} at 0: no value was commanded"), "write R and the depth in the block that begins the cycle"),
            Self::CycleShiftZero => (&SHIFT_MISSING, "the cycle shifts the boring bar by 0: it is drawn along the wall of the hole".into(), "write the shift in Q; G86 bores without one"),
            Self::LengthOffsetZero(code) => (&LENGTH_OF_NOTHING, format!("G{} with H0 applies no tool length compensation", spelled(code)), "write H with the number of the tool's offset"),
            Self::CutterRadiusZero(code @ 450..=480) => (&RADIUS_OF_NOTHING, format!("G{} with offset 0 moves to the end as written", spelled(code)), "write D with the number of the tool's offset; G43 H compensates a tool length"),
            Self::CutterRadiusZero(code) => (&RADIUS_OF_NOTHING, format!("G{} with D0 applies no cutter compensation", spelled(code)), "write D with the number of the tool's radius offset"),
            Self::CompensationAtToolChange(code) => (&COMPENSATION_LEFT, format!("G{} is in force at the tool change: the moves after it are beside the path that is written", spelled(code)), "command G40 where the tool leaves the contour"),
            Self::CompensationAtEnd(code) => (&COMPENSATION_LEFT, format!("G{} is in force at the end of the program: the last moves are beside the path that is written", spelled(code)), "command G40 where the tool leaves the contour"),
            Self::MirrorEnded => (&MIRROR_ENDED, "G50.1 without an axis ends all mirror images".to_owned(), "name the axes: the manuals give G50.1 with axes only"),
            Self::MachineValueUnknown { number, item } => (&MACHINE_VALUE, match item { Some(item) => format!("#{number}.{item} reads as {}: nothing states its value on the machine", assumed_machine_value(number, item.into())), None => format!("#{number} reads as 0: nothing states its value on the machine") }, "give its value with --input, written '#NUMBER=VALUE', or in the control file"),
            Self::Engraving { characters, height } => (&ENGRAVED_TEXT, format!("not checked: engraving: the strokes of G47 are in a box of {} mm by {} mm that begins at X and Y, and the run makes one cut along its base", f64::from(characters * height) / 1000.0, f64::from(height) / 1000.0), "check the text on the control"),
            Self::PocketClearing => (&POCKET_CLEARING, "not checked: pocket clearing: the run makes one cut along the outline of G150, at its full depth, and none of the passes before it".into(), "check the clearing passes on the control"),
            Self::ProgramZero => (&PROGRAM_ZERO, PROGRAM_ZERO_NOTE.0.into(), PROGRAM_ZERO_NOTE.1),
            Self::MainRepeats => (&MAIN_REPEATS, "M99 ends the main program: a control starts it again for ever, the run ends after the first pass".into(), "end it with M30, or state the passes with --cycles 1"),
            Self::EndInCall => (&END_IN_CALL, "this block ends the run in a called program: nothing behind the call is executed".into(), "write M99 where the caller goes on"),
            Self::NoKinematics(code @ (542 | 544)) => (&NO_KINEMATICS, format!("the offsets of {} are taken as 0: nothing states them, and where X, Y and Z are on the part is unknown", name(code)), "write the offset into a work offset, or end it with P0"),
            Self::NoKinematics(code) => (&NO_KINEMATICS, format!("{} without the rotary axes of the machine: X, Y and Z go on as if a table had turned the part, and where they and the rotary axes are on the machine is unknown", name(code)), "describe [[table]] or [[head.axis]], and [head], in the machine file"),
            Self::UnclosedComment => (&UNCLOSED_COMMENT, "the comment is not closed: the rest of the block is comment".to_owned(), "close it with ): some controls refuse the block"),
            Self::NestedComment => (&NESTED_COMMENT, "a comment stands inside a comment: a control ends it at the first ), and reads the words behind that".to_owned(), "take the inner brackets out"),
            Self::BlockSkip { switch, is_on: true } => (&BLOCK_SKIP, format!("the rest of the block after / is skipped: block skip {switch} is on; all results assume this setting"), "give --control BDT without its number to switch it off"),
            Self::BlockSkip { switch, is_on: false } => (&BLOCK_SKIP, format!("the rest of the block after / is executed: block skip {switch} is off; all results assume this setting"), "give --control BDT with its number, as BDT=2 or BDT=1+2, to switch it on"),
            Self::DrillsAlongZ(code) => (&DRILL_PLANE, format!("the cycle drills along Z while G{} is in force: a control may drill along the normal of that plane", spelled(code)), "write G17, or give --control FXY=1 for a control that drills along the normal"),
            Self::PostureControl(code) => (&POSTURE_CONTROL, format!("P1 of {} is tool posture control: the ends of the blocks are right, and how the rotary axes turn on the way differs", name(code)), "check on the control the way of a block that turns two rotary axes"),
            Self::LargeAlarmNumber { number, max } => (&LARGE_ALARM_NUMBER, format!("#3000={number}: the manuals give numbers up to {max}"), "use a smaller number"),
        }
    }
}
