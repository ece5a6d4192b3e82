//! Stream of a file's items: `%`, program names and blocks.
use std::collections::VecDeque;

use super::ast::{Block, Comment, DoLine, Folder, Item, ProgramName, Unreadable};
use super::block::{begins_program, read_block};
use super::comment::blank_out_comments;
use super::number::integer;
use super::token::{Input, LineInput, is_space, spaces, unspaced};
use super::word::program_name;
use crate::alarm::Alarm;
use crate::source::{SourceId, Span, end_of_line, line_length};

/// Item of a file. Items are read one at a time, so that a long file is never held as a tree.
#[derive(Clone, Debug, PartialEq)]
pub enum FileItem {
    /// `%`: the following blocks belong to no program yet.
    Section,
    /// `O0001`, `:0007` or `<NAME>`; words on its line form the next item.
    Program {
        /// O number or name.
        name: ProgramName,
        /// Span of the O word.
        span: Span,
    },
    /// Block with its comments.
    Block(Block),
}

/// Iterator over the items of a file. Empty lines are omitted.
#[derive(Debug)]
pub struct FileItems<'a> {
    source: SourceId,
    bytes: &'a [u8],
    /// Offset of the next line.
    next_line_start: usize,
    /// Offsets in the current line: its start, the next unread byte, the end of the line and the end of its
    /// code.
    line_start: usize,
    position: usize,
    line_end: usize,
    code_end: usize,
    /// Offset up to which the bytes contain no divider.
    undivided_end: usize,
    /// Offset of `code` in the file, if the current line has blanked comments.
    blanked: Option<usize>,
    code: Vec<u8>,
    /// Comments of the current line that belong to no item yet.
    comments: VecDeque<Comment>,
    /// A statement of the current line is DO.
    is_behind_do: bool,
    /// Path of the last folder line.
    folder: Option<&'a [u8]>,
}

impl<'a> FileItems<'a> {
    /// Starts at the beginning of a file, after byte order marks and the leader.
    pub fn new(source: SourceId, bytes: &'a [u8]) -> Self {
        let bytes = without_trailer(bytes);
        Self::starting_at(source, bytes, byte_order_marks(bytes)).skip_leader()
    }

    /// Starts at the line start `offset` of a text without its trailer; spaces before the code are skipped.
    pub(super) fn starting_at(source: SourceId, bytes: &'a [u8], offset: usize) -> Self {
        Self {
            source,
            bytes,
            next_line_start: offset,
            line_start: 0,
            position: 0,
            line_end: 0,
            code_end: 0,
            undivided_end: offset,
            blanked: None,
            code: Vec::new(),
            comments: VecDeque::new(),
            is_behind_do: false,
            folder: None,
        }
    }

    /// Returns the folder of the next program: the path of the last folder line, without slashes at its ends.
    pub fn folder(&self) -> Option<Folder> {
        self.folder.map(|path| Folder::new(&String::from_utf8_lossy(path)))
    }

    /// Skips the leader: text before the first `%`, ignored by a control if nothing in it is readable.
    fn skip_leader(mut self) -> Self {
        // Nearly every file begins with a readable item.
        let first = FileItems::starting_at(self.source, self.bytes, self.next_line_start).next();
        let text = &self.bytes[self.next_line_start..];
        if !first.as_ref().is_some_and(has_nothing_readable) || !text.contains(&b'%') {
            return self;
        }
        let begins_line = |at: usize| text[..at].last().is_none_or(|b| matches!(b, b'\n' | b'\r'));
        let mark = text.iter().enumerate().find(|(at, byte)| **byte == b'%' && begins_line(*at));
        let Some((mark, _)) = mark else { return self };
        let text = &self.bytes[..self.next_line_start + mark];
        let mut leader = FileItems::starting_at(self.source, text, self.next_line_start);
        if leader.all(|piece| has_nothing_readable(&piece)) {
            self.next_line_start += mark;
        }
        self
    }

