//! Probing moves: the signal of a probe, and moves that go on through metal.
use nalgebra::Point3;

use super::{HoleExtractor, MotionKind};
use gcode_lang::motion::{Event, SkipMove, SkipSignal};

impl HoleExtractor<'_> {
    /// Returns the probe's signal; `None` without a probe, or without a part that it could touch.
    pub(super) fn signal_of_probe(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        let (probe, surface) = (self.machine.probe.as_ref()?, self.surface.as_ref()?);
        let signal = self.machine.probe(probe, feed, &self.setup, surface, self.probe_count);
        self.probe_count += 1;
        Some(signal)
    }

    /// Returns the kind of a probing move: a feed if a tool of some kind goes through metal, since tools of all kinds cut. Other ones
    /// through metal are counted.
    pub(super) fn kind_of_probing(&mut self, event: &Event<'_>, from: &Point3<f64>) -> MotionKind {
        let is_cutter = self.machine.kind_of(self.setup.tool).is_some();
        match self.metal.uncut(&[*from, self.pose.tip]) {
            Some(_) if is_cutter => MotionKind::Feed,
            Some(_) => {
                self.probes_in_metal.count(|| event.backtrace());
                MotionKind::Probe
            }
            None => MotionKind::Probe,
        }
    }
}
