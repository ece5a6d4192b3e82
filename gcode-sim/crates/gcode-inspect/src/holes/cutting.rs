//! Cutting conditions: what is in force while a tool cuts, by block, for comparison with the reference.
use std::collections::BTreeMap;

use super::clamping::ClampState;
use super::offset_origin::OffsetOrigin;
use super::per_block::PerBlock;
use gcode_lang::motion::{Backtrace, LengthCompensation, SpindleDirection};
use gcode_lang::units::{MmPerMin, Rpm};

/// A feed, and the speed of the spindle with it.
pub(crate) type FeedAtSpeed = (MmPerMin, Rpm);

/// Depths that the strokes of a line add to the ones before, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PeckExtent {
    /// Number of strokes that cut.
    pub strokes: u32,
    /// Longest advance of a stroke, motion above the part included.
    pub max_fed: f64,
    /// Largest depth of cut of a stroke in the part.
    pub max_cut: f64,
}

/// Conditions under which a block feeds a tool into the part.
#[derive(Clone, Debug)]
pub(crate) struct CutConditions {
    /// Block of the first such cut.
    pub backtrace: Backtrace,
    /// Tool in the spindle; `None` before the first tool change.
    pub tool: Option<u32>,
    pub compensation: LengthCompensation,
    /// Block that puts the length offset in force; `None` without an offset.
    pub offset_origin: Option<OffsetOrigin>,
    pub spindle_direction: SpindleDirection,
    /// The spindle reverses in the hole.
    pub is_tapping: bool,
    pub speed: Rpm,
    /// Slowest and fastest feed.
    pub feed_range: [MmPerMin; 2],
    /// Feeds that cut least and most in a revolution, with their speeds.
    pub extremes: [FeedAtSpeed; 2],
    /// Largest depth of cut without a retract, mm.
    pub max_cut: f64,
    /// Least peck of the cuts in several strokes, each by its longest stroke, mm; `None` without pecks.
    pub min_peck: Option<f64>,
    /// Number of such cuts at the block.
    pub count: u64,
}

/// Returns the least and the largest feed in a revolution of two pairs, each feed with its speed.
pub(super) fn widen([least, most]: [FeedAtSpeed; 2], [low, high]: [FeedAtSpeed; 2]) -> [FeedAtSpeed; 2] {
    let is_less = |one: FeedAtSpeed, other: FeedAtSpeed| one.0.0 * other.1.0 < other.0.0 * one.1.0;
    [if is_less(low, least) { low } else { least }, if is_less(most, high) { high } else { most }]
}

/// Modal state of the program that concerns cutting.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CuttingState {
    pub tool: Option<u32>,
    /// Tool of the last T.
    pub selected_tool: Option<u32>,
    pub compensation: LengthCompensation,
    pub spindle_direction: SpindleDirection,
    pub speed: Rpm,
    /// Number of times that the spindle was changed other than by rigid tapping.
    pub free_turns: u32,
    /// Run of rigid tapping, in which the spindle keeps its angle at each height; 0 outside.
    pub rigid_run: u32,
    /// Last M code of the machine builder since M03, M04 or M05: it may have started the spindle.
    pub builder_code: Option<u32>,
    /// Clamp of the rotary table.
    pub clamp: ClampState,
}

impl CuttingState {
    /// Applies a change of the spindle, by rigid tapping or another one.
    pub(super) fn apply_rigid(&mut self, is_rigid: bool) {
        self.free_turns += u32::from(!is_rigid);
        self.rigid_run = if is_rigid { self.free_turns + 1 } else { 0 };
    }

    /// Returns true if two feeds in these states have the same findings.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        let rest = |state: &Self| (state.selected_tool, state.builder_code, state.clamp);
        self.key() == other.key() && rest(self) == rest(other)
    }

    /// Returns tool, length offset, direction and speed as a key.
    pub(super) fn key(&self) -> [u64; 4] {
        let length = match self.compensation {
            LengthCompensation::Off => 0,
            LengthCompensation::Plus(h) => 1 << 32 | u64::from(h),
            LengthCompensation::Minus(h) => 2 << 32 | u64::from(h),
        };
        [self.tool.map_or(u64::MAX, u64::from), length, self.spindle_direction as u64, self.speed.0.to_bits()]
    }
}

/// Cut of one block: what is recorded of it.
#[derive(Debug)]
pub(super) struct RecordedCut<'c> {
    pub backtrace: &'c Backtrace,
    pub state: &'c CuttingState,
    pub is_tapping: bool,
    /// Slowest and fastest feed, and those that cut least and most in a revolution with their speeds.
    pub feeds: ([MmPerMin; 2], [FeedAtSpeed; 2]),
    pub pecks: PeckExtent,
    /// Block that puts the length offset in force.
    pub offset_origin: Option<&'c OffsetOrigin>,
}

/// State, tapping and range of feeds of a cut.
type CutKey = ([u64; 4], bool, [u64; 2]);

/// Conditions by block and key, in order of first occurrence.
#[derive(Debug, Default)]
pub(super) struct CutConditionsByBlock {
    /// A program has few keys, and many blocks.
    key_numbers: BTreeMap<CutKey, usize>,
    blocks: PerBlock<usize, CutConditions>,
}

impl CutConditionsByBlock {
    pub(super) fn add(&mut self, cut: RecordedCut<'_>) {
        let RecordedCut { backtrace, state, is_tapping, feeds, pecks, offset_origin } = cut;
        let (feed_range, extremes) = feeds;
        let CuttingState { tool, compensation, spindle_direction, speed, .. } = *state;
        let key = (state.key(), is_tapping, feed_range.map(|feed| feed.0.to_bits()));
        let next = self.key_numbers.len();
        let number = *self.key_numbers.entry(key).or_insert(next);
        let (_, entry) = self.blocks.count(backtrace.block, number, || CutConditions {
            backtrace: backtrace.clone(),
            tool,
            compensation,
            offset_origin: offset_origin.filter(|origin| origin.is_of(compensation)).cloned(),
            spindle_direction,
            is_tapping,
            speed,
            feed_range,
            extremes,
            max_cut: 0.0,
            min_peck: None,
            count: 0,
        });
        let cut = &mut entry.value;
        cut.extremes = widen(cut.extremes, extremes);
        cut.max_cut = cut.max_cut.max(pecks.max_cut);
        if 1 < pecks.strokes {
            cut.min_peck = Some(cut.min_peck.map_or(pecks.max_fed, |least| least.min(pecks.max_fed)));
        }
    }

    pub(super) fn finish(self) -> Vec<CutConditions> {
        self.blocks.into_entries().map(|entry| CutConditions { count: entry.count, ..entry.value }).collect()
    }
}
