//! Index of one file: chunks of lines with their entries, and the programs that they form.
use std::sync::Arc;

use gcode_lang::control::Settings;
use gcode_lang::source::Bytes;
use gcode_lang::syntax::ast::{Folder, ProgramName};
use gcode_lang::syntax::first_line;

use crate::chunk;
use crate::chunk_builder::{Chunk, MotionKind};
use crate::entry::{CallRecord, EntryKind};
use crate::text::{TextEdit, TextRange, apply_edits};

/// Least number of bytes of a chunk. A key press reads as many again.
const CHUNK_LENGTH: usize = 16 * 1024;

/// Index of the text of one file.
#[derive(Clone, Debug)]
pub struct FileIndex {
    text: Bytes,
    chunks: Vec<PlacedChunk>,
    programs: Vec<ProgramOutline>,
}

#[derive(Clone, Debug)]
struct PlacedChunk {
    range: TextRange,
    chunk: Arc<Chunk>,
}

/// Program of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramOutline {
    /// O number or name.
    pub name: ProgramName,
    /// Folder of a memory dump.
    pub folder: Option<Folder>,
    /// From the O word, or the first block, to the last block.
    pub range: TextRange,
    /// O word; empty at the first block of a program without one.
    pub name_range: TextRange,
}

/// Entry with its place in the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedEntry<'a> {
    pub range: TextRange,
    pub kind: EntryKind,
    pub value: u32,
    chunk: &'a PlacedChunk,
}

impl<'a> PlacedEntry<'a> {
    /// Returns the call of an entry of this kind.
    pub(crate) fn call(&self) -> Option<Call<'a>> {
        let record =
            (self.kind == EntryKind::Call).then(|| self.chunk.chunk.calls.get(self.value as usize))??;
        Some(Call { record, code: self.range, base: self.chunk.range.start })
    }
}

/// Call with its place in the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Call<'a> {
    pub record: &'a CallRecord,
    /// Code of the call.
    pub code: TextRange,
    base: u32,
}

impl Call<'_> {
    /// Returns the range of a part of the record in the file.
    pub(crate) fn place(&self, range: TextRange) -> TextRange {
        TextRange::new(range.start + self.base, range.end + self.base)
    }

    /// Returns the range of the block.
    pub(crate) fn block(&self) -> TextRange {
        self.place(self.record.block)
    }

    /// Returns the word P.
    pub(crate) fn target_range(&self) -> Option<TextRange> {
        self.record.target_range.map(|range| self.place(range))
    }
}

impl FileIndex {
    /// Reads a text. Long files are read in chunks, most of whose blocks need no tree.
    pub fn new(text: impl Into<Bytes>, settings: &Settings) -> Self {
        let text = text.into();
        let whole = TextRange::new(0, text.len() as u32);
        let chunks = read_chunks(&text, whole, settings);
        let programs = programs(&text, &chunks);
        Self { text, chunks, programs }
    }

    /// Returns the index of the text after an edit; only the chunks that the edit touches are read.
    #[must_use]
    pub fn edited(&self, edit: &TextEdit, settings: &Settings) -> Self {
        let length = self.text.len() as u32;
        let range = TextRange::new(
            edit.range.start.min(length),
            edit.range.end.clamp(edit.range.start.min(length), length),
        );
        let edit = TextEdit { range, text: edit.text.clone() };
        let text = Bytes::from(apply_edits(&self.text, std::slice::from_ref(&edit)));
        self.replaced(range, edit.text.len() as u32, text, settings)
    }

    /// Returns the index of another state of the text; only the chunks that differ are read.
    #[must_use]
    pub(crate) fn moved_to(self, text: Bytes, settings: &Settings) -> Self {
        if std::ptr::eq(&self.text[..], &text[..]) {
            return self;
        }
        let equal = |(one, other): &(&u8, &u8)| one == other;
        let front = self.text.iter().zip(text.iter()).take_while(equal).count();
        let (old, new) = (&self.text[front..], &text[front..]);
        let back = old.iter().rev().zip(new.iter().rev()).take_while(equal).count();
        let range = TextRange::new(front as u32, (self.text.len() - back) as u32);
        let length = (new.len() - back) as u32;
        self.replaced(range, length, text, settings)
    }

