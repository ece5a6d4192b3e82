//! Files as senders, editors and memory dumps leave them: their line ends, their bytes, their sizes.
use gcode_lang::source::SourceId;
use gcode_lang::syntax::{parse, print};
use gcode_tests::expect;
use proptest::prelude::*;

/// The program that the first tests write in different ways.
const LINES: [&str; 8] =
    ["%", "O0001(PLATE)", "G90 G00 X1.", "N10 #100=#100+1", "IF[#100 LT 3]GOTO 10", "Y[#100]", "M30", "%"];

fn ends_as_the_program(bytes: &[u8]) {
    let wrong = expect::run(bytes).differences("end=normal; #100=3; path=R(1,0,0) R(1,3,0)");
    assert!(wrong.is_empty(), "{:?}: {wrong:?}", String::from_utf8_lossy(bytes));
}

#[test]
fn line_ends_change_nothing() {
    for end in [
        "\n", "\r\n", "\n\r\r", "\r", "\r\r\n", ";\n", " ;\r\n", " \n", "\t\r\n", "\n\n", "\r\n\r\n", " ; \n",
    ] {
        ends_as_the_program(LINES.join(end).as_bytes());
        ends_as_the_program(format!("{}{end}", LINES.join(end)).as_bytes());
    }
    let ends = ["\n", "\r\n", "\n\r\r", "\r"];
    let mixed: String = LINES.iter().enumerate().map(|(i, line)| format!("{line}{}", ends[i % 4])).collect();
    ends_as_the_program(mixed.as_bytes());
}

#[test]
fn text_round_the_tape_changes_nothing() {
    let tape = LINES.join("\r\n");
    let body = LINES[1..7].join("\n");
    for text in [
        format!("\u{feff}{tape}"),
        format!("\u{feff}\u{feff}{tape}\n"),
        format!("{tape}\r\n\u{1a}"),
        format!("{tape}\u{1a}\u{1a}\u{1a}"),
        format!("{tape}\n\0\0\0"),
        format!("\0\0{tape}"),
        format!("\r\n\r\n{tape}\n\n"),
        format!("PLATE 7, REV B\n{tape}"),
        body.clone(),
        format!("%\n{body}"),
        format!("{tape}\n\u{1a}\n%\nO0002\nM99\n%\u{1a}"),
        format!("{body}\n%"),
        format!("%{body}\n%"),
        LINES.join("\n").to_lowercase(),
    ] {
        ends_as_the_program(text.as_bytes());
    }
}

/// What was read, printed and read again.
fn printed(bytes: &[u8]) -> Vec<u8> {
    parse(SourceId(0), bytes).iter().flat_map(print).collect()
}

fn contains(text: &[u8], part: &[u8]) -> bool {
    text.windows(part.len()).any(|window| window == part)
}

#[test]
fn comments_in_other_alphabets_stay_byte_for_byte() {
    // A Chinese one in GBK, a German one in Latin-1, a Japanese one in Shift JIS, a Russian one in UTF-8.
    for comment in [
        &b"(\xd0\xcd\xc7\xbb\xbc\xd3\xb9\xa4 D10)"[..],
        b"(Bohrung f\xfcr \xd88,5 \xb10,02)",
        b"(\x8c\x8a\x89\xc1\x8d\x48\x83\x5c)",
        "(отверстие)".as_bytes(),
    ] {
        let program = [b"O1", comment, b"\nG0", comment, b"X1.\n#100=1", comment, b"\nM30\n"].concat();
        let text = printed(&program);
        assert!(contains(&text, comment), "{:?}", String::from_utf8_lossy(&text));
        assert_eq!(printed(&text), text);
        expect::run(&program).must("end=normal; abs.X=1; #100=1");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn comments_of_any_bytes_stay_as_they_are(
        bytes in prop::collection::vec(any::<u8>().prop_filter("no end and no setting", |b| !b"()\r\n@".contains(b)), 0..40)
    ) {
        let comment = [b"(", &bytes[..], b")"].concat();
        let program = [b"O1\nG0 X1.", &comment[..], b"Y2.\nM30\n"].concat();
        prop_assert!(contains(&printed(&program), &comment));
        let wrong = expect::run(&program).differences("end=normal; path=R(1,2,0)");
        prop_assert!(wrong.is_empty(), "{:?}", wrong);
    }
}

/// A memory dump of 40 programs in four folders: each calls the next, the first is run.
fn dump() -> String {
    let mut text = "%\r\n".to_owned();
    for number in 1..=40 {
        if number % 10 == 1 {
            text.push_str(&format!("&F=//CNC_MEM/USER/FOLDER{}/\r\n", number / 10));
        }
        text.push_str(&format!("O{number:04}(PROGRAM {number})\r\n#100=#100+{number}\r\n"));
        let (next, end) = (number + 1, if number == 1 { "M30" } else { "M99" });
        // Nine calls inside one another and the main program: the first of each ten is called from there.
        match number {
            1 => text.push_str("M98P0002\r\nM98P0011\r\nM98P0021\r\nM98P0031\r\n"),
            _ if number % 10 == 0 => {}
            _ => text.push_str(&format!("M98P{next:04}\r\n")),
        }
        text.push_str(&format!("{end}\r\n"));
    }
    text + "%\r\n"
}

#[test]
fn a_memory_dump_of_forty_programs_runs() {
    let ran = expect::run(dump().as_bytes());
    assert_eq!(ran.control.memory().programs().len(), 40);
    // 1 + 2 + … + 40.
    ran.must("end=normal; #100=820");
}

#[test]
fn a_hundred_thousand_lines_are_read_and_run() {
    let mut text = "%\nO0001\nG90 G94 F1000\n".to_owned();
    for line in 1..=99_990 {
        text.push_str(&format!("N{line} G01 X{}. Y-{}.5\n", line % 200, line % 7));
    }
    text.push_str("M30\n%\n");
    // 99,990 = 499 × 200 + 190 = 14,284 × 7 + 2.
    expect::run(text.as_bytes()).must("end=normal; abs.X=190; abs.Y=-2.5");
}