    /// Advances to the next line. A folder line of a memory dump, `&F=//CNC_MEM/…`, is no item: it is the [folder] of the
    /// programs behind it.
    ///
    /// [folder]: FileItems::folder
    pub(super) fn next_line(&mut self) -> Option<()> {
        loop {
            let text = self.bytes.get(self.next_line_start..).filter(|text| !text.is_empty())?;
            let length = line_length(text);
            (self.line_start, self.position) = (self.next_line_start, self.next_line_start);
            self.line_end = self.next_line_start + length;
            self.code_end = self.line_end;
            (self.blanked, self.is_behind_do) = (None, false);
            self.next_line_start = self.line_end + end_of_line(&text[length..]);
            let line = &text[..length];
            if let [b'&', b'F' | b'f', b'=', path @ ..] = unspaced(line) {
                self.folder = Some(path);
                continue;
            }
            if line.iter().fold(false, |any, byte| any | matches!(byte, b'(' | b';' | b'/')) {
                self.blank_comments(line);
            }
            return Some(());
        }
    }

    fn blank_comments(&mut self, text: &[u8]) {
        let Self { source, position: at, code, comments, .. } = self;
        blank_out_comments(*source, *at as u32, text, code, comments, |text| {
            if is_program_number(spaces(text)) {
                return true;
            }
            let mut block = Block::default();
            let left =
                read_block(LineInput { source: SourceId(0), end: text.len() as u32 }, text, &mut block);
            !left.is_empty() || !block.is_unreadable() && !block.items.iter().any(is_unreadable)
        });
        self.code_end = *at + code.len();
        self.blanked = Some(*at);
    }

    /// Reads the next item of the current line; `None` at its end.
    pub(super) fn next_item(&mut self) -> Option<FileItem> {
        if self.position == self.code_end && self.comments.is_empty() {
            return None;
        }
        self.read_item()
    }

    fn read_item(&mut self) -> Option<FileItem> {
        let text = match self.blanked {
            Some(begin) => &self.code[self.position - begin..],
            None => &self.bytes[self.position..self.code_end],
        };
        let line = LineInput { source: self.source, end: self.code_end as u32 };
        let left = |rest: Input<'_>| self.code_end - rest.len();
        // At the start of a line `;` ends no block: the text behind it may as well be a comment.
        let (text, semicolon) = if self.begins_line() { (text, None) } else { behind_semicolons(line, text) };
        let from = left(text);
        let at = spaces(text);
        if at.is_empty() && self.comments.is_empty() {
            return None;
        }
        if let Some(behind) = at.strip_prefix(b"%") {
            // `%O0003(…)` continues with the program; any other text after `%` is a leader.
            let behind = spaces(behind);
            let goes_on = begins_program(behind) || behind.first() == Some(&b'<');
            self.position = if goes_on { left(behind) } else { self.code_end };
            if !goes_on {
                self.comments.clear();
            }
            return Some(FileItem::Section);
        }
        if let [b'O' | b'o' | b':' | b'<', ..] = at
            && let Some((rest, name)) = program_word(at)
        {
            let span = line.span(at, rest);
            self.position = left(rest);
            return Some(FileItem::Program { name, span });
        }
        let do_line = if self.is_behind_do { DoLine::Behind } else { DoLine::No };
        let mut block = Block { behind_semicolon: semicolon, do_line, ..Block::default() };
        let to = left(read_block(line, text, &mut block));
        self.position = to;
        self.is_behind_do = block.do_line != DoLine::No;
        self.attach_comments(&mut block, from, to);
        Some(FileItem::Block(block))
    }

    /// Passes the following lines to `each`, as long as each is exactly one block without comments.
    ///
    /// The spans exclude leading spaces. The lines count as read.
    #[inline]
    pub(super) fn plain_lines(&mut self, mut each: impl FnMut(Span)) {
        let mut text = &self.bytes[self.next_line_start..];
        while !text.is_empty() {
            let offset = self.bytes.len() - text.len();
            if self.undivided_end <= offset {
                self.undivided_end = find_divider(self.bytes, offset);
            }
            let (line, behind) = text.split_at(line_length(text));
            let end = offset + line.len();
            if self.undivided_end < end {
                break;
            }
            let line = if let [0x21..=0x7e, ..] = line { line } else { unspaced(line) };
            if !line.is_empty() {
                each(Span { source: self.source, start: (end - line.len()) as u32, end: end as u32 });
            }
            text = &behind[end_of_line(behind)..];
        }
        self.next_line_start = self.bytes.len() - text.len();
    }

