//! Full turns of a milling run, and the wall that edges of some length cut all round.

/// Full turns of a run: what edges of some length cut all round.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sweep {
    /// Height of the lowest point of the highest full turn.
    pub(super) top: f64,
    /// Largest change of height in a turn, mm.
    pub(super) step: f64,
}

impl Sweep {
    /// No full turn.
    pub(super) const NONE: Self = Self { top: f64::NEG_INFINITY, step: 0.0 };

    pub(super) fn add(&mut self, lowest: f64, step: f64) {
        *self = Self { top: self.top.max(lowest), step: self.step.max(step) };
    }
}
