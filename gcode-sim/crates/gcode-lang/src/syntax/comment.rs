//! Comments: located before the rest of a line is read, kept byte for byte and blanked in the code.
use std::collections::VecDeque;

use super::ast::{Comment, CommentMark};
use super::token::{COMMENT, is_space};
use crate::source::{SourceId, Span};

/// Copies a line into `code` with its comments overwritten by [`COMMENT`], and appends them to `comments`.
///
/// Remarks at the end, `; TEXT` and `// TEXT`, are cut off. If the text after a `;` is a block according to
/// `is_block`, the `;` stays in the code and ends the block before it.
pub(super) fn blank_out_comments(
    source: SourceId,
    start: u32,
    line: &[u8],
    code: &mut Vec<u8>,
    comments: &mut VecDeque<Comment>,
    is_block: impl Fn(&[u8]) -> bool,
) {
    code.clear();
    code.extend_from_slice(line);
    let mut push_comment = |from: usize, to: usize, text: &[u8], mark| {
        // Spaces at the end of a line are not part of a comment.
        let kept =
            text.iter().rposition(|b| mark == CommentMark::Round || !is_space(*b)).map_or(0, |last| last + 1);
        let text = &text[..kept];
        let span = Span { source, start: start + from as u32, end: start + to as u32 };
        comments.push_back(Comment { span, text: text.to_vec(), mark });
    };
    let mut pairs: Option<Vec<usize>> = None;
    let (mut brackets, mut names) = (0u32, 0u32);
    let mut at = 0;
    while let Some(byte) = line.get(at) {
        let rest = &line[at..];
        match byte {
            b'(' => {
                let (end, mark) = match closing(line, at, &mut pairs) {
                    Some(close) => (close + 1, CommentMark::Round),
                    None => (line.len(), CommentMark::Unclosed),
                };
                let inner_end = if mark == CommentMark::Round { end - 1 } else { end };
                push_comment(at, end, &line[at + 1..inner_end], mark);
                code[at..end].fill(COMMENT);
                at = end;
                continue;
            }
            b';' => {
                let text = &rest[1..];
                if text.iter().all(|b| is_space(*b) || *b == b';') {
                    code.truncate(at);
                    return;
                }
                let first = text.iter().position(|b| matches!(b, b'(' | b';')).unwrap_or(text.len());
                let is_empty = text.get(first) == Some(&b';') && text[..first].iter().all(|b| is_space(*b));
                if !is_empty && !is_block(&text[..first]) {
                    push_comment(at, line.len(), text, CommentMark::Semicolon);
                    code.truncate(at);
                    return;
                }
            }
            b'/' if brackets + names == 0 && begins_remark(rest) => {
                push_comment(at, line.len(), &rest[2..], CommentMark::Slashes);
                code.truncate(at);
                return;
            }
            b'[' => brackets += 1,
            b']' => brackets = brackets.saturating_sub(1),
            // Inside brackets `<` and `>` are comparisons.
            b'<' if brackets == 0 => names += 1,
            b'>' if brackets == 0 => names = names.saturating_sub(1),
            _ => {}
        }
        at += 1;
    }
}

/// Returns true at `// TEXT`. Before a number or a variable the second `/` may be a faulty division or skip.
fn begins_remark(rest: &[u8]) -> bool {
    rest.get(1) == Some(&b'/') && !matches!(rest.get(2), Some(b'0'..=b'9' | b'#' | b'['))
}

/// Returns the position of the bracket that closes the comment at `open`.
///
/// A control ends a comment at the first `)`. Some programs nest round brackets, `(O9804: D (RING ID)
/// REQUIRED)`, where a control raises an alarm at the last `)`; such a comment ends at its matching `)`.
fn closing(line: &[u8], open: usize, pairs: &mut Option<Vec<usize>>) -> Option<usize> {
    let first = line[open + 1..].iter().position(|b| matches!(b, b'(' | b')')).map(|i| open + 1 + i)?;
    if line[first] == b')' {
        return Some(first);
    }
    let pairs = pairs.get_or_insert_with(|| matching_brackets(line));
    match pairs[open] {
        0 => line[open + 1..].iter().position(|b| *b == b')').map(|i| open + 1 + i),
        own => Some(own),
    }
}

/// Returns the position of the matching `)` for each `(`, 0 if there is none.
fn matching_brackets(line: &[u8]) -> Vec<usize> {
    let mut closes = vec![0; line.len()];
    let mut open = Vec::new();
    for (at, byte) in line.iter().enumerate() {
        match byte {
            b'(' => open.push(at),
            b')' => {
                if let Some(begin) = open.pop() {
                    closes[begin] = at;
                }
            }
            _ => {}
        }
    }
    closes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blanked(line: &str) -> (String, Vec<String>) {
        let (mut code, mut comments) = (Vec::new(), VecDeque::new());
        blank_out_comments(SourceId(0), 0, line.as_bytes(), &mut code, &mut comments, |text| {
            text.starts_with(b" G")
        });
        let comments = comments.into_iter().map(|c| String::from_utf8(c.text).unwrap()).collect();
        (String::from_utf8(code).unwrap(), comments)
    }

    #[test]
    fn a_comment_ends_where_a_control_ends_it_or_at_its_own_bracket() {
        let check = |line: &str, code: &str, comments: &[&str]| {
            let (found, texts) = blanked(line);
            assert_eq!(found, code, "{line}");
            assert_eq!(texts, comments, "{line}");
        };
        check("G0(FAST)X1.", "G0((((((X1.", &["FAST"]);
        check("G0()X1.", "G0((X1.", &[""]);
        check("M0(D (RING) REQUIRED)", "M0(((((((((((((((((((", &["D (RING) REQUIRED"]);
        check("(A (B) X1.", "(((((( X1.", &["A (B"]);
        check("G0 (NEVER CLOSED", "G0 (((((((((((((", &["NEVER CLOSED"]);
        check("G0 X1.;", "G0 X1.", &[]);
        check("G0 X1.; UP (AGAIN)", "G0 X1.", &[" UP (AGAIN)"]);
        check("G0 X1.; G1", "G0 X1.; G1", &[]);
        check("G0 X1.;; G1 (A); UP", "G0 X1.;; G1 (((", &["A", " UP"]);
        check("G0 X1.; G1; G1 ;", "G0 X1.; G1; G1 ", &[]);
        check("G0 // UP", "G0 ", &[" UP"]);
        check("#1=#2//2", "#1=#2//2", &[]);
        check("M98<//CNC_MEM/A>", "M98<//CNC_MEM/A>", &[]);
        check("IF[#1<5]GOTO 5//UP", "IF[#1<5]GOTO 5", &["UP"]);
        check("(A;B//C%)", "(((((((((", &["A;B//C%"]);
    }
}
