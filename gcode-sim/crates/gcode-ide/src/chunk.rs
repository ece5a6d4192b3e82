//! Index of some whole lines of a file. An edit reads the chunks again that it touches, and no other.
use gcode_lang::control::Settings;
use gcode_lang::program::g_codes::{self, Effect};
use gcode_lang::program::modes::Motion;
use gcode_lang::syntax::ast::{Block, Folder};
use gcode_lang::syntax::{LineItem, block_at, line_items};

use crate::block_entries;
use crate::entry::{CallRecord, Entry, EntryKind, ProgramRecord};
use crate::text::{SOURCE, TextRange};

/// Kind of motion that a block of axis words makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MotionKind {
    Rapid,
    Feed,
    Arc,
    Cycle,
}

/// Entries of some lines, relative to the start of the first.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    pub entries: Vec<Entry>,
    /// Indices of the entries that bound programs.
    pub boundaries: Vec<u32>,
    pub programs: Vec<ProgramRecord>,
    pub calls: Vec<CallRecord>,
    /// Folder of the last folder line.
    pub folder: Option<Folder>,
    /// Motion in force after the lines; `None` if they command none.
    pub last_motion: Option<MotionKind>,
}

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
    builder.chunk
}

/// Builds a chunk from the items of its lines.
pub(crate) struct ChunkBuilder<'a> {
    /// Text up to the end of the chunk.
    pub text: &'a [u8],
    base: u32,
    pub settings: &'a Settings,
    pub has_code_calls: bool,
    pub chunk: Chunk,
    has_block: bool,
    has_readable: bool,
}

impl ChunkBuilder<'_> {
    /// Appends an entry at a range of the file.
    pub(crate) fn push(&mut self, kind: EntryKind, range: TextRange, value: u32) {
        let length = range.len().min(u32::from(u16::MAX)) as u16;
        self.chunk.entries.push(Entry { start: range.start - self.base, length, kind, value });
    }

    /// Returns a range of the file relative to the chunk.
    pub(crate) fn relative(&self, range: TextRange) -> TextRange {
        TextRange::new(range.start - self.base, range.end - self.base)
    }

    fn push_boundary(&mut self, kind: EntryKind, range: TextRange, value: u32) {
        self.chunk.boundaries.push(self.chunk.entries.len() as u32);
        self.push(kind, range, value);
    }

    /// Marks the first block, and the first readable one, of the chunk or its section.
    fn mark_block(&mut self, range: TextRange, is_readable: bool) {
        if !self.has_block {
            self.has_block = true;
            self.push_boundary(EntryKind::FirstBlock, range, u32::from(is_readable));
        }
        if is_readable && !self.has_readable {
            self.has_readable = true;
            self.push_boundary(EntryKind::FirstReadable, range, 0);
        }
    }

    fn push_block(&mut self, block: &Block) {
        self.mark_block(block.span.into(), !block.is_unreadable());
        block_entries::record(self, block);
    }

    /// Notes the motion that a G code × 10 puts in force.
    pub(crate) fn note_motion(&mut self, code: u32) {
        match motion_of(code, self.settings) {
            MotionChange::None => {}
            MotionChange::To(motion) => self.chunk.last_motion = Some(motion),
        }
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

    /// Returns true if a code × 10, or an address, calls a program by a setting.
    pub(crate) fn calls_program(&self, letter: u8, code: u32) -> bool {
        let calls = &self.settings.code_calls;
        matches!(letter, b'G' | b'M') && calls.find_call(letter, code).is_some()
            || calls.address_call(letter).is_some()
    }
}

/// Returns true for a G code × 10 whose block is read: calls and data input.
pub(crate) fn is_read_g(code: u32) -> bool {
    matches!(code, 100 | 110 | 650 | 660 | 661 | 670)
}

/// Returns true for an M code whose block is read: ends, calls, jumps and input.
pub(crate) fn is_read_m(code: u32) -> bool {
    matches!(code, 2 | 30 | 96..=99 | 109 | 198)
}

/// Effect of a G code on the motion of the blocks after it.
pub(crate) enum MotionChange {
    None,
    To(MotionKind),
}

/// Returns the motion that a G code × 10 puts in force.
pub(crate) fn motion_of(code: u32, settings: &Settings) -> MotionChange {
    let row = g_codes::row_on(code, g_codes::find(code), settings);
    MotionChange::To(match row.map(|row| row.effect) {
        Some(Effect::Motion(Motion::Rapid)) => MotionKind::Rapid,
        Some(Effect::Motion(Motion::Linear | Motion::Thread)) => MotionKind::Feed,
        Some(Effect::Motion(Motion::Clockwise | Motion::Counterclockwise)) => MotionKind::Arc,
        Some(Effect::Cycle(Some(_))) => MotionKind::Cycle,
        // G80 is followed by the motion that its block commands, or by rapid moves.
        Some(Effect::Cycle(None)) => MotionKind::Rapid,
        _ => return MotionChange::None,
    })
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
            (b'0'..=b'9', None) => tenths = tenths * 10 + u64::from(byte - b'0'),
            (b'0'..=b'9', Some(places)) => {
                *places += 1;
                if *places == 1 {
                    tenths = tenths * 10 + u64::from(byte - b'0');
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
