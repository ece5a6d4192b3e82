//! Assumptions of a result: values that the run read and nothing in its program set, with the holes that each can touch.
use std::cell::Cell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

use super::{Request, Run, causes, set_up_control};
use gcode_control::slice::{Marks, OutsideRead, Slice, StatedValues};
use gcode_inspect::holes::{DrilledHole, HoleExtractor};
use gcode_lang::motion::{Backtrace, Call, Event, EventSink, MAX_AXES, Position, SkipMove, SkipSignal};
use gcode_lang::program::NoLibrary;
use gcode_lang::source::{SourceId, Span};
use gcode_part::{Assumption, AssumptionPlace, Surface};

/// Holes of a run, and the values from outside on which each depends.
#[derive(Clone, Debug, Default)]
pub struct Dependences {
    reads: Vec<OutsideRead>,
    /// Sets of reads, by hole in the order of the extraction.
    holes: Vec<Marks>,
}

/// Follows the outside values through a second run, if the first one can have read any.
pub(super) fn dependences(request: &Request, run: &Run, surface: Option<Surface>) -> Dependences {
    if !may_read_outside(request, run) {
        return Dependences::default();
    }
    let Ok(mut control) = set_up_control(request, causes::reload(run)) else { return Dependences::default() };
    let mut slice = Slice::new(stated_values(request));
    let mut sink = MarkedEvents {
        extractor: HoleExtractor::new(&request.machine).with_surface(surface.or(request.part)),
        motion: slice.motion(),
        strokes: Vec::new(),
        position: Position::default(),
        axis: None,
    };
    control.run_observed(request.limits, &mut NoLibrary, &mut sink, &mut slice);
    let MarkedEvents { extractor, strokes, .. } = sink;
    let holes = extractor.finish().holes.iter().map(|hole| marks_of(hole, &strokes)).collect();
    Dependences { reads: slice.into_reads(), holes }
}

impl Dependences {
    /// Returns the assumptions that can touch a hole; `names` returns the name of a hole by its index in the extraction.
    pub fn assumptions(&self, run: &Run, names: impl Fn(usize) -> Option<String>) -> Vec<Assumption> {
        let assumption = |(index, read): (usize, &OutsideRead)| {
            let touched = self.holes.iter().enumerate().filter(|(_, marks)| marks.contains(index));
            let decides: Vec<String> = touched.filter_map(|(hole, _)| names(hole)).collect();
            let (program, line) = run.locate(read.place.block);
            let place = AssumptionPlace { program, line };
            let what = read.source.name();
            (!decides.is_empty()).then_some(Assumption { what, value: read.value, place, decides })
        };
        self.reads.iter().enumerate().filter_map(assumption).collect()
    }
}

/// Returns true if the run can have read a value that its program does not set. A text that names a variable beyond the
/// locals counts as reading it.
fn may_read_outside(request: &Request, run: &Run) -> bool {
    let control = &run.control;
    let stated = stated_values(request);
    !request.variables.is_empty()
        || !control.unset_work_systems().is_empty()
        || control.auxiliary_codes().keys().any(|code| !stated.codes.contains(code))
        || control.memory().sources().iter().any(|(_, source)| names_outside(&source.bytes, &stated))
}

/// Returns true if a text has a block skip, `#` before anything but a local or a harmless system variable, PRM, G31, or a
/// tool offset whose value the machine file does not state.
fn names_outside(text: &[u8], stated: &StatedValues) -> bool {
    let mut rest = text;
    while let Some(at) = rest.iter().position(|byte| b"#/HDPGhdpg".contains(byte)) {
        let (letter, behind) = (rest[at].to_ascii_uppercase(), &rest[at + 1..]);
        let behind = behind.trim_ascii_start();
        let digits = behind.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = std::str::from_utf8(&behind[..digits]).ok().and_then(|digits| digits.parse::<u32>().ok());
        let is_outside = match (letter, number) {
            (b'#', Some(number)) => !matches!(number, 0..=33 | 3000 | 3006 | 3100..=3102 | 4001..=4330 | 5001..=5060),
            (b'#', None) | (b'/', _) => true,
            (b'H', Some(number)) => number != 0 && !stated.lengths.contains(&number),
            (b'D', Some(number)) => number != 0,
            (b'H' | b'D', None) => behind.starts_with(b"#"),
            (b'P', None) => behind.starts_with(b"RM"),
            (b'G', Some(31)) => true,
            _ => false,
        };
        if is_outside {
            return true;
        }
        rest = behind;
    }
    false
}

/// Returns what the machine file and the reference state.
fn stated_values(request: &Request) -> StatedValues {
    let lengths = request.machine.tools.iter().filter(|tool| tool.length.is_some()).map(|tool| tool.number);
    let clamp = request.process_limits.clamp.iter().flat_map(|clamp| [clamp.on, clamp.off]);
    StatedValues { lengths: lengths.collect(), codes: clamp.collect::<BTreeSet<u32>>() }
}

/// Source of the calls that mark the backtraces of events: no text has it.
const MARKER: SourceId = SourceId(u32::MAX);

/// Sink that marks each event with the stroke it belongs to, and records the outside values on which a stroke depends.
///
/// A stroke is a series of moves of one and the same axis; every other move is a stroke of its own. The mark is an innermost
/// call that no program has, so that the passes of the extraction carry it.
struct MarkedEvents<'m> {
    extractor: HoleExtractor<'m>,
    motion: Rc<Cell<Marks>>,
    strokes: Vec<Marks>,
    position: Position,
    /// Axis of the current stroke.
    axis: Option<usize>,
}

impl EventSink for MarkedEvents<'_> {
    fn skip_signal(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        self.extractor.skip_signal(feed)
    }

    fn event(&mut self, event: &Event<'_>) {
        let Some(to) = event.kind.end() else { return self.extractor.event(event) };
        let mut moved = (0..MAX_AXES).filter(|axis| to[*axis] != self.position[*axis]);
        let axis = moved.next().filter(|_| moved.next().is_none());
        if self.strokes.is_empty() || axis.is_none() || axis != self.axis {
            self.strokes.push(Marks::NONE);
        }
        (self.axis, self.position) = (axis, *to);
        let stroke = self.strokes.len() - 1;
        self.strokes[stroke] |= self.motion.get();
        let place = Span { source: MARKER, start: stroke as u32, end: stroke as u32 };
        let calls = Some(Arc::new(Call { calling_block: place, outer_calls: event.calls.clone() }));
        self.extractor.event(&Event { calls: &calls, ..*event });
    }
}

/// Returns the outside values on which the passes of a hole depend.
fn marks_of(hole: &DrilledHole, strokes: &[Marks]) -> Marks {
    let stroke = |place: &Backtrace| {
        let call = place.calls.as_ref().filter(|call| call.calling_block.source == MARKER)?;
        strokes.get(call.calling_block.start as usize).copied()
    };
    let passes = hole.earlier_passes.iter().map(|pass| &pass.backtrace);
    passes.chain([&hole.backtrace]).filter_map(stroke).collect()
}