    /// Returns the index of a text in which `new_length` bytes stand in place of a range.
    fn replaced(&self, range: TextRange, new_length: u32, text: Bytes, settings: &Settings) -> Self {
        let length = self.text.len() as u32;
        let first = self.chunks.partition_point(|placed| placed.range.end < range.start);
        let last = self.chunks.partition_point(|placed| placed.range.start <= range.end);
        let start = self.chunks.get(first).map_or(0, |placed| placed.range.start).min(range.start);
        let old_end = self.chunks[..last].last().map_or(length, |placed| placed.range.end).max(range.end);
        let shift = |offset: u32| offset - range.len() + new_length;
        let mut chunks = self.chunks[..first].to_vec();
        chunks.extend(read_chunks(&text, TextRange::new(start, shift(old_end)), settings));
        chunks.extend(self.chunks[last..].iter().map(|placed| PlacedChunk {
            range: TextRange::new(shift(placed.range.start), shift(placed.range.end)),
            chunk: placed.chunk.clone(),
        }));
        let programs = programs(&text, &chunks);
        Self { text, chunks, programs }
    }

    /// Returns the text.
    pub fn text(&self) -> &Bytes {
        &self.text
    }

    /// Returns the programs in the order written.
    pub fn programs(&self) -> &[ProgramOutline] {
        &self.programs
    }

    /// Returns the index of the program that contains an offset, or that ends last before it.
    pub fn program_at(&self, offset: u32) -> Option<usize> {
        self.programs.partition_point(|program| program.range.start <= offset).checked_sub(1)
    }

    /// Iterates over the entries that begin in a range, by block.
    pub(crate) fn entries(&self, range: TextRange) -> impl Iterator<Item = PlacedEntry<'_>> {
        let first = self.chunks.partition_point(|placed| placed.range.end <= range.start);
        let chunks = self.chunks[first..].iter().take_while(move |placed| placed.range.start < range.end);
        let entries = chunks.flat_map(|placed| placed.chunk.entries.iter().map(move |entry| (placed, entry)));
        let placed = entries.map(|(chunk, entry)| {
            let start = chunk.range.start + entry.start;
            let range = TextRange::new(start, start + u32::from(entry.length));
            PlacedEntry { range, kind: entry.kind, value: entry.value, chunk }
        });
        placed.filter(move |entry| (range.start..range.end).contains(&entry.range.start))
    }

    /// Iterates over the entries of a program.
    pub(crate) fn program_entries(&self, program: usize) -> impl Iterator<Item = PlacedEntry<'_>> {
        self.entries(self.programs.get(program).map(|program| program.range).unwrap_or_default())
    }

    /// Iterates over all entries.
    pub(crate) fn all_entries(&self) -> impl Iterator<Item = PlacedEntry<'_>> {
        self.entries(TextRange::new(0, self.text.len() as u32 + 1))
    }

    /// Returns the start of the chunk of an offset, a line start, and the motion in force there.
    pub(crate) fn motion_before(&self, offset: u32) -> (u32, Option<MotionKind>) {
        let next = self.chunks.partition_point(|placed| placed.range.start <= offset);
        let before = &self.chunks[..next.saturating_sub(1)];
        let motion = before.iter().rev().find_map(|placed| placed.chunk.last_motion);
        (before.last().map_or(0, |placed| placed.range.end), motion)
    }
}

/// Reads the chunks of a range of whole lines.
fn read_chunks(text: &[u8], range: TextRange, settings: &Settings) -> Vec<PlacedChunk> {
    let mut chunks = Vec::new();
    let mut start = range.start;
    while start < range.end {
        let end = chunk_end(text, start, range.end);
        let first = if start == 0 { first_line(text).min(end) } else { start };
        let range = TextRange::new(start, end);
        let mut chunk = chunk::read(text, TextRange::new(first, end), settings);
        for entry in &mut chunk.entries {
            entry.start += first - start;
        }
        for call in &mut chunk.calls {
            call.shift(first - start);
        }
        chunks.push(PlacedChunk { range, chunk: Arc::new(chunk) });
        start = end;
    }
    chunks
}

/// Returns the first line start after a chunk's least length, where no line end is divided.
fn chunk_end(text: &[u8], start: u32, end: u32) -> u32 {
    let from = start as usize + CHUNK_LENGTH;
    let Some(rest) = text.get(from..end as usize) else { return end };
    let mut feeds = rest.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let boundary = feeds.find(|(at, _)| rest.get(at + 1).is_some_and(|next| *next != b'\r'));
    boundary.map_or(end, |(at, _)| (from + at + 1) as u32)
}

