//! The letters of a macro call to its locals.
use super::Core;
use super::eval::Checked;
use super::vars::{Locals, VACANT, Value};
use crate::alarm::Alarm;
use crate::program::{Coded, Program};

impl Core {
    /// Letters to locals: specification I, and II for I J K, word by word in the order they stand in. `every` is
    /// G66.1, which takes G, L, N and P as well.
    pub(super) fn arguments(&self, program: &Program, words: &[Coded], every: bool) -> Checked<Locals> {
        let plain_ijk = self.settings.plain_ijk;
        let mut locals = VACANT;
        let mut set = 0;
        let mut last = 0;
        for word in words {
            let local = match word.letter {
                b'I' | b'J' | b'K' if !plain_ijk => {
                    // I J K open the next set unless they follow in the alphabet.
                    if word.letter <= last {
                        set += 1;
                    }
                    last = word.letter;
                    if set == 10 {
                        return Err(Alarm::TooManyArgumentSets.at(word.span));
                    }
                    4 + 3 * set + usize::from(word.letter - b'I')
                }
                letter => match plain_argument(letter) {
                    Some(local) => local,
                    None if every && letter == b'G' => 10,
                    None if every && letter == b'L' => 12,
                    None if every && letter == b'N' => 14,
                    None if every && letter == b'P' => 16,
                    None if matches!(letter, b'L' | b'P') => continue,
                    None => return Err(Alarm::ImproperAddress { letter: char::from(letter) }.at(word.span)),
                },
            };
            if let Some(raw) = self.raw(program, word)? {
                locals[local] = Value::Number(self.argument(raw, word.letter));
            }
        }
        Ok(locals)
    }
}

/// Argument specification I.
fn plain_argument(letter: u8) -> Option<usize> {
    Some(match letter {
        b'A' => 1,
        b'B' => 2,
        b'C' => 3,
        b'D' => 7,
        b'E' => 8,
        b'F' => 9,
        b'H' => 11,
        b'I' => 4,
        b'J' => 5,
        b'K' => 6,
        b'M' => 13,
        b'Q'..=b'Z' => usize::from(letter - b'Q') + 17,
        _ => return None,
    })
}
