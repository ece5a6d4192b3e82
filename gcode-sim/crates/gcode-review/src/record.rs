//! What one revision does, written down: all that two of them are compared by, without the run it came from.
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::first_command::FirstCommand;
use super::modal_conditions::ModalConditions;
use super::recorder::{EndCause, ExecutedBlocks, FirstExecutions, MOST_STEPS, Recorder, SharedRecorder};
use super::steps::{Step, StepKind};
use gcode_control::{Control, Observer, Outcome, ResidualKind, ResidualValue, mode_name};
use gcode_inspect::holes::DrilledHole;
use gcode_lang::alarm::kinds::{LIMIT, PS0076};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Axes, Backtrace, CallChain, MAX_AXES, Position};
use gcode_lang::program::{Library, Program};
use gcode_lang::source::{Sources, Span};
use gcode_part::Surface;
use gcode_session::{Request, Run, SessionError, Simulation};

/// What one revision does.
#[derive(Clone, Debug)]
pub struct Record {
    pub(super) axes: Axes,
    pub(super) steps: Vec<Step>,
    /// In the order in which they are begun.
    pub(super) holes: Vec<DrilledHole>,
    /// The steps that cut each hole, the finishing one last.
    pub(super) feeds: Vec<Vec<usize>>,
    /// Holes that a stop leaves unfinished: their depth and their tools aren't known.
    pub(super) unfinished: BTreeSet<usize>,
    /// The blocks that the steps come from: [`Step::place`] counts them.
    pub(super) places: Vec<BlockLocation>,
    /// What is in force while steps are made: [`Step::condition`] counts them.
    pub(super) conditions: Vec<ModalConditions>,
    /// What the program commands, each at its first time; `None` where nobody has written that down.
    pub(super) begun: Option<Vec<FirstCommand>>,
    /// The main program's name as a control shows it.
    pub(super) program: Option<String>,
    pub(super) ending: EndState,
    /// What was read; nothing of what was read from a file.
    pub(super) sources: Option<Sources>,
    /// When the run first executed each block; nothing of what was read from a file.
    pub(super) reached: FirstExecutions,
    pub totals: Totals,
}

/// A block by program and line, and the calls that led to it, innermost first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockLocation {
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
pub(super) struct EndState {
    /// `end`, `alarm` or `limit`.
    pub outcome: String,
    /// The words by which two revisions are compared.
    pub words: String,
    /// The block that ended or stopped the run; for a run without an end the block that jumps back.
    pub stopped: Option<BlockLocation>,
    /// The lines of DPRNT and BPRNT; bytes that are not text as `\xNN`.
    pub output: Vec<String>,
    /// The final state by name: every value that is neither vacant nor 0.
    pub left: BTreeMap<String, ResidualEntry>,
}

/// A value of the final state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ResidualEntry {
    /// The code of a change of it.
    pub code: String,
    pub value: f64,
    /// The block that set the mode, or wrote the value last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<BlockLocation>,
}

/// A run with its record.
#[derive(Debug)]
pub struct Revision {
    pub simulation: Simulation,
    pub record: Record,
    pub(super) done: ExecutedBlocks,
}

impl Revision {
    /// Executes a program and writes down what it does.
    /// With the part's surface known, motion inside it is seen as well.
    pub fn of(
        request: &Request,
        library: &mut impl Library,
        surface: Option<Surface>,
    ) -> Result<Self, SessionError> {
        Self::observed(request, library, surface, &mut ())
    }

    /// As [`Revision::of`], with somebody who looks on from block to block.
    pub fn observed(
        request: &Request,
        library: &mut impl Library,
        surface: Option<Surface>,
        watcher: &mut impl Observer,
    ) -> Result<Self, SessionError> {
        let recorder = RefCell::new(Recorder::default());
        let (mut told, mut beside) =
            (SharedRecorder(&recorder), ObserverPair(SharedRecorder(&recorder), watcher));
        let mut simulation =
            gcode_session::simulate_observed(request, library, surface, &mut told, &mut beside)?;
        let mut recorder = recorder.into_inner();
        if recorder.too_many {
            let message = format!("more than {MOST_STEPS} moves: later ones are not compared");
            simulation.extracted.findings.push(Diagnostic::new(&LIMIT, message));
        }
        let done = std::mem::take(&mut recorder.done);
        let record = record(&simulation, recorder);
        Ok(Self { simulation, record, done })
    }

