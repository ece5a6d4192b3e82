//! What is in force while a tool cuts: its direction of rotation, S, F and length offset, which the verdict holds against
//! what the reference says of the tool.
use super::per_block::PerBlock;
use gcode_lang::motion::{Backtrace, LengthCompensation, SpindleDirection};
use gcode_lang::units::{MmPerMin, Rpm};

/// How much strokes cut beyond the ones before them, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PeckExtent {
    /// So many strokes cut.
    pub strokes: u32,
    /// The most that one of them was fed beyond the others, air included.
    pub max_fed: f64,
    /// The most that one of them cut of the part.
    pub max_cut: f64,
}

/// How a block feeds a tool into the part.
#[derive(Clone, Debug)]
pub struct CutConditions {
    pub backtrace: Backtrace,
    pub tool: Option<u32>,
    pub compensation: LengthCompensation,
    pub spindle_direction: SpindleDirection,
    pub speed: Rpm,
    /// The slowest and the fastest of the feeds.
    pub feed_range: [MmPerMin; 2],
    /// The most that was cut without a way back, mm.
    pub max_cut: f64,
    /// Of cuts in several strokes the least by which one went on, each taken by its longest, mm.
    pub min_peck: Option<f64>,
    /// How many cuts were made so at that block.
    pub count: u64,
}

/// What the program has said so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CuttingState {
    pub tool: Option<u32>,
    pub compensation: LengthCompensation,
    pub spindle_direction: SpindleDirection,
    pub speed: Rpm,
}

/// One for each block and what was in force there, in the order in which they came up.
#[derive(Debug, Default)]
pub(super) struct CutConditionsByBlock(PerBlock<[u64; 6], CutConditions>);

impl CutConditionsByBlock {
    pub(super) fn add(
        &mut self,
        place: &Backtrace,
        state: &CuttingState,
        feeds: [MmPerMin; 2],
        pecks: PeckExtent,
    ) {
        let CuttingState { tool, compensation: by, spindle_direction: turning, speed } = *state;
        let length = match by {
            LengthCompensation::Off => 0,
            LengthCompensation::Plus(h) => 1 << 32 | u64::from(h),
            LengthCompensation::Minus(h) => 2 << 32 | u64::from(h),
        };
        let tool_key = tool.map_or(u64::MAX, u64::from);
        let [least, most] = feeds.map(|feed| feed.0.to_bits());
        let kind = [tool_key, length, turning as u64, speed.0.to_bits(), least, most];
        let (_, entry) = self.0.count(place.block, kind, || CutConditions {
            backtrace: place.clone(),
            tool,
            compensation: by,
            spindle_direction: turning,
            speed,
            feed_range: feeds,
            max_cut: 0.0,
            min_peck: None,
            count: 0,
        });
        let cutting = &mut entry.value;
        cutting.max_cut = cutting.max_cut.max(pecks.max_cut);
        if 1 < pecks.strokes {
            cutting.min_peck = Some(cutting.min_peck.map_or(pecks.max_fed, |least| least.min(pecks.max_fed)));
        }
    }

    pub(super) fn finish(self) -> Vec<CutConditions> {
        self.0.into_entries().map(|entry| CutConditions { count: entry.count, ..entry.value }).collect()
    }
}