    /// Returns the offset of the next unread byte.
    pub(super) fn position(&self) -> u32 {
        self.position as u32
    }

    /// Returns true if nothing of the current line has been read.
    pub(super) fn begins_line(&self) -> bool {
        self.position == self.line_start
    }

    /// Returns the offset of the first byte of the current line that is no space.
    pub(super) fn line_code_start(&self) -> Option<u32> {
        let code = unspaced(&self.bytes[self.line_start..self.line_end]);
        (!code.is_empty()).then(|| (self.line_end - code.len()) as u32)
    }

    /// Counts the current line as read.
    pub(super) fn skip_line(&mut self) {
        (self.position, self.code_end, self.blanked) = (self.line_end, self.line_end, None);
        self.comments.clear();
    }

    /// Sets the comments and span of a block, and the text of its unreadable rest.
    fn attach_comments(&mut self, block: &mut Block, from: usize, to: usize) {
        let is_last = to == self.code_end;
        let end = if is_last { self.line_end } else { to };
        if is_last {
            block.comments = self.comments.drain(..).collect();
        } else if !self.comments.is_empty() {
            let own = self.comments.iter().take_while(|c| (c.span.start as usize) < to).count();
            block.comments.extend(self.comments.drain(..own));
        }
        block.span = trimmed(self.source, self.bytes, from, end);
        if let Some(Item::Unreadable(unreadable)) = block.items.last_mut() {
            fill_alarm_text(unreadable, self.bytes, end);
            let begin = unreadable.span.start;
            block.comments.retain(|c| c.span.start < begin);
        }
    }
}

impl Iterator for FileItems<'_> {
    type Item = FileItem;

    fn next(&mut self) -> Option<FileItem> {
        loop {
            if let Some(piece) = self.next_item() {
                return Some(piece);
            }
            self.next_line()?;
        }
    }
}

/// Returns the text without the trailer of a sender: 0x1A or blank tape.
pub(crate) fn without_trailer(bytes: &[u8]) -> &[u8] {
    let kept = bytes.iter().rposition(|b| !matches!(b, 0 | 0x1a | b' ' | b'\t' | b'\r' | b'\n'));
    &bytes[..kept.map_or(0, |last| last + 1)]
}

/// Returns the length of the byte order marks; an editor that does not recognise one adds another.
pub(super) fn byte_order_marks(bytes: &[u8]) -> usize {
    3 * bytes.chunks(3).take_while(|mark| mark == b"\xef\xbb\xbf").count()
}

/// Returns the span between two offsets without leading and trailing spaces.
fn trimmed(source: SourceId, bytes: &[u8], from: usize, to: usize) -> Span {
    let text = &bytes[from..to];
    let start = from + text.len() - unspaced(text).len();
    let end = text.iter().rposition(|b| !is_space(*b)).map_or(start, |last| from + last + 1);
    Span { source, start: start as u32, end: end as u32 }
}

/// Returns the end of the text before `offset`, without its trailing spaces.
pub(crate) fn end_without_spaces(bytes: &[u8], offset: u32) -> u32 {
    let text = &bytes[..offset as usize];
    text.iter().rposition(|b| !is_space(*b)).map_or(0, |last| last as u32 + 1)
}

/// Fills in the text that an alarm shows of the unreadable rest.
fn fill_alarm_text(unreadable: &mut Unreadable, bytes: &[u8], end: usize) {
    let Unreadable { alarm, span, text } = unreadable;
    *span = trimmed(span.source, bytes, span.start as usize, end);
    *text = bytes[span.start as usize..span.end as usize].to_vec();
    let of_rest = span.end.max(alarm.span.start);
    alarm.span.end = match alarm.node {
        // Their spans are those of the number.
        Alarm::IllegalPoint { .. } | Alarm::TooManyDigits(_) => alarm.span.end.min(of_rest),
        _ => of_rest,
    };
    if let Alarm::NotAWord { text } | Alarm::Expression { text } | Alarm::AxisAddress { text } =
        &mut alarm.node
    {
        let rest = String::from_utf8_lossy(&bytes[alarm.span.start as usize..alarm.span.end as usize]);
        let shown: String = rest.chars().take(12).collect();
        let cut = if shown.len() < rest.len() { "…" } else { "" };
        *text = format!("{}{cut}", shown.trim_end());
    }
}

