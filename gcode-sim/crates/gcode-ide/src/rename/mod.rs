//! Rename of variables, sequence numbers and programs: everything that refers to them changes, or nothing.
mod message;
mod number;
mod program;
#[cfg(test)]
mod tests;
mod unfollowed;
mod variable;

pub(crate) use number::{MAX_NUMBER, is_number};

use gcode_lang::syntax::ast::ProgramName;

use crate::entry::EntryKind;
use crate::project::{ProgramKey, Project};
use crate::symbol::Symbol;
use crate::text::{FileEdit, FileId, Refusal, TextEdit, TextRange, apply_edits, line_number, lossy};

/// Symbol that can be renamed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RenameTarget {
    /// Range of the name.
    pub range: TextRange,
    /// Name as it is, `#101`, `N10`, `O8101`.
    pub placeholder: String,
}

impl Project {
    /// Returns the symbol at an offset if it can be renamed.
    ///
    /// # Errors
    ///
    /// The reason why not.
    pub fn prepare_rename(&self, file: FileId, offset: u32) -> Result<RenameTarget, Refusal> {
        let (renamed, range) = self.renamed_symbol(file, offset)?;
        let placeholder = match renamed {
            RenameSymbol::Variable { number, program } => {
                self.check_variable(number, program)?;
                format!("#{number}")
            }
            RenameSymbol::Number { number, program } => {
                self.check_number(number, program)?;
                format!("N{number}")
            }
            RenameSymbol::Program { number } => {
                self.check_program(number, file)?;
                ProgramName::Number(number).label()
            }
        };
        Ok(RenameTarget { range, placeholder })
    }

    /// Returns the edits that rename the symbol at an offset, by file and place.
    ///
    /// The new name is a number with or without its sign or letter: `#105`, `105`, `N20`, `O8105`.
    ///
    /// # Errors
    ///
    /// The reason why a program could do something else afterwards.
    pub fn rename(&self, file: FileId, offset: u32, new_name: &str) -> Result<Vec<FileEdit>, Refusal> {
        let (renamed, _) = self.renamed_symbol(file, offset)?;
        let mut edits = match renamed {
            RenameSymbol::Variable { number, program } => {
                self.rename_variable(number, program, new_number(new_name, &['#'], "a variable as #101")?)?
            }
            RenameSymbol::Number { number, program } => self.rename_number(
                number,
                program,
                new_number(new_name, &['N'], "a sequence number as N10")?,
            )?,
            RenameSymbol::Program { number } => self.rename_program(
                number,
                file,
                new_number(new_name, &['O', ':'], "a program number as O8101")?,
            )?,
        };
        edits.sort_unstable();
        edits.dedup();
        Ok(edits)
    }

    fn renamed_symbol(&self, file: FileId, offset: u32) -> Result<(RenameSymbol, TextRange), Refusal> {
        let nothing = || Refusal::new("no variable, sequence number or program is here");
        let (symbol, range) = self.symbol_at(file, offset).ok_or_else(nothing)?;
        let refused = |reason: &str| Err(Refusal::new(reason).at(file, range));
        // Text behind the end of a program names its symbols, and no program reads it.
        let is_listed = || {
            let found = self.highlights(file, offset);
            found.iter().any(|reference| reference.location.range.touches(offset))
        };
        if matches!(symbol, Symbol::Variable { .. } | Symbol::SequenceNumber { .. }) && !is_listed() {
            return refused("this place is behind the end of the program");
        }
        let renamed = match symbol {
            Symbol::Variable { number, program, .. } => RenameSymbol::Variable { number, program },
            Symbol::SequenceNumber { number, programs } => match programs[..] {
                [program] => RenameSymbol::Number { number, program },
                [] => return refused("the called program is not in the project"),
                _ => return refused("several programs call this one: its M99 P continues in each of them"),
            },
            Symbol::Program { name: ProgramName::Number(number) } => RenameSymbol::Program { number },
            Symbol::Program { .. } => return refused("only programs with an O number are renamed"),
            Symbol::Argument { letter, local, .. } => {
                let reason =
                    format!("{letter} is the argument for #{local}: rename #{local} in the called program");
                return refused(&reason);
            }
            Symbol::ComputedVariable => {
                return refused("the number of this variable is known at run time only");
            }
            Symbol::ComputedJump => {
                return refused("the sequence number of this jump is known at run time only");
            }
            Symbol::ComputedCall => return refused("the number of this program is known at run time only"),
        };
        Ok((renamed, range))
    }

    /// Returns a place in messages, `O8101 line 12`, the line counted in its file.
    pub(crate) fn place(&self, key: ProgramKey, range: TextRange) -> String {
        let line = self.file(key.file).map_or(0, |index| line_number(index.text(), range.start));
        format!("{} line {line}", self.label(key))
    }

