//! Checkpoints of a run at growing distances: close together near the present, far apart near the start.
use gcode_control::Checkpoint;

/// Work between two checkpoints near the present: blocks and moves.
pub(super) const SHORTEST_GAP: u64 = 2_000;

/// A gap may be this fraction of its distance from the present.
const GAP_FRACTION: u64 = 8;

/// A checkpoint with its place in the run.
#[derive(Debug)]
pub(super) struct PlacedCheckpoint {
    /// Number of blocks executed before it.
    pub(super) position: u64,
    /// Blocks and moves before it.
    work: u64,
    /// Number of recorded changes that it contains.
    pub(super) changes: usize,
    /// The block before it has led into a called program.
    pub(super) has_entered: bool,
    pub(super) state: Checkpoint,
}

impl PlacedCheckpoint {
    pub(super) fn new(
        (position, work): (u64, u64),
        changes: usize,
        has_entered: bool,
        state: Checkpoint,
    ) -> Self {
        Self { position, work, changes, has_entered, state }
    }
}

/// Checkpoints in the order of the run; the first is its start.
#[derive(Debug)]
pub(super) struct Checkpoints {
    list: Vec<PlacedCheckpoint>,
    shortest_gap: u64,
}

impl Checkpoints {
    pub(super) fn new(start: PlacedCheckpoint, shortest_gap: u64) -> Self {
        Self { list: vec![start], shortest_gap }
    }

    /// Returns true if a run that has done so much work needs another checkpoint.
    #[inline]
    pub(super) fn is_due(&self, work: u64) -> bool {
        self.list.last().is_none_or(|last| work >= last.work + self.shortest_gap)
    }

    /// Adds the newest checkpoint and removes those that are too close together for their distance from it.
    pub(super) fn add(&mut self, checkpoint: PlacedCheckpoint) {
        let now = checkpoint.work;
        self.list.push(checkpoint);
        let mut kept = self.list.len() - 1;
        for index in (1..self.list.len() - 1).rev() {
            let gap = self.list[kept].work - self.list[index - 1].work;
            let longest = ((now - self.list[kept].work) / GAP_FRACTION).max(self.shortest_gap);
            if gap <= longest {
                self.list.remove(index);
                kept -= 1;
            } else {
                kept = index;
            }
        }
    }

    /// Returns the position of the last checkpoint before a position, or of the start.
    pub(super) fn position_before(&self, position: u64) -> u64 {
        let before = self.list.partition_point(|one| one.position < position);
        self.list[before.saturating_sub(1)].position
    }

    /// Removes the checkpoints behind a position and returns the last one that remains.
    pub(super) fn rewind(&mut self, position: u64) -> &PlacedCheckpoint {
        let remaining = self.list.partition_point(|one| one.position <= position).max(1);
        self.list.truncate(remaining);
        &self.list[remaining - 1]
    }

    /// Returns the number of checkpoints.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.list.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_control::Control;
    use gcode_lang::control::Settings;
    use gcode_lang::program::Memory;

    fn placed(work: u64) -> PlacedCheckpoint {
        let control = Control::new(Memory::default(), Settings::default());
        PlacedCheckpoint::new((work, work), 0, false, control.checkpoint())
    }

    #[test]
    fn gaps_grow_with_their_distance_and_their_number_stays_small() {
        let mut checkpoints = Checkpoints::new(placed(0), SHORTEST_GAP);
        let end = 1_000_000;
        for work in 1..=end {
            if checkpoints.is_due(work) {
                checkpoints.add(placed(work));
            }
        }
        let works: Vec<u64> = checkpoints.list.iter().map(|one| one.work).collect();
        assert_eq!(works[0], 0, "the start stays");
        for pair in works.windows(2) {
            let longest = ((end - pair[1]) / GAP_FRACTION).max(SHORTEST_GAP) + SHORTEST_GAP;
            assert!(pair[1] - pair[0] <= longest, "{pair:?}");
        }
        // Eight near the present, then some twelve for each doubling of the distance from 16,000 to a million.
        assert!((20..100).contains(&checkpoints.count()), "{}", checkpoints.count());
        assert!(end - works[works.len() - 1] < SHORTEST_GAP);
    }

    #[test]
    fn a_rewind_removes_what_lies_ahead_and_keeps_the_start() {
        let mut checkpoints = Checkpoints::new(placed(0), SHORTEST_GAP);
        [2_000, 4_000, 6_000].into_iter().for_each(|work| checkpoints.add(placed(work)));
        assert_eq!(checkpoints.position_before(4_000), 2_000);
        assert_eq!(checkpoints.rewind(4_000).position, 4_000);
        assert_eq!(checkpoints.count(), 3);
        assert_eq!(checkpoints.rewind(3_999).position, 2_000);
        assert_eq!(checkpoints.position_before(0), 0);
        assert_eq!(checkpoints.rewind(0).position, 0);
    }
}
