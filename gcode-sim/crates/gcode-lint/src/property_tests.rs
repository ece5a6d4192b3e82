//! Property of the check after an edit: it finds what a check of the new text finds.
use proptest::collection::vec;
use proptest::prelude::*;

use crate::*;
use gcode_lang::program::NoLibrary;

/// Blocks of all kinds, some of them only parts of blocks.
const BLOCKS: &str = "(N[1-4]0 ?)?(G0?[0-3] ?)?X[0-9]\\.(Y[0-9]{1,2})?( F[0-9]0\\.)?|M30|M99|G81Z-1\\.R1\\.|#1=#2|#[1-4]=#[1-4]\\+1|IF\\[#1EQ#0\\]GOTO[1-4]0\
    |GOTO[1-4]0|M98P2|G65P2A1\\.|WHILE\\[#1LT2\\]DO1|END1|\\(A\\)|O2|%|IF\\[#1EQ2\\]THEN#3000=1\\(A\\)|G4X#7|X1\\.\\.|/2X1\\.";

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
        edits in vec((any::<prop::sample::Index>(), 0..4_usize, proptest::string::string_regex(&format!("({BLOCKS}|\n|\r|\\(|=)?")).unwrap()), 1..4),
    ) {
        let settings = Settings::default();
        let control = (&settings, ControlKnowledge::Stated);
        let mut text = format!("O1{end}{}{end}(END OF ALL)", lines.join(end)).into_bytes();
        let named = |text: &[u8]| ("O1.nc".to_owned(), Bytes::from(text));
        let mut before = check_edited(named(&text), ReadBlocks::default(), control, &mut NoLibrary);
        for (at, length, new) in edits {
            let from = at.index(text.len());
            text.splice(from..(from + length).min(text.len()), new.bytes());
            let edited = check_edited(named(&text), before.read_blocks, control, &mut NoLibrary);
            let fresh = check("O1.nc", &text[..], &settings, &mut NoLibrary);
            prop_assert_eq!(shown(&edited), shown(&fresh), "{}", String::from_utf8_lossy(&text));
            prop_assert_eq!(edited.programs, fresh.programs);
            before = edited;
        }
    }
}
