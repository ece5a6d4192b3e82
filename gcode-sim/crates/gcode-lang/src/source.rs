//! Program texts as bytes, and positions in them. Every token, operation, event and finding has a [`Span`].
use std::borrow::Cow;
use std::ops::Deref;
use std::sync::{Arc, OnceLock};

/// Index of a text in its [`Sources`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(pub u32);

/// Byte range of one text, from `start` up to but not including `end`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    /// Text that the range belongs to.
    pub source: SourceId,
    /// Offset of the first byte.
    pub start: u32,
    /// Offset after the last byte.
    pub end: u32,
}

/// Value with its span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub node: T,
    /// Span of the value in its text.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// Pairs a value with its span.
    pub fn new(node: T, span: Span) -> Self {
        Self { node, span }
    }
}

/// Line and column as shown in messages, both counted from 1; the column counts bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineColumn {
    /// Line number.
    pub line: u32,
    /// Byte position in the line.
    pub column: u32,
}

/// Shared bytes of a text. Bytes read from a file are taken over without a copy.
#[derive(Clone, Debug)]
pub struct Bytes {
    text: Arc<Vec<u8>>,
    /// Content of the file, if the text was converted from another encoding.
    file: Option<Arc<Vec<u8>>>,
}

impl Bytes {
    /// Returns a text that was converted to UTF-8 from the encoding of its file.
    pub fn converted(text: String, file: Vec<u8>) -> Self {
        Self { text: Arc::new(text.into_bytes()), file: Some(Arc::new(file)) }
    }

    /// Returns the content of the file, in its own encoding.
    pub fn file_content(&self) -> &[u8] {
        self.file.as_ref().unwrap_or(&self.text)
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.text
    }
}

impl From<Vec<u8>> for Bytes {
    fn from(bytes: Vec<u8>) -> Self {
        Self { text: Arc::new(bytes), file: None }
    }
}

impl From<&[u8]> for Bytes {
    fn from(bytes: &[u8]) -> Self {
        bytes.to_vec().into()
    }
}

impl<const N: usize> From<[u8; N]> for Bytes {
    fn from(bytes: [u8; N]) -> Self {
        bytes.to_vec().into()
    }
}

/// One text: its name, its bytes and the starts of its lines.
#[derive(Debug)]
pub struct Source {
    /// Name as given by the user.
    pub name: String,
    /// Content.
    pub bytes: Bytes,
    /// Offsets of the line starts, computed on first use.
    lines: OnceLock<Vec<u32>>,
}

impl Source {
    fn new(name: String, bytes: Bytes) -> Self {
        Self { name, bytes, lines: OnceLock::new() }
    }

    fn cached_line_starts(&self) -> &[u32] {
        self.lines.get_or_init(|| line_starts(&self.bytes))
    }

    /// Iterates over the lines without their ends; invalid UTF-8 is replaced.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        let starts = self.cached_line_starts();
        let ends = starts.iter().skip(1).map(|end| *end as usize).chain([self.bytes.len()]);
        starts.iter().zip(ends).map(|(start, end)| {
            let line = &self.bytes[*start as usize..end];
            let content_end =
                line.iter().rposition(|b| !matches!(b, b'\n' | b'\r')).map_or(0, |last| last + 1);
            String::from_utf8_lossy(&line[..content_end]).into_owned()
        })
    }

    /// Returns the offsets of a line, counted from 1, with its end.
    pub fn line_range(&self, line: u32) -> Option<std::ops::Range<u32>> {
        let (starts, line) = (self.cached_line_starts(), line as usize);
        let start = *starts.get(line.checked_sub(1)?)?;
        Some(start..starts.get(line).map_or(self.bytes.len() as u32 + 1, |next| *next))
    }

    /// Returns line and column of the byte at `offset`.
    pub fn line_column(&self, offset: u32) -> LineColumn {
        let lines = self.cached_line_starts();
        let index = lines.partition_point(|start| *start <= offset).saturating_sub(1);
        let start = lines.get(index).copied().unwrap_or(0);
        LineColumn { line: index as u32 + 1, column: offset - start + 1 }
    }
}

/// Returns the offset of each line start.
///
/// A line ends with LF, with CR LF or with a single CR. The stray CRs that some senders put around a LF
/// belong to that one line end.
fn line_starts(bytes: &[u8]) -> Vec<u32> {
    let mut starts = vec![0];
    let mut at = 0;
    loop {
        at += line_length(&bytes[at..]);
        if at == bytes.len() {
            return starts;
        }
        at += end_of_line(&bytes[at..]);
        starts.push(at as u32);
    }
}

