//! Record of a run: everything by which two revisions are compared, and the run that it comes from.
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::block_list::{BlockList, ExecutedBlocks};
use super::block_location::{BlockLocation, OtherBlock};
use super::first_command::FirstCommand;
use super::kinds;
use super::modal_conditions::ModalConditions;
use super::recorder::{MOST_STEPS, Recorder, RunStart, SharedRecorder};
use super::step_list::StepList;
use super::steps::StepKind;
use gcode_control::{Control, Observer, Outcome, ResidualKind, ResidualValue};
use gcode_inspect::holes::DrilledHole;
use gcode_inspect::verify::Verdict;
use gcode_lang::alarm::kinds::{LIMIT, PS0076};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Axes, Backtrace, CallChain, EventSink, MAX_AXES, Position};
use gcode_lang::program::Library;
use gcode_lang::source::{SourceId, Span};
use gcode_session::{Criteria, HoleJudgement, Request, Run, SessionError, Simulation};

/// Steps, holes and final state of one revision.
#[derive(Clone, Debug)]
pub struct Record {
    pub(super) axes: Axes,
    /// Axes before the first step; at 0 and known in an accepted result, which does not record them.
    pub(super) start: RunStart,
    pub(super) steps: StepList,
    /// In the order of their first feeds.
    pub(super) holes: Vec<DrilledHole>,
    /// Steps that cut each hole, the finishing one last.
    pub(super) feeds: Vec<Vec<usize>>,
    /// Holes that a stop leaves unfinished: their depth and their tools are unknown.
    pub(super) unfinished: BTreeSet<usize>,
    /// Blocks by the numbers that steps, conditions and first commands name.
    pub(super) blocks: BlockList,
    /// Blocks that no step names, of a file that has them.
    pub(super) other_blocks: Option<Vec<OtherBlock>>,
    /// Modal conditions by the numbers that steps name.
    pub(super) conditions: Vec<ModalConditions>,
    /// First commands of the program; `None` in accepted results that do not have them.
    pub(super) first_commands: Option<Vec<FirstCommand>>,
    /// Name of the main program as a control shows it.
    pub(super) program: Option<String>,
    pub(super) ending: EndState,
    /// True if the case has a reference, which judges what the run makes.
    pub is_verified: bool,
    /// Totals of the run.
    pub totals: Totals,
}

/// Totals of one revision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Totals {
    /// Number of holes, repeated ones as well.
    pub holes: usize,
    /// Number of moves.
    pub moves: u64,
    /// Number of executed blocks.
    pub blocks: u64,
    /// Duration of the run, s.
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
    #[serde(rename = "left")]
    pub residual: BTreeMap<String, ResidualEntry>,
}

/// A value of the final state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ResidualEntry {
    /// The code of a change of it.
    pub code: String,
    pub value: f64,
    /// The block that set the mode, or wrote the value last.
    #[serde(default, rename = "place", skip_serializing_if = "Option::is_none")]
    pub location: Option<BlockLocation>,
}

/// A run with its record.
#[derive(Debug)]
pub struct Revision {
    /// The run, its holes and its findings.
    pub simulation: Simulation,
    /// The verdict on the holes; `None` without a reference.
    pub verdict: Option<Verdict>,
    /// The record of the run.
    pub record: Record,
    /// The finding that the run has more moves than a record.
    pub truncation: Option<Diagnostic>,
}

impl Revision {
    /// Runs a program, judges its holes if there are criteria, and records its steps.
    pub fn of(
        request: &Request,
        library: &mut impl Library,
        criteria: Option<Criteria<'_>>,
    ) -> Result<Self, SessionError> {
        Self::observed(request, library, criteria, &mut (), &mut ())
    }

    /// Runs a program like [`Revision::of`]; `sink` and `observer` record what else the caller shows.
    pub fn observed(
        request: &Request,
        library: &mut impl Library,
        criteria: Option<Criteria<'_>>,
        sink: &mut impl EventSink,
        observer: &mut impl Observer,
    ) -> Result<Self, SessionError> {
        let recorder = RefCell::new(Recorder::default());
        let (mut sinks, mut observers) =
            ((SharedRecorder(&recorder), sink), ObserverPair(SharedRecorder(&recorder), observer));
        let HoleJudgement { simulation, verdict } =
            gcode_session::simulate_judged(request, library, criteria, &mut sinks, &mut observers)?;
        let recorder = recorder.into_inner();
        let message = || format!("more than {MOST_STEPS} moves: later ones are not compared");
        let truncation = recorder.is_truncated.then(|| Diagnostic::new(&LIMIT, message()));
        let record = record(&simulation, recorder);
        Ok(Self { simulation, verdict, record, truncation })
    }

