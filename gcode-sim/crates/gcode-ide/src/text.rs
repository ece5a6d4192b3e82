//! Ranges of bytes, places in files, and edits.
use gcode_lang::source::{SourceId, Span};

/// Name of a file as its owner gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// Bytes from `start` up to but not including `end`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextRange {
    /// Offset of the first byte.
    pub start: u32,
    /// Offset after the last byte.
    pub end: u32,
}

impl TextRange {
    /// Creates a range.
    pub fn new(start: u32, end: u32) -> Self {
        Self { start, end }
    }

    /// Returns true if an offset is in the range or at its end, as a cursor behind a word is.
    pub fn touches(self, offset: u32) -> bool {
        (self.start..=self.end).contains(&offset)
    }

    /// Returns true if two ranges share a byte or a boundary.
    pub fn overlaps(self, other: Self) -> bool {
        self.start <= other.end && other.start <= self.end
    }

    /// Returns the number of bytes.
    pub fn len(self) -> u32 {
        self.end.saturating_sub(self.start)
    }

    /// Returns true if the range has no byte.
    pub fn is_empty(self) -> bool {
        self.end <= self.start
    }

    /// Returns the bytes of the range, as far as the text has them.
    pub(crate) fn of(self, text: &[u8]) -> &[u8] {
        let end = (self.end as usize).min(text.len());
        text.get(self.start as usize..end).unwrap_or_default()
    }
}

impl From<Span> for TextRange {
    fn from(span: Span) -> Self {
        Self { start: span.start, end: span.end }
    }
}

/// Text that the spans of one file belong to while it is read.
pub(crate) const SOURCE: SourceId = SourceId(0);

/// Range in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Location {
    /// File.
    pub file: FileId,
    /// Range in the file.
    pub range: TextRange,
}

/// Replacement of a range of one file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextEdit {
    /// Replaced range; empty for an insertion.
    pub range: TextRange,
    /// New text.
    pub text: String,
}

/// Replacement of a range of a file of the project.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileEdit {
    /// File.
    pub file: FileId,
    /// Edit of the file.
    pub edit: TextEdit,
}

/// Reason why a change is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Reason, one sentence.
    pub reason: String,
    /// Place of the obstacle.
    pub at: Option<Location>,
}

impl Refusal {
    pub(crate) fn new(reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), at: None }
    }

    pub(crate) fn at(self, file: FileId, range: TextRange) -> Self {
        Self { at: Some(Location { file, range }), ..self }
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.reason)
    }
}

impl std::error::Error for Refusal {}

/// Returns a text with edits applied; the edits are sorted and do not overlap.
pub fn apply_edits(text: &[u8], edits: &[TextEdit]) -> Vec<u8> {
    let mut result = Vec::with_capacity(text.len());
    let mut copied = 0;
    for TextEdit { range, text: new } in edits {
        result.extend_from_slice(TextRange::new(copied, range.start).of(text));
        result.extend_from_slice(new.as_bytes());
        copied = range.end;
    }
    result.extend_from_slice(TextRange::new(copied, text.len() as u32).of(text));
    result
}

/// Returns the range of the line of an offset, without its end.
pub(crate) fn line_range(text: &[u8], offset: u32) -> TextRange {
    let at = (offset as usize).min(text.len());
    let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let start = text[..at].iter().rposition(is_end).map_or(0, |last| last + 1);
    let end = text[at..].iter().position(is_end).map_or(text.len(), |first| at + first);
    TextRange::new(start as u32, end as u32)
}

/// Returns the number of the line of an offset, counted from 1.
pub(crate) fn line_number(text: &[u8], offset: u32) -> usize {
    let before = &text[..(offset as usize).min(text.len())];
    let has_feeds = before.contains(&b'\n');
    let end = if has_feeds { b'\n' } else { b'\r' };
    1 + before.iter().filter(|byte| **byte == end).count()
}

/// Returns bytes as text; invalid UTF-8 is replaced.
pub(crate) fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
