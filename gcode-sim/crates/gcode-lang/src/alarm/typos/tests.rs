//! Typing errors have a remedy, and others do not.
use super::*;
use crate::alarm::OtherControl;

/// Returns the remedy for an alarm at the first occurrence of `at` in the line.
fn help(alarm: Alarm, line: &str, at: &str) -> String {
    let mut sources = Sources::default();
    let text = format!("O1\n{line}\nM30\n");
    let source = sources.add("O1.nc", text.clone().into_bytes());
    let start = text.find(at).unwrap();
    let span = Span { source, start: start as u32, end: (start + at.len()) as u32 };
    remedy(&alarm, span, &sources).unwrap_or_default()
}

fn not_a_word() -> Alarm {
    Alarm::NotAWord { text: String::new() }
}

fn no_number(letter: char) -> Alarm {
    Alarm::NoDataAfterAddress { letter }
}

fn no_value() -> Alarm {
    Alarm::Expression { text: "X".into() }
}

#[test]
fn a_letter_o_in_a_number_has_a_remedy() {
    assert!(help(Alarm::MixedStatements, "G90 GO1 X10. F100.", "G90").contains("write G01"));
    assert!(help(no_value(), "GOO X10.", "O X").contains("write G00"));
    assert!(help(no_value(), "M3O", "O\n").contains("write M30"));
    assert!(help(no_number('Y'), "G00 X1O.5 Y", "Y").contains("write X10.5"));
    assert!(help(no_value(), "GO X5.", "X5.").contains("'GO' has the letter O instead of a zero: write G0"));
    assert!(
        help(no_value(), "#100=1O.", "O.").contains("'1O.' has the letter O instead of a zero: write 10.")
    );
    assert!(help(no_value(), "#5=O.5", "O.5").contains("write 0.5"));
    assert!(
        help(not_a_word(), "#1OO=5.", "OO").contains("'1OO' has the letter O instead of a zero: write 100")
    );
    assert!(help(not_a_word(), "IF[#1 EQ 2]GOTO 1O", "1O").contains("write 10"));
    for (alarm, line) in [
        (no_value(), "GO 10"),
        (no_value(), "#1=2OR#3"),
        (no_value(), "O1 X"),
        (no_value(), "GO TO X"),
        (Alarm::WhileFormat, "WHILE #1 LT 5 DO1"),
        (no_value(), "#1=ROUND X"),
    ] {
        assert!(!help(alarm, line, line).contains("letter O"), "{line}");
    }
}

#[test]
fn similar_characters_have_a_remedy() {
    assert!(
        help(no_number('X'), "G00 X\u{2212}10.", "X")
            .contains("U+2212 is not a character of a control: type the minus")
    );
    assert!(help(no_number('X'), "G00 X\u{2013}10.", "X").contains("type the minus"));
    assert!(help(not_a_word(), "G00\u{a0}X1.", "\u{a0}X").contains("type a space"));
    assert!(help(not_a_word(), "G00 \u{ff38}10.", "\u{ff38}").contains("type 'X' in half width"));
    assert!(help(not_a_word(), "G00 é", "é").contains("'é' (U+00E9)"));
    // A comment may contain any text.
    assert!(!help(no_number('X'), "G00 X (é)", "X").contains("character"));
}

#[test]
fn misplaced_commas_have_a_remedy() {
    assert_eq!(help(not_a_word(), "G00 X10,5", ",5"), "write 10.5: the decimal separator is a point");
    assert!(help(Alarm::CornerWords, "G00 X10., Y5.", ", Y").contains("not separated by commas"));
    assert!(!help(Alarm::CornerWords, "G01 X10.,R1.,C1.", ",R1").contains("not separated by commas"));
}

#[test]
fn notation_of_other_languages_has_a_remedy() {
    assert_eq!(help(Alarm::MixedStatements, "#1=1E3", "#1"), "write 1000 for 1E3: numbers have no exponent");
    let alarm = Alarm::ImproperAddress { letter: 'E' };
    assert_eq!(help(alarm, "G00 X2.5E-2", "E"), "write 0.025 for 2.5E-2: numbers have no exponent");
    assert!(help(no_number('E'), "IF[#1EQ1]THEN #2=1 ELSE #2=2", "ELSE").contains("no ELSE"));
    assert_eq!(help(Alarm::MissingEquals, "#1=5#2", "#2"), "check for a missing + - * or / before #2");
    assert_eq!(help(no_value(), "GOTO N10", "N10"), "write GOTO 10, without N");
    assert_eq!(help(no_value(), "G81 X[#1+5. Y0 Z-10.", "Y0"), "write ']' before Y0");
    assert_eq!(help(no_value(), "IF[#1 EQ 2 GOTO 5", "GOTO 5"), "write ']' before GOTO");
    assert_eq!(help(no_value(), "G81 X[#1+5.] Y0", "Y0"), "");
}

