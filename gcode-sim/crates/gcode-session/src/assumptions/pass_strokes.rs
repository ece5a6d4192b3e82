//! Strokes of the passes of known holes, found again in a second run by their blocks and their ends.
use std::collections::HashMap;
use std::iter::successors;

use gcode_control::slice::Marks;
use gcode_inspect::holes::DrilledHole;
use gcode_lang::motion::{
    Backtrace, CallChain, Event, EventKind, EventSink, MAX_AXES, Position, SkipMove, SkipSignal,
};
use gcode_lang::source::{SourceId, Span};

use crate::marked_events::stroke_of;

/// A feed: its block and the blocks that called it, and the bits of its end.
type FeedKey = (Vec<(SourceId, u32)>, [u64; MAX_AXES]);

/// Sink of marked events that finds the strokes of some passes.
#[derive(Debug, Default)]
pub(super) struct PassStrokes {
    /// Strokes of all feeds that are like a pass.
    strokes: HashMap<FeedKey, Vec<u32>>,
    /// A probe has moved: where it stops depends on what the feeds have left of the part.
    has_probed: bool,
}

fn key(block: Span, calls: &CallChain, to: &Position) -> FeedKey {
    let calls = successors(calls.as_deref(), |call| call.outer_calls.as_deref());
    let blocks = [block].into_iter().chain(calls.map(|call| call.calling_block));
    (blocks.map(|block| (block.source, block.start)).collect(), to.0.map(f64::to_bits))
}

/// Returns the blocks and ends of the passes of a hole.
fn passes(hole: &DrilledHole) -> impl Iterator<Item = FeedKey> {
    let earlier = hole.earlier_passes.iter().map(|pass| (&pass.backtrace, &pass.axis_position));
    let all = earlier.chain([(&hole.backtrace, &hole.axis_position)]);
    all.map(|(Backtrace { block, calls }, at)| key(*block, calls, at))
}

impl PassStrokes {
    /// Returns a sink that looks for the passes of these holes.
    pub(super) fn new(holes: &[DrilledHole]) -> Self {
        let strokes = holes.iter().flat_map(passes).map(|key| (key, Vec::new())).collect();
        Self { strokes, has_probed: false }
    }

    /// Returns the outside values on which each hole depends; `None` if a pass is not found, or is one of several feeds that
    /// depend on different values.
    pub(super) fn marks_of(&self, holes: &[DrilledHole], marks: &[Marks]) -> Option<Vec<Marks>> {
        let of_pass = |key: FeedKey| {
            let mut all = self.strokes.get(&key)?.iter().map(|stroke| marks.get(*stroke as usize).copied());
            let first = all.next()??;
            all.all(|other| other == Some(first)).then_some(first)
        };
        let of_hole = |hole: &DrilledHole| passes(hole).map(of_pass).collect::<Option<Marks>>();
        if self.has_probed { None } else { holes.iter().map(of_hole).collect() }
    }
}

impl EventSink for PassStrokes {
    fn skip_signal(&mut self, _: &SkipMove<'_>) -> Option<SkipSignal> {
        self.has_probed = true;
        None
    }

    fn event(&mut self, event: &Event<'_>) {
        let (EventKind::Feed { to, .. } | EventKind::Arc { to, .. }) = event.kind else { return };
        let Some((stroke, calls)) = stroke_of(event.calls) else { return };
        if let Some(strokes) = self.strokes.get_mut(&key(event.block, calls, to))
            && strokes.last() != Some(&stroke)
        {
            strokes.push(stroke);
        }
    }
}
