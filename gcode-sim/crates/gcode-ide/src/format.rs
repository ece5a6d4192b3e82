//! Format: one space between words, none at the ends of lines. No word, comment or statement changes.
use gcode_lang::syntax::ast::{Block, CommentMark, Item, Program, ProgramName, WordValue};
use gcode_lang::syntax::{block_at, print};

use crate::project::Project;
use crate::text::{FileId, SOURCE, TextEdit, TextRange, apply_edits, line_range};
use crate::trimming::{FormatOptions, end_of_lines, tail_edit, without_spaces_at_end};

impl Project {
    /// Returns the edits that format the lines of a range, or of the whole file with its end.
    ///
    /// A line that would be read differently afterwards stays as it is, as does one that cannot be read, but for spaces at its end.
    pub fn format(&self, file: FileId, range: Option<TextRange>, options: FormatOptions) -> Vec<TextEdit> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let text = index.text();
        let tail = if range.is_none() { tail_edit(text, options) } else { None };
        let range = range.unwrap_or(TextRange::new(0, end_of_lines(text)));
        let mut edits = Vec::new();
        let mut at = line_range(text, range.start).start;
        while at <= range.end && (at as usize) < text.len() {
            let line = line_range(text, at);
            let programs = index.programs();
            let program = index.program_at(line.end).and_then(|program| programs.get(program));
            // A leader, and text behind the last block, is none of a control.
            if let Some(program) = program.filter(|program| line.start < program.range.end) {
                let has_name = line.overlaps(program.name_range) && !program.name_range.is_empty();
                if !has_name {
                    edits.extend(line_edits(text, line));
                }
            }
            if options.trims_trailing_spaces {
                let is_trimmed =
                    |edits: &[TextEdit]| edits.last().is_some_and(|last| last.range.end == line.end);
                let trimmed = without_spaces_at_end(text, line).filter(|_| !is_trimmed(&edits));
                edits.extend(trimmed.filter(|edit| is_read_the_same(text, line, edit)));
            }
            at = next_line(text, line.end);
        }
        edits.extend(tail);
        edits
    }
}

/// Returns the start of the line behind a line end.
fn next_line(text: &[u8], end: u32) -> u32 {
    let rest = &text[end as usize..];
    end + rest.iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count().max(1) as u32
}

/// Returns the edits of a line, if it is read the same afterwards.
fn line_edits(text: &[u8], line: TextRange) -> Vec<TextEdit> {
    let Some(block) = block_at(SOURCE, &text[..line.end as usize], line.start) else { return Vec::new() };
    // Behind `;` another block may follow.
    let is_alone = || text[block.span.end as usize..line.end as usize].trim_ascii().is_empty();
    let is_own = line.start <= block.span.start && block.span.end <= line.end && is_alone();
    let edits = if is_own { block_edits(text, line, &block) } else { Vec::new() };
    if edits.is_empty() {
        return edits;
    }
    let own: Vec<_> = edits.iter().map(|edit| shifted(edit, line.start)).collect();
    let changed = apply_edits(line.of(text), &own);
    let read = block_at(SOURCE, &changed, 0);
    let is_same = read.is_some_and(|read| printed(read) == printed(block));
    if is_same { edits } else { Vec::new() }
}

/// Returns true if an edit at the end of a line leaves the block of that line as it is.
fn is_read_the_same(text: &[u8], line: TextRange, edit: &TextEdit) -> bool {
    let read = |end: u32| block_at(SOURCE, &text[..end as usize], line.start).map(printed);
    read(line.end) == read(edit.range.start)
}

/// Returns an edit of a line whose text begins at 0.
fn shifted(edit: &TextEdit, start: u32) -> TextEdit {
    let range = TextRange::new(edit.range.start - start, edit.range.end - start);
    TextEdit { range, text: edit.text.clone() }
}

/// Returns a block as the printer spells it.
fn printed(block: Block) -> Vec<u8> {
    print(&Program { name: ProgramName::Unnamed, span: block.span, blocks: vec![block] })
}

