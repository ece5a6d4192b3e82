//! Refusal of new sequence numbers that an edit of one program cannot follow.
use gcode_lang::program::g_codes::Effect;
use gcode_lang::syntax::ast::{Block, Item, Word, WordValue};
use gcode_lint::constant;

use crate::block_entries::{code, whole};
use crate::code_text::{g_row, g_text};
use crate::entry::EntryKind;
use crate::project::{ProgramKey, Project};
use crate::text::{Refusal, TextRange, line_range};

impl Project {
    /// Refuses new sequence numbers of a program that other callers, or blocks without a known meaning, refer to.
    pub(crate) fn refuse_unfollowed(
        &self,
        key: ProgramKey,
        is_changed: impl Fn(u32) -> bool,
    ) -> Result<(), Refusal> {
        self.refuse_shared_returns(key, &is_changed)?;
        self.refuse_unknown_references(key, &is_changed)
    }

    /// Refuses the sequence numbers to which a program returns that others call too: each caller has its own.
    fn refuse_shared_returns(
        &self,
        key: ProgramKey,
        is_changed: &impl Fn(u32) -> bool,
    ) -> Result<(), Refusal> {
        for (from, _) in self.programs() {
            let Some(index) = self.file(from.file) else { continue };
            let is_shared = |entry: &crate::file_index::PlacedEntry<'_>| {
                entry.kind == EntryKind::ReturnTo && is_changed(entry.value)
            };
            let mut entries = index.program_entries(from.program).filter(is_shared);
            let Some(entry) = entries.next() else { continue };
            let callers = self.return_programs(from);
            let other = callers.iter().find(|caller| **caller != key).filter(|_| callers.contains(&key));
            if let Some(other) = other {
                let reason = format!(
                    "{}, which calls {} too, returns to its own N{}: {}",
                    self.label(*other),
                    self.label(from),
                    entry.value,
                    self.place(from, entry.range)
                );
                return Err(Refusal::new(reason).at(from.file, entry.range));
            }
        }
        Ok(())
    }

    /// Refuses sequence numbers in P or Q of an unknown G code, as a turning cycle has them.
    fn refuse_unknown_references(
        &self,
        key: ProgramKey,
        is_changed: &impl Fn(u32) -> bool,
    ) -> Result<(), Refusal> {
        let Some((index, outline)) = self.file(key.file).zip(self.program(key)) else { return Ok(()) };
        let mut start = outline.range.start;
        while start < outline.range.end {
            let line = line_range(index.text(), start);
            start = line.end + 1;
            let has =
                |letter: u8| line.of(index.text()).iter().any(|byte| byte.eq_ignore_ascii_case(&letter));
            if !has(b'G') || !(has(b'P') || has(b'Q')) {
                continue;
            }
            let Some(block) = self.block(key.file, line.start) else { continue };
            let Some((unknown, word)) = self.unknown_reference(&block, is_changed) else { continue };
            let range = TextRange::from(word.span);
            let reason = format!(
                "{} may refer to a sequence number by {}: {} is not known to this control",
                self.place(key, range),
                self.text(key.file, range),
                self.text(key.file, unknown.span.into())
            );
            return Err(Refusal::new(reason).at(key.file, range));
        }
        Ok(())
    }

    /// Returns the code and the word of a block that may refer to a changed sequence number.
    fn unknown_reference<'a>(
        &self,
        block: &'a Block,
        is_changed: &impl Fn(u32) -> bool,
    ) -> Option<(&'a Word, &'a Word)> {
        let words = || {
            let words = block.items.iter();
            words.filter_map(|item| if let Item::Word(word) = item { Some(word) } else { None })
        };
        let unknown = words().filter(|word| word.address.letter == b'G').find(|word| {
            let Some(code) = code(word) else { return false };
            let is_unused =
                g_row(code, self.settings()).is_some_and(|row| row.effect == Effect::NotSimulated);
            is_unused || g_text(code, self.settings()).is_none()
        })?;
        let refers = |word: &&Word| {
            let number = match &word.value {
                WordValue::Literal(number) => Some(number.value()),
                WordValue::Expr(expr) => constant(expr),
                WordValue::Name(_) => return false,
            };
            matches!(word.address.letter, b'P' | b'Q') && whole(number).is_none_or(is_changed)
        };
        Some((unknown, words().find(refers)?))
    }
}
