//! Property of the check after an edit: it finds what a check of the new text finds.
use proptest::collection::vec;
use proptest::prelude::*;

use crate::*;
use gcode_lang::control::Dialect;
use gcode_lang::program::NoLibrary;

/// Blocks of all kinds, some of them only parts of blocks.
const BLOCKS: &str = "(N[1-4]0 ?)?(G0?[0-3] ?)?X[0-9]\\.(Y[0-9]{1,2})?( F[0-9]0\\.)?|M30|M99|G81Z-1\\.R1\\.|#1=#2|#[1-4]=#[1-4]\\+1|IF\\[#1EQ#0\\]GOTO[1-4]0\
    |GOTO[1-4]0|M98P2|G65P2A1\\.|WHILE\\[#1LT2\\]DO1|END1|\\(A\\)|O2|%|IF\\[#1EQ2\\]THEN#3000=1\\(A\\)|G4X#7|X1\\.\\.|/2X1\\.\
    |#34=#[1-4]|#100=#10[0-9]\\+1|#101=#450|#2=#[1-4]\\*3\\.14|#101=SQRT\\[-4\\]|#3=#5021|IF\\[#10[0-1]EQ#[0-1]\\](GOTO[1-4]0|THEN#10?1=5\\.)|IF\\[#0EQ#0\\]GOTO20|WHILE\\[#101LT[#2]2\\]DO1|\\(CHECK-OFF ROUNDED-PI\\)|X#101";

fn shown(checked: &CheckResult) -> Vec<String> {
    let each = checked.findings.iter().map(|f| {
        format!(
            "{} {:?} {} {:?} {:?} {:?} {:?}",
            f.kind, f.severity, f.message, f.backtrace, f.span, f.labels, f.help
        )
    });
    each.collect()
}

proptest! {
    /// Three edits, each of any stretch of the text, with the blocks of the check before.
    #[test]
    fn a_check_after_an_edit_finds_what_a_check_of_the_text_finds(
        lines in vec(proptest::string::string_regex(BLOCKS).unwrap(), 1..25),
        end in proptest::sample::select(vec!["\n", "\r\n"]),
        edits in vec((any::<prop::sample::Index>(), 0..4_usize, proptest::string::string_regex(&format!("({BLOCKS}|\n|\r|\\(|=)?")).unwrap(), any::<bool>()), 1..4),
    ) {
        let mut haas = Settings::default();
        haas.apply_dialect(Dialect::HaasNgc);
        let mut text = format!("O1{end}{}{end}(END OF ALL)", lines.join(end)).into_bytes();
        let named = |text: &[u8]| ("O1.nc".to_owned(), Bytes::from(text));
        let (stated, fanuc) = (ControlKnowledge::Stated, Settings::default());
        let mut before =
            check_edited(named(&text), CheckedBlocks::default(), (&fanuc, stated), FindingLimit::NONE, &mut NoLibrary);
        for (at, length, new, is_haas) in edits {
            let from = at.index(text.len());
            text.splice(from..(from + length).min(text.len()), new.bytes());
            // The editor's settings may name another control.
            let settings = if is_haas { &haas } else { &fanuc };
            let edited = check_edited(named(&text), before.blocks, (settings, stated), FindingLimit::NONE, &mut NoLibrary);
            let fresh = check("O1.nc", &text[..], settings, &mut NoLibrary);
            prop_assert_eq!(shown(&edited), shown(&fresh), "{}", String::from_utf8_lossy(&text));
            prop_assert_eq!(edited.programs, fresh.programs);
            before = edited;
        }
    }
}

/// A program of so many blocks that threads share them, with a fault in every thousandth block: √−4, a rounded π and #34 in
/// turn. An edit removes one fault, adds one and moves the others; a second one has the head turn a rule off.
#[test]
fn a_long_program_is_checked_after_an_edit_as_before_it() {
    const FAULTS: [&str; 3] = ["#101=SQRT[-4]", "#101=#102*3.14", "#34=1"];
    let line = |index: usize| match index % 1000 {
        999 => FAULTS[index / 1000 % 3].to_owned(),
        _ => format!("#{}=[#{}+{index}.]*2", 100 + index % 50, 110 + index % 30),
    };
    let mut lines: Vec<_> = (0..12_000).map(line).collect();
    let settings = Settings::default();
    let control = (&settings, ControlKnowledge::Stated);
    let check_lines = |lines: &[String], before| {
        let text = format!("O1\n{}\nM30\n", lines.join("\n"));
        check_edited(
            ("O1.nc".to_owned(), text.into_bytes().into()),
            before,
            control,
            FindingLimit::NONE,
            &mut NoLibrary,
        )
    };
    let places = |checked: &CheckResult| -> Vec<(String, u32)> {
        let line =
            |f: &Diagnostic| checked.memory.sources().line_column(f.backtrace.as_ref().unwrap().block).line;
        checked.findings.iter().map(|f| (f.code().into_owned(), line(f))).collect()
    };
    let codes = ["constant-alarm", "rounded-pi", "no-such-variable"];
    // Line 1 is O1: block 999 stands in line 1001.
    let expected = |all: std::ops::Range<usize>, moved: u32| -> Vec<(String, u32)> {
        all.map(|nth| (codes[nth % 3].to_owned(), nth as u32 * 1000 + 1001 + moved)).collect()
    };
    let first = check_lines(&lines, CheckedBlocks::default());
    assert_eq!(places(&first), expected(0..12, 0));
    // The fault in block 4999 goes; a new one stands in block 500, in a line of its own.
    lines[4999] = "#101=1.".to_owned();
    lines.insert(500, "#101=5./0".to_owned());
    let second = check_lines(&lines, first.blocks);
    let mut all = expected(0..4, 1);
    all.insert(0, ("constant-alarm".to_owned(), 502));
    all.extend(expected(5..12, 1));
    assert_eq!(places(&second), all);
    lines.insert(0, "(CHECK-OFF ROUNDED-PI)".to_owned());
    let third = check_lines(&lines, second.blocks);
    let off: Vec<_> = all.iter().filter(|(code, _)| code != "rounded-pi").collect();
    let off: Vec<_> = off.into_iter().map(|(code, line)| (code.clone(), line + 1)).collect();
    assert_eq!(places(&third), off);
    lines.remove(0);
    assert_eq!(places(&check_lines(&lines, third.blocks)), all);
}
