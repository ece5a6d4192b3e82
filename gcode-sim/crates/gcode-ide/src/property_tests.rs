//! Properties of all answers: no panic on any text, ranges inside it, and renames that lead back.
use gcode_lang::control::Settings;
use proptest::prelude::*;

use crate::project::Project;
use crate::text::{FileId, TextEdit, TextRange};

/// Lines that refer to one another, in any order.
const LINES: [&str; 24] = [
    "O1(A)",
    "O2",
    "N10 G0 X#1",
    "N20",
    "GOTO 10",
    "IF[#1 EQ #2]GOTO20",
    "#1=#100+1",
    "#2=5",
    "#100=#1",
    "G65 P2 A1. B#2",
    "M98 P2",
    "M98 P2 Q10",
    "M99 P20",
    "M99",
    "M30",
    "WHILE[#1 LT 3]DO1",
    "END1",
    "(#1 = X)",
    "X..5 #1",
    "G66 P2 A2.",
    "#[#1]=2",
    "GOTO#1",
    "DPRNT[A#1[44]]",
    "%",
];

fn project(text: &str) -> Project {
    let mut project = Project::new(Settings::default());
    project.set_file(FileId(0), "O7.nc", text.as_bytes());
    project
}

fn lines() -> impl Strategy<Value = String> {
    let line = prop::sample::select(LINES.to_vec());
    prop::collection::vec(line, 0..25).prop_map(|lines| lines.join("\n") + "\n")
}

/// Asks everything at an offset.
fn ask(project: &Project, offset: u32) {
    let file = FileId(0);
    let length = project.file(file).map_or(0, |index| index.text().len() as u32);
    let check = |range: TextRange| assert!(range.start <= range.end && range.end <= length, "{range:?}");
    for target in project.definition(file, offset).into_iter().flat_map(|found| found.targets) {
        check(target.range);
        check(target.selection);
    }
    project.references(file, offset, true).iter().for_each(|reference| check(reference.location.range));
    project.hover(file, offset).iter().for_each(|hover| check(hover.range));
    project.completions(file, offset).iter().for_each(|completion| check(completion.replace));
    project.signature_help(file, offset);
    project.call_item(file, offset).iter().for_each(|item| check(item.range));
    let _ = project.prepare_rename(file, offset).map(|target| check(target.range));
}

proptest! {
    #[test]
    fn any_text_has_answers(bytes in prop::collection::vec(any::<u8>(), 0..120), words in lines(), at in 0..400_u32) {
        for text in [bytes, words.into_bytes()] {
            let mut project = Project::new(Settings::default());
            project.set_file(FileId(0), "A", text.clone());
            ask(&project, at);
            ask(&project, at % (text.len() as u32 + 1));
            project.document_symbols(FileId(0));
            project.workspace_symbols("N", 9);
            project.folding_ranges(FileId(0));
            project.document_links(FileId(0));
            for (key, _) in project.programs().collect::<Vec<_>>() {
                project.outgoing_calls(key);
                project.incoming_calls(key);
                let _ = project.renumber(key, None, 5, 5);
            }
            project.quick_fixes(FileId(0), "unreadable", TextRange::new(at, at + 3), Some("write '[' and ']'"));
        }
    }

    /// Edits one after the other give the index of the text that they make.
    #[test]
    fn edits_keep_the_index(text in lines(), edits in prop::collection::vec((0..500_u32, 0..30_u32, prop::sample::select(LINES.to_vec())), 0..6)) {
        let mut edited = project(&text);
        for (start, length, new) in edits {
            let edit = TextEdit { range: TextRange::new(start, start + length), text: format!("{new}\n") };
            edited.edit_file(FileId(0), &edit);
            let fresh = project(&String::from_utf8_lossy(edited.file(FileId(0)).unwrap().text()));
            prop_assert_eq!(edited.document_symbols(FileId(0)), fresh.document_symbols(FileId(0)));
            prop_assert_eq!(edited.workspace_symbols("", 99), fresh.workspace_symbols("", 99));
            for at in 0..20 {
                prop_assert_eq!(edited.references(FileId(0), at * 7, true), fresh.references(FileId(0), at * 7, true));
            }
        }
    }

    /// A rename that is not refused can be taken back, and gives the first text again.
    #[test]
    fn a_rename_leads_there_and_back(text in lines(), at in 0..300_u32) {
        let before = project(&text);
        let file = FileId(0);
        let Ok(target) = before.prepare_rename(file, at) else { return Ok(()) };
        for new in ["#3", "#19", "#555", "N77", "O3777"] {
            let Ok(edits) = before.rename(file, at, new) else { continue };
            prop_assert!(!edits.is_empty(), "{new}");
            let after = before.with_edits(&edits);
            let start = target.range.start;
            // Edits before the place move it.
            let moved = edits.iter().filter(|edit| edit.edit.range.end <= start);
            let shift: i64 = moved.map(|edit| edit.edit.text.len() as i64 - i64::from(edit.edit.range.len())).sum();
            let start = (i64::from(start) + shift) as u32;
            let back = after.rename(file, start, &target.placeholder);
            let back = back.map_err(|refusal| TestCaseError::fail(format!("{new}: {refusal}")))?;
            let again = after.with_edits(&back);
            let again = String::from_utf8_lossy(again.file(file).unwrap().text()).into_owned();
            // O1 comes back as O0001.
            let same = |text: &str| text.replace("O0001", "O1").replace("O0002", "O2");
            prop_assert_eq!(same(&again), same(&text), "{}", new);
        }
    }
}
