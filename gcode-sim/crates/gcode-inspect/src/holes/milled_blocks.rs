//! Blocks that mill stated pockets: what they leave has no nominal shape, and no check judges it.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::feed_law::is_along;
use super::near_metal::{FeedPart, Judged};
use super::strip::{Line, Strip};
use super::swept_tool::rim;
use crate::machine::TOUCH_DEPTH;
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

    /// Returns true if the tip or the rim of the tool cuts metal outside the nominal holes on a straight feed.
    fn mills_a_pocket(&self, chord: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        let cuts = |travel: &Line, part| self.metal.judged_on(travel, Judged::Milled(part)).is_some();
        if cuts(chord, FeedPart::Tip) {
            return true;
        }
        let along = chord[1] - chord[0];
        // The full diameter of a point is above the tip; a tool that moves sideways cuts with the whole point.
        // Edges whose end is below the part cut it above.
        let edges = self.tool_body.iter().filter(|part| part.is_cutter).map(|part| part.to);
        let upper = edges.reduce(f64::max).map(|to| to - TOUCH_DEPTH);
        self.machine.tool_end(self.setup.tool).first().is_some_and(|full| {
            let lower = if is_along(axis, &along) { full.from } else { 0.0 };
            let side = FeedPart::Side { radius: full.radius(), slope: 0.0 };
            let offsets = rim(axis, &along, full.radius());
            [Some(lower), upper].into_iter().flatten().any(|height| {
                let up = axis.into_inner() * height;
                offsets.iter().any(|offset| cuts(&chord.map(|tip: Point3<f64>| tip + offset + up), side))
            })
        })
    }
}
