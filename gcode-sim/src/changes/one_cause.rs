//! What one word that is written otherwise does to holes, moves and what they are made under, in one entry.
use std::collections::BTreeMap;

use super::cause::{cause, words};
use super::change::Change;
use super::record::{Record, Where};
use crate::syntax::parse;

/// The only block of two programs that is written otherwise, before and now.
pub(super) struct Edit {
    was: Where,
    is: Where,
}

/// Nothing where the texts aren't known, where more than one block is written otherwise, or more than one word of it: of two
/// words nobody knows which has done what, and a reviewer must not accept one thing with another.
pub(super) fn edit(old: &Record, new: &Record) -> Option<Edit> {
    let (was, is) = (programs(old)?, programs(new)?);
    let mut edits = Vec::new();
    for (name, before) in was {
        // A program that one of them alone calls is none that somebody has written otherwise.
        let Some(now) = is.get(&name) else { continue };
        if before.len() != now.len() {
            return None;
        }
        let others = before.into_iter().zip(now).filter(|(was, is)| words(&was.block) != words(&is.block));
        edits.extend(others.take(2).map(|(was, is)| Edit { was, is: is.clone() }));
        if 1 < edits.len() {
            return None;
        }
    }
    edits.pop().filter(Edit::is_one_word)
}

impl Edit {
    /// A statement has one value or one condition.
    fn is_one_word(&self) -> bool {
        let (was, is) = (words(&self.was.block), words(&self.is.block));
        let is_statement = |block: &str| ["#", "IF", "WHILE"].iter().any(|begin| block.starts_with(begin));
        let (before, now) = (letters(&was), letters(&is));
        let others = before.iter().zip(&now).filter(|(a, b)| a != b).count();
        is_statement(&was) && is_statement(&is) || before.len() == now.len() && others == 1
    }

    /// Whether an entry's blocks, or the calls that lead there, are the ones that are written otherwise.
    fn is_named_by(&self, change: &Change) -> bool {
        let places = change.old.as_ref().zip(change.new.as_ref());
        places.map(|(was, is)| cause(was, is)).is_some_and(|(was, is)| {
            words(&was.block) == words(&self.was.block) && words(&is.block) == words(&self.is.block)
        })
    }
}

/// All entries about holes, moves, and what these are made under, are told with the first of them, each in its own words, at
/// the block that is written otherwise; one alone as well, wherever the moves are that it is about.
pub(super) fn joined(changes: Vec<Change>, edit: &Edit) -> Vec<Change> {
    let (motion, mut others): (Vec<Change>, Vec<Change>) = changes.into_iter().partition(is_motion);
    let mut motion = motion.into_iter();
    let Some(mut first) = motion.next() else { return others };
    motion.for_each(|more| first.message.push_str(&format!("; {}", more.message)));
    if !edit.is_named_by(&first) {
        (first.old, first.new) = (Some(edit.was.clone()), Some(edit.is.clone()));
    }
    let is_before = |other: &&Change| ["outcome", "program", "start"].contains(&&*other.code);
    others.insert(others.iter().take_while(is_before).count(), first);
    others
}

fn is_motion(change: &Change) -> bool {
    let codes =
        ["feed", "dwell", "tool", "tool-length", "cutter-side", "work-system", "cycle", "return-level"];
    ["hole-", "move-"].iter().any(|code| change.code.starts_with(code)) || codes.contains(&&*change.code)
}

/// Every block that says something of every program that was read, by the program's name; the main program has the first place
/// and none.
fn programs(record: &Record) -> Option<BTreeMap<String, Vec<Where>>> {
    let sources = record.sources.as_ref()?;
    let mut programs = BTreeMap::new();
    for (source, text) in sources.iter() {
        for program in parse(source, &text.bytes) {
            let name = program.name.label();
            let blocks = program.blocks.iter().map(|block| Where {
                program: name.clone(),
                line: sources.place(block.span).line,
                block: sources.text(block.span).trim().to_owned(),
                calls: Vec::new(),
            });
            let blocks: Vec<Where> = blocks.filter(|block| !words(&block.block).is_empty()).collect();
            programs.insert(if programs.is_empty() { String::new() } else { name }, blocks);
        }
    }
    Some(programs)
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
