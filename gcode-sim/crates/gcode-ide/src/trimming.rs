//! Spaces and line ends that an editor's options of formatting remove or add, where no block is.
use crate::text::{TextEdit, TextRange, line_range};

/// What an editor asks of formatting beyond the spaces between words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FormatOptions {
    /// No line ends with spaces, a comment's or that of a program's name neither.
    pub trims_trailing_spaces: bool,
    /// The text ends with a line end.
    pub inserts_final_newline: bool,
    /// No empty line ends the text.
    pub trims_final_newlines: bool,
}

/// Returns the edit that removes the spaces at the end of a line.
pub(crate) fn without_spaces_at_end(text: &[u8], line: TextRange) -> Option<TextEdit> {
    let spaces = line.of(text).iter().rev().take_while(|byte| is_space(byte)).count() as u32;
    let range = TextRange::new(line.end - spaces, line.end);
    (0 < spaces).then(|| TextEdit { range, text: String::new() })
}

/// Returns the end of the last line that has more than spaces; 0 in a text without one.
pub(crate) fn end_of_lines(text: &[u8]) -> u32 {
    let last = text.iter().rposition(|byte| !is_space(byte) && !is_line_end(byte));
    last.map_or(0, |at| line_range(text, at as u32).end)
}

/// Returns the edit of what follows the last line.
pub(crate) fn tail_edit(text: &[u8], options: FormatOptions) -> Option<TextEdit> {
    let range = TextRange::new(end_of_lines(text), text.len() as u32);
    if range.start == 0 {
        return None;
    }
    let tail = range.of(text);
    let end = first_line_end(tail);
    let changed = if options.trims_final_newlines && !end.is_empty() {
        end.to_vec()
    } else if options.trims_trailing_spaces {
        tail.iter().copied().filter(|byte| !is_space(byte)).collect()
    } else {
        tail.to_vec()
    };
    let is_open = !changed.last().is_some_and(is_line_end);
    let added = match first_line_end(text) {
        _ if !(is_open && options.inserts_final_newline) => b"",
        [] => b"\n".as_slice(),
        end => end,
    };
    let changed = [changed.as_slice(), added].concat();
    (changed != tail).then(|| TextEdit { range, text: String::from_utf8_lossy(&changed).into_owned() })
}

/// Returns the first line end of a text: LF, CR LF or CR; nothing in a text of one line.
fn first_line_end(text: &[u8]) -> &[u8] {
    let Some(start) = text.iter().position(is_line_end) else { return &[] };
    let length = if text[start..].starts_with(b"\r\n") { 2 } else { 1 };
    &text[start..start + length]
}

fn is_space(byte: &u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

fn is_line_end(byte: &u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::apply_edits;

    fn ended(text: &str, options: FormatOptions) -> String {
        let edits: Vec<_> = tail_edit(text.as_bytes(), options).into_iter().collect();
        String::from_utf8(apply_edits(text.as_bytes(), &edits)).unwrap()
    }

    #[test]
    fn the_end_of_a_text_is_as_the_options_have_it() {
        let none = FormatOptions::default();
        let inserts = FormatOptions { inserts_final_newline: true, ..none };
        let trims = FormatOptions { trims_final_newlines: true, ..none };
        let spaces = FormatOptions { trims_trailing_spaces: true, ..none };
        let all = FormatOptions { inserts_final_newline: true, trims_final_newlines: true, ..spaces };
        for (text, options, expected) in [
            ("O1\nM30", inserts, "O1\nM30\n"),
            ("O1\r\nM30", inserts, "O1\r\nM30\r\n"),
            ("M30", inserts, "M30\n"),
            ("O1\nM30\n", inserts, "O1\nM30\n"),
            ("O1\nM30\n  ", inserts, "O1\nM30\n  \n"),
            ("O1\nM30\n\n\n", inserts, "O1\nM30\n\n\n"),
            ("O1\nM30\n\n\n", trims, "O1\nM30\n"),
            ("O1\r\nM30\r\n\r\n", trims, "O1\r\nM30\r\n"),
            ("O1\nM30\n  \n", trims, "O1\nM30\n"),
            ("O1\nM30", trims, "O1\nM30"),
            ("O1\nM30\n  \n", spaces, "O1\nM30\n\n"),
            ("O1\nM30\n  ", spaces, "O1\nM30\n"),
            ("O1\nM30\n \n\t", all, "O1\nM30\n"),
            ("O1\nM30\n\n\n", none, "O1\nM30\n\n\n"),
            ("", all, ""),
            ("\n\n", all, "\n\n"),
        ] {
            assert_eq!(ended(text, options), expected, "{text:?} {options:?}");
        }
    }
}
