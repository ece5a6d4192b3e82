//! One change in a program is one entry of `diff` that names it: tried at words of the examples and of the programs that cases are
//! about.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gcode_review::{Change, Record, Revision, changes};
use gcode_tests::changes::effect_texts;
use gcode_tests::{files_below, workspace};

use crate::accepted::{folders, mains, request};
use crate::every_word::effect;
use crate::words::slips;

/// Number of words that are changed in one program; a long one has many alike.
const MOST: usize = 12;

fn record(main: &Path, text: &str) -> Option<Record> {
    let mut request = request(main);
    request.bytes = text.as_bytes().into();
    Some(Revision::of(&request, &mut folders(main), None).ok()?.record)
}

/// The programs of some kinds of cases.
pub(crate) fn cases() -> Vec<PathBuf> {
    let folders = ["verify", "cli", "picture"].into_iter();
    folders.flat_map(|kind| files_below(&workspace().join("tests/suite").join(kind), "nc")).collect()
}

/// The lines of a program with what they become: M00 (letter 0) before every fifth line, a feed a quarter higher, the next tool of
/// an M06, an X 0.01 mm farther.
fn edits(text: &str) -> Vec<(char, usize, String)> {
    let is_block =
        |line: usize, block: &str| 1 < line && !block.is_empty() && !block.starts_with(['%', 'O', '(', '/']);
    let blocks: Vec<&str> = text.lines().collect();
    let stops = blocks.iter().enumerate().filter(|(line, _)| line % 5 == 3);
    let stops = stops.map(|(line, block)| ('0', line, format!("M00\n{block}")));
    let words = slips(text).into_iter().filter(|slip| match slip.letter {
        'F' | 'X' => !slip.is_argument,
        'T' => !slip.is_argument && (slip.block.contains("M6") || slip.block.contains("M06")),
        _ => false,
    });
    let mut edits: Vec<_> = stops.chain(words.map(|slip| (slip.letter, slip.line, slip.block))).collect();
    edits.retain(|(_, line, _)| is_block(*line, blocks[*line]));
    edits.sort_by_key(|(letter, line, _)| (*line, *letter));
    edits.dedup_by_key(|(letter, line, _)| (*line, *letter));
    edits
}

/// Whether the only entry is the edit's.
fn is_named(letter: char, found: &[Change]) -> bool {
    let [only] = found else { return false };
    match letter {
        // That of a Haas stops the spindle too.
        '0' => only.effects().any(|(_, text)| text.starts_with("the stop M00 is removed")),
        'F' => only.code == "feed",
        // A tool of another diameter or length: the entry names both.
        'T' => only.effects().any(|(_, text)| text.contains("made by T") || text.starts_with("tool T")),
        _ => ["hole-", "move-", "work-offset", "dwell"].iter().any(|code| only.code.starts_with(code)),
    }
}

#[test]
fn one_edit_is_one_entry_that_names_it() {
    let (mut wrong, mut tried) = (String::new(), BTreeMap::<char, u32>::new());
    for main in mains().into_iter().chain(cases()) {
        let Ok(text) = std::fs::read_to_string(&main) else { continue };
        let name = main.strip_prefix(workspace()).unwrap().display().to_string();
        let Some(old) = record(&main, &text).filter(|old| old.outcome() == "end") else { continue };
        let before = effect(&old);
        let edits = edits(&text);
        let step = edits.len().div_ceil(MOST).max(1);
        for (letter, line, block) in edits.into_iter().step_by(step) {
            let lines =
                text.lines().enumerate().map(|(at, own)| if at == line { block.as_str() } else { own });
            let new = lines.map(|line| format!("{line}\n")).collect::<String>();
            let Some(new) = record(&main, &new).filter(|new| new.outcome() == "end") else { continue };
            let found = if letter == '0' { changes(&new, &old, 0.0001) } else { changes(&old, &new, 0.0001) };
            // A block that isn't reached, or one without effect.
            let is_idle = effect(&new) == before;
            *tried.entry(letter).or_default() += u32::from(!is_idle);
            if if is_idle { !found.is_empty() } else { !is_named(letter, &found) } {
                let entries = effect_texts(&found).into_iter().map(|entry| format!("    {entry}\n"));
                wrong.push_str(&format!("{name}: {block}\n{}", entries.collect::<String>()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(tried.len() == 4 && tried.values().all(|times| *times > 20), "too few: {tried:?}");
}
