//! Gauge blocks: sets as data, the stack with the fewest blocks nearest to a height, and what it makes of a sine table's angle.
mod sets;
mod sine;
mod stack;

pub use sets::{GaugeSet, Series, Thickness};
pub use sine::{SineSetting, height, sine_setting};
pub use stack::Stack;
