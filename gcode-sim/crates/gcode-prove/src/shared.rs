//! State of a proof that its threads share: the boxes that are left, and the claims that are refuted.
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use gcode_enclosure::{Domain, Ranked};

use crate::region::ClaimSet;

/// Box that is to be examined.
#[derive(Debug)]
pub(crate) struct Pending {
    pub(crate) domain: Domain,
    /// Claims that aren't decided there.
    pub(crate) claims: ClaimSet,
    /// Part of the whole volume.
    pub(crate) volume: f64,
    /// Order: the largest first.
    pub(crate) size: f64,
}

/// Shared state.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    all_claims: ClaimSet,
    refuted: AtomicU64,
    is_included: AtomicBool,
    has_end: AtomicBool,
    read_inputs: AtomicU64,
    queue: Mutex<Queue>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Queue {
    boxes: BinaryHeap<Ranked<Pending>>,
    /// Boxes that no division decides.
    parked: Vec<Pending>,
    in_work: usize,
    /// Counterexamples by claim.
    counterexamples: Vec<(usize, Vec<f64>)>,
    /// What isn't followed somewhere.
    unfollowed: Vec<String>,
    disagreement: Option<Vec<f64>>,
}

/// Largest number of reasons that are kept.
const MAX_REASONS: usize = 8;

/// Largest number of boxes in the queue.
const MAX_BOXES: usize = 1_000_000;

impl Shared {
    pub(crate) fn new(all_claims: ClaimSet) -> Self {
        Self { all_claims, ..Self::default() }
    }

    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the claims that aren't refuted.
    pub(crate) fn open_claims(&self) -> ClaimSet {
        self.all_claims & !self.refuted.load(Ordering::Relaxed)
    }

    /// Records claims that fail at a point, which the control has run.
    pub(crate) fn refute(&self, failed: ClaimSet, point: &[f64]) {
        let new = failed & self.all_claims & !self.refuted.fetch_or(failed, Ordering::Relaxed);
        let mut queue = self.queue();
        for claim in (0..64).filter(|claim| new >> claim & 1 == 1) {
            queue.counterexamples.push((claim, point.to_vec()));
        }
        drop(queue);
        self.changed.notify_all();
    }

    /// Records a point at which the control and the tree disagree: nothing is proved then.
    pub(crate) fn disagree(&self, point: &[f64]) {
        self.queue().disagreement.get_or_insert_with(|| point.to_vec());
    }

    /// Records the inputs that some way reads, as bits.
    pub(crate) fn note_read(&self, inputs: u64) {
        self.read_inputs.fetch_or(inputs, Ordering::Relaxed);
    }

    pub(crate) fn note_unfollowed(&self, what: &str) {
        let mut queue = self.queue();
        if queue.unfollowed.len() < MAX_REASONS && !queue.unfollowed.iter().any(|known| known == what) {
            queue.unfollowed.push(what.to_owned());
        }
    }

    /// Records that the conditions of the request include some values, and that a run with some of them ends.
    pub(crate) fn include(&self, has_end: bool) {
        self.is_included.store(true, Ordering::Relaxed);
        if has_end {
            self.has_end.store(true, Ordering::Relaxed);
        }
    }

    pub(crate) fn push(&self, boxes: impl IntoIterator<Item = Pending>) {
        let mut queue = self.queue();
        for pending in boxes {
            if queue.boxes.len() < MAX_BOXES {
                queue.boxes.push(Ranked { rank: pending.size, item: pending });
            } else {
                queue.parked.push(pending);
            }
        }
        drop(queue);
        self.changed.notify_all();
    }

    /// Keeps a box that no division decides.
    pub(crate) fn park(&self, pending: Pending) {
        self.queue().parked.push(pending);
    }

    /// Takes the largest box; `None` if the work is done or `is_over`.
    pub(crate) fn take(&self, is_over: impl Fn() -> bool) -> Option<Pending> {
        let mut queue = self.queue();
        loop {
            if is_over() || self.open_claims() == 0 {
                return None;
            }
            if let Some(Ranked { item: pending, .. }) = queue.boxes.pop() {
                queue.in_work += 1;
                return Some(pending);
            }
            if queue.in_work == 0 {
                return None;
            }
            let waited = self.changed.wait_timeout(queue, Duration::from_millis(5));
            queue = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Ends the work on a box that was taken.
    pub(crate) fn finish(&self) {
        self.queue().in_work -= 1;
        self.changed.notify_all();
    }

    /// Returns what is left.
    pub(crate) fn into_rest(self) -> Rest {
        let open = self.open_claims();
        let queue = self.queue.into_inner().unwrap_or_else(PoisonError::into_inner);
        let boxes = queue.boxes.into_iter().map(|ranked| ranked.item);
        let left = boxes.chain(queue.parked).filter(|pending| pending.claims & open != 0);
        let (mut undecided, mut share, mut boxes) = (0, 0.0, 0);
        for pending in left {
            undecided |= pending.claims & open;
            share += pending.volume;
            boxes += 1;
        }
        Rest {
            undecided,
            refuted: self.refuted.into_inner(),
            share: f64::min(share, 1.0),
            boxes_left: boxes,
            counterexamples: queue.counterexamples,
            unfollowed: queue.unfollowed,
            disagreement: queue.disagreement,
            is_included: self.is_included.into_inner(),
            has_end: self.has_end.into_inner(),
            read_inputs: self.read_inputs.into_inner(),
        }
    }
}

/// Result of the threads' work.
#[derive(Debug)]
pub(crate) struct Rest {
    pub(crate) undecided: ClaimSet,
    pub(crate) refuted: ClaimSet,
    /// Part of the volume in which a claim isn't decided.
    pub(crate) share: f64,
    pub(crate) boxes_left: usize,
    pub(crate) counterexamples: Vec<(usize, Vec<f64>)>,
    pub(crate) unfollowed: Vec<String>,
    pub(crate) disagreement: Option<Vec<f64>>,
    pub(crate) is_included: bool,
    pub(crate) has_end: bool,
    /// Inputs that some way reads, as bits.
    pub(crate) read_inputs: u64,
}