fn block_edits(text: &[u8], line: TextRange, block: &Block) -> Vec<TextEdit> {
    let is_unreadable = block.items.iter().any(|item| matches!(item, Item::Unreadable(_)));
    let is_unclosed = block.comments.iter().any(|comment| comment.mark == CommentMark::Unclosed);
    if is_unreadable
        || is_unclosed
        || block.items.is_empty() && block.comments.is_empty() && block.number.is_none()
    {
        return Vec::new();
    }
    // Pieces in order, with true for one that no space follows.
    let mut pieces: Vec<(TextRange, bool)> = Vec::new();
    let is_close = |range: TextRange| range.of(text) == b"/";
    pieces.extend(block.skip.iter().map(|skip| (skip.span.into(), is_close(skip.span.into()))));
    pieces.extend(block.number.iter().map(|number| (number.span.into(), false)));
    let mut edits = Vec::new();
    for item in &block.items {
        let range: TextRange = match item {
            Item::Word(word) => {
                let range = word.span.into();
                if matches!(word.value, WordValue::Literal(_)) {
                    edits.extend(closed_up(text, range));
                }
                range
            }
            Item::Statement(statement) => without_spaces_behind(text, statement.span.into()),
            Item::Skip(skip) => skip.span.into(),
            Item::Unreadable(unreadable) => unreadable.span.into(),
        };
        pieces.push((range, matches!(item, Item::Skip(_)) && is_close(range)));
    }
    pieces.extend(
        block.comments.iter().map(|comment| (without_spaces_behind(text, comment.span.into()), false)),
    );
    pieces.sort_unstable();
    let mut last: Option<(TextRange, bool)> = None;
    for piece in &pieces {
        match last {
            None => edits.extend(gap(text, TextRange::new(line.start, piece.0.start), "")),
            // A comment lies inside a word or a statement.
            Some((before, _)) if piece.0.start < before.end => continue,
            Some((before, is_skip)) => {
                let between = TextRange::new(before.end, piece.0.start);
                // A comment may follow without a space, as the text of an alarm does.
                let is_comment = text.get(piece.0.start as usize) == Some(&b'(');
                let is_close = is_skip || between.is_empty() && is_comment;
                let space = if is_close { "" } else { " " };
                edits.extend(gap(text, between, space));
            }
        }
        last = Some(*piece);
    }
    if let Some((last, _)) = last {
        edits.extend(gap(text, TextRange::new(last.end, line.end), ""));
    }
    edits.sort_unstable();
    edits
}

/// Returns a range without the spaces at its end.
fn without_spaces_behind(text: &[u8], range: TextRange) -> TextRange {
    let spaces = range.of(text).iter().rev().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
    TextRange::new(range.start, range.end - spaces as u32)
}

fn is_blank(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| matches!(byte, b' ' | b'\t'))
}

/// Returns the edit of a gap that has nothing but spaces.
fn gap(text: &[u8], range: TextRange, space: &str) -> Option<TextEdit> {
    let bytes = range.of(text);
    (is_blank(bytes) && bytes != space.as_bytes()).then(|| TextEdit { range, text: space.to_owned() })
}