    /// The files of the programs, by the names that [`BlockLocation`] gives them; those that stand for one file only.
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
        self.stopped().any(|finding| finding.kind == &LIMIT)
    }

    /// Why the run stopped before its end, or can't be compared to its end.
    pub fn stopped(&self) -> impl Iterator<Item = &Diagnostic> {
        self.simulation.extracted.findings.iter().filter(|finding| finding.severity == Severity::Alarm)
    }
}

/// Two that look on.
struct ObserverPair<A, B>(A, B);

impl<A: Observer, B: Observer> Observer for ObserverPair<A, B> {
    fn before_block(&mut self, control: &mut Control) {
        self.0.before_block(control);
        self.1.before_block(control);
    }

    fn after_block(&mut self, control: &Control) {
        self.0.after_block(control);
        self.1.after_block(control);
    }
}

fn record(simulation: &Simulation, mut recorder: Recorder) -> Record {
    recorder.forget_taken_up();
    let (run, holes) = (&simulation.run, simulation.extracted.holes.clone());
    let feeds = feeds(&recorder, &holes);
    let Recorder {
        mut steps,
        places,
        mut conditions,
        mut set,
        assigned,
        written,
        begun,
        reached,
        last,
        end,
        ..
    } = recorder;
    let mut begun: Vec<FirstCommand> = begun.into_values().collect();
    if conditions.is_empty() {
        conditions.push(ModalConditions::default());
    }
    let words = conditions.iter_mut().flat_map(|condition| &mut condition.0);
    let named = words.filter_map(|word| word.place.as_mut()).chain(set.values_mut());
    let named = named.chain(begun.iter_mut().map(|begun| &mut begun.place));
    let of_steps = steps.iter_mut().flat_map(|step| std::iter::once(&mut step.place).chain(&mut step.set_by));
    let places = resolve(run, &places, of_steps.chain(named));
    let modes = set.iter().map(|(group, place)| (mode_name(*group), places[*place].clone()));
    let at = |place: &Backtrace| BlockLocation::of(run, place);
    let variables = assigned.iter().map(|(number, place)| (format!("#{number}"), at(place)));
    let tables = written.iter().map(|(name, place)| (name.clone(), at(place)));
    let by: BTreeMap<String, BlockLocation> = modes.chain(variables).chain(tables).collect();
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
        reached,
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
fn feeds(recorder: &Recorder, holes: &[DrilledHole]) -> Vec<Vec<usize>> {
    let key = |block: Span, at: &Position| (block.source, block.start, at.0.map(f64::to_bits));
    let mut steps: BTreeMap<(_, u32, [u64; MAX_AXES]), Vec<usize>> = BTreeMap::new();
    for (index, step) in recorder.steps.iter().enumerate().rev().filter(|(_, step)| step.is_move()) {
        steps.entry(key(recorder.places[step.place].block, &step.at)).or_default().push(index);
    }
    // The steps stand in reverse, so that the earliest of those that end alike is taken first.
    let of = |found: &DrilledHole| {
        let passes = found.earlier_passes.iter().map(|cut| key(cut.backtrace.block, &cut.axis_position));
        let all = passes.chain([key(found.backtrace.block, &found.axis_position)]);
        all.filter_map(|key| steps.get_mut(&key)?.pop()).collect()
    };
    holes.iter().map(of).collect()
}

/// Every place once, as people find it.
fn resolve<'a>(
    run: &Run,
    places: &[Backtrace],
    named: impl Iterator<Item = &'a mut usize>,
) -> Vec<BlockLocation> {
    let mut numbers: BTreeMap<BlockLocation, usize> = BTreeMap::new();
    let resolved: Vec<usize> = places
        .iter()
        .map(|place| {
            let next = numbers.len();
            *numbers.entry(BlockLocation::of(run, place)).or_insert(next)
        })
        .collect();
    named.for_each(|place| *place = resolved[*place]);
    let mut all: Vec<(BlockLocation, usize)> = numbers.into_iter().collect();
    all.sort_by_key(|(_, number)| *number);
    all.into_iter().map(|(place, _)| place).collect()
}