fn is_unreadable(item: &Item) -> bool {
    matches!(item, Item::Unreadable(_))
}

fn has_nothing_readable(piece: &FileItem) -> bool {
    matches!(piece, FileItem::Block(block) if block.is_unreadable())
}

/// Returns a text behind the `;` that end the block before it, with the last of them.
fn behind_semicolons(line: LineInput, text: Input<'_>) -> (Input<'_>, Option<Span>) {
    let (mut text, mut semicolon) = (text, None);
    while let [b';', behind @ ..] = spaces(text) {
        semicolon = Some(line.span(spaces(text), behind));
        text = behind;
    }
    (text, semicolon)
}

/// Reads `O0001`, `:0007`, `<NAME>` or `O9123<NAME>`; in the last the name is only a title.
fn program_word(at: Input<'_>) -> Option<(Input<'_>, ProgramName)> {
    if begins_program(at) {
        let (rest, number) = integer(spaces(&at[1..])).ok()?;
        let number = u32::try_from(number).ok().filter(|n| (1..=99_999_999).contains(n))?;
        let rest = program_name(spaces(rest)).map_or(rest, |(rest, _)| rest);
        return Some((rest, ProgramName::Number(number)));
    }
    let (rest, text) = program_name(at).ok()?;
    Some((rest, ProgramName::of(text)))
}

/// Returns true for the number of a program and nothing behind it.
fn is_program_number(text: Input<'_>) -> bool {
    begins_program(text) && program_word(text).is_some_and(|(rest, _)| spaces(rest).is_empty())
}

/// Returns true for a byte of a line that may be more than one block without comments.
///
/// The byte may begin a comment or a remark, end a block before its line does (`%`, `O`, `:`, `<`), or belong
/// to DO, END or EN or to a folder line (`&`). The test is branch-free, so that many bytes are tested at
/// once; a few other bytes match too.
const fn divides(byte: u8) -> bool {
    let of_words = byte & 0xde == b'D';
    let slash_or_o = byte & 0x9f == b'/' & 0x9f;
    of_words
        | slash_or_o
        | (byte.wrapping_sub(b'%') <= b'(' - b'%')
        | (byte.wrapping_sub(b':') <= b'<' - b':')
}

/// Lookup table of [`divides`] for single bytes.
const DIVIDES: [bool; 256] = {
    let mut all = [false; 256];
    let mut byte = 0;
    while byte < all.len() {
        all[byte] = divides(byte as u8);
        byte += 1;
    }
    all
};

/// Returns the offset of the next byte from `from` on that [`divides`] its line, or the length of the text.
#[inline(never)]
fn find_divider(bytes: &[u8], from: usize) -> usize {
    let text = &bytes[from..];
    let divided = |chunk: &[u8; 32]| chunk.iter().fold(false, |any, byte| any | divides(*byte));
    let plain = 32 * text.as_chunks().0.iter().take_while(|chunk| !divided(chunk)).count();
    let found = text[plain..].iter().position(|byte| DIVIDES[usize::from(*byte)]);
    found.map_or(bytes.len(), |offset| from + plain + offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_divider_is_found() {
        for byte in *b"(;/%Oo:<DdEe&" {
            for offset in 0..80 {
                let mut text = b"N10 G1 X-1.5 Y+2. Z#3 F[100*2]=,\tgzAKQ@\n\r9".repeat(3);
                text[offset] = byte;
                assert_eq!(find_divider(&text, 0), offset);
                assert_eq!(find_divider(&text, offset), offset);
                assert_eq!(find_divider(&text, offset + 1), text.len());
            }
        }
    }
}
