//! Blocks that mill stated pockets: what they leave has no nominal shape, and no check judges it.
use nalgebra::{Unit, Vector3};

use super::HoleExtractor;
use super::near_metal::{Contact, FeedPart, Judged};
use super::strip::{Line, Strip};
use super::swept_tool::{TipPaths, contact};
use gcode_lang::motion::Event;
use gcode_lang::source::Span;

/// Largest number of runs of blocks that are kept.
const MAX_RUNS: usize = 1000;

/// Number of chords after which a feed counts as milling where it leads through a pocket, cut before or not.
const MAX_SEARCHED: u32 = 2_000;

/// Runs of blocks that mill, in the order of the run. A tool change, and a block of another file, begin a new one.
#[derive(Debug, Default)]
pub(super) struct MilledBlocks {
    runs: Vec<[Span; 2]>,
    is_last_open: bool,
    searched: u32,
}

impl MilledBlocks {
    /// Ends the current run.
    pub(super) fn end_tool(&mut self) {
        self.is_last_open = false;
    }

    /// Returns true if no block mills.
    pub(super) fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Returns the first and the last block of each run.
    pub(super) fn finish(self) -> Vec<[Span; 2]> {
        self.runs
    }

    fn has(&self, block: Span) -> bool {
        let holds = |[first, last]: &[Span; 2]| {
            first.source == block.source && first.start <= block.start && block.start <= last.start
        };
        self.runs.iter().rev().any(holds)
    }

    fn add(&mut self, block: Span) {
        let follows =
            |[first, _]: &&mut [Span; 2]| first.source == block.source && first.start <= block.start;
        let count = self.runs.len();
        match self.runs.last_mut().filter(|_| self.is_last_open).filter(follows) {
            Some([_, last]) => *last = block,
            None if count < MAX_RUNS => self.runs.push([block; 2]),
            None => {}
        }
        self.is_last_open = true;
    }
}

impl HoleExtractor<'_> {
    /// Records the block of a feed that removes metal of a pocket outside the nominal holes.
    pub(super) fn note_milled_block(&mut self, event: &Event<'_>, path: &[(Line, Unit<Vector3<f64>>)]) {
        let block = event.block;
        if self.metal.pockets.is_empty() || self.surface.is_none() || self.milled_blocks.has(block) {
            return;
        }
        let mut searched = self.milled_blocks.searched;
        let is_milling = path.iter().any(|(chord, axis)| {
            self.is_in_a_pocket(chord, axis) && {
                searched = searched.saturating_add(1);
                MAX_SEARCHED < searched || self.mills_a_pocket(chord, axis)
            }
        });
        self.milled_blocks.searched = searched;
        if is_milling {
            self.milled_blocks.add(block);
        }
    }

    /// Returns true if a feed may lead through a pocket.
    fn is_in_a_pocket(&self, chord: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        let margin = Vector3::repeat(self.tool_radius().unwrap_or(0.0));
        let [low, high] = Strip::line(*chord).bounds();
        self.metal.pockets_near(&[low - margin, high + margin]).next().is_some()
            && self.metal.is_touched(&chord[0], &chord[1], axis, margin.x)
    }

    /// Returns true if the tip or the side of the tool cuts metal outside the nominal holes on a straight feed.
    fn mills_a_pocket(&self, chord: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        if self.metal.judged_on(chord, Judged::Milled(FeedPart::Tip)).is_some() {
            return true;
        }
        let paths = TipPaths::line(chord);
        self.tool_body.iter().filter(|part| part.is_cutter).any(|part| {
            let side = FeedPart::Side { radius: part.radius(), slope: part.taper.slope };
            matches!(contact(part, axis, &paths, &self.metal, Judged::Milled(side)), Contact::Metal(_))
        })
    }
}
