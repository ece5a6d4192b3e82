//! Holes that come out bad: the blocks that finish them, found by a whole run ahead.
//!
//! Whether a hole is bad is known when its last tool has been there. So the run is made once to its end, with the changes
//! recorded so far, its holes are compared with the reference, and each bad one leads back to the position of its block.
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::run::{PositionedSink, ReversibleRun};
use gcode_inspect::verify::{Tolerances, verify};
use gcode_lang::motion::{Backtrace, Call, Event, EventSink, SkipMove, SkipSignal};
use gcode_lang::source::{SourceId, Span};
use gcode_part::Reference;
use gcode_session::{Request, SessionError};

/// Source of the calls that mark events with their position: no text has it.
const MARKER: SourceId = SourceId(u32::MAX);

/// Positions of blocks that finish bad holes, with sentences on them.
pub(crate) type BadHoles = BTreeMap<u64, Vec<String>>;

/// Sink that marks each event with the position of its block: an innermost call that no program has.
struct MarkedEvents<S> {
    sink: S,
    position: u64,
}

impl<S: EventSink> EventSink for MarkedEvents<S> {
    fn event(&mut self, event: &Event<'_>) {
        let (start, end) = (self.position as u32, (self.position >> 32) as u32);
        let calling_block = Span { source: MARKER, start, end };
        let calls = Some(Arc::new(Call { calling_block, outer_calls: event.calls.clone() }));
        self.sink.event(&Event { calls: &calls, ..*event });
    }

    fn skip_signal(&mut self, skip_move: &SkipMove<'_>) -> Option<SkipSignal> {
        self.sink.skip_signal(skip_move)
    }
}

impl<S: EventSink> PositionedSink for MarkedEvents<S> {
    fn begin_block(&mut self, position: u64) {
        self.position = position;
    }
}

/// Returns the position with which the events of a hole are marked.
fn position_of(backtrace: &Backtrace) -> Option<u64> {
    let mark = backtrace.calls.as_ref()?.calling_block;
    (mark.source == MARKER).then_some(u64::from(mark.start) | u64::from(mark.end) << 32)
}

/// Finds the bad holes of a run as its changes make it; `None` if the search is interrupted.
pub(crate) fn find(
    request: &Request,
    (reference, tolerances): (&Reference, Tolerances),
    run: &mut ReversibleRun,
    is_interrupted: &dyn Fn() -> bool,
) -> Result<Option<BadHoles>, SessionError> {
    let extractor = gcode_session::extractor(request, request.metal(reference));
    let mut events = MarkedEvents { sink: extractor, position: 0 };
    let control = gcode_session::set_up(request, None)?;
    if !run.run_again(control, request.limits.blocks, &mut events, is_interrupted) {
        return Ok(None);
    }
    let extraction = events.sink.finish();
    let memory = run.control().memory();
    let locate = |span: Span| match memory.sources().iter().nth(span.source.0 as usize) {
        Some((_, source)) => {
            let label =
                memory.program_at(span).map_or_else(|| source.name.clone(), |program| program.label());
            (label, source.line_column(span.start).line)
        }
        None => (String::new(), 0),
    };
    let verdict = verify(&extraction, reference, tolerances, &request.machine, &locate);
    let mut found = BadHoles::new();
    let mut add = |index: usize, sentence: String| {
        let hole = extraction.holes.get(index);
        if let Some(position) = hole.and_then(|hole| position_of(&hole.backtrace)) {
            found.entry(position).or_default().push(sentence);
        }
    };
    for hole in verdict.holes.iter().filter(|hole| !hole.ok) {
        let (deviation, allowed) = (hole.position_deviation, tolerances.position);
        let codes = hole.error_codes.join(", ");
        add(
            hole.drilled_index,
            format!(
                "hole {} comes out bad ({codes}): Φ{deviation:.4}, tolerance Φ{allowed}; depth {:+.4} mm",
                hole.id, hole.depth_error
            ),
        );
    }
    for extra in &verdict.extra {
        let [x, y, z] = extra.hole.entry;
        add(extra.drilled_index, format!("extra hole at x {x:.3} y {y:.3} z {z:.3}: {}", extra.why));
    }
    Ok(Some(found))
}
