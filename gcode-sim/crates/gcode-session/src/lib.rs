//! Runs one program through the whole chain: from its text to a run, its holes, flutes or readings, and findings.
//!
//! **In:** a [`Request`], which holds the program's bytes, the control's settings and the machine, and a
//! [`Library`] of called programs. **Out:** a [`Run`] with the control in its end state, or a run with the
//! extracted holes ([`simulate`]), the ground flutes ([`grind`]) or the readings of an edge finder ([`read_stylus`]).
//! [`judge_holes`] and [`judge_flutes`] run a program and verify what it makes against a reference: the verdict that every
//! command shows. Findings are [`Diagnostic`]s.
//!
//! ```
//! use gcode_inspect::machine::Machine;
//! use gcode_lang::program::NoLibrary;
//! use gcode_session::{Request, simulate};
//!
//! let machine = Machine::parse("[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n")?;
//! let program = "O1\nS1000 M03\nG90 G54 G00 X10. Y20. Z50.\nG81 Z-15. R2. F100.\nM30\n";
//! let request = Request::new("O1.nc", program.as_bytes(), machine);
//! let simulation = simulate(&request, &mut NoLibrary, None)?;
//! let holes = simulation.hole_list().holes;
//! // Without a surface a hole begins where the cutting feed begins: at the R point level.
//! assert_eq!(holes[0].entry, [10.0, 20.0, 2.0]);
//! assert_eq!(holes[0].depth, 17.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]
mod assumptions;
mod causes;
mod completion;
mod error;
mod event_thread;
pub mod file_uri;
pub mod files;
mod grinding;
mod judgement;
mod marked_events;
mod open_depths;
mod outside_text;
mod reset_lengths;
mod second_start;
mod set_up;
mod stubs;
mod trace;

use std::sync::Arc;

pub use assumptions::Dependencies;
pub use error::SessionError;
pub use grinding::{GrindingError, GrindingRun, grind};
pub use judgement::{Criteria, HoleJudgement, judge_flutes, judge_holes, motion_reference, simulate_judged};
pub use open_depths::complete_depths;
pub use set_up::set_up;
pub use trace::{ExecutedBlock, Trace, VariableRole, VariableValues};

use self::event_thread::with_event_thread;
use self::set_up::{load, set_up_control};
use gcode_control::{Control, Limits, Observer, Outcome, Progress};
use gcode_inspect::findings::{FEED_NO_HOLE, FEED_WITHOUT_RETRACT};
use gcode_inspect::holes::{HoleExtraction, HoleExtractor};
use gcode_inspect::machine::Machine;
use gcode_inspect::stylus::{RapidChecker, Stylus, StylusReadings};
use gcode_inspect::verify::{Tolerances, Verdict, stop_sentence, verify};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::alarm::remedy;
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, EventSink};
use gcode_lang::program::Library;
use gcode_lang::program::modes::Unit;
use gcode_lang::source::{Bytes, Span};
use gcode_lang::syntax::ast::ProgramPath;
use gcode_part::{HoleList, Metal, PartSolid, ProcessLimits, Reference};

/// A program and the conditions of its run.
#[derive(Clone, Debug)]
pub struct Request {
    /// The file's name as the user gave it.
    pub name: String,
    /// The program file.
    pub bytes: Bytes,
    /// The main program; the first of the file if `None`.
    pub main: Option<ProgramPath>,
    /// The control's settings.
    pub settings: Settings,
    /// The machine with its tools and work offsets.
    pub machine: Machine,
    /// Limits that end the run.
    pub limits: Limits,
    /// Numbers and values of variables set before the start.
    pub variables: Vec<(u32, f64)>,
    /// The part for probing that is named for the run.
    pub part: Option<PartSolid>,
    /// Limits of the process that the reference specifies.
    pub process_limits: ProcessLimits,
    /// Each assumption of a verdict on the run is an error.
    pub denies_assumptions: bool,
    /// Shared progress of the run, through which it can be cancelled.
    pub progress: Option<Arc<Progress>>,
}

