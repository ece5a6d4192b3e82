//! Whether a probe's ball touches the part while the control waits for its signal.
use super::Extractor;
use crate::motion::{Signal, SkipFeed};

impl Extractor<'_> {
    /// `None` where there is no probe, or no part that it could touch.
    pub(super) fn probe(&mut self, feed: &SkipFeed<'_>) -> Option<Signal> {
        let (probe, surface) = (self.machine.probe.as_ref()?, self.surface.as_ref()?);
        let signal = self.machine.probe(probe, feed, &self.setup, surface, self.touches);
        self.touches += 1;
        Some(signal)
    }
}
