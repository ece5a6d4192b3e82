//! Whether a probe's ball touches the part while the control waits for its signal.
use super::HoleExtractor;
use gcode_lang::motion::{SkipMove, SkipSignal};

impl HoleExtractor<'_> {
    /// `None` where there is no probe, or no part that it could touch.
    pub(super) fn probe(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        let (probe, surface) = (self.machine.probe.as_ref()?, self.surface.as_ref()?);
        let signal = self.machine.probe(probe, feed, &self.setup, surface, self.probe_count);
        self.probe_count += 1;
        Some(signal)
    }
}
