//! Events of a run marked with the stroke they belong to, and the outside values on which each stroke depends.
use std::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;

use gcode_control::slice::Marks;
use gcode_lang::motion::{
    Backtrace, Call, CallChain, Event, EventKind, EventSink, MAX_AXES, Position, SkipMove, SkipSignal,
};
use gcode_lang::source::{SourceId, Span};

/// Source of the calls that mark the backtraces of events: no text has it.
const MARKER: SourceId = SourceId(u32::MAX);

/// Cosine of the largest angle between two moves along one line.
const MIN_COSINE: f64 = 1.0 - 1e-9;

/// Cosine of the least angle between a stroke and the shift of a boring bar.
const MAX_SQUARE_COSINE: f64 = 0.01;

/// Largest shift of a boring bar, mm.
const MAX_BAR_SHIFT: f64 = 5.0;

/// Sink that marks each event with the stroke it belongs to, and records the outside values on which a stroke depends.
///
/// A stroke is a series of feeds, with the rapids along the line of the move before. The mark is an innermost call that no
/// program has, so that the passes of the extraction carry it.
pub(super) struct MarkedEvents<S> {
    pub(super) sink: S,
    motion: Rc<Cell<Marks>>,
    pub(super) strokes: Vec<Marks>,
    /// Outside values on which a feed depends, moves of G31 left out.
    pub(super) feeds: Marks,
    position: Position,
    /// Direction of the last move, and whether it was a rapid.
    last: Option<(Position, bool)>,
    /// Start and direction of the stroke's first feed; `None` before it. Rapids before a feed decide no hole but by their end,
    /// from which it feeds.
    first_feed: Option<(Position, Position)>,
}

impl<S> MarkedEvents<S> {
    /// Hands the events on to a sink; `motion` are the values on which the next move depends.
    pub(super) fn new(sink: S, motion: Rc<Cell<Marks>>) -> Self {
        let (strokes, position) = (Vec::new(), Position::default());
        Self { sink, motion, strokes, feeds: Marks::NONE, position, last: None, first_feed: None }
    }
}

impl<S: EventSink> EventSink for MarkedEvents<S> {
    fn skip_signal(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        self.sink.skip_signal(feed)
    }

    fn event(&mut self, event: &Event<'_>) {
        let Some(to) = event.kind.end() else { return self.sink.event(event) };
        let is_rapid = matches!(event.kind, EventKind::Rapid { .. });
        let from = std::mem::replace(&mut self.position, *to);
        let mut direction = Position::default();
        (0..MAX_AXES).for_each(|axis| direction[axis] = to[axis] - from[axis]);
        let length = (0..MAX_AXES).map(|axis| direction[axis] * direction[axis]).sum::<f64>().sqrt();
        if length > 0.0 {
            (0..MAX_AXES).for_each(|axis| direction[axis] /= length);
            let is_along = |last: &Position| {
                let cosine: f64 = (0..MAX_AXES).map(|axis| last[axis] * direction[axis]).sum();
                cosine.abs() >= MIN_COSINE
            };
            let continues =
                self.last.is_some_and(|(last, was_rapid)| !is_rapid && !was_rapid || is_along(&last));
            let is_square = |last: &Position| {
                let cosine: f64 = (0..MAX_AXES).map(|axis| last[axis] * direction[axis]).sum();
                cosine.abs() <= MAX_SQUARE_COSINE
            };
            // Where the spindle stands a boring bar is shifted off its wall: that decides how the stroke ends.
            let may_shift = is_rapid
                && length <= MAX_BAR_SHIFT
                && self.last.is_some_and(|(last, was_rapid)| !was_rapid && is_square(&last));
            if let Some(stroke) = self.strokes.last_mut().filter(|_| may_shift) {
                *stroke |= self.motion.get();
            }
            if !continues {
                self.strokes.push(Marks::NONE);
                self.first_feed = None;
            }
            self.last = Some((direction, is_rapid));
        } else if self.strokes.is_empty() {
            self.strokes.push(Marks::NONE);
        }
        let stroke = self.strokes.len() - 1;
        if matches!(event.kind, EventKind::Feed { .. } | EventKind::Arc { .. }) {
            self.feeds |= self.motion.get();
        }
        if !is_rapid {
            self.first_feed.get_or_insert((from, direction));
        }
        if self.first_feed.is_some_and(|(start, along)| !(is_rapid && is_behind(&start, &along, [&from, to])))
        {
            self.strokes[stroke] |= self.motion.get();
        }
        let place = Span { source: MARKER, start: stroke as u32, end: stroke as u32 };
        let calls = Some(Arc::new(Call { calling_block: place, outer_calls: event.calls.clone() }));
        self.sink.event(&Event { calls: &calls, ..*event });
    }
}

/// Returns true if a stroke that first fed from `start` in a direction has come out again, and no point lies farther along.
fn is_behind(start: &Position, direction: &Position, points: [&Position; 2]) -> bool {
    points.iter().all(|point| {
        let along: f64 = (0..MAX_AXES).map(|axis| (point[axis] - start[axis]) * direction[axis]).sum();
        along <= 0.0
    })
}

/// Returns the number of a marked event's stroke, and the calls that led to its block.
pub(super) fn stroke_of(calls: &CallChain) -> Option<(u32, &CallChain)> {
    let call = calls.as_deref().filter(|call| call.calling_block.source == MARKER)?;
    Some((call.calling_block.start, &call.outer_calls))
}

/// Returns the outside values on which the passes at these places depend.
pub(super) fn marks_of<'p>(places: impl IntoIterator<Item = &'p Backtrace>, strokes: &[Marks]) -> Marks {
    let stroke = |place: &Backtrace| strokes.get(stroke_of(&place.calls)?.0 as usize).copied();
    places.into_iter().filter_map(stroke).collect()
}
