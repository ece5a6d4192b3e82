//! The touch probe as data.
use super::error::Distribution;
use gcode_lang::units::Seconds;

/// A touch probe; the tool's tip is the centre of its ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Of the stylus ball, mm.
    pub radius: f64,
    /// From contact until the control notes the position.
    pub delay: Seconds,
    /// From then until the axes stand still, at the commanded feed all the time.
    pub overrun: Seconds,
    /// How far the stylus can be pushed before it breaks, mm.
    pub overtravel_limit: f64,
    /// Error of each touch along its direction, mm.
    pub noise: Distribution,
    pub seed: u64,
}

impl Probe {
    /// A ball that notes its contact at once and exactly.
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
