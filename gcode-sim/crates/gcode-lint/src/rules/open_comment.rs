//! Rule: a comment that is not closed. The rest of its line is comment too, and some controls refuse the
//! line.
use gcode_lang::syntax::ast::CommentMark;

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("open-comment", Severity::Warning, "a comment that is not closed", find);

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, block) in unit.blocks.iter().enumerate() {
        for comment in block.comments.iter().filter(|comment| comment.mark == CommentMark::Unclosed) {
            let message = "the comment is not closed: it extends to the end of the line";
            let help = "close it with ): some controls refuse the line";
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
    fn the_rest_of_the_line_is_comment() {
        assert_eq!(lines(&RULE, "O1\nG0 X1. (OUT G1 Z-5.\nG0 X2. (BACK)\n(END\nM30\n"), [2, 4]);
    }
}
