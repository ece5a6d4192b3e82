//! The touch probe.
use super::error::Distribution;
use gcode_lang::units::Seconds;

/// A touch probe; the tool's tip is the centre of its ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Radius of the stylus ball, mm.
    pub radius: f64,
    /// Time from contact until the control latches the position.
    pub delay: Seconds,
    /// Time from then until the axes stop, at the commanded feed throughout.
    pub overrun: Seconds,
    /// Largest deflection of the stylus before it breaks, mm.
    pub overtravel_limit: f64,
    /// Error of each touch along its direction, mm.
    pub noise: Distribution,
    /// Seed of the random errors.
    pub seed: u64,
}

impl Probe {
    /// Returns a probe whose contact is latched at once and exactly.
    pub fn new(radius: f64) -> Self {
        let (delay, overrun) = (Seconds::ZERO, Seconds::ZERO);
        Self {
            radius,
            delay,
            overrun,
            overtravel_limit: f64::INFINITY,
            noise: Distribution::Fixed(0.0),
            seed: 0,
        }
    }
}