#[test]
fn impossible_numbers_have_a_remedy() {
    assert_eq!(help(Alarm::TwoSigns { letter: 'Z' }, "G00 Z--5", "-5"), "write one sign: Z-5, or Z-[-5]");
    assert_eq!(help(Alarm::DivideByZero, "#1=10/0", "10/0"), "correct the divisor: it is written as 0");
    assert!(help(Alarm::DivideByZero, "#1=10/#2", "10/#2").contains("vacant"));
    let small = |radius: f64| Alarm::RadiusTooSmall { radius, half_chord: 5.0 };
    assert_eq!(
        help(small(0.004), "G02 X10. R4", "R4"),
        "write R4.: R4 without a decimal point is 0.004 mm here"
    );
    // With calculator input a missing point is not the error.
    assert!(!help(small(4.0), "G02 X10. R4", "R4").contains("without"));
    assert!(help(Alarm::WordNotSimulated('X'), "G04 X1.5 P500", "X1.5").contains("one time"));
}

#[test]
fn a_function_without_brackets_is_written_with_them() {
    assert_eq!(help(Alarm::MissingOpenBracket, "#100=SIN30", "30"), "write SIN[30]");
    assert_eq!(help(Alarm::MissingOpenBracket, "#1=2*ABS -#2+1", "-#2"), "write ABS[-#2]");
    assert!(help(Alarm::MissingOpenBracket, "#1=1+2]", "]").contains("unmatched"));
}

#[test]
fn a_code_of_another_control_names_it() {
    let improper = |other| Alarm::ImproperGCode { code: "187".into(), other };
    let haas = OtherControl { name: "haas-ngc", is_turning_cycle: false };
    assert!(help(improper(Some(haas)), "G187 P1", "G187").starts_with("haas-ngc has it"));
    let turning = OtherControl { is_turning_cycle: true, ..haas };
    let begin = "on a lathe it is a turning cycle";
    assert!(help(improper(Some(turning)), "G71 U2. R1.", "G71").starts_with(begin));
    assert_eq!(
        help(improper(None), "G187 P1", "G187"),
        "correct it; if this machine has it, give what it does: --code G187=wait, --code G187=nothing, or the number of the macro that it calls"
    );
}

#[test]
fn a_vacant_jump_target_is_named() {
    let range = |number| Alarm::SequenceNumberRange { number };
    let vacant = help(range(0), "GOTO#1", "#1");
    assert_eq!(vacant, "check #1: a vacant variable counts as 0; write 1 to 99999999");
    assert_eq!(help(range(-5), "GOTO#1", "#1"), "write 1 to 99999999");
    assert_eq!(help(range(0), "GOTO0", "0"), "write 1 to 99999999");
}

#[test]
fn an_offset_number_has_the_range_of_its_code() {
    let remedy = |number, line| help(Alarm::OffsetNumber { number }, line, line);
    for line in ["G90 G54.1 P400", "G10 L20 P400 X0", "G10L20P400.X0", "G54 P0400", "g154 p400"] {
        assert!(remedy(400, line).contains("P1 to P300"), "{line}");
    }
    assert!(remedy(0, "G54.1 P0").contains("P1 to P300"));
    assert!(remedy(7, "G10 L2 P7 X0").contains("P0 for the external offset"));
    for line in ["G54 G43 H400", "G54.1 P1 G43 H400", "G10 L10 P400 R0", "G54.1 P#1"] {
        assert!(remedy(400, line).contains("OFFSETS"), "{line}");
    }
}

#[test]
fn what_is_typed_for_a_number_is_named() {
    let in_brackets = || Alarm::RoundBracketsForValue;
    let prose = "write a number before the comment, or remove the letter";
    assert_eq!(help(in_brackets(), "G01 Z (Move to Z depth) F5.", "(Move to Z depth)"), prose);
    assert_eq!(help(in_brackets(), "G01 Z(SIN(30)*#1)", "(SIN(30)*#1)"), "write '[' and ']'");
    let no_number = || Alarm::RoundBrackets { letter: Some('F') };
    assert_eq!(help(no_number(), "G01 Z-1. F (feed) M8", "(feed) M8"), prose);
    assert_eq!(help(no_number(), "G01 Z-1. F(#1*2) M08 AA", "(#1*2) M08 AA"), "write '[' and ']'");
    let feed = "set #513 above 0 before this block: vacant or 0 it is no feed";
    assert_eq!(help(Alarm::FeedZero, "G31 Z-5. F#513", "G31 Z-5. F#513"), feed);
    assert_eq!(help(Alarm::FeedZero, "G1 X5.", "G1 X5."), "command F before or in this block");
    assert_eq!(help(Alarm::DivideByZero, "#1=5/#27", "5/#27"), "check #27: a vacant variable counts as 0");
    assert!(help(Alarm::WhileFormat, "ENDIF", "IF").contains("a control has no ENDIF"));
    let named = "write [#RADIUS] for a variable that SETVN names, or its number";
    assert_eq!(help(no_value(), "G01 X#[RADIUS] F100.", "RADIUS]"), named);
    assert_eq!(help(no_value(), "G01 X#<radius> F100.", "<radius>"), named);
    assert_eq!(help(no_value(), "G01 X#[5+] F100.", "]"), "");
    let of_program = "write O0001: a program number begins with the letter O";
    assert_eq!(help(not_a_word(), "00001 ;", "00001 ;"), of_program);
    assert!(!help(not_a_word(), "0001", "0001").contains("program"));
}