/// Returns the edits that remove the spaces inside a word.
fn closed_up(text: &[u8], range: TextRange) -> Vec<TextEdit> {
    let bytes = range.of(text);
    let is_space = |byte: &u8| matches!(byte, b' ' | b'\t');
    if !bytes.iter().any(is_space) || bytes.contains(&b'(') {
        return Vec::new();
    }
    let mut edits: Vec<TextEdit> = Vec::new();
    for (at, _) in bytes.iter().enumerate().filter(|(_, byte)| is_space(byte)) {
        let at = range.start + at as u32;
        match edits.last_mut() {
            Some(last) if last.range.end == at => last.range.end += 1,
            _ => edits.push(TextEdit { range: TextRange::new(at, at + 1), text: String::new() }),
        }
    }
    edits
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::control::Settings;
    use gcode_lang::syntax::parse;
    use proptest::prelude::*;

    const ALL_OPTIONS: FormatOptions = FormatOptions {
        trims_trailing_spaces: true,
        inserts_final_newline: true,
        trims_final_newlines: true,
    };

    fn formatted(text: &[u8], options: FormatOptions) -> Vec<u8> {
        let mut project = Project::new(Settings::default());
        project.set_file(FileId(0), "A", text);
        apply_edits(text, &project.format(FileId(0), None, options))
    }

    fn shown(text: &str) -> String {
        String::from_utf8(formatted(text.as_bytes(), FormatOptions::default())).unwrap()
    }

    #[test]
    fn spaces_at_ends_go_where_no_block_ends_too() {
        let shown = |text: &str| String::from_utf8(formatted(text.as_bytes(), ALL_OPTIONS)).unwrap();
        assert_eq!(shown("% \nO1 (A)  \nN5G0  \n\t\nX..5  \nM30"), "%\nO1 (A)\nN5 G0\n\nX..5\nM30\n");
        assert_eq!(
            shown("LEADER  \n%\nO1\nG43 ; H1  \n%\nBEHIND  \n\n"),
            "LEADER\n%\nO1\nG43 ; H1\n%\nBEHIND\n"
        );
        assert_eq!(shown("O1\n#3000=1(OPEN  \nM30\n"), "O1\n#3000=1(OPEN\nM30\n");
    }

    #[test]
    fn words_are_separated_by_one_space() {
        assert_eq!(
            shown("O1 (A)  \nN10G1X 1.Y-2.   F100(FEED)\t\n"),
            "O1 (A)  \nN10 G1 X1. Y-2. F100(FEED)\n"
        );
        assert_eq!(shown("/N5G0X1.\n/ 2  N5\n"), "/N5 G0 X1.\n/ 2 N5\n");
        assert_eq!(shown("  N5  G0\r\n\r\n X1.\r\n"), "N5 G0\r\n\r\nX1.\r\n");
        assert_eq!(shown("G1X1.;\nG1X1.  // UP \n"), "G1 X1.;\nG1 X1. // UP\n");
        assert_eq!(shown("G43  ;  H1 \n"), "G43  ;  H1 \n", "two blocks in a line");
    }

    #[test]
    fn statements_and_comments_stay() {
        for text in [
            "DPRNT[A  #1[44]  B]\n",
            "IF [ #1 EQ  0 ] GOTO  10\n",
            "(A  B   C)\n",
            "X..5   Y1.\n",
            "G0(NOT CLOSED   X\n",
            "%\nO1\nG0 X1.\n%\nTEXT   BEHIND\n",
            "LEADER  X1.?\n%\nO1\n%\n",
        ] {
            assert_eq!(shown(text), text);
        }
        assert_eq!(shown("#1=2  (A)\n#3000=1(B)\n"), "#1=2 (A)\n#3000=1(B)\n");
    }

    #[test]
    fn a_range_is_formatted_alone() {
        let text = b"N1G0\nN2G0\nN3G0\n";
        let mut project = Project::new(Settings::default());
        project.set_file(FileId(0), "A", *text);
        let edits = project.format(FileId(0), Some(TextRange::new(6, 7)), FormatOptions::default());
        assert_eq!(apply_edits(text, &edits), b"N1G0\nN2 G0\nN3G0\n");
    }

    /// Returns the programs as the printer spells them.
    fn meaning(text: &[u8]) -> Vec<Vec<u8>> {
        parse(SOURCE, text).iter().map(print).collect()
    }

    proptest! {
        #[test]
        fn format_keeps_the_meaning_and_is_idempotent(
            bytes in proptest::collection::vec(any::<u8>(), 0..200),
            words in "([NGXYFPO/#]{0,1}[0-9. \\-]{0,4}|IF\\[#1 EQ 1\\]|GOTO ?5|\\(A  B\\)|\t|;| // |%|=|\n|\r\n|DPRNT\\[A #1\\[2\\]\\]){0,40}",
        ) {
            for text in [bytes, words.into_bytes()] {
                for options in [FormatOptions::default(), ALL_OPTIONS] {
                    let once = formatted(&text, options);
                    prop_assert_eq!(meaning(&once), meaning(&text));
                    prop_assert_eq!(formatted(&once, options), once);
                }
            }
        }
    }
}
