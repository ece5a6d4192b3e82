//! Local variables of a macro call's letters: argument specification I, and II for I J K.
use crate::alarm::Alarm;

/// Assigns local variables to the letters of one call, in the order written.
#[derive(Debug)]
pub struct ArgumentLocals {
    /// IJK 6008#7: I J K are always specification I.
    plain_ijk: bool,
    /// G66.1, call in every block: G, L, N and P are arguments too.
    is_every_block: bool,
    set: usize,
    last: u8,
}

impl ArgumentLocals {
    /// Starts with the first argument of a call.
    pub fn new(plain_ijk: bool, is_every_block: bool) -> Self {
        Self { plain_ijk, is_every_block, set: 0, last: 0 }
    }

    /// Returns the local that the next letter sets; `None` for L and P, which set none.
    pub fn next(&mut self, letter: u8) -> Result<Option<usize>, Alarm> {
        match letter {
            b'I' | b'J' | b'K' if !self.plain_ijk => {
                // I J K begin the next set unless they are in alphabetical order.
                if letter <= self.last {
                    self.set += 1;
                }
                self.last = letter;
                if self.set == 10 {
                    return Err(Alarm::TooManyArgumentSets);
                }
                Ok(Some(4 + 3 * self.set + usize::from(letter - b'I')))
            }
            b'G' if self.is_every_block => Ok(Some(10)),
            b'L' if self.is_every_block => Ok(Some(12)),
            b'N' if self.is_every_block => Ok(Some(14)),
            b'P' if self.is_every_block => Ok(Some(16)),
            b'L' | b'P' => Ok(None),
            letter => {
                let local = plain_argument(letter);
                local.map(Some).ok_or(Alarm::ImproperAddress { letter: char::from(letter) })
            }
        }
    }
}

/// Returns the local of a letter in argument specification I.
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

/// Returns the letter that sets a local in argument specification I; `None` if no letter does.
pub fn argument_letter(local: usize) -> Option<char> {
    (b'A'..=b'Z').find(|letter| plain_argument(*letter) == Some(local)).map(char::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_and_locals_belong_together() {
        assert_eq!(argument_letter(1), Some('A'));
        assert_eq!(argument_letter(18), Some('R'));
        assert_eq!(argument_letter(26), Some('Z'));
        for none in [10, 12, 14, 15, 16, 27, 33] {
            assert_eq!(argument_letter(none), None, "#{none}");
        }
    }

    #[test]
    fn i_j_k_open_sets() {
        let dealt = |letters: &str| {
            let mut locals = ArgumentLocals::new(false, false);
            letters.bytes().map(|l| locals.next(l).unwrap().unwrap()).collect::<Vec<_>>()
        };
        assert_eq!(dealt("JI"), [5, 7]);
        assert_eq!(dealt("III"), [4, 7, 10]);
        assert_eq!(dealt("ABIID"), [1, 2, 4, 7, 7]);
    }
}
