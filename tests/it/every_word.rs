//! Every literal word of the examples and of the macros they call, changed by a small step: one entry if the program has another
//! effect, and none otherwise.
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use gcode_control::Limits;
use gcode_review::{Change, Record, Revision, changes};
use gcode_tests::workspace;

use crate::accepted::{EditedLibrary, mains, request};
use crate::words::{Slip, slips, with};

/// All of a honeycomb.
const BLOCKS: u64 = 200_000;

/// Runs a program with one of its files edited (the main program has no name here), and gives the files that it calls.
fn run(main: &Path, other: Option<(&str, String)>) -> Option<(Record, BTreeMap<String, String>)> {
    let mut request = request(main);
    request.limits = Limits { blocks: BLOCKS };
    if let Some(("", text)) = &other {
        request.bytes = text.clone().into_bytes().into();
    }
    let mut read = BTreeMap::new();
    let mut library = EditedLibrary::new(main, |name, text| {
        read.insert(name.to_owned(), text.clone());
        other.as_ref().filter(|(edited, _)| *edited == name).map_or(text, |(_, edited)| edited.clone())
    });
    let record = Revision::of(&request, &mut library, None).ok()?.record;
    Some((record, read))
}

/// The effect of a program as text: its record without the text of the blocks, those without a step and the totals.
pub(crate) fn effect(record: &Record) -> String {
    let mut effect = String::new();
    let text = record.to_json().unwrap();
    let (before, others) = text.split_once("\"other_blocks\": ").unwrap();
    let behind = &others[others.find("\"begun\": ").unwrap()..];
    for line in before.lines().chain(behind.lines()).filter(|line| !line.starts_with("\"totals\"")) {
        let mut parts = line.split("\"block\":\"");
        effect.push_str(parts.next().unwrap());
        for part in parts {
            // A quotation mark ends the text of a block unless a backslash stands before it.
            let end = part.match_indices('"').find(|(at, _)| !part[..*at].ends_with('\\')).unwrap().0;
            effect.push_str(&part[end..]);
        }
        effect.push('\n');
    }
    effect
}

/// Results of slips of one letter.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    /// The effect is the same.
    idle: usize,
    one: usize,
    wrong: usize,
}

/// Every `nth` word of the examples, changed.
fn count_effects(nth: usize, only: &str) -> (BTreeMap<String, Tally>, String) {
    let (mut tallies, mut wrong) = (BTreeMap::<String, Tally>::new(), String::new());
    let mut number = 0;
    for main in mains() {
        let name = main.strip_prefix(workspace()).unwrap().display().to_string();
        if !name.contains(only) {
            continue;
        }
        let Some((old, called)) = run(&main, None) else { continue };
        if old.outcome() != "end" {
            continue;
        }
        let before = effect(&old);
        let main_text = (String::new(), std::fs::read_to_string(&main).unwrap());
        for (file, text) in called.into_iter().chain([main_text]) {
            for slip in slips(&text) {
                number += 1;
                if number % nth != 0 {
                    continue;
                }
                let Some((new, _)) = run(&main, Some((&file, with(&text, &slip)))) else { continue };
                let found = changes(&old, &new, 0.0001);
                let is_idle = effect(&new) == before;
                let kind = format!("{}{}", slip.letter, if slip.is_argument { " of a call" } else { "" });
                let tally = tallies.entry(kind).or_default();
                match (is_idle, found.len()) {
                    (true, 0) => tally.idle += 1,
                    (false, 1) if is_named(&slip, &found[0]) => tally.one += 1,
                    _ => {
                        tally.wrong += 1;
                        let program = if file.is_empty() { &name } else { &file };
                        wrong.push_str(&shown(&name, program, &slip, is_idle, &found));
                    }
                }
            }
        }
    }
    (tallies, wrong)
}

fn shown(main: &str, program: &str, slip: &Slip, is_idle: bool, found: &[Change]) -> String {
    let what = if is_idle { "nothing different" } else { "different" };
    let entries = found.iter().map(|change| {
        let at = |place: &Option<gcode_review::BlockLocation>| place.as_ref().map(|place| place.line);
        format!("    {} {:?} {:?}: {}\n", change.code, at(&change.old), at(&change.new), change.message)
    });
    let entries: String = entries.collect();
    format!(
        "{main}: {program}:{}: {} ({what}, {} entries)\n{entries}",
        slip.line + 1,
        slip.block,
        found.len()
    )
}

/// Whether the entry is of the word's kind.
fn is_named(slip: &Slip, change: &Change) -> bool {
    let codes: &[&str] = match (slip.is_argument, slip.letter) {
        (true, _) => return true,
        (_, 'F') => &["feed"],
        (_, 'S') => &["spindle"],
        (_, 'T') => &["tool", "hole-tool", "hole-diameter", "hole-depth", "hole-moved"],
        (_, 'H') => &["tool-length"],
        (_, 'M') => &["spindle", "coolant", "stop"],
        (_, 'G') => &["work-system"],
        (_, 'X' | 'Y' | 'Z' | 'R' | 'A' | 'B' | 'C') => &["hole-", "move-", "work-offset", "outcome"],
        _ => return true,
    };
    codes.iter().any(|code| change.code.starts_with(code))
}

/// Every ninth word; with EVERY_WORD in the environment all of them, of the examples with that in their names (`examples` for all), and
/// the results by letter.
#[test]
fn a_word_of_the_examples_changed_is_one_entry() {
    let only = std::env::var("EVERY_WORD").ok();
    let (tallies, wrong) =
        count_effects(if only.is_some() { 1 } else { 9 }, only.as_deref().unwrap_or_default());
    if only.is_some() {
        for (letter, tally) in &tallies {
            writeln!(std::io::stderr(), "{letter}: {tally:?}").unwrap();
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    let named: usize = tallies.values().map(|tally| tally.one).sum();
    assert!(named > 100 || only.is_some(), "too few: {tallies:?}");
}
