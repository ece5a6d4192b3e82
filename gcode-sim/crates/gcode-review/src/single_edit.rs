//! What one word that is written otherwise does to holes, moves and what they are made under, in one entry.
use std::collections::BTreeMap;

use super::cause::{cause, words};
use super::change::Change;
use super::record::{BlockLocation, Record};
use gcode_lang::syntax::parse;

/// The only block of two programs that is written otherwise, before and now; of a block that is gone or new one of
/// the two.
pub(super) struct Edit {
    was: Option<BlockLocation>,
    is: Option<BlockLocation>,
}

/// Nothing where the texts aren't known, where more than one block is written otherwise, or more than one word of it:
/// of two words nobody knows which has done what, and a reviewer must not accept one thing with another. A word that
/// is gone or new is one, and so is a whole block.
pub(super) fn edit(old: &Record, new: &Record) -> Option<Edit> {
    let (was, is) = (programs(old)?, programs(new)?);
    let mut edits = Vec::new();
    for (name, before) in was {
        // A program that one of them alone calls is none that somebody has written otherwise.
        let Some(now) = is.get(&name) else { continue };
        edits.extend(of_program(&before, now)?);
        if 1 < edits.len() {
            return None;
        }
    }
    edits.pop().filter(Edit::is_one_word)
}

/// What is written otherwise in a program; nothing where it is more than one block.
fn of_program(before: &[BlockLocation], now: &[BlockLocation]) -> Option<Option<Edit>> {
    let is_same = |(was, is): &(&BlockLocation, &BlockLocation)| words(&was.block) == words(&is.block);
    let first = before.iter().zip(now).take_while(is_same).count();
    let rest = before.len().min(now.len()) - first;
    let last = before.iter().rev().zip(now.iter().rev()).take(rest).take_while(is_same).count();
    match (&before[first..before.len() - last], &now[first..now.len() - last]) {
        ([], []) => Some(None),
        (was @ ([] | [_]), is @ ([] | [_])) => {
            Some(Some(Edit { was: was.first().cloned(), is: is.first().cloned() }))
        }
        _ => None,
    }
}

impl Edit {
    /// A statement has one value or one condition.
    fn is_one_word(&self) -> bool {
        let (Some(was), Some(is)) = (&self.was, &self.is) else { return true };
        let (was, is) = (words(&was.block), words(&is.block));
        let is_statement = |block: &str| ["#", "IF", "WHILE"].iter().any(|begin| block.starts_with(begin));
        let (before, now) = (letters(&was), letters(&is));
        let first = before.iter().zip(&now).take_while(|(a, b)| a == b).count();
        let rest = before.len().min(now.len()) - first;
        let last = before.iter().rev().zip(now.iter().rev()).take(rest).take_while(|(a, b)| a == b).count();
        is_statement(&was) && is_statement(&is) || before.len().max(now.len()) - first - last <= 1
    }

    /// Whether an entry's blocks, or the calls that lead there, are the ones that are written otherwise.
    fn is_named_by(&self, change: &Change) -> bool {
        let is_it = |edited: &Option<BlockLocation>, named: &BlockLocation| {
            edited.as_ref().is_some_and(|edited| words(&edited.block) == words(&named.block))
        };
        match (&change.old, &change.new) {
            (Some(was), Some(is)) => {
                let (was, is) = cause(was, is);
                is_it(&self.was, &was) && is_it(&self.is, &is)
            }
            (Some(was), None) => self.is.is_none() && is_it(&self.was, was),
            (None, Some(is)) => self.was.is_none() && is_it(&self.is, is),
            (None, None) => false,
        }
    }
}

/// All entries about holes, moves, and what these are made under, are told with the first of them, each in its own
/// words, at the block that is written otherwise; one alone as well, wherever the moves are that it is about.
pub(super) fn merge_into_edit(changes: Vec<Change>, edit: &Edit) -> Vec<Change> {
    let (motion, mut others): (Vec<Change>, Vec<Change>) = changes.into_iter().partition(is_motion);
    let mut motion = motion.into_iter();
    let Some(mut first) = motion.next() else { return others };
    motion.for_each(|more| first.message.push_str(&format!("; {}", more.message)));
    if !edit.is_named_by(&first) {
        (first.old, first.new) = (edit.was.clone(), edit.is.clone());
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

/// Every block that says something of every program that was read, by the program's name; the main program has the
/// first place and none.
fn programs(record: &Record) -> Option<BTreeMap<String, Vec<BlockLocation>>> {
    let sources = record.sources.as_ref()?;
    let mut programs = BTreeMap::new();
    for (source, text) in sources.iter() {
        for program in parse(source, &text.bytes) {
            let name = program.name.label();
            let blocks = program.blocks.iter().map(|block| BlockLocation {
                program: name.clone(),
                line: sources.line_column(block.span).line,
                block: sources.text(block.span).trim().to_owned(),
                calls: Vec::new(),
            });
            let blocks: Vec<BlockLocation> = blocks.filter(|block| !words(&block.block).is_empty()).collect();
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
