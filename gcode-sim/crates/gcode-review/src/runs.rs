//! Lists of values that stay equal for a while, or of numbers that count on: kept as runs.

/// Number of indices between two entries of the index of [`Runs`].
const STRIDE: usize = 256;

/// Values by index, each kept once for consecutive equal ones.
#[derive(Clone, Debug)]
pub(super) struct Runs<T> {
    starts: Vec<u32>,
    values: Vec<T>,
    /// Number of runs that begin up to each index that is a multiple of [`STRIDE`].
    index: Vec<u32>,
    length: usize,
}

impl<T> Default for Runs<T> {
    fn default() -> Self {
        Self { starts: Vec::new(), values: Vec::new(), index: Vec::new(), length: 0 }
    }
}

impl<T: PartialEq> Runs<T> {
    /// Appends a value.
    pub(super) fn push(&mut self, value: T) {
        if self.values.last() != Some(&value) {
            self.starts.push(self.length as u32);
            self.values.push(value);
        }
        if self.length.is_multiple_of(STRIDE) {
            self.index.push(self.starts.len() as u32);
        }
        self.length += 1;
    }

    /// Returns the value at an index.
    pub(super) fn get(&self, index: usize) -> &T {
        // Most lists end with one long run.
        if let (Some(start), Some(value)) = (self.starts.last(), self.values.last())
            && *start as usize <= index
        {
            return value;
        }
        let first = self.index[index / STRIDE] as usize - 1;
        let last = self.index.get(index / STRIDE + 1).map_or(self.starts.len(), |end| *end as usize);
        let behind = self.starts[first..last].partition_point(|start| *start as usize <= index);
        &self.values[first + behind - 1]
    }

    pub(super) fn shrink(&mut self) {
        self.starts.shrink_to_fit();
        self.values.shrink_to_fit();
    }
}

/// Numbers by index; one that is greater by 1 than the one before it, or equal to it, needs no memory.
#[derive(Clone, Debug, Default)]
pub(super) struct CountingRuns(Runs<(bool, i64)>);

impl CountingRuns {
    /// Appends a number.
    pub(super) fn push(&mut self, number: usize) {
        let (index, number) = (self.0.length as i64, number as i64);
        let value = match self.0.values.last() {
            Some((false, last)) if *last == number => (false, number),
            Some((true, offset)) if index + offset == number => (true, *offset),
            // A run begins as one that counts; a number that repeats the first of a run ends it.
            Some((true, offset)) if index - 1 + offset == number => (false, number),
            _ => (true, number - index),
        };
        self.0.push(value);
    }

    /// Returns the number at an index.
    pub(super) fn get(&self, index: usize) -> usize {
        match *self.0.get(index) {
            (true, offset) => (index as i64 + offset) as usize,
            (false, number) => number as usize,
        }
    }

    pub(super) fn shrink(&mut self) {
        self.0.shrink();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn runs_return_what_was_appended(lengths in prop::collection::vec((0_u8..3, 1_usize..300), 0..20)) {
            let all: Vec<u8> = lengths.iter().flat_map(|(value, n)| std::iter::repeat_n(*value, *n)).collect();
            let mut runs = Runs::default();
            all.iter().for_each(|value| runs.push(*value));
            prop_assert!(runs.values.len() <= lengths.len());
            for (index, value) in all.iter().enumerate() {
                prop_assert_eq!(runs.get(index), value);
            }
        }

        #[test]
        fn counting_runs_return_what_was_appended(
            parts in prop::collection::vec((0_usize..1000, 0_usize..2, 1_usize..300), 0..20)
        ) {
            let all = parts.iter().flat_map(|(first, step, n)| (0..*n).map(move |k| first + step * k));
            let all: Vec<usize> = all.collect();
            let mut runs = CountingRuns::default();
            all.iter().for_each(|number| runs.push(*number));
            prop_assert!(runs.0.values.len() <= 3 * parts.len());
            for (index, number) in all.iter().enumerate() {
                prop_assert_eq!(runs.get(index), *number);
            }
        }
    }
}
