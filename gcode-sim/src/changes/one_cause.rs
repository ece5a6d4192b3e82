//! What one word that is written otherwise does to holes, moves and feeds, in one entry.
use std::collections::{BTreeMap, BTreeSet};

use super::cause::{cause, words};
use super::change::Change;
use super::record::{Record, Where};

/// Where all blocks of both records that do something say the same but for one word of one of them, entries about holes, moves
/// and feeds that come of it are told with the first of them, each in its own words. Of more than one word nobody knows which
/// has done what: a reviewer must not accept one thing with another.
pub(super) fn joined(changes: Vec<Change>, old: &Record, new: &Record) -> Vec<Change> {
    let Some((was, is)) = edit(old, new) else { return changes };
    let is_by_it = |change: &Change| {
        let is_motion = ["hole-", "move-", "feed"].iter().any(|code| change.code.starts_with(code));
        let places = change.old.as_ref().zip(change.new.as_ref()).filter(|_| is_motion);
        let blocks = places.map(|(was, is)| cause(was, is));
        blocks.is_some_and(|(a, b)| words(&a.block) == was && words(&b.block) == is)
    };
    let mut all: Vec<Change> = Vec::with_capacity(changes.len());
    for change in changes {
        match all.iter_mut().find(|first| is_by_it(&change) && is_by_it(first)) {
            Some(first) => first.message.push_str(&format!("; {}", change.message)),
            None => all.push(change),
        }
    }
    all
}

/// The one block that is written otherwise, before and now, if it is by one word.
fn edit(old: &Record, new: &Record) -> Option<(String, String)> {
    let (was, is) = (blocks(old), blocks(new));
    let less = |all: &BTreeMap<(String, String), usize>, others: &BTreeMap<(String, String), usize>| {
        let mut more = Vec::new();
        for ((program, words), times) in all {
            let other = others.get(&(program.clone(), words.clone())).copied().unwrap_or(0);
            more.extend((other..*times).map(|_| (program.clone(), words.clone())));
        }
        more
    };
    let ([gone], [come]) = (&less(&was, &is)[..], &less(&is, &was)[..]) else { return None };
    let (before, now) = (letters(&gone.1), letters(&come.1));
    let others = before.iter().zip(&now).filter(|(a, b)| a != b).count();
    (gone.0 == come.0 && before.len() == now.len() && others == 1).then(|| (gone.1.clone(), come.1.clone()))
}

/// What the blocks of a record say, with their programs, and how many blocks say it.
fn blocks(record: &Record) -> BTreeMap<(String, String), usize> {
    let all = record.places.iter().flat_map(|place| std::iter::once(place).chain(&place.calls));
    let lines: BTreeSet<(&str, u32, &str)> = all.map(key).collect();
    let mut blocks = BTreeMap::new();
    for (program, _, block) in lines {
        *blocks.entry((program.to_owned(), words(block))).or_insert(0) += 1;
    }
    blocks
}

fn key(place: &Where) -> (&str, u32, &str) {
    (&place.program, place.line, &place.block)
}

/// The words of a block: each from a letter to the next, brackets whole.
fn letters(words: &str) -> Vec<String> {
    let mut depth = 0;
    let mut all: Vec<String> = Vec::new();
    for c in words.chars() {
        match all.last_mut() {
            Some(word) if depth > 0 || !c.is_ascii_uppercase() => word.push(c),
            _ => all.push(c.to_string()),
        }
        depth += i32::from(c == '[') - i32::from(c == ']');
    }
    all
}
