//! Rename of a sequence number with its jumps.
use gcode_lang::program::CallCode;
use gcode_lang::syntax::ast::ProgramName;

use super::file_edit;
use crate::entry::EntryKind;
use crate::navigation::Access;
use crate::project::{ProgramKey, Project};
use crate::text::{FileEdit, Refusal, TextRange, lossy};

/// Largest sequence number.
pub(crate) const MAX_NUMBER: u32 = 99_999_999;

/// Returns the word of a statement, or the letter of an address, right before a range.
fn letters_before(text: &[u8], range: TextRange) -> String {
    let before = text[..range.start as usize].trim_ascii_end();
    let letters = before.iter().rev().take_while(|byte| byte.is_ascii_alphabetic()).count();
    lossy(&before[before.len() - letters..])
}

impl Project {
    /// Refuses a sequence number that cannot be renamed, whatever its new number.
    pub(super) fn check_number(&self, number: u32, key: ProgramKey) -> Result<(), Refusal> {
        self.refuse_unknown_jumps(key)?;
        let references = self.number_references(key, number);
        let mut declared = references.iter().filter(|reference| reference.access == Access::Declaration);
        let label = self.label(key);
        if declared.next().is_none() {
            return Err(Refusal::new(format!("N{number} is not in {label}")));
        }
        if let Some(second) = declared.next() {
            let place = self.place(key, second.location.range);
            let reason = format!("N{number} is in {label} more than once, again in {place}");
            return Err(Refusal::new(reason).at(key.file, second.location.range));
        }
        Ok(())
    }

    /// Returns the edits that give a block another sequence number.
    pub(super) fn rename_number(
        &self,
        number: u32,
        key: ProgramKey,
        new: u32,
    ) -> Result<Vec<FileEdit>, Refusal> {
        self.check_number(number, key)?;
        if new == number {
            return Ok(Vec::new());
        }
        if !(1..=MAX_NUMBER).contains(&new) {
            return Err(Refusal::new(format!("N{new} is out of range: 1 to {MAX_NUMBER}")));
        }
        self.refuse_unfollowed(key, |changed| changed == number || changed == new)?;
        if let Some(taken) = self.number_references(key, new).first() {
            let place = self.place(key, taken.location.range);
            let reason = match taken.access {
                Access::Declaration => format!("N{new} is in use: {place}"),
                Access::Read | Access::Write => {
                    format!("a jump to N{new}, which is missing, would find it: {place}")
                }
            };
            return Err(Refusal::new(reason).at(taken.location.file, taken.location.range));
        }
        let edits: Vec<_> = self
            .number_references(key, number)
            .into_iter()
            .map(|reference| {
                let text = match reference.access {
                    Access::Declaration => format!("N{new}"),
                    Access::Read | Access::Write => new.to_string(),
                };
                file_edit(reference.location.file, reference.location.range, text)
            })
            .collect();
        let is_renamed = |kind: EntryKind, from: u32, to: u32| is_number(kind) && (from, to) == (number, new);
        self.prove(&edits, is_renamed, |_, _| false)?;
        Ok(edits)
    }

    /// Refuses a program whose sequence numbers something reads that cannot be followed.
    pub(crate) fn refuse_unknown_jumps(&self, key: ProgramKey) -> Result<(), Refusal> {
        for (other, _) in self.programs() {
            let Some(index) = self.file(other.file) else { continue };
            for entry in index.program_entries(other.program) {
                let text = || self.text(other.file, entry.range);
                let reaches = match entry.kind {
                    EntryKind::ComputedGoto => other == key,
                    EntryKind::ComputedReturn => self.return_programs(other).contains(&key),
                    EntryKind::ComputedStart => self.starts(other, entry.range, key),
                    EntryKind::Unreadable => other == key && may_jump(&text()),
                    EntryKind::Call if other == key => entry
                        .call()
                        .is_some_and(|call| self.is_every_block(call.record.kind, call.record.is_modal)),
                    _ => false,
                };
                if !reaches {
                    continue;
                }
                let reason = match entry.kind {
                    EntryKind::Unreadable => format!("cannot be read: {}", text()),
                    EntryKind::Call => "makes N an argument of every block".to_owned(),
                    EntryKind::ComputedReturn => {
                        format!("may lead to any sequence number by M99 P{}", text())
                    }
                    _ => format!(
                        "may lead to any sequence number by {}{}",
                        letters_before(index.text(), entry.range),
                        text()
                    ),
                };
                let reason = format!("{} {reason}", self.place(other, entry.range));
                return Err(Refusal::new(reason).at(other.file, entry.range));
            }
        }
        self.refuse_reads(&[4114, 4314], "the sequence number")?;
        let is_unnamed = self.program(key).is_some_and(|program| program.name == ProgramName::Unnamed);
        if is_unnamed {
            self.refuse_reads(&[4115, 4315], "the first sequence number as program number")
        } else {
            Ok(())
        }
    }

    /// Returns true if the call beside a computed Q may start a program.
    fn starts(&self, from: ProgramKey, start: TextRange, key: ProgramKey) -> bool {
        let started = self.started_programs(from, start);
        started.is_empty() || started.contains(&key)
    }

    /// Returns true for a call whose later blocks pass all their words as arguments: G66.1.
    pub(super) fn is_every_block(&self, kind: Option<CallCode>, is_modal: bool) -> bool {
        kind == Some(CallCode::EveryBlock)
            || kind.is_none() && is_modal && self.settings().code_calls.modal_is_every_block
    }
}

/// Returns true for an entry whose value is a sequence number.
pub(crate) fn is_number(kind: EntryKind) -> bool {
    use EntryKind::{Goto, LocalCall, Number, ReturnTo, StartAt};
    matches!(kind, Number | Goto | ReturnTo | StartAt | LocalCall)
}

/// Returns true for text that cannot be read and that a jump or a sequence number is meant by.
fn may_jump(text: &str) -> bool {
    let text = text.to_ascii_uppercase();
    text.contains("GO") || text.contains('N') || text.contains("M9")
}
