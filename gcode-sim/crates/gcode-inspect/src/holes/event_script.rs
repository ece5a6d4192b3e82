//! For tests: a run written as events, without a control.
use gcode_lang::motion::{Axes, Event, EventKind, EventSink, Position, SpindleDirection, StopKind};
use gcode_lang::source::{SourceId, Span};
use gcode_lang::units::{MmPerMin, Rpm, Seconds};

/// Events in order; event n has line n, from 1.
#[derive(Clone, Default)]
pub(crate) struct EventScript {
    position: Position,
    events: Vec<EventKind>,
}

impl EventScript {
    /// Starts a run with the spindle rotating.
    pub(crate) fn new() -> Self {
        Self::default().with(EventKind::Spindle {
            direction: SpindleDirection::Clockwise,
            speed: Rpm(1500.0),
            is_rigid: false,
            is_oriented: false,
        })
    }

    /// Appends steps separated by `;`: `tool 1; head 30; rapid X10 B90; feed X5`.
    pub(crate) fn then(self, steps: &str) -> Self {
        steps.split(';').fold(self, |script, step| {
            let (verb, words) = step.trim().split_once(' ').unwrap();
            match verb {
                "rapid" => script.rapid(words),
                "feed" => script.feed(words),
                "tool" => script.with(EventKind::ToolChange { number: words.parse().unwrap() }),
                "head" => script.head(words.parse().unwrap()),
                _ => panic!("{step}"),
            }
        })
    }

    pub(crate) fn with(mut self, event: EventKind) -> Self {
        self.events.push(event);
        self
    }

    fn move_to(&mut self, words: &str) -> Position {
        for word in words.split_whitespace() {
            let axis = Axes::default().find(word.as_bytes()[0]).unwrap();
            self.position[axis] = word[1..].parse().unwrap();
        }
        self.position
    }

    pub(crate) fn rapid(mut self, words: &str) -> Self {
        let to = self.move_to(words);
        self.with(EventKind::Rapid { to })
    }

    pub(crate) fn feed(mut self, words: &str) -> Self {
        let to = self.move_to(words);
        self.with(EventKind::Feed { to, rate: MmPerMin(10.0) })
    }

    /// Adds the message that asks the operator to set the head to this angle.
    pub(crate) fn head(self, angle: f64) -> Self {
        self.message("SET HEAD TO #140", vec![(140, angle)])
    }

    pub(crate) fn message(self, text: &str, variables: Vec<(u32, f64)>) -> Self {
        self.with(EventKind::Stop { kind: StopKind::Message, text: text.to_owned(), variables })
    }

    pub(crate) fn emit_to(&self, sink: &mut impl EventSink) {
        for (line, kind) in (1..).zip(&self.events) {
            let block = Span { source: SourceId(0), start: line, end: line };
            sink.event(&Event { kind, seconds: Seconds::ZERO, block, calls: &None });
        }
    }
}