/// Returns the length of the first line of a text without its end.
#[inline]
pub(crate) fn line_length(text: &[u8]) -> usize {
    memchr::memchr2(b'\n', b'\r', text).unwrap_or(text.len())
}

/// Most CRs next to a LF that belong to one line end. The limit keeps reading linear in a file of CRs only.
const MAX_CARRIAGE_RETURNS: usize = 4;

/// Returns the length of the line end at the start of `rest`: CRs with at most one LF, 0 if none.
#[inline]
pub(crate) fn end_of_line(rest: &[u8]) -> usize {
    match rest {
        // The most common line end.
        [b'\n', behind, ..] if *behind != b'\r' => 1,
        _ => mixed_line_end_length(rest),
    }
}

fn mixed_line_end_length(rest: &[u8]) -> usize {
    let before = rest.iter().take(MAX_CARRIAGE_RETURNS).take_while(|b| **b == b'\r').count();
    match rest.get(before) {
        Some(b'\n') => before + 1 + trailing_return_count(&rest[before + 1..]),
        _ => usize::from(before > 0),
    }
}

/// Counts the CRs after a LF that do not begin the next CR LF.
fn trailing_return_count(rest: &[u8]) -> usize {
    let count = rest.iter().take(MAX_CARRIAGE_RETURNS).take_while(|b| **b == b'\r').count();
    if rest.get(count) == Some(&b'\n') { 0 } else { count }
}

/// All texts of one session. Adding a text moves no other, so a [`SourceId`] stays valid.
#[derive(Clone, Debug, Default)]
pub struct Sources(Vec<Arc<Source>>);

impl Sources {
    /// Adds a text and returns its id.
    pub fn add(&mut self, name: impl Into<String>, bytes: impl Into<Bytes>) -> SourceId {
        let id = SourceId(self.0.len() as u32);
        self.0.push(Arc::new(Source::new(name.into(), bytes.into())));
        id
    }

    /// Returns the number of texts.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Iterates over all texts with their ids, in the order of addition.
    pub fn iter(&self) -> impl Iterator<Item = (SourceId, &Arc<Source>)> {
        self.0.iter().enumerate().map(|(id, source)| (SourceId(id as u32), source))
    }

    /// Returns the text with this id.
    ///
    /// # Panics
    ///
    /// If the id comes from another collection.
    pub fn get(&self, id: SourceId) -> &Arc<Source> {
        &self.0[id.0 as usize]
    }

    /// Returns line and column of the first byte of `span`.
    pub fn line_column(&self, span: Span) -> LineColumn {
        self.get(span.source).line_column(span.start)
    }

    /// Returns the text at `span`; invalid UTF-8 is replaced.
    pub fn text(&self, span: Span) -> String {
        self.text_in(span).into_owned()
    }

    /// Returns the text at `span` like [`Sources::text`], without a copy if it is valid UTF-8.
    pub fn text_in(&self, span: Span) -> Cow<'_, str> {
        let bytes = &self.get(span.source).bytes;
        String::from_utf8_lossy(&bytes[span.start as usize..span.end as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_line_end_counts_once() {
        assert_eq!(line_starts(b"a\nb\nc"), [0, 2, 4]);
        assert_eq!(line_starts(b"a\r\nb\r\nc"), [0, 3, 6]);
        assert_eq!(line_starts(b"a\rb\rc"), [0, 2, 4]);
        assert_eq!(line_starts(b"a\n\r\rb\n\r\rc"), [0, 4, 8]);
        assert_eq!(line_starts(b"a\r\n\r\nb"), [0, 3, 5], "an empty line between CR LF pairs is a line");
        assert_eq!(line_starts(b"a\r\rb"), [0, 2, 3], "CRs without a LF end a line each");
    }

    #[test]
    fn a_line_ends_at_its_first_line_end() {
        for length in 0..40 {
            for end in [&b"\n"[..], b"\r", b"\r\n\n", b"", b"\n\x0b\x0c\x8a\x8d\r\r\r\r"] {
                let text = [&b"X\x0b\x0c\x0e\x09\x8a\x8d\xff".repeat(5)[..length], end].concat();
                assert_eq!(line_length(&text), length, "{text:?}");
            }
        }
    }

    #[test]
    fn places_count_from_one() {
        let mut sources = Sources::default();
        let id = sources.add("O1", *b"%\r\nO1\r\nG0 X1.\r\n");
        assert_eq!(sources.get(id).line_column(10), LineColumn { line: 3, column: 4 });
    }
}