impl Request {
    /// Returns the part that a touch probe touches: the one that is named for the run, or else the stock of a machine with a
    /// probe, unless a setting says where the signal comes.
    pub fn probed(&self) -> Option<PartSolid> {
        self.part.clone().or_else(|| {
            let stock = self.machine.stock.as_ref().filter(|_| self.machine.probe.is_some())?;
            stock.solid(None).filter(|_| self.settings.skip_signal.is_none())
        })
    }

    /// Builds a request with the machine's control and the limits of [`Limits::default`].
    pub fn new(name: impl Into<String>, bytes: impl Into<Bytes>, machine: Machine) -> Self {
        let mut settings = Settings {
            axes: machine.axes.clone(),
            increment: machine.increment,
            kinematics: machine.kinematics(),
            ..Settings::default()
        };
        settings.apply_dialect(machine.dialect);
        settings.is_inch_at_power_on = machine.unit.map(|unit| unit == Unit::Inch);
        Self {
            name: name.into(),
            bytes: bytes.into(),
            main: None,
            settings,
            machine,
            limits: Limits::default(),
            variables: Vec::new(),
            part: None,
            process_limits: ProcessLimits::default(),
            denies_assumptions: false,
            progress: None,
        }
    }
}

/// A finished run with the control in its end state.
#[derive(Debug)]
pub struct Run {
    /// The control after the run.
    pub control: Control,
    /// The end of the run: program end, alarm or limit.
    pub outcome: Outcome,
    /// The note that the file has further main programs.
    main_note: Option<Diagnostic>,
}

/// Runs a program and emits the machine's events to `sink`.
///
/// # Errors
/// [`SessionError`] if the run cannot begin; an alarm is an outcome of the run, not an error.
pub fn run<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    sink: &mut S,
) -> Result<Run, SessionError> {
    run_observed(request, library, sink, &mut ())
}

/// Runs a program like [`run`], with an observer that is called before and after every block.
///
/// # Errors
/// See [`run`].
pub fn run_observed<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    sink: &mut S,
    observer: &mut impl Observer,
) -> Result<Run, SessionError> {
    let (memory, main_note) = load(request)?;
    let mut control = set_up_control(request, memory)?;
    if let Some(progress) = &request.progress {
        control.set_progress(Arc::clone(progress));
    }
    let outcome = control.run_observed(request.limits, library, sink, observer);
    Ok(Run { control, outcome, main_note })
}

/// A run with the readings of an edge finder.
#[derive(Debug)]
pub struct StylusRun {
    /// The run.
    pub run: Run,
    /// The readings, and the findings of the run.
    pub readings: StylusReadings,
}

/// Runs a program and records the readings of an edge finder along the part's surface; `radius` is its ball's, mm.
/// Skip moves of the program touch the surface.
///
/// # Errors
/// [`SessionError`] if the run cannot begin.
pub fn read_stylus(
    request: &Request,
    library: &mut impl Library,
    part: impl Into<PartSolid>,
    radius: f64,
) -> Result<StylusRun, SessionError> {
    let part = part.into();
    let mut stylus = Stylus::new(&request.machine, part.clone(), radius);
    let mut rapids = RapidChecker::new(&request.machine, part.clone(), radius);
    let mut extractor = HoleExtractor::new(&request.machine).with_probed(Some(part));
    let run = run(request, library, &mut (&mut (&mut stylus, &mut rapids), &mut extractor))?;
    let mut readings = stylus.finish();
    readings.findings.extend(rapids.finish().into_iter().chain(run.findings()));
    Ok(StylusRun { run, readings })
}

/// A run with the holes that it makes.
#[derive(Debug)]
pub struct Simulation {
    /// The run.
    pub run: Run,
    /// The holes, and the findings of the run.
    pub extracted: HoleExtraction,
    /// Known metal of the run.
    metal: Metal,
}

