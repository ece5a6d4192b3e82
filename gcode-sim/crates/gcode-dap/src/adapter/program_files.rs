//! Files of programs as a client names them: their blocks by line, their paths, their texts.
use std::collections::BTreeMap;

use gcode_lang::program::{Memory, Op, OpKind};
use gcode_lang::source::{Bytes, SourceId};

/// Block of a file on which a run can stand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BlockSite {
    /// Offset in the file.
    pub(super) start: u32,
    /// Line and column, from 1.
    pub(super) line: u32,
    pub(super) column: u32,
    /// Label of the program that the block belongs to.
    pub(super) program: String,
}

/// Text of a file with its programs.
pub(super) struct ProgramFile {
    memory: Memory,
}

impl ProgramFile {
    pub(super) fn new(path: &str, bytes: Bytes) -> Self {
        let mut memory = Memory::default();
        memory.load(path, bytes);
        Self { memory }
    }

    /// Returns the text.
    pub(super) fn text(&self) -> String {
        String::from_utf8_lossy(&self.memory.sources().get(SourceId(0)).bytes).into_owned()
    }

    /// Returns the block on a line at or before a column, else the next block of the program.
    pub(super) fn block_from(&mut self, line: u32, column: Option<u32>) -> Result<BlockSite, String> {
        let source = std::sync::Arc::clone(self.memory.sources().get(SourceId(0)));
        let range = source.line_range(line).ok_or_else(|| format!("the file has no line {line}"))?;
        let found = self.memory.ids().find(|id| self.memory.get(*id).span.end > range.start);
        let id = found.ok_or_else(|| format!("no block follows line {line}"))?;
        let texts = self.memory.get(id).block_texts().clone();
        let mut index = texts.first_from(range.start);
        if let Some(column) = column {
            let last = range.start.saturating_add(column.max(1) - 1);
            let is_at = |index: usize| {
                index < texts.count() && texts.start(index) < range.end && texts.start(index) <= last
            };
            while is_at(index + 1) {
                index += 1;
            }
        }
        loop {
            let Some(op) = self.memory.lower_block(id, index) else {
                let program = self.memory.get(id).label();
                return Err(format!("no block of {program} follows line {line}"));
            };
            if is_place_to_stand(op) {
                let start = op.span.start;
                let place = source.line_column(start);
                let program = self.memory.get(id).label();
                return Ok(BlockSite { start, line: place.line, column: place.column, program });
            }
            index += 1;
        }
    }

    /// Returns the blocks on lines on which a run can stand.
    pub(super) fn blocks_on(&mut self, first: u32, last: u32) -> Vec<BlockSite> {
        let source = std::sync::Arc::clone(self.memory.sources().get(SourceId(0)));
        let Some(from) = source.line_range(first.max(1)).map(|range| range.start) else { return Vec::new() };
        let to = source.line_range(last).map_or(u32::MAX, |range| range.end);
        let mut sites = Vec::new();
        for id in self.memory.ids() {
            let program = self.memory.get(id).label();
            let mut index = self.memory.get(id).block_texts().first_from(from);
            while let Some(op) = self.memory.lower_block(id, index).filter(|op| op.span.start < to) {
                if is_place_to_stand(op) {
                    let (start, place) = (op.span.start, source.line_column(op.span.start));
                    let program = program.clone();
                    sites.push(BlockSite { start, line: place.line, column: place.column, program });
                }
                index += 1;
            }
        }
        sites
    }
}

/// Returns false for an empty line and a comment.
fn is_place_to_stand(op: &Op) -> bool {
    op.number.is_some() || !matches!(op.kind(), OpKind::Empty)
}

/// Files by their canonical paths, and the paths by which the client knows them.
#[derive(Default)]
pub(super) struct ProgramFiles {
    files: BTreeMap<String, ProgramFile>,
    client_paths: BTreeMap<String, String>,
}

impl ProgramFiles {
    /// Forgets the texts, which may have changed on the disk.
    pub(super) fn forget_texts(&mut self) {
        self.files.clear();
    }

    /// Records the path by which the client names a file.
    pub(super) fn name(&mut self, canonical: &str, path: &str) {
        self.client_paths.insert(canonical.to_owned(), path.to_owned());
    }

    /// Returns the path by which the client names a file.
    pub(super) fn client_path(&self, canonical: &str) -> Option<&str> {
        self.client_paths.get(canonical).map(String::as_str)
    }

    /// Returns a file, read by `read` the first time.
    pub(super) fn file(
        &mut self,
        canonical: &str,
        read: impl FnOnce() -> Result<Bytes, String>,
    ) -> Result<&mut ProgramFile, String> {
        if !self.files.contains_key(canonical) {
            let file = ProgramFile::new(canonical, read()?);
            self.files.insert(canonical.to_owned(), file);
        }
        self.files.get_mut(canonical).ok_or_else(|| "the file is gone".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "%\nO1(ONE)\n(REMARK)\n\nN10 G0 X1.\nM99\n(END)\n\nO2\n#1=1\n(LAST)\n%\n";

    fn line_of(line: u32) -> Result<u32, String> {
        let mut file = ProgramFile::new("O1.nc", TEXT.as_bytes().into());
        file.block_from(line, None).map(|site| site.line)
    }

    #[test]
    fn a_line_without_a_block_moves_to_the_next_block() {
        assert_eq!([1, 2, 3, 4, 5].map(line_of), [5; 5].map(Ok));
        assert_eq!(line_of(6), Ok(6));
        assert_eq!(line_of(9), Ok(10), "the head of O2");
        assert!(line_of(11).unwrap_err().contains("line 11"));
        assert!(line_of(12).is_err());
        assert!(line_of(99).unwrap_err().contains("no line 99"));
    }

    #[test]
    fn the_blocks_on_lines_are_listed() {
        let mut file = ProgramFile::new("O1.nc", TEXT.as_bytes().into());
        let lines = |file: &mut ProgramFile, from, to| {
            file.blocks_on(from, to).iter().map(|site| site.line).collect::<Vec<_>>()
        };
        assert_eq!(lines(&mut file, 1, 12), [5, 6, 10]);
        assert_eq!(lines(&mut file, 3, 4), [0; 0]);
        assert_eq!(lines(&mut file, 6, 6), [6]);
    }
}
