//! Assumptions of a result: values that the run read and nothing in its program set, with the holes that each can touch.
mod pass_strokes;

use std::collections::BTreeSet;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;

use self::pass_strokes::PassStrokes;
use super::marked_events::{MarkedEvents, marks_of};
use super::outside_text::names_outside;
use super::{Request, Run, Simulation, set_up_control};
use gcode_control::slice::{KEPT_GROUPS, Marks, OutsideRead, OutsideValue, Slice, StatedValues};
use gcode_control::{Control, OperatorStop};
use gcode_inspect::flutes::FluteTracker;
use gcode_inspect::holes::DrilledHole;
use gcode_lang::motion::{Backtrace, EventSink, StopKind};
use gcode_lang::program::NoLibrary;
use gcode_lang::program::modes::ModalGroup;
use gcode_part::{Assumption, AssumptionPlace, Metal};

/// Values from outside on which the holes of a run, or its passes over flutes, depend.
#[derive(Clone, Debug, Default)]
pub struct Dependencies {
    reads: Vec<OutsideRead>,
    /// Sets of reads, by hole or pass in the order of their extraction.
    marks: Vec<Marks>,
}

/// Second run of a program, which follows the values from outside to the events.
#[derive(Debug)]
struct SecondRun<'r> {
    control: Control,
    request: &'r Request,
}

/// What a second run finds: the outside values that it reads, and the values of each stroke.
struct Followed {
    reads: Vec<OutsideRead>,
    strokes: Vec<Marks>,
}

impl<'r> SecondRun<'r> {
    /// Sets the second run up; `None` if the first one can't have read a value from outside.
    fn new(request: &'r Request, run: &Run) -> Option<Self> {
        if run.control.is_cancelled() || !may_read_outside(request, run) {
            return None;
        }
        let mut control = set_up_control(request, run.control.memory().reload()).ok()?;
        if let Some(progress) = &request.progress {
            control.set_progress(Arc::clone(progress));
        }
        Some(Self { control, request })
    }

    /// Runs the program again into a sink.
    fn follow<S: EventSink>(mut self, sink: S) -> (Followed, S) {
        let request = self.request;
        let mut slice = Slice::new(stated_values(request), &request.settings, &request.variables);
        let mut events = MarkedEvents::new(sink, slice.motion());
        self.control.run_observed(request.limits, &mut NoLibrary, &mut events, &mut slice);
        // What mills decides as much as what makes a hole.
        let fed = events.feeds;
        let mut reads = slice.into_reads();
        reads
            .iter_mut()
            .enumerate()
            .for_each(|(index, read)| read.decides_further_cuts |= fed.contains(index));
        (Followed { reads, strokes: events.strokes }, events.sink)
    }
}

/// Follows the outside values to the holes through a second run, if the first one can have read any. `metal` is that of the
/// first run.
pub(super) fn of_holes(request: &Request, run: &Run, metal: &Metal) -> Dependencies {
    let Some(second) = SecondRun::new(request, run) else { return Dependencies::default() };
    let (followed, extractor) = second.follow(super::extractor(request, metal.clone()).without_rapids());
    let marks_of = |hole: &DrilledHole| {
        let passes = hole.earlier_passes.iter().map(|pass| &pass.backtrace);
        marks_of(passes.chain([&hole.backtrace]), &followed.strokes)
    };
    let marks = extractor.finish().holes.iter().map(marks_of).collect();
    Dependencies { reads: followed.reads, marks }
}

/// Follows the outside values to the holes of the first run, which are found by their blocks and ends; `None` if these are not
/// enough to find a hole.
fn of_known_holes(second: SecondRun<'_>, holes: &[DrilledHole]) -> Option<Dependencies> {
    let (followed, passes) = second.follow(PassStrokes::new(holes));
    let marks = passes.marks_of(holes, &followed.strokes)?;
    Some(Dependencies { reads: followed.reads, marks })
}