    /// Returns the file of each program by its name in a [`BlockLocation`]; names of several files are left out.
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

    /// Returns true if a limit ended the run, so that the record is incomplete.
    pub fn is_cut_off(&self) -> bool {
        self.stopped().any(|finding| finding.kind == &LIMIT)
    }

    /// Iterates over the alarms and limits that stopped the run or its record.
    pub fn stopped(&self) -> impl Iterator<Item = &Diagnostic> {
        let findings = self.simulation.extracted.findings.iter().chain(&self.truncation);
        findings.filter(|finding| finding.severity == Severity::Alarm)
    }
}

/// Two observers of one run.
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
    recorder.finish();
    let (run, holes) = (&simulation.run, simulation.extracted.holes.clone());
    let feeds = feeds(&recorder, &holes);
    let ending = ending(run, &recorder);
    let Recorder { start, steps, numbers, mut conditions, first_commands, .. } = recorder;
    if conditions.is_empty() {
        conditions.push(ModalConditions::default());
    }
    let memory = run.control.memory();
    Record {
        axes: run.control.settings().axes.clone(),
        totals: Totals {
            holes: holes.len(),
            moves: run.control.moves(),
            blocks: run.control.blocks(),
            seconds: run.control.seconds().0,
        },
        ending,
        is_verified: false,
        first_commands: Some(first_commands.into_values().collect()),
        program: Some(memory.get(memory.main()).label()),
        conditions,
        start,
        steps,
        holes,
        feeds,
        unfinished: BTreeSet::new(),
        blocks: BlockList::Executed(Box::new(ExecutedBlocks::new(numbers, memory))),
        other_blocks: None,
    }
}

/// Block of a pass, its end point as bits, and its tool.
type PassKey = (SourceId, u32, [u64; MAX_AXES], Option<u32>);

/// Finds the step of each pass by its block, its end point and its tool: one block of a subprogram is executed with several.
fn feeds(recorder: &Recorder, holes: &[DrilledHole]) -> Vec<Vec<usize>> {
    let key = |block: Span, at: &Position, tool: Option<u32>| -> PassKey {
        (block.source, block.start, at.0.map(f64::to_bits), tool)
    };
    let passes = |found: &DrilledHole| {
        let earlier = found.earlier_passes.iter();
        let passes = earlier.map(|cut| key(cut.backtrace.block, &cut.axis_position, cut.tool));
        let finishing = key(found.backtrace.block, &found.axis_position, found.tool);
        passes.chain([finishing]).collect::<Vec<_>>()
    };
    let mut steps: BTreeMap<PassKey, Vec<usize>> =
        holes.iter().flat_map(passes).map(|key| (key, Vec::new())).collect();
    let numbers = if holes.is_empty() { 0 } else { recorder.steps.len() };
    let changes = recorder.steps.kinds().enumerate().take(numbers).filter_map(|(step, kind)| match kind {
        StepKind::Tool(number) => Some((step, *number)),
        _ => None,
    });
    let mut changes: Vec<(usize, u32)> = changes.collect();
    for number in (0..numbers).rev() {
        changes.pop_if(|(change, _)| number < *change);
        let tool = changes.last().map(|(_, tool)| *tool);
        if !recorder.steps.is_move(number) {
            continue;
        }
        let step = recorder.steps.at(number);
        let block = recorder.numbers.start_of(step.block_number);
        if let Some(of_pass) = steps.get_mut(&key(block, &step.at, tool)).filter(|_| !step.is_rapid()) {
            of_pass.push(number);
        }
    }
    // Steps are in reverse, so that `pop` takes the earliest of equal ones.
    let of = |found: &DrilledHole| {
        passes(found).into_iter().filter_map(|key| steps.get_mut(&key)?.pop()).collect()
    };
    holes.iter().map(of).collect()
}

