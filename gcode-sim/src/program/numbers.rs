//! Blocks of numbers, lowered straight from their text.
use super::lower::Lowering;
use super::words::{Coded, Input, Words, literal};
use super::{Op, OpKind};
use crate::source::{SourceId, Span};
use crate::syntax::{NumberWord, Numbers};

impl Lowering {
    /// The block that begins at `start`; `None` where more stands in it than numbers, or a call: then its tree is lowered.
    pub(super) fn numbers(&mut self, source: SourceId, bytes: &[u8], start: u32) -> Option<Op> {
        let mut numbers = Numbers::new(source, bytes, start)?;
        let number = numbers.sequence_number;
        let mut end = number.map_or(start, |number| number.span.end);
        let mut list = self.spare_words();
        for NumberWord { letter, number, span } in numbers.by_ref() {
            let Some(value) = literal(letter, number).filter(|value| !calls(letter, value)) else {
                self.give_back(list);
                return None;
            };
            list.push(Coded { letter, axis: None, comma: false, value, span });
            end = span.end;
        }
        if !numbers.is_at_end() {
            self.give_back(list);
            return None;
        }
        let kind = if list.is_empty() {
            self.give_back(list);
            OpKind::Empty
        } else {
            OpKind::Words(Words { list, call: None, short: None, punched: None })
        };
        let span = Span { source, start, end };
        Some(Op { span, skip: None, number: number.map(|number| number.node), forms: Box::default(), kind })
    }
}

/// Whether a word may make a call of its block.
fn calls(letter: u8, value: &Input) -> bool {
    match value {
        Input::G(code, _) => matches!(code, 650 | 660 | 661 | 670),
        Input::Literal(number) => letter == b'M' && matches!(number.digits, 97 | 98 | 99 | 198),
        Input::Operand(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;
    use crate::syntax::block_at;

    proptest! {
        #[test]
        fn a_block_of_numbers_is_what_its_tree_is(
            words in vec("[A-Z]|G(1|0?4|54\\.1|65|5\\.55|-1)|M(3|9[7-9]|198)|[XNIFO][-+]?[0-9]{0,4}[.]?[0-9]{0,2}|[ \t\x1a]|[#%(;/n]", 1..8),
            end in proptest::sample::select(vec!["", "\n", "\r\n", " \nX5", "\t\r"]),
        ) {
            let text = format!("{}{end}", words.concat().trim_start_matches([' ', '\t', '\x1a']));
            let mut lowering = Lowering::default();
            if let Some(op) = lowering.numbers(SourceId(0), text.as_bytes(), 0) {
                let shown = format!("{op:?}");
                prop_assume!(op.span.end > 0);
                let tree = block_at(SourceId(0), text.as_bytes(), 0).unwrap();
                prop_assert_eq!(format!("{:?}", lowering.block(&tree, None)), shown, "{:?}", text);
            }
        }
    }

    #[test]
    fn the_common_line_needs_no_tree() {
        let text = b"N10 G1 X1.5 Y-.25 Z+3\r\nG0";
        let op = Lowering::default().numbers(SourceId(0), text, 0).unwrap();
        assert_eq!((op.number, op.span.end), (Some(10), 21));
        assert!(matches!(op.kind, OpKind::Words(words) if words.list.len() == 4));
    }

    #[test]
    fn whatever_else_stands_in_a_block_is_left_to_its_tree() {
        for text in
            ["G1 X#1", "G1 (A)", "g1", "G65 P1", "M98 P1", "M99", "X1 O2", "G5.55", "/G1", "X1.2.", "X 1"]
        {
            assert!(Lowering::default().numbers(SourceId(0), text.as_bytes(), 0).is_none(), "{text}");
        }
    }
}
