//! The box of the inputs.
use crate::interval::Interval;

/// A box: a range for every input.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    ranges: Vec<Interval>,
}

impl Domain {
    /// Returns the box of these ranges; that of input *i* is the *i*-th.
    pub fn new(ranges: Vec<Interval>) -> Self {
        Self { ranges }
    }

    /// Returns the ranges.
    pub fn ranges(&self) -> &[Interval] {
        &self.ranges
    }

    /// Returns the range of an input.
    pub fn range(&self, input: usize) -> Interval {
        self.ranges[input]
    }

    /// Returns the box with another range of one input.
    pub fn with(&self, input: usize, range: Interval) -> Self {
        let mut ranges = self.ranges.clone();
        ranges[input] = range;
        Self { ranges }
    }

    /// Returns two boxes that together have every double of this one, divided at an input's midpoint.
    ///
    /// No double lies in both. `None` if the input has one double only.
    pub fn split(&self, input: usize) -> Option<[Self; 2]> {
        let range = self.range(input);
        let middle = range.midpoint();
        let middle = if middle < range.hi() { middle } else { range.lo() };
        let parts = [Interval::new(range.lo(), middle), Interval::new(middle.next_up(), range.hi())];
        (range.lo() < range.hi()).then(|| parts.map(|part| self.with(input, part)))
    }

    /// Returns the middle of the box.
    pub fn midpoint(&self) -> Vec<f64> {
        self.ranges.iter().map(|range| range.midpoint()).collect()
    }
}