impl Record {
    /// Iterates over the operator stops: number of the step, and its block.
    pub fn stops(&self) -> impl Iterator<Item = (usize, Cow<'_, BlockLocation>)> {
        let steps = self.steps.kinds().enumerate();
        let stops = steps.filter(|(_, kind)| matches!(kind, StepKind::Stop(..)));
        stops.map(|(number, _)| (number, self.block(number)))
    }

    /// Returns the record of the first steps, and of the holes that they begin.
    pub(super) fn up_to(&self, steps: usize) -> Cow<'_, Self> {
        if steps >= self.steps.len() {
            return Cow::Borrowed(self);
        }
        let mut first = self.clone();
        first.steps = first.steps.filtered(|step, _| step < steps);
        let is_cut = |feeds: &Vec<usize>| feeds.iter().any(|step| *step >= steps);
        first.unfinished = (0..self.feeds.len()).filter(|hole| is_cut(&self.feeds[*hole])).collect();
        first.feeds.iter_mut().for_each(|feeds| feeds.retain(|step| *step < steps));
        let count = first.feeds.iter().rposition(|feeds| !feeds.is_empty()).map_or(0, |last| last + 1);
        first.feeds.truncate(count);
        first.holes.truncate(count);
        Cow::Owned(first)
    }

    /// Returns the block of a step.
    pub(super) fn block(&self, step: usize) -> Cow<'_, BlockLocation> {
        self.blocks.location(self.steps.block_number(step))
    }

    /// Returns the modal conditions of a step.
    pub(super) fn under(&self, step: usize) -> &ModalConditions {
        &self.conditions[self.steps.condition(step)]
    }

    /// Returns `end`, `alarm` or `limit`.
    pub fn outcome(&self) -> &str {
        &self.ending.outcome
    }

    /// Returns true if a called program was not found, probably because its folder is missing in the arguments.
    pub fn lacks_program(&self) -> bool {
        alarm_code(&self.ending.words) == Some(PS0076.code)
    }

    /// Returns the end of the run in words.
    pub fn words(&self) -> &str {
        &self.ending.words
    }
}

/// Returns the alarm's code from the text of a run's end: `alarm PS0076 program O0009 is not found`.
pub fn alarm_code(words: &str) -> Option<&str> {
    words.strip_prefix("alarm ")?.split(' ').next()
}

/// Returns end and final state of a run.
fn ending(run: &Run, recorder: &Recorder) -> EndState {
    let (outcome, words, stopped) = match &run.outcome {
        Outcome::End => ("end", format!("the program ends{}", recorder.end), recorder.last.clone()),
        Outcome::Alarm(stopped) => {
            let row = stopped.alarm.row();
            ("alarm", format!("alarm {} {}", row.code, row.message), Some(stopped.backtrace.clone()))
        }
        Outcome::Limit => {
            let block = run.control.endless_loop().map_or(run.control.backtrace().block, |(_, back)| back);
            let words = "the program doesn't end within the limits".to_owned();
            ("limit", words, Some(Backtrace { block, calls: CallChain::default() }))
        }
    };
    let residual = run.control.residual_values().into_iter().map(|value: ResidualValue| {
        let written = recorder.written.get(&value.name);
        let location = written.map(|backtrace| BlockLocation::of(run, backtrace));
        let code = match value.kind {
            ResidualKind::Variable => &kinds::VARIABLE,
            ResidualKind::Mode => &kinds::MODE,
            ResidualKind::WorkOffset => &kinds::WORK_OFFSET,
            ResidualKind::ToolOffset => &kinds::TOOL_OFFSET,
            ResidualKind::Parameter => &kinds::PARAMETER,
            ResidualKind::Output => &kinds::SIGNAL,
            ResidualKind::Counter => &kinds::COUNTER,
        };
        (value.name, ResidualEntry { code: code.code.to_owned(), value: value.value, location })
    });
    EndState {
        outcome: outcome.to_owned(),
        words,
        stopped: stopped.map(|backtrace| BlockLocation::of(run, &backtrace)),
        output: run.control.output().iter().map(|line| gcode_control::printable(line)).collect(),
        residual: residual.collect(),
    }
}
