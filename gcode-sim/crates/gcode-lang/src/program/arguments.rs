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
                // A reader may go on after the alarm.
                if self.set >= 10 {
                    return Err(Alarm::TooManyArgumentSets);
                }
                Ok(Some(4 + 3 * self.set + usize::from(letter - b'I')))
            }
            b'L' | b'P' if !self.is_every_block => Ok(None),
            b'G' | b'N' if !self.is_every_block => Err(Alarm::ImproperAddress { letter: char::from(letter) }),
            letter => LETTERS
                .iter()
                .position(|other| *other == letter && letter != b'O')
                .map(|index| Some(index + 1))
                .ok_or(Alarm::ImproperAddress { letter: char::from(letter) }),
        }
    }
}

/// Letters of #1 to #26 in argument specification I. G, L, N and P are arguments of G66.1 only, O never.
const LETTERS: &[u8; 26] = b"ABCIJKDEFGHLMNOPQRSTUVWXYZ";

/// Returns the letter that sets a local in argument specification I; `None` if no letter does.
pub fn argument_letter(local: usize) -> Option<char> {
    let letter = LETTERS.get(local.checked_sub(1)?).filter(|letter| !b"GLNOP".contains(letter))?;
    Some(char::from(*letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_letter_has_its_local() {
        assert_eq!(argument_letter(1), Some('A'));
        assert_eq!(argument_letter(18), Some('R'));
        assert_eq!(argument_letter(26), Some('Z'));
        for none in [10, 12, 14, 15, 16, 27, 33] {
            assert_eq!(argument_letter(none), None, "#{none}");
        }
    }

    #[test]
    fn i_j_k_begin_sets() {
        let dealt = |letters: &str| {
            let mut locals = ArgumentLocals::new(false, false);
            letters.bytes().map(|l| locals.next(l).unwrap().unwrap()).collect::<Vec<_>>()
        };
        assert_eq!(dealt("JI"), [5, 7]);
        assert_eq!(dealt("III"), [4, 7, 10]);
        assert_eq!(dealt("ABIID"), [1, 2, 4, 7, 7]);
    }

    #[test]
    fn every_set_after_the_tenth_is_refused() {
        let mut locals = ArgumentLocals::new(false, false);
        let dealt: Vec<_> = (0..13).map(|_| locals.next(b'I').is_ok()).collect();
        assert_eq!(dealt, [[true; 10].as_slice(), &[false; 3]].concat());
    }
}
