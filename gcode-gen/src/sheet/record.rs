//! Record of a run for the operator: tools, stops in order, and times.
use gcode_control::Outcome;
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::machine::Machine;
use gcode_lang::motion::{Backtrace, Event, EventKind, EventSink, StopKind};
use gcode_part::Surface;
use gcode_part::job::Job;
use gcode_session::{Request, Run, SessionError, run};

use crate::check::{CheckError, Programs, broken_package};
use crate::families::alignment;
use crate::package::{Package, file_name, stem};

/// Common variables that a control keeps between programs and while it is switched off.
const KEPT_VARIABLES: std::ops::RangeInclusive<u32> = 500..=999;

/// Record of the run of all main programs.
#[derive(Debug, Default)]
pub(super) struct Record {
    /// Each main program with the kept common variables at its first start.
    pub program_starts: Vec<ProgramStart>,
    pub stops: Vec<OperatorStop>,
    /// Tool numbers of all M06, in order.
    pub tools: Vec<u32>,
    pub times: MotionTimes,
    /// M codes that are left to the machine builder.
    pub auxiliary_codes: Vec<u32>,
    /// Main programs that end in an alarm on a part in its nominal position.
    pub alarmed_programs: Vec<String>,
    /// Rapid rates of the times: of linear axes, mm/min, and of rotary axes, degrees/min.
    pub rapids: [f64; 2],
}

/// A main program, and the variables that earlier ones left.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ProgramStart {
    pub main: u32,
    pub variables: Vec<(u32, f64)>,
}

/// An operator stop.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OperatorStop {
    pub kind: StopKind,
    pub text: String,
    /// Variables that the text names, with their values.
    pub variables: Vec<(u32, f64)>,
    /// Tool in the spindle.
    pub tool: Option<u32>,
    /// Running time before the stop, seconds.
    pub elapsed: f64,
    /// The block that stops and its callers: program and line, innermost first.
    pub locations: Vec<(String, u32)>,
}

/// Times in seconds: paths over feeds and rapid rates, without acceleration, stops and tool changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotionTimes {
    pub rapid: f64,
    pub feed: f64,
    pub dwell: f64,
}

impl MotionTimes {
    pub(super) fn total(&self) -> f64 {
        self.rapid + self.feed + self.dwell
    }
}

/// Runs the package's main programs on its own machine file in the order of the work. Each starts with the
/// common variables that the previous one left: O8230 reads results of O8210.
///
/// # Errors
/// [`CheckError::Broken`] if the package contradicts itself, which [`crate::check::check`] refuses before.
pub(super) fn record(job: &Job, package: &Package) -> Result<Record, CheckError> {
    let mut listener = RunRecorder::default();
    let mut record = Record::default();
    let mut kept = Vec::new();
    let order = match job {
        Job::Alignment(_) => alignment::run_order(&package.mains),
        Job::PinHoles(_) | Job::Honeycomb(_) | Job::Burr(_) | Job::Pattern(_) => package.mains.clone(),
    };
    for main in order {
        let begin = ProgramStart { main, variables: std::mem::take(&mut kept) };
        let request = request(package, &begin)?;
        record.rapids = [request.settings.rapid.0, request.settings.rapid_rotary];
        let run = run_with_part(job, package, &request, &mut listener)
            .map_err(|error| broken_package(&file_name(main), &error))?;
        if !matches!(run.outcome, Outcome::End) {
            record.alarmed_programs.push(stem(main));
        }
        kept.extend(run.control.variables().filter(|(number, _)| KEPT_VARIABLES.contains(number)));
        let stops = listener.stops.drain(..);
        record.stops.extend(
            stops.map(|(stop, place)| OperatorStop { locations: block_locations(&run, &place), ..stop }),
        );
        record.auxiliary_codes.extend(run.control.builder_m_codes().keys());
        if record.program_starts.iter().all(|earlier| earlier.main != main) {
            record.program_starts.push(begin);
        }
    }
    record.alarmed_programs.dedup();
    record.auxiliary_codes.sort_unstable();
    record.auxiliary_codes.dedup();
    Ok(Record { tools: listener.tools, times: listener.times, ..record })
}

/// Runs a program with the part on the machine, if the program touches it.
pub(super) fn run_with_part<S: EventSink>(
    job: &Job,
    package: &Package,
    request: &Request,
    sink: &mut S,
) -> Result<Run, SessionError> {
    match job {
        Job::Alignment(job) => {
            let surface = Surface::Ellipsoid { a: job.surface.a, b: job.surface.b };
            let mut probe = HoleExtractor::new(&request.machine).with_surface(Some(surface));
            run(request, &mut Programs(package), &mut (&mut probe, sink))
        }
        Job::PinHoles(_) | Job::Honeycomb(_) | Job::Burr(_) | Job::Pattern(_) => {
            run(request, &mut Programs(package), sink)
        }
    }
}

/// Builds the request to run a main program on the package's own machine file.
pub(super) fn request(package: &Package, begin: &ProgramStart) -> Result<Request, CheckError> {
    let main = begin.main;
    let machine = Machine::parse(&package.machine).map_err(|e| broken_package("machine.toml", &e))?;
    let program =
        package.program(main).ok_or_else(|| broken_package(&file_name(main), &"it was not emitted"))?;
    let request = Request::new(file_name(main), program.text.as_bytes(), machine);
    Ok(Request { variables: begin.variables.clone(), ..request })
}

fn block_locations(run: &Run, place: &Backtrace) -> Vec<(String, u32)> {
    let calls = std::iter::successors(place.calls.as_deref(), |call| call.outer_calls.as_deref());
    std::iter::once(place.block)
        .chain(calls.map(|call| call.calling_block))
        .map(|span| run.locate(span))
        .collect()
}

#[derive(Default)]
struct RunRecorder {
    stops: Vec<(OperatorStop, Backtrace)>,
    tools: Vec<u32>,
    times: MotionTimes,
}

impl EventSink for RunRecorder {
    fn event(&mut self, event: &Event<'_>) {
        let seconds = event.seconds.0;
        match &event.kind {
            EventKind::Rapid { .. } => self.times.rapid += seconds,
            EventKind::Feed { .. } | EventKind::Arc { .. } | EventKind::Skip { .. } => {
                self.times.feed += seconds;
            }
            EventKind::Dwell { .. } => self.times.dwell += seconds,
            EventKind::ToolChange { number } => self.tools.push(*number),
            EventKind::Stop { kind, text, variables } => {
                let stop = OperatorStop {
                    kind: *kind,
                    text: text.clone(),
                    variables: variables.clone(),
                    tool: self.tools.last().copied(),
                    elapsed: self.times.total(),
                    locations: Vec::new(),
                };
                self.stops.push((stop, event.backtrace()));
            }
            EventKind::ToolLength { .. }
            | EventKind::Start { .. }
            | EventKind::PositionUnknown { .. }
            | EventKind::Spindle { .. }
            | EventKind::ToolSelected { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. } => {}
        }
    }
}
