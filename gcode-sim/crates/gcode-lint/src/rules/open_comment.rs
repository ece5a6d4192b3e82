//! Rule: a comment that is not closed, whose line is comment to its end, or one that a control ends before its last
//! bracket.
use gcode_lang::syntax::ast::CommentMark;

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("open-comment", Severity::Warning, "a comment that is not closed, or closed twice", find);

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, block) in unit.blocks.iter().enumerate() {
        for comment in block.comments.iter().filter(|comment| comment.mark == CommentMark::Unclosed) {
            let message = "the comment is not closed: it extends to the end of the line";
            let help = "close it with ): some controls refuse the line";
            found.push(unit.finding(&RULE.kind, index, message).with_span(comment.span).help(help));
        }
        for comment in &block.comments {
            let Some(words) = comment.word_behind_inner() else { continue };
            let words = String::from_utf8_lossy(words);
            let message = format!("a control ends the comment at its first ) and reads `{words}`");
            let help = "take the inner brackets out";
            found.push(unit.finding(&RULE.kind, index, message).with_span(comment.span).help(help));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::lines;
    use super::RULE;

    #[test]
    fn an_unclosed_comment_is_reported() {
        assert_eq!(
            lines(&RULE, "O1\nG0 X1. (HOLE (1) X5.)\nG0 (RING (ID) REQUIRED)\n(M69 (PROBE M65))\nM30\n"),
            [2]
        );
        assert_eq!(lines(&RULE, "O1\nG0 X1. (OUT G1 Z-5.\nG0 X2. (BACK)\n(END\nM30\n"), [2, 4]);
    }
}
