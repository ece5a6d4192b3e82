//! Chunk under construction: entries are appended with places in the file and kept relative to the chunk.
use gcode_lang::control::Settings;
use gcode_lang::program::g_codes::{self, Effect};
use gcode_lang::program::modes::Motion;
use gcode_lang::syntax::ast::Folder;

use crate::entry::{CallRecord, Entry, EntryKind, ProgramRecord};
use crate::text::TextRange;

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

/// Builds a chunk from the items of its lines.
pub(crate) struct ChunkBuilder<'a> {
    /// Text up to the end of the chunk.
    pub text: &'a [u8],
    pub base: u32,
    pub settings: &'a Settings,
    pub has_code_calls: bool,
    pub chunk: Chunk,
    pub has_block: bool,
    pub has_readable: bool,
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

    pub(crate) fn push_boundary(&mut self, kind: EntryKind, range: TextRange, value: u32) {
        self.chunk.boundaries.push(self.chunk.entries.len() as u32);
        self.push(kind, range, value);
    }

    /// Marks the first block, and the first readable one, of the chunk or its section.
    pub(crate) fn mark_block(&mut self, range: TextRange, is_readable: bool) {
        if !self.has_block {
            self.has_block = true;
            self.push_boundary(EntryKind::FirstBlock, range, u32::from(is_readable));
        }
        if is_readable && !self.has_readable {
            self.has_readable = true;
            self.push_boundary(EntryKind::FirstReadable, range, 0);
        }
    }

    /// Notes the motion that a G code × 10 puts in force.
    pub(crate) fn note_motion(&mut self, code: u32) {
        match motion_of(code, self.settings) {
            MotionChange::None => {}
            MotionChange::To(motion) => self.chunk.last_motion = Some(motion),
        }
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