/// Runs a program and extracts its holes. Where metal is known, as that of a reference or inside a surface, motion in it
/// is detected too; a probe of the machine can touch a surface.
///
/// # Errors
/// [`SessionError`] if the run cannot begin.
pub fn simulate(
    request: &Request,
    library: &mut impl Library,
    metal: impl Into<Metal>,
) -> Result<Simulation, SessionError> {
    simulate_observed(request, library, metal, &mut (), &mut ())
}

/// Runs a program like [`simulate`], with a further event sink and an observer that is called before and after every
/// block.
///
/// # Errors
/// See [`simulate`].
pub fn simulate_observed<S: EventSink>(
    request: &Request,
    library: &mut impl Library,
    metal: impl Into<Metal>,
    sink: &mut S,
    observer: &mut impl Observer,
) -> Result<Simulation, SessionError> {
    let metal = metal.into();
    let mut extractor = extractor(request, metal.clone());
    let mut feeds = second_start::FeedTrace::default();
    let run = with_event_thread(&mut extractor, |events| {
        run_observed(request, library, &mut (events, (&mut feeds, sink)), observer)
    })?;
    let mut extracted = extractor.finish();
    let lengths = run.control.tool_lengths().map(|(h, _)| h);
    extracted.program_lengths = lengths.filter(|h| !request.states_length(*h)).collect();
    extracted.reset_lengths = reset_lengths::reset_lengths(request, &run);
    extracted.called_stubs = stubs::called_stubs(&run);
    extracted.findings.extend(second_start::finding(request, &run, &metal, (&extracted, feeds)));
    extracted.findings.extend(run.findings());
    Ok(Simulation { run, extracted, metal })
}

/// Returns the extractor of a run's holes, to which the events of a run can be given.
pub fn extractor(request: &Request, metal: Metal) -> HoleExtractor<'_> {
    let part = request.part.as_ref().map(PartSolid::body);
    // A reference states the part that is there while the program runs, before the stock of the machine file.
    let probed = if metal.body.is_none() { request.probed() } else { request.part.clone() };
    HoleExtractor::new(&request.machine)
        .with_metal(Metal { body: metal.body.or(part), ..metal })
        .with_probed(probed)
        .with_straight_rapids(request.settings.rapids_are_straight)
        .with_dialect(request.settings.codes)
        .with_process_limits(&request.process_limits)
}

impl Simulation {
    /// Iterates over the findings of a run that no reference judges. A contour or a slot is no hole that failed: the warnings
    /// that a feed is not counted as a hole belong to the list of the holes.
    pub fn findings_without_reference(&self) -> impl Iterator<Item = &Diagnostic> {
        let is_uncounted = |finding: &Diagnostic| {
            finding.severity == Severity::Warning
                && [&FEED_NO_HOLE, &FEED_WITHOUT_RETRACT].contains(&finding.kind)
        };
        self.extracted.findings.iter().filter(move |finding| !is_uncounted(finding))
    }

    /// Verifies the holes against a reference, and completes the verdict by the request of the run.
    pub fn verify(&self, reference: &Reference, tolerances: Tolerances, request: &Request) -> Verdict {
        let (machine, memory) = (&request.machine, self.run.control.memory());
        let locate = |span| memory.locate(span);
        let judge = || verify(&self.extracted, reference, tolerances, machine, &locate);
        let (mut verdict, dependencies) = assumptions::beside(self, request, judge);
        let likely = causes::of_holes(self, &mut verdict, machine);
        let names = if dependencies.is_empty() { Default::default() } else { verdict.hole_names() };
        let assumptions = || dependencies.assumptions(&self.run, |hole| names.get(&hole).cloned());
        completion::complete(&mut verdict, request, &self.run, likely, assumptions);
        verdict
    }

