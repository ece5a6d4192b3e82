//! Lowering of blocks of numbers directly from their text.
use super::g_codes;
use super::words::{LoweredWord, WordOperand, Words, g_code, is_call};
use super::{Op, OpBody, OpKind};
use crate::source::{SourceId, Span};
use crate::syntax::{NumberWord, NumberWords};

impl Op {
    /// Replaces the operation by the block at `start` and returns true.
    ///
    /// Returns false if the block has anything but numbers, or a call. The content is then undefined, and the
    /// block must be lowered from its tree.
    #[inline]
    pub(super) fn refill(&mut self, source: SourceId, text: &[u8], start: u32) -> bool {
        self.ordinal = 0;
        if !matches!(self.body, OpBody::Plain(OpKind::Words(_))) {
            self.body = OpBody::Plain(OpKind::Words(Words::default()));
        }
        let OpBody::Plain(OpKind::Words(words)) = &mut self.body else { return false };
        let filled = fill(words.cleared_list(), source, text, start);
        let Some((numbers, end)) = filled.filter(|(numbers, _)| numbers.is_at_end()) else { return false };
        if words.list.is_empty() {
            self.body = OpBody::default();
        }
        self.span = Span { source, start, end };
        self.number = numbers.sequence_number;
        true
    }

    /// Replaces the operation as [`Op::refill`] does, also by a block of numbers with one comment behind them. Returns the text
    /// of the comment, which is empty without one.
    pub(super) fn refill_commented<'t>(
        &mut self,
        source: SourceId,
        text: &'t [u8],
        start: u32,
    ) -> Option<&'t [u8]> {
        if self.refill(source, text, start) {
            return Some(&[]);
        }
        let OpBody::Plain(OpKind::Words(words)) = &mut self.body else { return None };
        let (numbers, _) = fill(words.cleared_list(), source, text, start)?;
        let (comment, end) = numbers.comment_at_end().filter(|_| !words.list.is_empty())?;
        self.span = Span { source, start, end };
        self.number = numbers.sequence_number;
        Some(comment)
    }
}

/// Appends the words of the line at `start` to an empty list, up to anything but a word with a number. Returns the iterator
/// behind them, which has the sequence number, and the end of the last word; `None` for a call.
#[inline(always)]
fn fill<'t>(
    list: &mut Vec<LoweredWord>,
    source: SourceId,
    text: &'t [u8],
    start: u32,
) -> Option<(NumberWords<'t>, u32)> {
    let mut numbers = NumberWords::new(source, text, start)?;
    let mut end = numbers.words_start;
    for NumberWord { letter, number, span } in numbers.by_ref() {
        end = span.end;
        let lowered_word = |value| LoweredWord { letter, axis: None, comma: false, value, span };
        match letter {
            b'G' => match g_code(number)? {
                code if is_call(code) => return None,
                code => list.push(lowered_word(WordOperand::G(code, g_codes::find(code)))),
            },
            b'M' if matches!(number.digits, 97 | 98 | 99 | 198) => return None,
            _ => list.push(lowered_word(WordOperand::Literal(number))),
        }
    }
    Some((numbers, end))
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::super::lowering::Lowering;
    use super::*;
    use crate::syntax::block_at;

    /// Returns an operation left over from a different block.
    fn another() -> Op {
        let tree = block_at(SourceId(0), b"/N5 gO04 M30 /2 X1 (0123456789ABCDEF)", 0).unwrap();
        Lowering::default().lower_block(&tree, None)
    }

    /// Text after the line, as in a long file.
    const FOLLOWING: &str = "\nX1.\nG4 (AND SO FORTH) X1.\n";

    proptest! {
        #[test]
        fn a_block_of_numbers_lowers_like_its_tree(
            words in vec("[A-Z]|G(1|0?4|54\\.1|65|5\\.55|-1)|M(3|9[7-9]|198)|[XNIFO][-+]?[0-9]{0,10}[.]?[0-9]{0,10}|[XNY][0-9]{1,3}\\.?[0-9]{1,3} ?|[ \t\x1a]|[#%(;/n]", 1..8),
            end in proptest::sample::select(vec!["", "\n", "\r\n", " \nX5", "\t\r", " (A B)\n", "(C) \r\nX5"]),
            after in proptest::sample::select(vec!["", FOLLOWING]),
        ) {
            let text = format!("{}{end}{after}", words.concat().trim_start_matches([' ', '\t', '\x1a']));
            let mut op = another();
            if let Some(comment) = op.refill_commented(SourceId(0), text.as_bytes(), 0) {
                prop_assume!(op.span.end > 0);
                let tree = block_at(SourceId(0), text.as_bytes(), 0).unwrap();
                let lowered = Lowering::default().lower_block(&tree, None);
                prop_assert_eq!(format!("{op:?}"), format!("{lowered:?}"), "{:?}", text);
                let comments: Vec<_> = tree.comments.iter().map(|comment| comment.text.as_slice()).collect();
                prop_assert!(comments.concat() == comment && comments.len() < 2, "{:?}", text);
            }
        }
    }

    #[test]
    fn a_block_of_numbers_needs_no_tree() {
        let text = format!("N10 G1 X1.5 Y-.25 Z+3\r\nG0{FOLLOWING}");
        let mut op = another();
        assert!(op.refill(SourceId(0), text.as_bytes(), 0));
        assert_eq!((op.number, op.span.end), (Some(10), 21));
        assert!(matches!(op.kind(), OpKind::Words(words) if words.list.len() == 4));
    }

    #[test]
    fn any_other_block_needs_its_tree() {
        for text in
            ["G1 X#1", "G1 (A)", "g1", "G65 P1", "M98 P1", "M99", "X1 O2", "G5.55", "/G1", "X1.2.", "X 1"]
        {
            let text = format!("{text}{FOLLOWING}");
            assert!(!another().refill(SourceId(0), text.as_bytes(), 0), "{text}");
        }
    }
}
