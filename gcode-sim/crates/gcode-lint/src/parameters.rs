//! Blocks of parameter input, between G10 L50 or L52 and G11: N is a parameter number, the words are its
//! values.
use gcode_lang::program::{Op, OpKind, Program, WordOperand, Words};

use super::literal;

/// Returns true for each block of parameter input, without its G10 and G11.
pub(crate) fn parameter_blocks(program: &Program) -> Vec<bool> {
    let mut parameters = false;
    let blocks = program.ops().iter().map(|op| {
        let before = parameters;
        if let OpKind::Words(words) = op.kind() {
            parameters = if parameters { !has_g(words, 110) } else { starts_parameter_input(words) };
        }
        before && parameters
    });
    blocks.collect()
}

/// Returns true if the last block is within parameter input.
pub(crate) fn has_open_parameter_input(program: &Program) -> bool {
    let is_words = |op: &&Op| matches!(op.kind(), OpKind::Words(_));
    let begins_or_ends = |words: &Words| starts_parameter_input(words) || has_g(words, 110);
    let last = program.ops().iter().rev().filter(is_words).find_map(|op| match op.kind() {
        OpKind::Words(words) if begins_or_ends(words) => Some(starts_parameter_input(words)),
        _ => None,
    });
    last == Some(true)
}

/// Returns L of a block with G10, the kind of data input.
pub(crate) fn data_input_kind(words: &Words) -> Option<u32> {
    let l = words.list.iter().find(|word| word.letter == b'L');
    l.filter(|_| has_g(words, 100)).and_then(literal::word_count)
}

fn starts_parameter_input(words: &Words) -> bool {
    matches!(data_input_kind(words), Some(50 | 52))
}

fn has_g(words: &Words, code: u32) -> bool {
    words.list.iter().any(|word| matches!(word.value, WordOperand::G(c, _) if c == code))
}
