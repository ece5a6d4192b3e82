//! Time and progress of the work, seen from outside.
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// What has kept a proof from its first box.
pub(crate) const NO_TIME: &str =
    "reading the program has taken all the time: prove its macro from a file of its own, or give more --time";

/// Clock, limit and progress of a proof.
pub struct Watch<'a> {
    clock: &'a (dyn Fn() -> Duration + Sync),
    limit: Duration,
    /// Part of the limit at which the present work ends, in thousandths.
    part: AtomicU64,
    stop: AtomicBool,
    boxes: AtomicU64,
    runs: AtomicU64,
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch")
            .field("limit", &self.limit)
            .field("boxes", &self.boxes)
            .finish_non_exhaustive()
    }
}

impl<'a> Watch<'a> {
    /// Returns the watch of work that ends when the clock, which counts from its start, reaches a limit.
    pub fn new(clock: &'a (dyn Fn() -> Duration + Sync), limit: Duration) -> Self {
        Self {
            clock,
            limit,
            part: AtomicU64::new(1000),
            stop: AtomicBool::new(false),
            boxes: AtomicU64::new(0),
            runs: AtomicU64::new(0),
        }
    }

    /// Ends the work; what is decided so far stays.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Returns the number of boxes examined so far.
    pub fn boxes(&self) -> u64 {
        self.boxes.load(Ordering::Relaxed)
    }

    /// Returns the number of single runs so far.
    pub fn runs(&self) -> u64 {
        self.runs.load(Ordering::Relaxed)
    }

    /// Returns the time since the start.
    pub fn elapsed(&self) -> Duration {
        (self.clock)()
    }

    /// Returns true if the work is to end.
    pub(crate) fn is_over(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.part() * 1000.0 >= self.part.load(Ordering::Relaxed) as f64
    }

    /// Returns true if the time was over before a box was examined.
    pub(crate) fn ended_before_a_box(&self) -> bool {
        self.boxes() == 0 && self.is_over()
    }

    /// Lets the present work end after this part of the time, in thousandths.
    pub(crate) fn allow(&self, thousandths: u64) {
        self.part.store(thousandths, Ordering::Relaxed);
    }

    /// Returns the part of the time that has passed.
    pub(crate) fn part(&self) -> f64 {
        self.elapsed().as_secs_f64() / self.limit.as_secs_f64().max(1e-9)
    }

    pub(crate) fn count_box(&self) {
        self.boxes.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn count_run(&self) {
        self.runs.fetch_add(1, Ordering::Relaxed);
    }
}
