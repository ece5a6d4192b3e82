//! Which step of one run is which of the other, with few links for long runs of them.

/// A step of one run, or a pair of steps, one of each run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepPair {
    Same(usize, usize),
    /// A pair that differs.
    Changed(usize, usize),
    Lost(usize),
    Added(usize),
}

impl StepPair {
    /// Returns the numbers of the steps, old and new.
    pub(super) fn sides(self) -> [Option<usize>; 2] {
        match self {
            Self::Same(i, j) | Self::Changed(i, j) => [Some(i), Some(j)],
            Self::Lost(i) => [Some(i), None],
            Self::Added(j) => [None, Some(j)],
        }
    }

    /// Returns true if one run alone makes the step.
    pub(super) fn is_unpaired(self) -> bool {
        matches!(self, Self::Lost(_) | Self::Added(_))
    }

    pub(super) fn is_same(self) -> bool {
        matches!(self, Self::Same(..))
    }

    /// Returns the link of the same kind of later steps.
    pub(super) fn later(self, old: usize, new: usize) -> Self {
        match self {
            Self::Same(i, j) => Self::Same(i + old, j + new),
            Self::Changed(i, j) => Self::Changed(i + old, j + new),
            Self::Lost(i) => Self::Lost(i + old),
            Self::Added(j) => Self::Added(j + new),
        }
    }
}

/// Links in the order of the steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    runs: Vec<LinkRun>,
    length: usize,
}

/// Links of one kind of consecutive steps.
#[derive(Clone, Copy, Debug)]
struct LinkRun {
    /// Number of links before it.
    start: usize,
    first: StepPair,
    length: usize,
}

impl LinkRun {
    fn get(&self, index: usize) -> StepPair {
        self.first.later(index, index)
    }
}

impl Links {
    /// Appends a link.
    pub(super) fn push(&mut self, link: StepPair) {
        self.push_run(link, 1);
    }

    /// Appends links of one kind of consecutive steps.
    pub(super) fn push_run(&mut self, first: StepPair, length: usize) {
        if length == 0 {
            return;
        }
        match self.runs.last_mut() {
            Some(run) if run.get(run.length) == first => run.length += length,
            _ => self.runs.push(LinkRun { start: self.length, first, length }),
        }
        self.length += length;
    }

    /// Appends the links of later steps.
    pub(super) fn append(&mut self, later: &Self, old: usize, new: usize) {
        later.runs.iter().for_each(|run| self.push_run(run.first.later(old, new), run.length));
    }

    /// Appends a link, if there is one.
    pub(super) fn extend_by(&mut self, link: Option<StepPair>) {
        link.into_iter().for_each(|link| self.push(link));
    }

    pub(super) fn pop(&mut self) {
        if let Some(run) = self.runs.last_mut() {
            run.length -= 1;
            self.length -= 1;
        }
        self.runs.pop_if(|run| run.length == 0);
    }

    /// Returns a link by its number; `None` after the last one.
    pub(super) fn get(&self, number: usize) -> Option<StepPair> {
        let run = &self.runs[self.runs.partition_point(|run| run.start <= number).checked_sub(1)?];
        (number < self.length).then(|| run.get(number - run.start))
    }

    /// Returns the numbers of steps of both runs up to a link, its own included.
    pub(super) fn counts_up_to(&self, number: usize) -> [usize; 2] {
        let last = |side: usize| {
            let mut before = (0..=number).rev().filter_map(|number| self.get(number)?.sides()[side]);
            before.next().map_or(0, |step| step + 1)
        };
        [last(0), last(1)]
    }

    pub(super) fn last(&self) -> Option<StepPair> {
        self.get(self.length.checked_sub(1)?)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = StepPair> {
        self.runs.iter().flat_map(|run| (0..run.length).map(|index| run.get(index)))
    }

    /// Iterates over the links that are not of two equal steps, with their numbers.
    pub(super) fn differences(&self) -> impl Iterator<Item = (usize, StepPair)> {
        let runs = self.runs.iter().filter(|run| !run.first.is_same());
        runs.flat_map(|run| (0..run.length).map(|index| (run.start + index, run.get(index))))
    }

    /// Returns true if all of these pairs of steps are equal steps before the first difference or after the last one.
    pub(super) fn are_beside_differences(&self, pairs: &[(usize, usize)]) -> bool {
        let is_difference = |run: &&LinkRun| !run.first.is_same();
        let first = self.runs.iter().find(is_difference).map_or(self.length, |run| run.start);
        let last = self.runs.iter().rev().find(is_difference).map_or(0, |run| run.start + run.length);
        let behind = self.runs.iter().find(|run| run.start == last);
        let Some(StepPair::Same(from_i, from_j)) = behind.map(|run| run.first) else {
            return pairs.iter().all(|(i, j)| i == j && *i < first);
        };
        let is_behind = |(i, j): &(usize, usize)| from_i <= *i && i - from_i == j.wrapping_sub(from_j);
        pairs.iter().all(|pair| pair.0 == pair.1 && pair.0 < first || is_behind(pair))
    }

    /// Iterates over the links that one run alone has, with their numbers.
    pub(super) fn unpaired(&self) -> impl Iterator<Item = (usize, StepPair)> {
        self.differences().filter(|(_, link)| link.is_unpaired())
    }

    /// Iterates over paired steps: the first of each run of pairs, old and new, and their number.
    pub(super) fn paired_runs(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        self.runs.iter().filter_map(|run| match run.first {
            StepPair::Same(i, j) | StepPair::Changed(i, j) => Some((i, j, run.length)),
            StepPair::Lost(_) | StepPair::Added(_) => None,
        })
    }
}

impl FromIterator<StepPair> for Links {
    fn from_iter<T: IntoIterator<Item = StepPair>>(links: T) -> Self {
        let mut all = Self::default();
        links.into_iter().for_each(|link| all.push(link));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_steps_lie_beside_all_differences_or_among_them() {
        let mut links = Links::default();
        links.push_run(StepPair::Same(0, 0), 2);
        links.push(StepPair::Added(2));
        links.push_run(StepPair::Same(2, 3), 2);
        links.push(StepPair::Changed(4, 5));
        links.push_run(StepPair::Same(5, 6), 3);
        assert!(links.are_beside_differences(&[]));
        assert!(links.are_beside_differences(&[(1, 1), (5, 6), (7, 8)]));
        assert!(!links.are_beside_differences(&[(1, 1), (2, 3)]), "a difference lies on either side");
        assert!(!links.are_beside_differences(&[(4, 5)]), "they differ");
        assert!(!links.are_beside_differences(&[(6, 6)]), "no pair");
        let same: Links = [StepPair::Same(0, 0), StepPair::Same(1, 1)].into_iter().collect();
        assert!(same.are_beside_differences(&[(1, 1)]) && !same.are_beside_differences(&[(0, 1)]));
    }
}
