//! Folding: programs, loops, IFs that jump over lines, and comments of several lines.
use crate::entry::EntryKind;
use crate::project::Project;
use crate::text::{FileId, TextRange, line_range};

/// Kind of a folding range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FoldingKind {
    /// Program, from its O word to its last block.
    Program,
    /// WHILE or DO to its END.
    Loop,
    /// IF that jumps forward, to the block before its target.
    If,
    /// Lines of comments; the head of a program among them.
    Comment,
}

/// Range that an editor can fold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FoldingRange {
    /// From the first byte to the last; it spans at least two lines.
    pub range: TextRange,
    /// Kind.
    pub kind: FoldingKind,
}

impl Project {
    /// Returns the folding ranges of a file in order.
    pub fn folding_ranges(&self, file: FileId) -> Vec<FoldingRange> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let text = index.text();
        let mut found = Vec::new();
        let has_lines = |range: TextRange| range.end > line_range(text, range.start).end;
        for (program, outline) in index.programs().iter().enumerate() {
            found.push(FoldingRange { range: outline.range, kind: FoldingKind::Program });
            let mut open: Vec<(u32, u32)> = Vec::new();
            // IFs that wait for their target: the number and the place.
            let mut jumps: Vec<(u32, u32)> = Vec::new();
            let mut comment: Option<TextRange> = None;
            for entry in index.program_entries(program) {
                match entry.kind {
                    EntryKind::LoopBegin => open.push((entry.value, entry.range.start)),
                    EntryKind::LoopEnd => {
                        if let Some(at) = open.iter().rposition(|(number, _)| *number == entry.value) {
                            let range = TextRange::new(open[at].1, entry.range.end);
                            found.push(FoldingRange { range, kind: FoldingKind::Loop });
                            open.truncate(at);
                        }
                    }
                    EntryKind::Goto => {
                        let line = line_range(text, entry.range.start);
                        let before = TextRange::new(line.start, entry.range.start).of(text);
                        if before.contains(&b'[') && jumps.len() < 64 {
                            jumps.push((entry.value, line.start));
                        }
                    }
                    EntryKind::Number => {
                        let line = line_range(text, entry.range.start);
                        let end = end_of_line_before(text, line.start);
                        jumps.retain(|(number, start)| {
                            if *number == entry.value && end > *start {
                                let range = TextRange::new(*start, end);
                                found.push(FoldingRange { range, kind: FoldingKind::If });
                            }
                            *number != entry.value
                        });
                    }
                    EntryKind::Comment => {
                        let is_next =
                            comment.is_some_and(|range| is_blank_between(text, range.end, entry.range.start));
                        match (&mut comment, is_next) {
                            (Some(range), true) => range.end = entry.range.end,
                            (other, _) => {
                                let begun = other.replace(entry.range);
                                found.extend(
                                    begun.map(|range| FoldingRange { range, kind: FoldingKind::Comment }),
                                );
                            }
                        }
                    }
                    _ => {}
                }
            }
            found.extend(comment.map(|range| FoldingRange { range, kind: FoldingKind::Comment }));
        }
        found.retain(|folding| has_lines(folding.range));
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// Returns the end of the line before a line start, without its line end.
fn end_of_line_before(text: &[u8], start: u32) -> u32 {
    let before = &text[..start as usize];
    let kept = before.iter().rposition(|byte| !matches!(byte, b'\n' | b'\r' | b' ' | b'\t'));
    kept.map_or(0, |last| last as u32 + 1)
}

fn is_blank_between(text: &[u8], from: u32, to: u32) -> bool {
    let between = TextRange::new(from, to).of(text);
    between.iter().all(|byte| matches!(byte, b'\n' | b'\r' | b' ' | b'\t'))
}
