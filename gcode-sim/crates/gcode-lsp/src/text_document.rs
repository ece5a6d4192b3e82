//! One open text: its bytes, its lines, and the positions of the protocol in them.
use gcode_lang::source::Bytes;
use lsp_types::{Position, PositionEncodingKind, Range};

/// Unit in which a position counts the characters of its line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum PositionEncoding {
    /// Bytes.
    Utf8,
    /// UTF-16 code units, which every client has.
    #[default]
    Utf16,
}

impl PositionEncoding {
    /// Chooses the first of a client's encodings that the server has.
    pub(crate) fn negotiate(offered: Option<&[PositionEncodingKind]>) -> Self {
        let known = |kind: &PositionEncodingKind| match kind.as_str() {
            "utf-8" => Some(Self::Utf8),
            "utf-16" => Some(Self::Utf16),
            _ => None,
        };
        offered.unwrap_or_default().iter().find_map(known).unwrap_or_default()
    }

    /// Returns the protocol's name.
    pub(crate) fn kind(self) -> PositionEncodingKind {
        match self {
            Self::Utf8 => PositionEncodingKind::UTF8,
            Self::Utf16 => PositionEncodingKind::UTF16,
        }
    }
}

/// Text with the starts of its lines. A line ends with LF, with CR LF or with CR, as the protocol has it.
#[derive(Clone, Debug)]
pub(crate) struct TextDocument {
    bytes: Bytes,
    lines: Vec<u32>,
    encoding: PositionEncoding,
}

impl TextDocument {
    pub(crate) fn new(bytes: impl Into<Bytes>, encoding: PositionEncoding) -> Self {
        let bytes = bytes.into();
        let lines = line_starts(&bytes);
        Self { bytes, lines, encoding }
    }

    /// Returns the text.
    pub(crate) fn bytes(&self) -> &Bytes {
        &self.bytes
    }

    /// Returns the offset of a position. A character behind the end of its line is that end; a line behind the last is the end
    /// of the text.
    pub(crate) fn offset(&self, position: Position) -> u32 {
        let Some(start) = self.lines.get(position.line as usize) else { return self.bytes.len() as u32 };
        let line = self.line(position.line as usize);
        let character = position.character as usize;
        start + self.length(line, character) as u32
    }

    /// Returns the number of bytes in the first `character` units of a line, without half a character.
    fn length(&self, line: &[u8], character: usize) -> usize {
        if self.encoding == PositionEncoding::Utf8 {
            let mut length = character.min(line.len());
            while line.get(length).is_some_and(|byte| is_continuation(*byte)) {
                length -= 1;
            }
            return length;
        }
        let mut units = 0;
        for (at, byte) in line.iter().enumerate().filter(|(_, byte)| !is_continuation(**byte)) {
            let width = utf16_width(*byte);
            if character < units + width {
                return at;
            }
            units += width;
        }
        line.len()
    }

    /// Returns the position of an offset.
    pub(crate) fn position(&self, offset: u32) -> Position {
        let offset = offset.min(self.bytes.len() as u32);
        let line = self.lines.partition_point(|start| *start <= offset).saturating_sub(1);
        let before = &self.bytes[self.lines[line] as usize..offset as usize];
        Position::new(line as u32, self.width(before))
    }

    /// Returns the position of an offset like [`TextDocument::position`], from that of another offset in a short time if it is
    /// behind that in the same line.
    pub(crate) fn position_behind(&self, (known, position): (u32, Position), offset: u32) -> Position {
        let line_end = self.lines.get(position.line as usize + 1).copied().unwrap_or(u32::MAX);
        let offset = offset.min(self.bytes.len() as u32);
        if !(known..line_end).contains(&offset) {
            return self.position(offset);
        }
        let between = &self.bytes[known as usize..offset as usize];
        Position::new(position.line, position.character + self.width(between))
    }

    /// Returns the length of a part of a line in the protocol's units.
    fn width(&self, bytes: &[u8]) -> u32 {
        match self.encoding {
            PositionEncoding::Utf8 => bytes.len() as u32,
            PositionEncoding::Utf16 => bytes.iter().map(|byte| utf16_width(*byte) as u32).sum(),
        }
    }

    /// Returns the range of the protocol between two offsets.
    pub(crate) fn range(&self, start: u32, end: u32) -> Range {
        Range::new(self.position(start), self.position(end))
    }

    /// Returns the offsets of a range of the protocol; a range that ends before its start is taken in order.
    pub(crate) fn offsets(&self, range: Range) -> (u32, u32) {
        let (start, end) = (self.offset(range.start), self.offset(range.end));
        (start.min(end), start.max(end))
    }

    /// Returns a line without its end; the lines count from 0.
    pub(crate) fn line(&self, line: usize) -> &[u8] {
        let Some(start) = self.lines.get(line) else { return &[] };
        let end = self.lines.get(line + 1).map_or(self.bytes.len(), |next| *next as usize);
        let text = &self.bytes[*start as usize..end];
        let text = text.strip_suffix(b"\n").unwrap_or(text);
        text.strip_suffix(b"\r").unwrap_or(text)
    }

