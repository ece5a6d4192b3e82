//! One thing changed in a program is one entry of `diff` that names it: tried at every such word of the examples and of
//! the programs that other tests are about.
use std::path::{Path, PathBuf};

use gcode_review::{Change, Record, Revision, changes};
use gcode_tests::changes::effect_texts;
use gcode_tests::{files_below, workspace};

use crate::accepted::{folders, mains, request};
use crate::every_word::effect;

/// What is changed in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    /// M00 before it is lost.
    Stop,
    /// Its feed is a quarter more.
    Feed,
    /// Its tool has the next number.
    Tool,
    /// Its X is 0.01 mm more.
    Place,
}

/// As many words of one program are changed; a long one has many alike.
const MOST: usize = 24;

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

/// Where the numbers of a block's words with a letter stand, written as numbers.
fn words(block: &str, letter: char) -> Vec<std::ops::Range<usize>> {
    let code = block.split('(').next().unwrap();
    // X of a dwell is a time, and letters of a call mean what the macro makes of them.
    if ["=", "G65", "G04", "G4 "].iter().any(|other| code.contains(other)) {
        return Vec::new();
    }
    let number = |(at, _): (usize, &str)| {
        let digits = code[at + 1..].find(|c: char| !(c.is_ascii_digit() || ".-".contains(c)));
        let end = digits.map_or(code.len(), |digits| at + 1 + digits);
        (at + 1 < end && !code[end..].starts_with(['[', '#'])).then_some(at + 1..end)
    };
    code.match_indices(letter).filter_map(number).collect()
}

/// A block with one of its numbers changed.
fn slip(block: &str, slip: Slip) -> Option<String> {
    let letter = match slip {
        Slip::Stop => return Some(format!("M00\n{block}")),
        Slip::Feed => 'F',
        Slip::Tool if !block.contains("M6") && !block.contains("M06") => return None,
        Slip::Tool => 'T',
        Slip::Place => 'X',
    };
    let at = words(block, letter).into_iter().next()?;
    let value: f64 = block[at.clone()].parse().ok()?;
    let has_point = block[at.clone()].contains('.');
    let value = match slip {
        Slip::Feed => format!("{:.4}", value * 1.25),
        Slip::Place if has_point => format!("{:.4}", value + 0.01),
        // Thousandths.
        Slip::Place => format!("{}", value + 10.0),
        Slip::Stop | Slip::Tool => format!("{}", value + 1.0),
    };
    Some(format!("{}{value}{}", &block[..at.start], &block[at.end..]))
}

/// The entry that a slip has to be, and nothing else.
fn is_named(slip: Slip, found: &[Change]) -> bool {
    let [only] = found else { return false };
    match slip {
        Slip::Stop => only.code == "stop" && only.message.starts_with("the stop M00 is removed"),
        Slip::Feed => only.code == "feed",
        // A tool of another diameter or length: the entry names both.
        Slip::Tool => {
            only.effects().any(|(_, text)| text.contains("made by T") || text.starts_with("tool T"))
        }
        Slip::Place => ["hole-", "move-", "work-offset"].iter().any(|code| only.code.starts_with(code)),
    }
}

#[test]
fn one_slip_is_one_entry_that_names_it() {
    let (mut wrong, mut tried) = (String::new(), [0; 4]);
    for main in mains().into_iter().chain(cases()) {
        let Ok(text) = std::fs::read_to_string(&main) else { continue };
        let name = main.strip_prefix(workspace()).unwrap().display().to_string();
        let Some(old) = record(&main, &text).filter(|old| old.outcome() == "end") else { continue };
        let before = effect(&old);
        let blocks: Vec<&str> = text.lines().collect();
        let mut slips = Vec::new();
        for (line, block) in blocks.iter().enumerate() {
            let is_block = 1 < line && !block.is_empty() && !block.starts_with(['%', 'O', '(', '/']);
            for kind in [Slip::Stop, Slip::Feed, Slip::Tool, Slip::Place] {
                if is_block && (kind != Slip::Stop || line % 5 == 3) {
                    slips.extend(slip(block, kind).map(|new| (kind, line, new)));
                }
            }
        }
        let step = slips.len().div_ceil(MOST).max(1);
        for (kind, line, block) in slips.into_iter().step_by(step) {
            let mut lines = blocks.clone();
            lines[line] = &block;
            let Some(new) = record(&main, &(lines.join("\n") + "\n")) else { continue };
            if new.outcome() != "end" {
                continue;
            }
            let found = match kind {
                Slip::Stop => changes(&new, &old, 0.0001),
                Slip::Feed | Slip::Tool | Slip::Place => changes(&old, &new, 0.0001),
            };
            // A block that isn't reached, or one that does nothing.
            let is_idle = effect(&new) == before;
            tried[kind as usize] += usize::from(!is_idle);
            if if is_idle { !found.is_empty() } else { !is_named(kind, &found) } {
                let told = effect_texts(&found).into_iter().map(|entry| format!("    {entry}\n"));
                wrong.push_str(&format!("{name}: {kind:?}: {block}\n{}", told.collect::<String>()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(tried.iter().all(|times| *times > 20), "too few to tell: {tried:?}");
}
