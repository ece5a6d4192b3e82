//! One program through the whole chain: what the command line, the generator and tests call.
mod block_locator;
mod endless_cause;
mod likely_causes;
mod trace;

use std::sync::Arc;

use self::block_locator::BlockLocator;
pub use trace::{ExecutedBlock, Trace, VariableRole, VariableValues};

use gcode_control::{Control, Limits, Note, Observer, Outcome, Progress};
use gcode_inspect::flutes::{FluteTracker, GrinderError, GrindingResult};
use gcode_inspect::holes::{HoleExtraction, HoleExtractor};
use gcode_inspect::machine::Machine;
use gcode_inspect::stylus::{RapidChecker, Stylus, StylusReadings};
use gcode_inspect::verify::flutes::{FluteVerdict, verify_flutes};
use gcode_inspect::verify::{Tolerances, Verdict, verify};
use gcode_lang::alarm::{Alarm, AlarmCode, remedy};
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, EventSink};
use gcode_lang::program::{Library, Memory};
use gcode_lang::source::{Bytes, Span};
use gcode_part::Flutes;
use gcode_part::HoleList;
use gcode_part::ProcessLimits;
use gcode_part::Reference;
use gcode_part::Surface;

/// A program to run, and everything its run depends on.
#[derive(Clone, Debug)]
pub struct Request {
    /// The file's name as the user gave it.
    pub name: String,
    pub bytes: Bytes,
    pub settings: Settings,
    pub machine: Machine,
    pub limits: Limits,
    /// Variables set before the start.
    pub variables: Vec<(u32, f64)>,
    /// The part's surface, where it is there to be probed.
    pub part: Option<Surface>,
    /// How the part is to be worked, as far as the reference says it.
    pub conduct: ProcessLimits,
    /// Who sees how far the run is, and may end it.
    pub progress: Option<Arc<Progress>>,
}

impl Request {
    /// A program on a machine, with that machine's control and the limits of [`Limits::default`].
    pub fn new(name: impl Into<String>, bytes: impl Into<Bytes>, machine: Machine) -> Self {
        let mut settings =
            Settings { axes: machine.axes.clone(), increment: machine.increment, ..Settings::default() };
        settings.apply_dialect(machine.dialect);
        Self {
            name: name.into(),
            bytes: bytes.into(),
            settings,
            machine,
            limits: Limits::default(),
            variables: Vec::new(),
            part: None,
            conduct: ProcessLimits::default(),
            progress: None,
        }
    }
}

/// Why a run can't begin.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    #[error("{name} contains no program")]
    NoProgram { name: String },
    #[error(
        "{name}, line {line}: {program} is defined twice, and a control refuses the second: give it a \
         number of its own"
    )]
    DuplicateProgram { name: String, line: u32, program: String },
    #[error("#{number} cannot be set: {alarm}")]
    Variable { number: u32, alarm: Alarm },
}

/// A run that is over, with the control as it stands.
#[derive(Debug)]
pub struct Run {
    pub control: Control,
    pub outcome: Outcome,
}

/// Runs a program and tells `sink` what the machine does.
pub fn run<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    sink: &mut S,
) -> Result<Run, SessionError> {
    run_observed(request, library, sink, &mut ())
}

/// As [`run`], with somebody who looks on from block to block.
pub fn run_observed<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    sink: &mut S,
    observer: &mut impl Observer,
) -> Result<Run, SessionError> {
    let mut memory = Memory::default();
    memory.load(request.name.clone(), request.bytes.clone());
    if memory.programs().is_empty() {
        return Err(SessionError::NoProgram { name: request.name.clone() });
    }
    if let Some(second) = memory.duplicates().next() {
        let line = memory.sources().line_column(second.span).line;
        return Err(SessionError::DuplicateProgram {
            name: request.name.clone(),
            line,
            program: second.label(),
        });
    }
    let mut control = Control::new(memory, request.settings.clone());
    for (number, value) in
        presets(&request.machine, &request.settings).chain(request.variables.iter().copied())
    {
        control.set_variable(number, value).map_err(|alarm| SessionError::Variable { number, alarm })?;
    }
    if let Some(progress) = &request.progress {
        control.set_progress(Arc::clone(progress));
    }
    let outcome = control.run_observed(request.limits, library, sink, observer);
    Ok(Run { control, outcome })
}

