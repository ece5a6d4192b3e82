//! What one revision does, written down: all that two of them are compared by, without the run it came from.
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::begin::Begun;
use super::in_force::Condition;
use super::recorder::{Done, End, MOST_STEPS, Recorder, Shared};
use super::steps::{Kind, Step};
use crate::diag::{Diagnostic, Severity};
use crate::exec::{Control, Outcome, Remainder, RemainderKind, Watcher, mode_name};
use crate::holes::Found;
use crate::motion::{Axes, Calls, MAX_AXES, Place, Position};
use crate::part::surface::Surface;
use crate::program::{Library, Program};
use crate::session::{self, Request, Run, SessionError, Simulation};
use crate::source::{Sources, Span};

/// What one revision does.
#[derive(Clone, Debug)]
pub struct Record {
    pub(super) axes: Axes,
    pub(super) steps: Vec<Step>,
    /// In the order in which they are begun.
    pub(super) holes: Vec<Found>,
    /// The steps that cut each hole, the finishing one last.
    pub(super) feeds: Vec<Vec<usize>>,
    /// Holes that a stop leaves unfinished: their depth and their tools aren't known.
    pub(super) unfinished: BTreeSet<usize>,
    /// The blocks that the steps come from: [`Step::place`] counts them.
    pub(super) places: Vec<Where>,
    /// What is in force while steps are made: [`Step::under`] counts them.
    pub(super) conditions: Vec<Condition>,
    /// What the program commands, each at its first time; `None` where nobody has written that down.
    pub(super) begun: Option<Vec<Begun>>,
    /// The main program's name as a control shows it.
    pub(super) program: Option<String>,
    pub(super) ending: Ending,
    /// What was read; nothing of what was read from a file.
    pub(super) sources: Option<Sources>,
    pub totals: Totals,
}

/// A block by program and line, and the calls that led to it, innermost first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Where {
    pub program: String,
    pub line: u32,
    pub block: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calls: Vec<Self>,
}

/// Totals of one revision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Totals {
    pub holes: usize,
    pub moves: u64,
    pub blocks: u64,
    pub seconds: f64,
}

/// End and final state of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Ending {
    /// `end`, `alarm` or `limit`.
    pub outcome: String,
    /// The words by which two revisions are compared.
    pub words: String,
    /// The block that ended or stopped the run; for a run without an end the block that jumps back.
    pub stopped: Option<Where>,
    /// The lines of DPRNT and BPRNT; bytes that are not text as `\xNN`.
    pub output: Vec<String>,
    /// The final state by name: every value that is neither vacant nor 0.
    pub left: BTreeMap<String, Left>,
}

/// A value of the final state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Left {
    /// The code of a change of it.
    pub code: String,
    pub value: f64,
    /// The block that set the mode, or wrote the value last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<Where>,
}

/// A run with its record.
#[derive(Debug)]
pub struct Revision {
    pub simulation: Simulation,
    pub record: Record,
    pub(super) done: Done,
}

impl Revision {
    /// Executes a program and writes down what it does.
    /// With the part's surface known, motion inside it is seen as well.
    pub fn of(
        request: &Request,
        library: &mut impl Library,
        surface: Option<Surface>,
    ) -> Result<Self, SessionError> {
        Self::watched(request, library, surface, &mut ())
    }

    /// As [`Revision::of`], with somebody who looks on from block to block.
    pub fn watched(
        request: &Request,
        library: &mut impl Library,
        surface: Option<Surface>,
        watcher: &mut impl Watcher,
    ) -> Result<Self, SessionError> {
        let recorder = RefCell::new(Recorder::default());
        let (mut told, mut beside) = (Shared(&recorder), Beside(Shared(&recorder), watcher));
        let mut simulation = session::simulate_beside(request, library, surface, &mut told, &mut beside)?;
        let mut recorder = recorder.into_inner();
        if recorder.too_many {
            let message = format!("more than {MOST_STEPS} moves: later ones are not compared");
            simulation.extracted.findings.push(Diagnostic::new(Severity::Alarm, "limit", message));
        }
        let done = std::mem::take(&mut recorder.done);
        let record = record(&simulation, recorder);
        Ok(Self { simulation, record, done })
    }

    /// The files of the programs, by the names that [`Where`] gives them; those that stand for one file only.
    pub fn files(&self) -> BTreeMap<String, String> {
        let memory = self.simulation.run.control.memory();
        let mut files: BTreeMap<String, Option<String>> = BTreeMap::new();
        for program in memory.programs() {
            let file = memory.sources().get(program.span.source).name.clone();
            files
                .entry(program.label())
                .and_modify(|known| *known = known.take().filter(|known| *known == file))
                .or_insert(Some(file.clone()));
        }
        files.into_iter().filter_map(|(program, file)| Some((program, file?))).collect()
    }