impl Record {
    /// Where the program waited for the operator, in order: the number of the step, and its block.
    pub fn stops(&self) -> impl Iterator<Item = (usize, &BlockLocation)> {
        let steps = self.steps.iter().enumerate();
        let stops = steps.filter(|(_, step)| matches!(step.kind, StepKind::Stop(..)));
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
    pub(super) fn under(&self, step: usize) -> &ModalConditions {
        &self.conditions[self.steps[step].condition]
    }

    /// `end`, `alarm` or `limit`.
    pub fn outcome(&self) -> &str {
        &self.ending.outcome
    }

    /// A called program wasn't found: that says more of the folders that were named than of the program.
    pub fn lacks_program(&self) -> bool {
        alarm_code(&self.ending.words) == Some(PS0076.code)
    }

    /// How the run ended, in words.
    pub fn words(&self) -> &str {
        &self.ending.words
    }
}

/// Returns the alarm's code from the text of a run's end: `alarm PS0076 program O0009 is not found`.
pub fn alarm_code(words: &str) -> Option<&str> {
    words.strip_prefix("alarm ")?.split(' ').next()
}

impl BlockLocation {
    pub fn of(run: &Run, place: &Backtrace) -> Self {
        let sources = run.control.memory().sources();
        let at = |span| {
            let (program, line) = run.locate(span);
            Self { program, line, block: sources.text(span).trim().to_owned(), calls: Vec::new() }
        };
        let chain = std::iter::successors(place.calls.as_deref(), |call| call.outer_calls.as_deref());
        let calls = chain.map(|call| at(call.calling_block)).collect();
        Self { calls, ..at(place.block) }
    }
}

/// `by` has the blocks that what is left behind comes from, by its name.
fn ending(
    run: &Run,
    by: &BTreeMap<String, BlockLocation>,
    (last, end): (Option<&Backtrace>, EndCause),
) -> EndState {
    let (outcome, words, stopped) = match &run.outcome {
        Outcome::End => {
            let by = match end {
                EndCause::Code(2) => " by M02",
                EndCause::Code(_) => "",
                EndCause::Return => " by M99",
                EndCause::OfText => " where its text does, without M30",
            };
            ("end", format!("the program ends{by}"), last.map(|place| BlockLocation::of(run, place)))
        }
        Outcome::Alarm(stopped) => {
            let row = stopped.alarm.row();
            let place = BlockLocation::of(run, &stopped.backtrace);
            ("alarm", format!("alarm {} {}", row.code, row.message), Some(place))
        }
        Outcome::Limit => {
            let block = run.control.endless_loop().map_or(run.control.backtrace().block, |(_, back)| back);
            let place = Backtrace { block, calls: CallChain::default() };
            (
                "limit",
                "the program doesn't end within the limits".to_owned(),
                Some(BlockLocation::of(run, &place)),
            )
        }
    };
    EndState {
        outcome: outcome.to_owned(),
        words,
        stopped,
        output: run.control.output().iter().map(|line| gcode_control::printable(line)).collect(),
        left: left(run, by),
    }
}

/// What the next program finds, by name.
fn left(run: &Run, by: &BTreeMap<String, BlockLocation>) -> BTreeMap<String, ResidualEntry> {
    let all = run.control.residual_values().into_iter();
    let left = |r: ResidualValue| {
        let place = by.get(&r.name).cloned();
        (r.name, ResidualEntry { code: code(r.kind).to_owned(), value: r.value, place })
    };
    all.map(left).collect()
}

fn code(kind: ResidualKind) -> &'static str {
    match kind {
        ResidualKind::Variable => "variable",
        ResidualKind::Mode => "mode",
        ResidualKind::WorkOffset => "work-offset",
        ResidualKind::ToolOffset => "tool-offset",
        ResidualKind::Parameter => "parameter",
        ResidualKind::Output => "signal",
        ResidualKind::Counter => "counter",
    }
}
