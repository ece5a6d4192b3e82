//! Events handed to a sink in a thread of its own, in batches: the control executes on while the sink works. The sink receives the
//! same events in the same order as without a thread.
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, Scope, ScopedJoinHandle};

use gcode_lang::motion::{CallChain, Event, EventKind, EventSink, SkipMove, SkipSignal};
use gcode_lang::source::Span;
use gcode_lang::units::Seconds;

/// Number of events from which on a thread is worth its start.
const MIN_EVENTS: usize = 4096;

/// Number of events that are handed over together.
const BATCH: usize = 512;

/// Number of batches by which the control may be ahead.
const MAX_AHEAD: usize = 8;

/// An event as an owned value.
#[derive(Debug)]
struct OwnedEvent {
    kind: EventKind,
    seconds: Seconds,
    block: Span,
    calls: CallChain,
}

/// Sink that hands its events to another one, in this thread for a short run and else in another thread.
#[derive(Debug)]
pub(super) struct EventThread<'scope, 'env, S> {
    scope: &'scope Scope<'scope, 'env>,
    /// The other sink while it is in this thread, and the number of events that it has received here.
    here: Option<(&'scope mut S, usize)>,
    /// The thread that has it.
    there: Option<SinkThread<'scope, S>>,
}

/// Thread that has the sink.
#[derive(Debug)]
struct SinkThread<'scope, S> {
    batches: SyncSender<Vec<OwnedEvent>>,
    /// Events that are not handed over yet.
    batch: Vec<OwnedEvent>,
    thread: ScopedJoinHandle<'scope, &'scope mut S>,
}

/// Does `work` with a sink that hands its events to `sink`, which has received all of them in the end.
pub(super) fn with_event_thread<S: EventSink + Send, T>(
    sink: &mut S,
    work: impl FnOnce(&mut EventThread<'_, '_, S>) -> T,
) -> T {
    thread::scope(|scope| {
        let mut events = EventThread { scope, here: Some((sink, 0)), there: None };
        let result = work(&mut events);
        events.call_back();
        result
    })
}

/// Gives the events of all batches to a sink.
fn receive<S: EventSink>(batches: Receiver<Vec<OwnedEvent>>, sink: &mut S) -> &mut S {
    for OwnedEvent { kind, seconds, block, calls } in batches.into_iter().flatten() {
        sink.event(&Event { kind: &kind, seconds, block, calls: &calls });
    }
    sink
}

impl<S: EventSink + Send> EventThread<'_, '_, S> {
    /// Moves the sink to a thread.
    fn send_away(&mut self) {
        if let Some((sink, _)) = self.here.take() {
            let (batches, received) = sync_channel(MAX_AHEAD);
            let thread = self.scope.spawn(move || receive(received, sink));
            self.there = Some(SinkThread { batches, batch: Vec::with_capacity(BATCH), thread });
        }
    }

    /// Waits until the sink has received all events, and takes it back to this thread.
    fn call_back(&mut self) {
        if let Some(mut there) = self.there.take() {
            there.hand_over();
            drop(there.batches);
            self.here = Some((there.thread.join().unwrap_or_else(|panic| resume_unwind(panic)), 0));
        }
    }
}

impl<S> SinkThread<'_, S> {
    fn hand_over(&mut self) {
        let batch = std::mem::replace(&mut self.batch, Vec::with_capacity(BATCH));
        // A thread receives all batches unless it panics, which shows where it is joined.
        let _ = self.batches.send(batch);
    }
}

impl<S: EventSink + Send> EventSink for EventThread<'_, '_, S> {
    fn event(&mut self, event: &Event<'_>) {
        if let Some((sink, count)) = &mut self.here {
            *count += 1;
            sink.event(event);
            if *count == MIN_EVENTS {
                self.send_away();
            }
        } else if let Some(there) = &mut self.there {
            let Event { kind, seconds, block, calls } = event;
            let (kind, calls) = ((*kind).clone(), (*calls).clone());
            there.batch.push(OwnedEvent { kind, seconds: *seconds, block: *block, calls });
            if there.batch.len() == BATCH {
                there.hand_over();
            }
        }
    }

    /// The signal depends on the events before: the sink receives them first.
    fn skip_signal(&mut self, skip_move: &SkipMove<'_>) -> Option<SkipSignal> {
        self.call_back();
        self.here.as_mut()?.0.skip_signal(skip_move)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records the times of all pauses, and gives a signal at a fraction that is the number of them.
    #[derive(Debug, Default)]
    struct Recorder(Vec<f64>);

    impl EventSink for Recorder {
        fn event(&mut self, event: &Event<'_>) {
            if let EventKind::Dwell { time } = event.kind {
                self.0.push(time.0);
            }
        }

        fn skip_signal(&mut self, _: &SkipMove<'_>) -> Option<SkipSignal> {
            Some(SkipSignal::Received { latched: self.0.len() as f64, stop_fraction: 1.0 })
        }
    }

    fn emit(sink: &mut impl EventSink, numbers: std::ops::Range<usize>) {
        for number in numbers {
            let kind = EventKind::Dwell { time: Seconds(number as f64) };
            sink.event(&Event { kind: &kind, seconds: Seconds(0.0), block: Span::default(), calls: &None });
        }
    }

    #[test]
    fn all_events_arrive_in_order() {
        let sizes =
            [0, 1, MIN_EVENTS - 1, MIN_EVENTS, MIN_EVENTS + 1, MIN_EVENTS + BATCH, 9 * MIN_EVENTS + 7];
        for count in sizes {
            let mut recorder = Recorder::default();
            with_event_thread(&mut recorder, |events| emit(events, 0..count));
            assert!(recorder.0.iter().copied().eq((0..count).map(|number| number as f64)), "{count}");
        }
    }

    /// Before a signal the sink has all events, whether it is in a thread or not, and those behind it follow.
    #[test]
    fn a_signal_is_asked_for_behind_all_events() {
        let at = gcode_lang::motion::Position::default();
        let skip =
            SkipMove { from: &at, to: &at, rate: gcode_lang::units::MmPerMin(1.0), seconds: Seconds(0.0) };
        let mut recorder = Recorder::default();
        with_event_thread(&mut recorder, |events| {
            let mut from = 0;
            for to in [5, 2 * MIN_EVENTS + 3, 2 * MIN_EVENTS + 4, 5 * MIN_EVENTS] {
                emit(events, from..to);
                let signal = SkipSignal::Received { latched: to as f64, stop_fraction: 1.0 };
                assert_eq!(events.skip_signal(&skip), Some(signal));
                from = to;
            }
            emit(events, from..6 * MIN_EVENTS);
        });
        assert_eq!(recorder.0.len(), 6 * MIN_EVENTS);
    }

    #[test]
    #[should_panic(expected = "the sink panics")]
    fn a_panic_of_the_sink_is_passed_on() {
        struct Panics(usize);
        impl EventSink for Panics {
            fn event(&mut self, _: &Event<'_>) {
                self.0 += 1;
                assert!(self.0 < MIN_EVENTS + 10, "the sink panics");
            }
        }
        with_event_thread(&mut Panics(0), |events| emit(events, 0..20 * MIN_EVENTS));
    }
}