/// Follows the outside values to the holes of a simulation, while `work` is done beside it.
pub(super) fn beside<T>(
    simulation: &Simulation,
    request: &Request,
    work: impl FnOnce() -> T,
) -> (T, Dependencies) {
    let Simulation { run, metal, extracted } = simulation;
    let holes = &extracted.holes;
    let Some(second) = SecondRun::new(request, run) else {
        return (work(), Dependencies::default());
    };
    let (done, known) = thread::scope(|scope| {
        let known = scope.spawn(|| of_known_holes(second, holes));
        (work(), known.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    (done, known.unwrap_or_else(|| of_holes(request, run, metal)))
}

/// Follows the outside values to the passes over flutes.
pub(super) fn of_flutes(request: &Request, run: &Run, tracker: FluteTracker<'_>) -> Dependencies {
    let Some(second) = SecondRun::new(request, run) else { return Dependencies::default() };
    let (followed, tracker) = second.follow(tracker);
    let passes = tracker.finish().passes;
    let marks = passes.iter().map(|pass| marks_of([&pass.backtrace], &followed.strokes)).collect();
    Dependencies { reads: followed.reads, marks }
}

/// Returns the name of an outside value on the control of a run.
fn name_of(value: OutsideValue, run: &Run) -> String {
    value.name(run.control.settings().dialect)
}

impl Dependencies {
    /// Returns true if the run has read no outside value.
    pub(super) fn is_empty(&self) -> bool {
        self.reads.is_empty()
    }

    /// Returns the assumptions that can touch a hole or flute, each with its block; `names` returns the name of a hole or pass
    /// by its index in the extraction.
    pub fn assumptions(
        &self,
        run: &Run,
        names: impl Fn(usize) -> Option<String>,
    ) -> Vec<(Assumption, Backtrace)> {
        let assumption = |(index, read): (usize, &OutsideRead)| {
            let touched = self.marks.iter().enumerate().filter(|(_, marks)| marks.contains(index));
            // A through hole drilled from both sides is two drilled ones of one name.
            let mut named = BTreeSet::new();
            let decides = touched.filter_map(|(hole, _)| names(hole));
            let decides: Vec<String> = decides.filter(|name| named.insert(name.clone())).collect();
            let (program, line) = run.locate(read.place.block);
            let place = AssumptionPlace { program, line };
            // Values that share an index are one line.
            let sharing = if index == Marks::LAST_INDEX { &self.reads[index..] } else { &[] };
            let (what, value) = match sharing.len() {
                0 | 1 => (name_of(read.source, run), read.value),
                count => (format!("{count} further values, first {}", name_of(read.source, run)), None),
            };
            let decides_further = sharing.iter().any(|one| one.decides_further_cuts);
            let is_assumed = read.decides_further_cuts || decides_further || !decides.is_empty();
            let assumption = Assumption { what, value, place, decides };
            is_assumed.then(|| (assumption, read.place.clone()))
        };
        self.reads.iter().enumerate().take(Marks::LAST_INDEX + 1).filter_map(assumption).collect()
    }

    /// Returns the assumptions, with holes or passes named by their numbers from 1.
    pub fn numbered(&self, run: &Run) -> Vec<(Assumption, Backtrace)> {
        self.assumptions(run, |hole| Some((hole + 1).to_string()))
    }

    /// Returns the number of holes or passes.
    pub fn count(&self) -> usize {
        self.marks.len()
    }
}

/// Returns true if the run can have read a value that its program does not set. A text that names a variable beyond the
/// locals counts as reading it. Without moves only those values matter that can decide whether a block is executed, or how.
fn may_read_outside(request: &Request, run: &Run) -> bool {
    let control = &run.control;
    let has_moves = control.moves() > 0;
    let mut stated = stated_values(request);
    if request.settings.assumes_radius_offsets() {
        // A D that the program sets is one even where the machine file states it.
        stated.radii.clear();
    }
    let is_code_unknown = || control.builder_m_codes().keys().any(|code| !stated.codes.contains(code));
    let may_keep_spindle = || {
        let is_stop = |stop: &OperatorStop| matches!(stop.kind, StopKind::M00 | StopKind::M01);
        !control.settings().undocumented.stop_stops_spindle && control.stops().iter().any(is_stop)
    };
    let takes_power_on_modes = || {
        KEPT_GROUPS.into_iter().any(|group| {
            let is_used = match group {
                ModalGroup::Work => !stated.work_systems.is_empty(),
                ModalGroup::Unit => !stated.has_unit,
                _ => true,
            };
            is_used && !control.is_commanded_before_use(group)
        })
    };
    !request.variables.is_empty()
        || request.settings.skip_signal.is_some()
        || has_moves
            && (!control.unset_work_offsets().is_empty()
                || stated.work_systems.values().any(|axes| control.placed_axes() & !axes != 0)
                || is_code_unknown()
                || may_keep_spindle()
                || control.assumes_restored_length()
                || takes_power_on_modes())
        || control
            .memory()
            .sources()
            .iter()
            .any(|(_, source)| names_outside(&source.bytes, &stated, has_moves))
}

/// Returns what the machine file and the reference state.
fn stated_values(request: &Request) -> StatedValues {
    let lengths = request.machine.tools.iter().filter(|tool| tool.stated_length_offset().is_some());
    let lengths = lengths.map(|tool| tool.number);
    let radii =
        request.machine.tools.iter().filter(|tool| tool.radius_offset.is_some()).map(|tool| tool.number);
    let clamp = request.process_limits.clamp.iter().flat_map(|clamp| [clamp.on, clamp.off]);
    let offsets = request.machine.offsets.iter();
    StatedValues {
        lengths: lengths.collect(),
        radii: radii.collect(),
        work_systems: offsets.map(|offset| (offset.system, offset.axes())).collect(),
        codes: clamp.collect(),
        has_part: request.part.is_some(),
        has_unit: request.settings.is_inch_at_power_on.is_some(),
    }
}

#[cfg(test)]
mod tests;