    /// The run was cut off by a limit: what lies behind it isn't in the record.
    pub fn is_cut_off(&self) -> bool {
        self.stopped().any(|finding| finding.code == "limit")
    }

    /// Why the run stopped before its end, or can't be compared to its end.
    pub fn stopped(&self) -> impl Iterator<Item = &Diagnostic> {
        self.simulation.extracted.findings.iter().filter(|finding| finding.severity == Severity::Alarm)
    }
}

/// Two that look on.
struct Beside<A, B>(A, B);

impl<A: Watcher, B: Watcher> Watcher for Beside<A, B> {
    fn before(&mut self, control: &mut Control) {
        self.0.before(control);
        self.1.before(control);
    }

    fn after(&mut self, control: &Control) {
        self.0.after(control);
        self.1.after(control);
    }
}

fn record(simulation: &Simulation, mut recorder: Recorder) -> Record {
    recorder.forget_taken_up();
    let (run, holes) = (&simulation.run, simulation.extracted.holes.clone());
    let feeds = feeds(&recorder, &holes);
    let Recorder { mut steps, places, mut conditions, mut set, assigned, written, begun, last, end, .. } =
        recorder;
    let mut begun: Vec<Begun> = begun.into_values().collect();
    if conditions.is_empty() {
        conditions.push(Condition::default());
    }
    let words = conditions.iter_mut().flat_map(|condition| &mut condition.0);
    let named = words.filter_map(|word| word.place.as_mut()).chain(set.values_mut());
    let named = named.chain(begun.iter_mut().map(|begun| &mut begun.place));
    let of_steps = steps.iter_mut().flat_map(|step| std::iter::once(&mut step.place).chain(&mut step.said));
    let places = resolve(run, &places, of_steps.chain(named));
    let modes = set.iter().map(|(group, place)| (mode_name(*group), places[*place].clone()));
    let at = |place: &Place| Where::of(run, place);
    let variables = assigned.iter().map(|(number, place)| (format!("#{number}"), at(place)));
    let tables = written.iter().map(|(name, place)| (name.clone(), at(place)));
    let by: BTreeMap<String, Where> = modes.chain(variables).chain(tables).collect();
    Record {
        axes: run.control.settings().axes.clone(),
        totals: Totals {
            holes: holes.len(),
            moves: run.control.moves(),
            blocks: run.control.blocks(),
            seconds: run.control.seconds().0,
        },
        ending: ending(run, &by, (last.as_ref(), end)),
        sources: Some(run.control.memory().sources().clone()),
        begun: Some(begun),
        program: run.control.memory().programs().first().map(Program::label),
        conditions,
        steps,
        holes,
        feeds,
        unfinished: BTreeSet::new(),
        places,
    }
}

/// A pass remembers its block and where the axes stood at its end; that is its step.
fn feeds(recorder: &Recorder, holes: &[Found]) -> Vec<Vec<usize>> {
    let key = |block: Span, at: &Position| (block.source, block.start, at.0.map(f64::to_bits));
    let mut steps: BTreeMap<(_, u32, [u64; MAX_AXES]), Vec<usize>> = BTreeMap::new();
    for (index, step) in recorder.steps.iter().enumerate().rev().filter(|(_, step)| step.is_move()) {
        steps.entry(key(recorder.places[step.place].block, &step.at)).or_default().push(index);
    }
    // The steps stand in reverse, so that the earliest of those that end alike is taken first.
    let of = |found: &Found| {
        let passes = found.others.iter().map(|cut| key(cut.place.block, &cut.at));
        let all = passes.chain([key(found.place.block, &found.at)]);
        all.filter_map(|key| steps.get_mut(&key)?.pop()).collect()
    };
    holes.iter().map(of).collect()
}

/// Every place once, as people find it.
fn resolve<'a>(run: &Run, places: &[Place], named: impl Iterator<Item = &'a mut usize>) -> Vec<Where> {
    let mut numbers: BTreeMap<Where, usize> = BTreeMap::new();
    let resolved: Vec<usize> = places
        .iter()
        .map(|place| {
            let next = numbers.len();
            *numbers.entry(Where::of(run, place)).or_insert(next)
        })
        .collect();
    named.for_each(|place| *place = resolved[*place]);
    let mut all: Vec<(Where, usize)> = numbers.into_iter().collect();
    all.sort_by_key(|(_, number)| *number);
    all.into_iter().map(|(place, _)| place).collect()
}

