//! For tests: a run written down as events, without a control.
use gcode_lang::motion::{Axes, Event, EventKind, EventSink, Position, SpindleDirection, StopKind};
use gcode_lang::source::{SourceId, Span};
use gcode_lang::units::{MmPerMin, Rpm, Seconds};

/// Events in order; event n stands in line n, counted from 1.
#[derive(Clone, Default)]
pub(crate) struct EventScript {
    position: Position,
    events: Vec<EventKind>,
}

impl EventScript {
    /// A run with the spindle turning.
    pub(crate) fn new() -> Self {
        Self::default()
            .with(EventKind::Spindle { direction: SpindleDirection::Clockwise, speed: Rpm(1500.0) })
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

    /// `rapid("X10 B90")`
    pub(crate) fn rapid(mut self, words: &str) -> Self {
        let to = self.move_to(words);
        self.with(EventKind::Rapid { to })
    }

    pub(crate) fn feed(mut self, words: &str) -> Self {
        let to = self.move_to(words);
        self.with(EventKind::Feed { to, rate: MmPerMin(10.0) })
    }

    pub(crate) fn tool(self, number: u32) -> Self {
        self.with(EventKind::ToolChange { number })
    }

    /// The operator is asked to set the head to this angle.
    pub(crate) fn head(self, angle: f64) -> Self {
        let text = "SET HEAD TO #140".to_owned();
        self.with(EventKind::Stop { kind: StopKind::Message, text, variables: vec![(140, angle)] })
    }

    pub(crate) fn emit_to(&self, sink: &mut impl EventSink) {
        for (line, kind) in (1..).zip(&self.events) {
            let block = Span { source: SourceId(0), start: line, end: line };
            sink.event(&Event { kind, seconds: Seconds::ZERO, block, calls: &None });
        }
    }
}
