//! Lowering of blocks of numbers directly from their text.
use super::g_codes;
use super::words::{LoweredWord, MACRO_CALL, WordOperand, Words, g_code, is_call};
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
        let filled = fill(words.cleared_list(), source, text, start, |_| false);
        let Some((numbers, end)) = filled.filter(|(numbers, _)| numbers.is_at_end()) else { return false };
        if words.list.is_empty() {
            self.body = OpBody::default();
        }
        self.span = Span { source, start, end };
        self.number = numbers.sequence_number;
        true
    }
}

/// Block of numbers as written, with one comment behind them at most.
#[derive(Clone, Copy, Debug)]
pub struct NumberBlock<'a> {
    /// Words in the order written. Those of a macro call are among them: G65, its program and its arguments.
    pub words: &'a [LoweredWord],
    /// Sequence number at the start of the block.
    pub number: Option<u32>,
    /// Text of the comment; empty without one.
    pub comment: &'a [u8],
    /// Span of the block.
    pub span: Span,
}

impl<'a> NumberBlock<'a> {
    /// Reads the block at `start`; `list` takes its words. Returns `None` for any other block, and for a call but G65.
    pub(super) fn read(
        list: &'a mut Vec<LoweredWord>,
        source: SourceId,
        text: &'a [u8],
        start: u32,
    ) -> Option<Self> {
        list.clear();
        let (numbers, words_end) = fill(list, source, text, start, |code| code == MACRO_CALL)?;
        let (comment, end) = match numbers.is_at_end() {
            true => (&text[..0], words_end),
            false => numbers.comment_at_end().filter(|_| !list.is_empty())?,
        };
        Some(Self {
            words: list,
            number: numbers.sequence_number,
            comment,
            span: Span { source, start, end },
        })
    }
}

/// Appends the words of the line at `start` to an empty list, up to anything but a word with a number. Returns the iterator
/// behind them, which has the sequence number, and the end of the last word; `None` for a call that `takes_call` refuses.
#[inline(always)]
fn fill<'t>(
    list: &mut Vec<LoweredWord>,
    source: SourceId,
    text: &'t [u8],
    start: u32,
    takes_call: impl Fn(u32) -> bool,
) -> Option<(NumberWords<'t>, u32)> {
    let mut numbers = NumberWords::new(source, text, start)?;
    let mut end = numbers.words_start;
    for NumberWord { letter, number, span } in numbers.by_ref() {
        end = span.end;
        let lowered_word = |value| LoweredWord { letter, axis: None, comma: false, value, span };
        match letter {
            b'G' => match g_code(number)? {
                code if is_call(code) && !takes_call(code) => return None,
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

    use super::super::CallTarget;
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
            let mut list = Vec::new();
            if let Some(block) = NumberBlock::read(&mut list, SourceId(0), text.as_bytes(), 0) {
                prop_assume!(block.span.end > 0);
                let tree = block_at(SourceId(0), text.as_bytes(), 0).unwrap();
                let lowered = Lowering::default().lower_block(&tree, None);
                prop_assert_eq!((block.number, block.span), (lowered.number, lowered.span), "{:?}", text);
                let comments: Vec<_> = tree.comments.iter().map(|comment| comment.text.as_slice()).collect();
                prop_assert!(comments.concat() == block.comment && comments.len() < 2, "{:?}", text);
                let words = match lowered.kind() {
                    OpKind::Words(words) => in_order(words),
                    OpKind::Empty => Vec::new(),
                    // G65 with words that it doesn't take.
                    _ => return Ok(()),
                };
                prop_assert_eq!(format!("{:?}", block.words), format!("{words:?}"), "{:?}", text);
            }
            let mut op = another();
            if op.refill(SourceId(0), text.as_bytes(), 0) {
                prop_assume!(op.span.end > 0);
                let tree = block_at(SourceId(0), text.as_bytes(), 0).unwrap();
                let lowered = Lowering::default().lower_block(&tree, None);
                prop_assert_eq!(format!("{op:?}"), format!("{lowered:?}"), "{:?}", text);
            }
        }
    }

    /// Returns the words of a block in the order written, those of its call among them.
    fn in_order(words: &Words) -> Vec<LoweredWord> {
        let mut all = words.list.clone();
        if let Some(call) = words.call() {
            let code = WordOperand::G(MACRO_CALL, g_codes::find(MACRO_CALL));
            all.push(LoweredWord { letter: b'G', axis: None, comma: false, value: code, span: call.span });
            all.extend(&call.arguments);
            all.extend(call.repeats);
            if let CallTarget::Number(program) = &call.target {
                all.push(*program);
            }
        }
        all.sort_by_key(|word| word.span.start);
        all
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