impl Record {
    /// Where the program waited for the operator, in order: the number of the step, and its block.
    pub fn stops(&self) -> impl Iterator<Item = (usize, &Where)> {
        let steps = self.steps.iter().enumerate();
        let stops = steps.filter(|(_, step)| matches!(step.kind, Kind::Stop(..)));
        stops.map(|(number, step)| (number, &self.places[step.place]))
    }

    /// The first steps alone, and the holes that they begin.
    pub(super) fn up_to(&self, steps: usize) -> Cow<'_, Self> {
        if steps >= self.steps.len() {
            return Cow::Borrowed(self);
        }
        let mut first = self.clone();
        first.steps.truncate(steps);
        let is_cut = |feeds: &Vec<usize>| feeds.iter().any(|step| *step >= steps);
        first.unfinished = (0..self.feeds.len()).filter(|hole| is_cut(&self.feeds[*hole])).collect();
        first.feeds.iter_mut().for_each(|feeds| feeds.retain(|step| *step < steps));
        let begun = first.feeds.iter().rposition(|feeds| !feeds.is_empty()).map_or(0, |last| last + 1);
        first.feeds.truncate(begun);
        first.holes.truncate(begun);
        Cow::Owned(first)
    }

    /// What is in force while a step is made.
    pub(super) fn under(&self, step: usize) -> &Condition {
        &self.conditions[self.steps[step].under]
    }

    /// `end`, `alarm` or `limit`.
    pub fn outcome(&self) -> &str {
        &self.ending.outcome
    }

    /// A called program wasn't found: that says more of the folders that were named than of the program.
    pub fn lacks_program(&self) -> bool {
        self.ending.words.starts_with("alarm PS0076 ")
    }

    /// How the run ended, in words.
    pub fn words(&self) -> &str {
        &self.ending.words
    }
}

impl Where {
    pub fn of(run: &Run, place: &Place) -> Self {
        let sources = run.control.memory().sources();
        let at = |span| {
            let (program, line) = run.locate(span);
            Self { program, line, block: sources.text(span).trim().to_owned(), calls: Vec::new() }
        };
        let chain = std::iter::successors(place.calls.as_deref(), |call| call.outer.as_deref());
        let calls = chain.map(|call| at(call.from)).collect();
        Self { calls, ..at(place.block) }
    }
}

/// `by` has the blocks that what is left behind comes from, by its name.
fn ending(run: &Run, by: &BTreeMap<String, Where>, (last, end): (Option<&Place>, End)) -> Ending {
    let (outcome, words, stopped) = match &run.outcome {
        Outcome::End => {
            let by = match end {
                End::Code(2) => " by M02",
                End::Code(_) => "",
                End::Return => " by M99",
                End::OfText => " where its text does, without M30",
            };
            ("end", format!("the program ends{by}"), last.map(|place| Where::of(run, place)))
        }
        Outcome::Alarm(stopped) => {
            let row = stopped.alarm.row();
            let place = Where::of(run, &stopped.place);
            ("alarm", format!("alarm {} {}", row.code, row.message), Some(place))
        }
        Outcome::Limit => {
            let block = run.control.endless_loop().map_or(run.control.place().block, |(_, back)| back);
            let place = Place { block, calls: Calls::default() };
            ("limit", "the program doesn't end within the limits".to_owned(), Some(Where::of(run, &place)))
        }
    };
    Ending {
        outcome: outcome.to_owned(),
        words,
        stopped,
        output: run.control.output().iter().map(|line| crate::exec::printable(line)).collect(),
        left: left(run, by),
    }
}

/// What the next program finds, by name.
fn left(run: &Run, by: &BTreeMap<String, Where>) -> BTreeMap<String, Left> {
    let all = run.control.left_behind().into_iter();
    let left = |r: Remainder| {
        let place = by.get(&r.name).cloned();
        (r.name, Left { code: code(r.kind).to_owned(), value: r.value, place })
    };
    all.map(left).collect()
}

fn code(kind: RemainderKind) -> &'static str {
    match kind {
        RemainderKind::Variable => "variable",
        RemainderKind::Mode => "mode",
        RemainderKind::WorkOffset => "work-offset",
        RemainderKind::ToolOffset => "tool-offset",
        RemainderKind::Parameter => "parameter",
        RemainderKind::Output => "signal",
        RemainderKind::Counter => "counter",
    }
}