    /// Follows the values that the run read and nothing in its program set to the holes, in a second run on the same metal.
    pub fn dependencies(&self, request: &Request) -> Dependencies {
        assumptions::beside(self, request, || ()).1
    }

    /// Returns the list of holes, the JSON document of `gcode-sim holes`.
    pub fn hole_list(&self) -> HoleList {
        self.extracted.list(|span| self.run.locate(span))
    }
}

impl Run {
    /// Follows the values that the run read and nothing in its program set to the holes that it makes, in a second run.
    pub fn dependencies(&self, request: &Request) -> Dependencies {
        assumptions::of_holes(request, self, &Metal::default())
    }

    /// Returns program and line of a block: `O8101`, 31.
    pub fn locate(&self, span: Span) -> (String, u32) {
        self.control.memory().locate(span)
    }

    /// Returns the notes, then the finding that ended the run before its end.
    pub fn findings(&self) -> impl Iterator<Item = Diagnostic> + '_ {
        self.note_findings().chain(self.stop_finding())
    }

    /// Returns the control's notes as findings: actions without an alarm that are probably unintended are warnings.
    pub fn note_findings(&self) -> impl Iterator<Item = Diagnostic> + '_ {
        let of_control = self.control.notes().map(|(note, block)| {
            let (kind, message, help) = note.describe();
            Diagnostic::new(kind, message).with_backtrace(Backtrace { block, calls: None }).help(help)
        });
        self.main_note.iter().cloned().chain(of_control)
    }

    /// Returns the finding that ended the run before its end: an alarm or a limit.
    pub fn stop_finding(&self) -> Option<Diagnostic> {
        match &self.outcome {
            Outcome::End => None,
            Outcome::Alarm(stopped) => {
                let row = stopped.alarm.row();
                let mut finding = Diagnostic::new(row.code.kind, row.message);
                finding.raised = row.code.raised;
                finding.backtrace = Some(stopped.backtrace.clone());
                finding.span = Some(stopped.span);
                finding.help = remedy(&stopped.alarm, stopped.span, self.control.memory().sources()).or_else(
                    || match row.code.raised {
                        // The program's own message is the only help.
                        Some(_) => None,
                        None => Some(format!("run 'gcode-sim explain {}' for the correct form", row.code)),
                    },
                );
                Some(finding)
            }
            Outcome::Limit => Some(self.limit_finding()),
        }
    }

    /// Returns the sentence on an alarm or limit that ended the run before its end, for a list or picture of its holes.
    pub fn stop_sentence(&self) -> Option<String> {
        let sentence = stop_sentence(self.stop_finding().iter(), &|span| self.locate(span));
        sentence.map(|sentence| format!("{sentence}; holes may be missing"))
    }

    fn limit_finding(&self) -> Diagnostic {
        let limit = |message| Diagnostic::new(&LIMIT, message).with_backtrace(self.control.backtrace());
        let Some((first, last)) = self.control.endless_loop() else {
            let (blocks, moves) = (self.control.blocks(), self.control.moves());
            return if self.control.is_cancelled() {
                limit(format!("the run was interrupted after {blocks} blocks and {moves} moves"))
                    .help("results cover the blocks executed so far")
            } else {
                limit(format!("the program has not ended after {blocks} blocks and {moves} moves"))
                    .help("check for a loop that never ends; --max-blocks raises the limit")
            };
        };
        let ((program, from), (other, to)) = (self.locate(first), self.locate(last));
        let to = if program == other { format!("line {to}") } else { format!("line {to} of {other}") };
        let finding = limit(format!(
            "the program never ends: the blocks from line {from} of {program} to {to} repeat without change"
        ));
        match causes::unchanged_counter(&self.control, first, last) {
            Some(why) => {
                finding.note(why).help("check where the step gets its value: a step of 0 makes no progress")
            }
            None => finding.help(causes::endless_help(&self.control, first, last)),
        }
    }
}