/// What stands in the control of a machine that is set up: work offsets (#5221…), and the lengths of the tools in
/// the table as geometry offsets H (#11001…, or #2001… on a Haas).
fn presets<'a>(machine: &'a Machine, settings: &'a Settings) -> impl Iterator<Item = (u32, f64)> + 'a {
    let work = machine.offsets.iter().flat_map(|offset| {
        let first = 5221 + 20 * (offset.code - 54);
        offset.values.iter().map(move |(axis, value)| (first + *axis as u32, *value))
    });
    let lengths = machine.tools.iter().filter_map(move |tool| {
        let known = (1..=settings.tool_offsets).contains(&(tool.number as usize));
        let variable = settings.offset_variables.length(tool.number).filter(|_| known)?;
        Some((variable, tool.length?))
    });
    work.chain(lengths)
}

/// A run with the flutes it ground.
#[derive(Debug)]
pub struct GrindingRun {
    pub run: Run,
    pub result: GrindingResult,
    pub nominal: Flutes,
}

/// Why flutes can't be followed.
#[derive(Debug, thiserror::Error)]
pub enum GrindingError {
    #[error(transparent)]
    Machine(#[from] GrinderError),
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// Runs a program and follows the wheel on the burr that is wanted.
pub fn grind(
    request: &Request,
    library: &mut impl Library,
    wanted: &Flutes,
) -> Result<GrindingRun, GrindingError> {
    let mut follower = FluteTracker::new(&request.machine, *wanted)?;
    let run = run(request, library, &mut follower)?;
    let mut ground = follower.finish();
    ground.findings.extend(run.note_findings());
    ground.findings.extend(likely_causes::unset_work_offsets(&run, &request.machine, "flutes"));
    ground.findings.extend(run.stop_finding());
    Ok(GrindingRun { run, result: ground, nominal: *wanted })
}

impl GrindingRun {
    /// The flutes against the wanted ones.
    pub fn verify(&self) -> FluteVerdict {
        verify_flutes(&self.nominal, &self.result, &|span| self.run.locate(span))
    }
}

/// A run with what an edge finder showed.
#[derive(Debug)]
pub struct StylusRun {
    pub run: Run,
    pub readings: StylusReadings,
}

/// Runs a program and reads the ball of an edge finder, of so many mm of radius, along the part's surface; where the
/// program probes, a probe touches it.
pub fn read_stylus(
    request: &Request,
    library: &mut impl Library,
    surface: Surface,
    radius: f64,
) -> Result<StylusRun, SessionError> {
    let mut stylus = Stylus::new(&request.machine, surface, radius);
    let mut rapids = RapidChecker::new(&request.machine, surface, radius);
    let mut extractor = HoleExtractor::new(&request.machine).with_surface(Some(surface));
    let run = run(request, library, &mut (&mut (&mut stylus, &mut rapids), &mut extractor))?;
    let mut followed = stylus.finish();
    followed.findings.extend(rapids.finish());
    followed.findings.extend(run.note_findings());
    followed.findings.extend(run.stop_finding());
    Ok(StylusRun { run, readings: followed })
}

/// A run with the holes it made.
#[derive(Debug)]
pub struct Simulation {
    pub run: Run,
    pub extracted: HoleExtraction,
}

/// Runs a program and follows the tool; with the surface known, motion inside the part is seen as well, and a machine
/// that has a probe can touch it.
pub fn simulate(
    request: &Request,
    library: &mut impl Library,
    surface: Option<Surface>,
) -> Result<Simulation, SessionError> {
    simulate_observed(request, library, surface, &mut (), &mut ())
}

/// As [`simulate`], with another listener beside the one that follows the tool, and somebody who looks on from block to
/// block.
pub fn simulate_observed<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    surface: Option<Surface>,
    sink: &mut S,
    observer: &mut impl Observer,
) -> Result<Simulation, SessionError> {
    let mut extractor = HoleExtractor::new(&request.machine)
        .with_surface(surface.or(request.part))
        .with_process_limits(&request.conduct);
    let run = run_observed(request, library, &mut (&mut extractor, sink), observer)?;
    let mut extracted = extractor.finish();
    extracted.findings.extend(run.note_findings());
    extracted.findings.extend(run.stop_finding());
    Ok(Simulation { run, extracted })
}

impl Simulation {
    /// The holes against the wanted ones.
    pub fn verify(&self, reference: &Reference, tolerances: Tolerances, machine: &Machine) -> Verdict {
        let places = BlockLocator::of(&self.run);
        let locate = |span| places.locate(span);
        let mut verdict = verify(&self.extracted, reference, tolerances, machine, &locate);
        let told = verdict.has_findings();
        verdict.add_likely_causes(likely_causes::likely_causes(&self.run, machine, told), &locate);
        verdict
    }

