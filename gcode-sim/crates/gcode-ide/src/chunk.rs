//! Index of some whole lines of a file. An edit reads the chunks again that it touches, and no other.
use gcode_lang::control::Settings;
use gcode_lang::syntax::ast::Block;
use gcode_lang::syntax::{LineItem, block_at, line_items};

use crate::block_entries;
use crate::chunk_builder::{Chunk, ChunkBuilder, MotionChange, is_read_g, is_read_m, motion_of};
use crate::entry::{EntryKind, ProgramRecord};
use crate::text::{SOURCE, TextRange};

/// Reads the lines from `range.start`, a line start, to `range.end`.
pub(crate) fn read(bytes: &[u8], range: TextRange, settings: &Settings) -> Chunk {
    let text = &bytes[..range.end as usize];
    let mut builder = ChunkBuilder {
        text,
        base: range.start,
        settings,
        has_code_calls: !settings.code_calls.is_empty(),
        chunk: Chunk::default(),
        has_block: false,
        has_readable: false,
    };
    line_items(SOURCE, text, range.start, |item| match item {
        LineItem::Section { start } => {
            builder.push_boundary(EntryKind::Section, TextRange::new(start, start), 0);
            (builder.has_block, builder.has_readable) = (false, false);
        }
        LineItem::Program { name, span, folder } => {
            let index = builder.chunk.programs.len() as u32;
            builder.push_boundary(EntryKind::Program, span.into(), index);
            builder.chunk.folder = folder.or_else(|| builder.chunk.folder.take());
            let folder = builder.chunk.folder.clone();
            builder.chunk.programs.push(ProgramRecord { name, folder });
        }
        LineItem::Words(span) => {
            if !builder.scan_words(span.into())
                && let Some(block) = block_at(SOURCE, text, span.start)
            {
                builder.push_block(&block);
            }
        }
        LineItem::Block(block) => builder.push_block(&block),
    });
    builder.chunk.entries.shrink_to_fit();
    builder.chunk.calls.shrink_to_fit();
    builder.chunk
}

impl ChunkBuilder<'_> {
    fn push_block(&mut self, block: &Block) {
        self.mark_block(block.span.into(), !block.is_unreadable());
        block_entries::record(self, block);
    }

    /// Records a line of words with numbers; returns false if it has to be read.
    fn scan_words(&mut self, range: TextRange) -> bool {
        let text = range.of(self.text);
        let mut at = 0;
        let mut number = None;
        let mut motion = self.chunk.last_motion;
        while let Some(word) = next_word(text, &mut at) {
            let Some(word) = word else { return false };
            match word.letter {
                b'N' if word.start == 0 && word.tenths.is_multiple_of(10) && !word.has_point => {
                    let start = range.start;
                    number = Some((TextRange::new(start, start + word.end as u32), word.tenths / 10));
                }
                b'N' | b'O' => return false,
                b'G' if is_read_g(word.tenths) => return false,
                b'G' => {
                    if let MotionChange::To(to) = motion_of(word.tenths, self.settings) {
                        motion = Some(to);
                    }
                }
                b'M' if is_read_m(word.tenths / 10) => return false,
                _ => {}
            }
            if self.has_code_calls && self.calls_program(word.letter, word.tenths) {
                return false;
            }
        }
        self.chunk.last_motion = motion;
        self.mark_block(range, true);
        if let Some((range, number)) = number {
            self.push(EntryKind::Number, range, number);
        }
        true
    }
}

/// Word of a line of numbers.
struct PlainWord {
    letter: u8,
    /// Offsets in the line.
    start: usize,
    end: usize,
    /// Magnitude × 10, its further digits left out.
    tenths: u32,
    has_point: bool,
}

/// Returns the next word of a line; `None` at its end, `Some(None)` for anything but a letter with a number.
fn next_word(text: &[u8], at: &mut usize) -> Option<Option<PlainWord>> {
    let is_space = |byte: u8| matches!(byte, b' ' | b'\t');
    while text.get(*at).is_some_and(|byte| is_space(*byte)) {
        *at += 1;
    }
    let start = *at;
    let letter = text.get(start)?.to_ascii_uppercase();
    if !letter.is_ascii_uppercase() {
        return Some(None);
    }
    let mut end = start + 1;
    while text.get(end).is_some_and(|byte| is_space(*byte)) {
        end += 1;
    }
    if matches!(text.get(end), Some(b'-' | b'+')) {
        end += 1;
    }
    let (mut tenths, mut digits, mut places): (u64, usize, Option<usize>) = (0, 0, None);
    while let Some(byte) = text.get(end) {
        match (byte, &mut places) {
            (b'0'..=b'9', None) => tenths = tenths.saturating_mul(10).saturating_add(u64::from(byte - b'0')),
            (b'0'..=b'9', Some(places)) => {
                *places += 1;
                if *places == 1 {
                    tenths = tenths.saturating_mul(10).saturating_add(u64::from(byte - b'0'));
                }
            }
            (b'.', None) => places = Some(0),
            _ => break,
        }
        digits += usize::from(*byte != b'.');
        end += 1;
    }
    if places.is_none_or(|places| places == 0) {
        tenths *= 10;
    }
    // A number may go on behind a space, and a point or a sign may be wrong: the line is read.
    let is_plain = (1..=9).contains(&digits)
        && text.get(end).is_none_or(|byte| is_space(*byte) || byte.is_ascii_alphabetic());
    let next = text[end..].iter().find(|byte| !is_space(**byte));
    if !is_plain || next.is_some_and(|byte| !byte.is_ascii_alphabetic()) {
        return Some(None);
    }
    *at = end;
    Some(Some(PlainWord { letter, start, end, tenths: tenths as u32, has_point: places.is_some() }))
}
