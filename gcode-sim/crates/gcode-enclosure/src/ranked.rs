//! Items of a queue that gives the highest rank first.
use std::cmp::Ordering;

/// Item with its rank, by which alone it is compared: in a [`BinaryHeap`](std::collections::BinaryHeap) the highest rank comes
/// first.
#[derive(Clone, Debug)]
pub struct Ranked<T> {
    /// Its rank.
    pub rank: f64,
    /// The item.
    pub item: T,
}

impl<T> PartialEq for Ranked<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T> Eq for Ranked<T> {}

impl<T> PartialOrd for Ranked<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Ranked<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank.total_cmp(&other.rank)
    }
}