    /// The document that `holes` writes.
    pub fn hole_list(&self) -> HoleList {
        let places = BlockLocator::of(&self.run);
        self.extracted.list(|span| places.locate(span))
    }
}

impl Run {
    /// The program and the line of a block, as people name them: `O8101`, 31.
    pub fn locate(&self, span: Span) -> (String, u32) {
        BlockLocator::of(self).locate(span)
    }

    /// What the control did without a word and the programmer hardly meant, as warnings.
    pub fn note_findings(&self) -> impl Iterator<Item = Diagnostic> + '_ {
        self.control.notes().map(|(note, block)| {
            let (code, message, help) = note.describe();
            // K0, lower case, block skip, G53 to wait and a centre where the tool stands are meant; the others are slips.
            let meant = matches!(
                note,
                Note::CycleRepeatsZero
                    | Note::LowerCase
                    | Note::CentreDefaulted { .. }
                    | Note::NoAxis { code: 530 }
                    | Note::BlockSkip { .. }
            );
            let severity = if meant { Severity::Note } else { Severity::Warning };
            Diagnostic::new(severity, code, message)
                .with_backtrace(Backtrace { block, calls: None })
                .help(help)
        })
    }

    /// Why the run stopped before its end, as a finding; `None` where it didn't.
    pub fn stop_finding(&self) -> Option<Diagnostic> {
        match &self.outcome {
            Outcome::End => None,
            Outcome::Alarm(stopped) => {
                let row = stopped.alarm.row();
                let mut finding = Diagnostic::new(Severity::Alarm, row.code.to_string(), row.message);
                finding.backtrace = Some(stopped.backtrace.clone());
                finding.span = Some(stopped.span);
                finding.help = remedy(&stopped.alarm, stopped.span, self.control.memory().sources()).or_else(
                    || match row.code {
                        // The program's own words are all there is to say.
                        AlarmCode::Mc(_) => None,
                        code => Some(format!("run 'gcode-sim explain {code}' for the correct form")),
                    },
                );
                Some(finding)
            }
            Outcome::Limit => Some(self.limit_finding()),
        }
    }

    fn limit_finding(&self) -> Diagnostic {
        let Some((first, last)) = self.control.endless_loop() else {
            let (blocks, moves) = (self.control.blocks(), self.control.moves());
            if self.control.is_cancelled() {
                let message = format!("the run was interrupted after {blocks} blocks and {moves} moves");
                let finding = Diagnostic::new(Severity::Alarm, "limit", message)
                    .with_backtrace(self.control.backtrace());
                return finding.help("results cover the blocks executed so far");
            }
            let message = format!("the program has not ended after {blocks} blocks and {moves} moves");
            let finding =
                Diagnostic::new(Severity::Alarm, "limit", message).with_backtrace(self.control.backtrace());
            return finding.help("check for a loop that never ends; --max-blocks raises the limit");
        };
        let ((program, from), (other, to)) = (self.locate(first), self.locate(last));
        let to = if program == other { format!("line {to}") } else { format!("line {to} of {other}") };
        let message = format!(
            "the program never ends: the blocks from line {from} of {program} to {to} repeat without change"
        );
        let finding =
            Diagnostic::new(Severity::Alarm, "limit", message).with_backtrace(self.control.backtrace());
        if let Some(why) = endless_cause::unchanged_counter(&self.control, first, last) {
            return finding
                .note(why)
                .help("check where the step gets its value: a step of 0 makes no progress");
        }
        finding.help("end a wait for an input with --input '#1005=1', a main program's M99 with --cycles 1")
    }
}
