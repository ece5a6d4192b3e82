//! Numbers of the kinds of steps in little memory: in pieces, each in the smallest form.

/// Number of steps of a piece.
const PIECE: usize = 256;

/// Numbers by index.
#[derive(Clone, Debug, Default)]
pub(super) struct KindNumbers {
    pieces: Vec<NumberPiece>,
    /// Numbers of the last piece, up to [`PIECE`].
    open: Vec<u32>,
}

#[derive(Clone, Debug)]
enum NumberPiece {
    /// All are equal.
    Constant(u32),
    Short(Box<[u16]>),
    Long(Box<[u32]>),
}

impl NumberPiece {
    fn of(numbers: &[u32]) -> Self {
        let first = numbers.first().copied().unwrap_or_default();
        if numbers.iter().all(|number| *number == first) {
            return Self::Constant(first);
        }
        match numbers.iter().map(|number| u16::try_from(*number)).collect() {
            Ok(short) => Self::Short(short),
            Err(_) => Self::Long(numbers.into()),
        }
    }
}

impl KindNumbers {
    /// Appends a number.
    pub(super) fn push(&mut self, number: u32) {
        self.open.push(number);
        if self.open.len() == PIECE {
            self.pieces.push(NumberPiece::of(&self.open));
            self.open.clear();
        }
    }

    /// Returns the number at an index.
    pub(super) fn get(&self, index: usize) -> u32 {
        match self.pieces.get(index / PIECE) {
            Some(NumberPiece::Constant(number)) => *number,
            Some(NumberPiece::Short(numbers)) => u32::from(numbers[index % PIECE]),
            Some(NumberPiece::Long(numbers)) => numbers[index % PIECE],
            None => self.open[index % PIECE],
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_are_those_appended(
            parts in prop::collection::vec((0_u32..70_000, 0_u32..2, 1_usize..400), 0..10)
        ) {
            let all = parts.iter().flat_map(|(first, step, n)| (0..*n as u32).map(move |k| first + step * k));
            let all: Vec<u32> = all.collect();
            let mut numbers = KindNumbers::default();
            all.iter().for_each(|number| numbers.push(*number));
            for (index, number) in all.iter().enumerate() {
                prop_assert_eq!(numbers.get(index), *number);
            }
        }
    }
}
