//! The machine file's `[probe]`.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::machine::Probe;
use gcode_lang::units::Seconds;
use gcode_part::reader::bounds::{Bounded, ProbeDelay, StylusLength};

/// A touch probe.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileProbe {
    /// Radius of the stylus ball, mm; its centre is the tool's tip.
    radius: Bounded<StylusLength>,
    /// Time from the contact until the control latches the position, seconds [default: 0].
    delay: Option<Bounded<ProbeDelay>>,
    /// Time from then until the axes stop, seconds [default: 0].
    overrun: Option<Bounded<ProbeDelay>>,
    /// Largest deflection of the stylus before it breaks, mm [default: unlimited].
    give: Option<Bounded<StylusLength>>,
}

impl FileProbe {
    pub(super) fn probe(&self) -> Probe {
        let seconds = |value: &Option<Bounded<ProbeDelay>>| Seconds(value.as_ref().map_or(0.0, Bounded::get));
        let mut probe = Probe::new(self.radius.get());
        (probe.delay, probe.overrun) = (seconds(&self.delay), seconds(&self.overrun));
        if let Some(give) = &self.give {
            probe.overtravel_limit = give.get();
        }
        probe
    }
}