/// Returns the programs that the chunks form.
fn programs(text: &[u8], chunks: &[PlacedChunk]) -> Vec<ProgramOutline> {
    let mut found: Vec<(ProgramOutline, bool)> = Vec::new();
    let mut is_open = false;
    let mut folder = None;
    for placed in chunks {
        for index in &placed.chunk.boundaries {
            let Some(entry) = placed.chunk.entries.get(*index as usize) else { continue };
            let start = placed.range.start + entry.start;
            let range = TextRange::new(start, start + u32::from(entry.length));
            match entry.kind {
                EntryKind::Section | EntryKind::Program => {
                    if let Some((last, _)) = found.last_mut().filter(|_| is_open) {
                        last.range.end = start;
                    }
                    is_open = entry.kind == EntryKind::Program;
                    if let Some(record) = placed.chunk.programs.get(entry.value as usize).filter(|_| is_open)
                    {
                        folder = record.folder.clone().or(folder);
                        let (name, folder) = (record.name.clone(), folder.clone());
                        found.push((ProgramOutline { name, folder, range, name_range: range }, true));
                    }
                }
                EntryKind::FirstBlock if !is_open => {
                    is_open = true;
                    let (name, name_range) = (ProgramName::Unnamed, TextRange::new(start, start));
                    let folder = folder.clone();
                    found.push((ProgramOutline { name, folder, range, name_range }, entry.value == 1));
                }
                EntryKind::FirstReadable => {
                    if let Some((_, is_readable)) = found.last_mut() {
                        *is_readable = true;
                    }
                }
                _ => {}
            }
        }
    }
    if let Some((last, _)) = found.last_mut().filter(|_| is_open) {
        last.range.end = text.len() as u32;
    }
    let is_only = found.len() == 1;
    let mut programs: Vec<_> = found
        .into_iter()
        .filter(|(_, is_readable)| is_only || *is_readable)
        .map(|(program, _)| program)
        .collect();
    for program in &mut programs {
        let is_blank = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0 | 0x1a | 0x7f);
        let blank = program.range.of(text).iter().rev().take_while(|byte| is_blank(byte)).count();
        program.range.end = (program.range.end - blank as u32).max(program.name_range.end);
    }
    programs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::entries;

    fn labels(text: &[u8]) -> Vec<(String, u32, u32)> {
        let index = FileIndex::new(text, &Settings::default());
        index.programs().iter().map(|p| (p.name.label(), p.range.start, p.range.end)).collect()
    }

    #[test]
    fn programs_have_their_ranges() {
        assert_eq!(
            labels(b"%\nO1(A)\nG0 X1.\nM30\nO2\nM99\n%\n"),
            [("O0001".into(), 2, 18), ("O0002".into(), 19, 25)]
        );
        assert_eq!(labels(b"LEADER?\n%\nG0X1.\nM30\n%\n"), [("MAIN".into(), 10, 19)]);
        assert_eq!(labels(b""), []);
        assert_eq!(labels(b"?!\n"), [("MAIN".into(), 0, 2)]);
    }

    #[test]
    fn an_edit_gives_the_index_of_the_new_text() {
        let line = "N10 G1 X#100 Y2.\nGOTO 10\n(COMMENT)\nO7\nG65 P9000 A1.\n";
        let text = line.repeat(2000);
        let settings = Settings::default();
        let index = FileIndex::new(text.clone().into_bytes(), &settings);
        assert!(index.chunks.len() > 3, "several chunks");
        let (middle, end) = (text.len() as u32 / 2, text.len() as u32);
        let seam = index.chunks[1].range.start;
        for (start, stop, new) in [
            (0, 0, "O1\n"),
            (middle, middle + 3, ""),
            (seam, seam, "X"),
            (seam - 1, seam, ""),
            (end, end, "%"),
            (3, end - 4, ""),
        ] {
            let edit = TextEdit { range: TextRange::new(start, stop), text: new.into() };
            let edited = index.edited(&edit, &settings);
            let fresh = FileIndex::new(edited.text().clone(), &settings);
            assert_eq!(edited.programs, fresh.programs, "{start} {stop}");
            assert_eq!(entries(&edited), entries(&fresh), "{start} {stop}");
        }
    }
}
