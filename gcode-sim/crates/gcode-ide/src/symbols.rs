//! Symbols of a file, nested, and symbols of the project by a query.
use std::ops::RangeInclusive;

use gcode_lang::syntax::ast::ProgramName;

use crate::entry::EntryKind;
use crate::head_comment::title;
use crate::project::{ProgramKey, Project};
use crate::text::{FileId, Location, TextRange, line_range, lossy};

/// Kind of a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    /// O-program.
    Program,
    /// Sequence number.
    Number,
    /// WHILE or DO with its END.
    Loop,
}

/// Symbol of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentSymbol {
    /// `O8101`, `N10`, `WHILE DO1`.
    pub name: String,
    /// Title of a program, or the text of a block.
    pub detail: String,
    /// Kind.
    pub kind: SymbolKind,
    /// Whole symbol.
    pub range: TextRange,
    /// Name; part of the range.
    pub selection: TextRange,
    /// Symbols inside.
    pub children: Vec<DocumentSymbol>,
}

/// Symbol of the project.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkspaceSymbol {
    /// `O8101`, `N10`.
    pub name: String,
    /// Title of a program; the program of a sequence number.
    pub container: String,
    /// Kind.
    pub kind: SymbolKind,
    /// Place of the name.
    pub location: Location,
}

/// Most sequence numbers of a file that are listed as symbols: in JSON each is some 300 bytes.
const MAX_NUMBERS: usize = 5_000;

/// Numbers of loops.
const LOOP_NUMBERS: RangeInclusive<u32> = 1..=3;

impl Project {
    /// Returns the programs of a file with their sequence numbers and loops.
    pub fn document_symbols(&self, file: FileId) -> Vec<DocumentSymbol> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let mut left = MAX_NUMBERS;
        let programs = index.programs().iter().enumerate();
        programs
            .map(|(program, outline)| {
                let key = ProgramKey { file, program };
                DocumentSymbol {
                    name: self.label(key),
                    detail: title(index, program).unwrap_or_default(),
                    kind: SymbolKind::Program,
                    range: outline.range,
                    selection: outline.name_range,
                    children: self.program_symbols(key, &mut left),
                }
            })
            .collect()
    }

    /// Returns the sequence numbers and loops of a program.
    fn program_symbols(&self, key: ProgramKey, left: &mut usize) -> Vec<DocumentSymbol> {
        let Some(index) = self.file(key.file) else { return Vec::new() };
        let text = index.text();
        // Behind the last word a line may go on, but the program ends.
        let program_end = self.program(key).map_or(0, |outline| outline.range.end);
        // Open loops, the program first.
        let mut open: Vec<(u32, DocumentSymbol)> = Vec::new();
        let mut top = Vec::new();
        for entry in index.program_entries(key.program) {
            let line_end = line_range(text, entry.range.start).end.min(program_end).max(entry.range.end);
            match entry.kind {
                EntryKind::Number if *left > 0 => {
                    *left -= 1;
                    let behind = TextRange::new(entry.range.end, line_end);
                    let symbol = DocumentSymbol {
                        name: format!("N{}", entry.value),
                        detail: lossy(behind.of(text)).trim().to_owned(),
                        kind: SymbolKind::Number,
                        range: TextRange::new(entry.range.start, line_end),
                        selection: entry.range,
                        children: Vec::new(),
                    };
                    open.last_mut().map_or(&mut top, |(_, parent)| &mut parent.children).push(symbol);
                }
                EntryKind::LoopBegin => {
                    // A loop of the same number inside is refused: the END of the first is missing. The numbers are 1 to 3, and
                    // limit the nesting.
                    let same = open.iter().position(|(number, _)| *number == entry.value);
                    let from = same.unwrap_or(open.len());
                    close_loops(&mut open, &mut top, from, 0);
                    let symbol = DocumentSymbol {
                        name: lossy(entry.range.of(text)),
                        detail: String::new(),
                        kind: SymbolKind::Loop,
                        range: TextRange::new(entry.range.start, line_end),
                        selection: entry.range,
                        children: Vec::new(),
                    };
                    if LOOP_NUMBERS.contains(&entry.value) {
                        open.push((entry.value, symbol));
                    } else {
                        open.last_mut().map_or(&mut top, |(_, parent)| &mut parent.children).push(symbol);
                    }
                }
                EntryKind::LoopEnd => {
                    // An END closes its own loop and those that lack theirs.
                    let Some(at) = open.iter().rposition(|(number, _)| *number == entry.value) else {
                        continue;
                    };
                    close_loops(&mut open, &mut top, at, line_end);
                }
                _ => {}
            }
        }
        close_loops(&mut open, &mut top, 0, 0);
        top
    }

    /// Returns the programs and sequence numbers whose name or title contains a text, in any case. An empty text finds
    /// all programs.
    pub fn workspace_symbols(&self, query: &str, limit: usize) -> Vec<WorkspaceSymbol> {
        let query = query.trim().to_ascii_uppercase();
        let mut found = Vec::new();
        for (key, outline) in self.programs() {
            let (name, title) =
                (self.label(key), self.file(key.file).and_then(|index| title(index, key.program)));
            let container = title.unwrap_or_default();
            let is_number = matches!(&outline.name, ProgramName::Number(n) if query.strip_prefix('O').and_then(|q| q.parse().ok()) == Some(*n));
            if is_number || name.contains(&query) || container.to_ascii_uppercase().contains(&query) {
                let location = Location { file: key.file, range: outline.name_range };
                found.push(WorkspaceSymbol { name, container, kind: SymbolKind::Program, location });
            }
        }
        if query.starts_with('N') && query[1..].bytes().all(|byte| byte.is_ascii_digit()) {
            for (key, _) in self.programs() {
                let Some(index) = self.file(key.file) else { continue };
                let numbers =
                    index.program_entries(key.program).filter(|entry| entry.kind == EntryKind::Number);
                let named = numbers.map(|entry| (format!("N{}", entry.value), entry.range));
                let matching = named.filter(|(name, _)| name.starts_with(&query)).take(limit);
                found.extend(matching.map(|(name, range)| WorkspaceSymbol {
                    name,
                    container: self.label(key),
                    kind: SymbolKind::Number,
                    location: Location { file: key.file, range },
                }));
            }
        }
        found.truncate(limit);
        found
    }
}

/// Closes the open loops from an index on, at an offset unless it is before their end.
fn close_loops(open: &mut Vec<(u32, DocumentSymbol)>, top: &mut Vec<DocumentSymbol>, from: usize, end: u32) {
    while open.len() > from {
        let Some((_, mut symbol)) = open.pop() else { return };
        let last = symbol.children.last().map_or(0, |child| child.range.end);
        symbol.range.end = symbol.range.end.max(end).max(last);
        open.last_mut().map_or(&mut *top, |(_, parent)| &mut parent.children).push(symbol);
    }
}
