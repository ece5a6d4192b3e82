//! Gauge blocks: the sets, the stack nearest to a height, and the angle that it sets on a sine table.
mod sets;
mod sine;
mod stack;

pub use sets::{GaugeSet, Series, Thickness};
pub use sine::{SineSetting, height, sine_setting};
pub use stack::Stack;