    /// Takes over the text after a replacement of the bytes from `start` to `end` by `length` others.
    pub(crate) fn replace(&mut self, (start, end): (usize, usize), length: usize, text: Bytes) {
        // A CR at the seam may become a line end of its own, or cease to be one.
        let first = self.lines.partition_point(|line| (*line as usize) < start).saturating_sub(1);
        let last = self.lines.partition_point(|line| (*line as usize) <= end + 1);
        let from = self.lines[first] as usize;
        let delta = length as i64 - (end - start) as i64;
        let to = self.lines.get(last).map_or(text.len(), |line| (i64::from(*line) + delta) as usize);
        let mut between = line_starts(&text[from..to]);
        // The start of the line behind is in the list already.
        if last < self.lines.len() && between.last().is_some_and(|line| *line as usize + from == to) {
            between.pop();
        }
        let behind = self.lines.split_off(last);
        self.lines.truncate(first);
        self.lines.extend(between.into_iter().map(|line| line + from as u32));
        self.lines.extend(behind.into_iter().map(|line| (i64::from(line) + delta) as u32));
        self.bytes = text;
    }
}

/// Returns the offset of each line start.
fn line_starts(text: &[u8]) -> Vec<u32> {
    let mut starts = vec![0];
    for at in memchr::memchr2_iter(b'\n', b'\r', text) {
        let is_split = text[at] == b'\r' && text.get(at + 1) == Some(&b'\n');
        if !is_split {
            starts.push(at as u32 + 1);
        }
    }
    starts
}

fn is_continuation(byte: u8) -> bool {
    byte & 0xc0 == 0x80
}

/// Returns the number of UTF-16 units of the character that a byte begins; 0 within a character.
fn utf16_width(byte: u8) -> usize {
    if is_continuation(byte) { 0 } else { 1 + usize::from(byte >= 0xf0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_16_counts_a_pair_of_surrogates_as_two() {
        // 😀 is U+1F600: four bytes, two units; Ø is two bytes, one unit.
        let text = "O1(\u{1f600}\u{d8})\r\nM30";
        let document = TextDocument::new(text.as_bytes(), PositionEncoding::Utf16);
        assert_eq!(document.offset(Position::new(0, 5)), 7);
        assert_eq!(document.offset(Position::new(0, 4)), 3, "within the pair: before it");
        assert_eq!(document.offset(Position::new(0, 6)), 9);
        assert_eq!(document.position(9), Position::new(0, 6));
        assert_eq!(document.offset(Position::new(0, 99)), 10, "before CR LF");
        assert_eq!(document.offset(Position::new(1, 0)), 12);
        assert_eq!(document.offset(Position::new(7, 0)), 15);
        let document = TextDocument::new(text.as_bytes(), PositionEncoding::Utf8);
        assert_eq!(document.offset(Position::new(0, 7)), 7);
        assert_eq!(document.position(9), Position::new(0, 9));
    }

    #[test]
    fn a_position_behind_another_is_that_from_the_start() {
        let text = "G0(\u{1f600}\u{d8})X1\r\nM30\n\nY2";
        for encoding in [PositionEncoding::Utf8, PositionEncoding::Utf16] {
            let document = TextDocument::new(text.as_bytes(), encoding);
            let offsets = || text.char_indices().map(|(at, _)| at as u32).chain([text.len() as u32, 99]);
            for (known, offset) in offsets().flat_map(|known| offsets().map(move |offset| (known, offset))) {
                let found = document.position_behind((known, document.position(known)), offset);
                assert_eq!(found, document.position(offset), "{offset} from {known}");
            }
        }
    }

    /// Every replacement of a short text by each of a few gives the lines that the new text has from the start.
    #[test]
    fn lines_after_an_edit_are_those_of_the_new_text() {
        for text in ["", "a\r\nb\rc\nd", "\r\n\r\n", "\r\r\n\n", "x\ry"] {
            for start in 0..=text.len() {
                for end in start..=text.len() {
                    for new in ["", "z", "\n", "\r", "\r\n", "q\rw\n"] {
                        let mut document = TextDocument::new(text.as_bytes(), PositionEncoding::Utf8);
                        let expected = format!("{}{new}{}", &text[..start], &text[end..]);
                        document.replace((start, end), new.len(), expected.as_bytes().into());
                        let lines = line_starts(expected.as_bytes());
                        assert_eq!(document.lines, lines, "{text:?}, {start}..{end} by {new:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_first_known_encoding_of_the_client_counts() {
        let chosen = |names: &[&'static str]| {
            let kinds: Vec<_> = names.iter().map(|name| PositionEncodingKind::new(name)).collect();
            PositionEncoding::negotiate(Some(&kinds))
        };
        assert_eq!(chosen(&["utf-32", "utf-8", "utf-16"]), PositionEncoding::Utf8);
        assert_eq!(chosen(&["utf-16", "utf-8"]), PositionEncoding::Utf16);
        assert_eq!(chosen(&["utf-32"]), PositionEncoding::Utf16);
        assert_eq!(PositionEncoding::negotiate(None), PositionEncoding::Utf16);
    }
}
