//! The time that a program can read: what its motion takes, and what it waits for the clock.
use std::cell::Cell;

/// The clocks of a run, #3001, #3002 and #3012; they start with it.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    /// Seconds that the motion has taken.
    pub(super) motion_seconds: f64,
    /// Seconds that passed while the program did nothing but read a clock.
    pub(super) idle_seconds: f64,
    /// What #3001 and #3002 have been set off by: milliseconds, hours.
    pub(super) offsets: (f64, f64),
    /// The program has read a clock, or asked for a skip signal, since the last jump back.
    pub(super) has_been_read: Cell<bool>,
}

impl Clock {
    /// Whether two clocks that are read from here on differ by the motion alone.
    pub(super) fn continues_like(&self, other: &Self) -> bool {
        let Self { motion_seconds: _, idle_seconds, offsets, has_been_read: _ } = self;
        (*idle_seconds, *offsets) == (other.idle_seconds, other.offsets)
    }

    /// #3002: hours.
    pub(super) fn hours(&self) -> f64 {
        self.offsets.1 + self.seconds() / 3600.0
    }

    /// Sets #3001.
    pub(super) fn set_milliseconds(&mut self, value: f64) {
        self.offsets.0 = value - (self.motion_seconds + self.idle_seconds) * 1000.0;
    }

    /// Sets #3002.
    pub(super) fn set_hours(&mut self, value: f64) {
        self.offsets.1 = value - (self.motion_seconds + self.idle_seconds) / 3600.0;
    }
}

impl Clock {
    /// Seconds since the start, as the clocks read them.
    pub(super) fn seconds(&self) -> f64 {
        self.has_been_read.set(true);
        self.motion_seconds + self.idle_seconds
    }

    /// #3001: milliseconds; wraps as the control's does.
    pub(super) fn milliseconds(&self) -> f64 {
        (self.seconds() * 1000.0 + self.offsets.0 + 1e-6).trunc().rem_euclid(2_147_483_648.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_runs_with_the_motion_and_can_be_set() {
        let mut clock = Clock { motion_seconds: 1.5, ..Clock::default() };
        assert_eq!(clock.milliseconds(), 1500.0);
        assert!(clock.has_been_read.get());
        clock.set_milliseconds(100.0);
        clock.motion_seconds += 0.25;
        assert_eq!(clock.milliseconds(), 350.0);
        clock.set_hours(2.0);
        clock.motion_seconds += 1800.0;
        assert!((clock.hours() - 2.5).abs() < 1e-9);
    }

    #[test]
    fn motion_makes_no_other_program_but_a_setting_does() {
        let clock = Clock::default();
        assert!(clock.continues_like(&Clock { motion_seconds: 5.0, ..Clock::default() }));
        assert!(!clock.continues_like(&Clock { idle_seconds: 5.0, ..Clock::default() }));
        assert!(!clock.continues_like(&Clock { offsets: (0.0, 1.0), ..Clock::default() }));
    }
}