    /// Returns the text of a range.
    pub(crate) fn text(&self, file: FileId, range: TextRange) -> String {
        self.file(file).map_or_else(String::new, |index| lossy(range.of(index.text())))
    }

    /// Refuses if a program of the project reads one of these system variables.
    pub(crate) fn refuse_reads(&self, numbers: &[u32], what: &str) -> Result<(), Refusal> {
        for (key, _) in self.programs() {
            let Some(index) = self.file(key.file) else { continue };
            let mut entries = index.program_entries(key.program);
            let read = entries.find(|entry| entry.kind == EntryKind::Read && numbers.contains(&entry.value));
            if let Some(entry) = read {
                let reason = format!("{} reads #{}, {what}", self.place(key, entry.range), entry.value);
                return Err(Refusal::new(reason).at(key.file, entry.range));
            }
        }
        Ok(())
    }

    /// Returns the project after edits.
    pub(crate) fn with_edits(&self, edits: &[FileEdit]) -> Self {
        let mut changed = self.clone();
        let mut sorted = edits.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        for of_file in sorted.chunk_by(|one, other| one.file == other.file) {
            let Some(file) = of_file.first().map(|edit| edit.file) else { continue };
            let Some(index) = self.file(file) else { continue };
            let edits: Vec<TextEdit> = of_file.iter().map(|edit| edit.edit.clone()).collect();
            let text = apply_edits(index.text(), &edits);
            changed.set_file(file, self.file_name(file).unwrap_or_default(), text);
        }
        changed
    }

    /// Refuses edits after which the texts have other entries than before, but for those that `is_renamed` accepts.
    pub(crate) fn prove(
        &self,
        edits: &[FileEdit],
        is_renamed: impl Fn(EntryKind, u32, u32) -> bool,
        is_recalled: impl Fn(&Option<ProgramName>, &Option<ProgramName>) -> bool,
    ) -> Result<(), Refusal> {
        let after = self.with_edits(edits);
        for file in edits.iter().map(|edit| edit.file).collect::<std::collections::BTreeSet<_>>() {
            let (Some(old), Some(new)) = (self.file(file), after.file(file)) else { continue };
            let mut others = new.all_entries().filter(is_comparable);
            for entry in old.all_entries().filter(is_comparable) {
                let is_same = others.next().is_some_and(|other| {
                    let targets = [&entry, &other]
                        .map(|e| e.call().and_then(|call| crate::project::program_name(&call.record.target)));
                    let is_same_call = targets[0] == targets[1] || is_recalled(&targets[0], &targets[1]);
                    let is_same_value =
                        entry.value == other.value || is_renamed(entry.kind, entry.value, other.value);
                    entry.kind == other.kind && is_same_value && is_same_call
                });
                if !is_same {
                    return Err(
                        Refusal::new("the block would be read differently afterwards").at(file, entry.range)
                    );
                }
            }
            if others.next().is_some() {
                return Err(Refusal::new("the file would be read differently afterwards"));
            }
        }
        Ok(())
    }
}

/// Returns true for an entry that does not depend on where chunks begin.
fn is_comparable(entry: &crate::file_index::PlacedEntry<'_>) -> bool {
    !matches!(entry.kind, EntryKind::FirstBlock | EntryKind::FirstReadable)
}

/// Symbol to rename.
enum RenameSymbol {
    Variable { number: u32, program: ProgramKey },
    Number { number: u32, program: ProgramKey },
    Program { number: u32 },
}

/// Reads a new name: a number, with or without one of the signs before it.
fn new_number(text: &str, signs: &[char], what: &str) -> Result<u32, Refusal> {
    let text = text.trim().to_ascii_uppercase();
    let digits = text.strip_prefix(signs).unwrap_or(&text);
    let is_number = (1..=9).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
    let number = if is_number { digits.parse().ok() } else { None };
    number.ok_or_else(|| Refusal::new(format!("'{text}' is not a name: write {what}")))
}

/// Returns an edit of a file.
fn file_edit(file: FileId, range: TextRange, text: impl Into<String>) -> FileEdit {
    FileEdit { file, edit: TextEdit { range, text: text.into() } }
}

/// Returns the range of the first digits in a range, after an optional sign or letter and spaces.
fn digits_in(text: &[u8], range: TextRange) -> Option<TextRange> {
    let bytes = range.of(text);
    let first = bytes.iter().position(u8::is_ascii_digit)?;
    let is_prefix =
        |byte: &u8| matches!(byte, b'#' | b'O' | b'o' | b':' | b'N' | b'n' | b'P' | b'p' | b' ' | b'\t');
    let is_plain = bytes[..first].iter().all(is_prefix);
    let length = bytes[first..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let start = range.start + first as u32;
    is_plain.then(|| TextRange::new(start, start + length as u32))
}
