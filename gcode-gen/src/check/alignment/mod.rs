//! Trials of the alignment programs on simulated parts of known misplacement: a program that does not
//! determine it is not written.
mod chord;
mod ellipse;
mod runout;
mod search;
mod sine;

use std::fmt::Display;

use gcode_control::Value;
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::machine::{Machine, Placement};
use gcode_lang::diag::Severity;
use gcode_part::Surface;
use gcode_part::job::Alignment;
use gcode_session::{Request, Run, run};
use gcode_sim::report::diagnostic;

use super::{CheckError, CheckedPackage, PackageVerdict, Programs, broken_package};
use crate::families::alignment;
use crate::package::{Package, file_name};

/// Result of one program's trial, as text for the terminal: a line of the report, refusals and warnings.
struct TrialResult {
    /// File name of the program, before each message.
    name: String,
    report: String,
    refusals: Vec<String>,
    warnings: Vec<String>,
    /// Time of one run, seconds.
    seconds: f64,
}

impl TrialResult {
    fn refuse(&mut self, message: impl Display) {
        self.refusals.push(format!("{}: {message}\n", self.name));
    }

    fn warn(&mut self, message: impl Display) {
        self.warnings.push(format!("warning: {}: {message}\n", self.name));
    }

    fn report(&mut self, message: impl Display) {
        self.report = format!("{}  {message}\n", self.name);
    }
}

type Trial = fn(&TrialProgram<'_>) -> Result<TrialResult, CheckError>;

/// The trial of each main program.
const TRIALS: &[(u32, Trial)] = &[
    (alignment::RUNOUT, runout::run_trial),
    (alignment::SINE_TABLE, sine::run_trial),
    (alignment::CHORD, chord::run_trial),
    (alignment::ELLIPSE, ellipse::run_trial),
];

pub(super) fn check(job: &Alignment, package: &Package) -> Result<CheckedPackage, CheckError> {
    let mut checked = CheckedPackage {
        refusals: Vec::new(),
        warnings: Vec::new(),
        seconds: 0.0,
        report: String::new(),
        pictures: Vec::new(),
        verdict: PackageVerdict::Measured,
    };
    for main in &package.mains {
        let trial = TRIALS.iter().find(|(number, _)| number == main);
        let (_, trial) = trial.ok_or_else(|| broken_package(&file_name(*main), &"it has no trial"))?;
        let tried = trial(&TrialProgram { job, package, main: *main })?;
        checked.refusals.extend(tried.refusals);
        checked.warnings.extend(tried.warnings);
        // The sheet counts the same runs.
        let runs = alignment::run_order(&package.mains).iter().filter(|run| *run == main).count();
        checked.seconds += tried.seconds * runs as f64;
        checked.report.push_str(&tried.report);
        if 1 < runs {
            let again =
                "runs once more after the sine table has moved the part; the running time counts both";
            checked.report.push_str(&format!("{}  {again}\n", file_name(*main)));
        }
    }
    Ok(checked)
}

/// One main program of a package, to be run on parts in various positions.
struct TrialProgram<'p> {
    job: &'p Alignment,
    package: &'p Package,
    main: u32,
}

impl TrialProgram<'_> {
    fn name(&self) -> String {
        file_name(self.main)
    }

    /// Returns a result without messages.
    fn result(&self) -> TrialResult {
        let (refusals, warnings) = (Vec::new(), Vec::new());
        TrialResult { name: self.name(), report: String::new(), refusals, warnings, seconds: 0.0 }
    }

    fn surface(&self) -> Surface {
        Surface::Ellipsoid { a: self.job.surface.a, b: self.job.surface.b }
    }

    fn broken(&self, error: &dyn Display) -> CheckError {
        broken_package(&self.name(), error)
    }

    /// Returns the machine of the package's own machine file.
    fn machine(&self) -> Result<Machine, CheckError> {
        Machine::parse(&self.package.machine).map_err(|e| broken_package("machine.toml", &e))
    }

    /// Builds the request to run the program on that machine with the part misplaced.
    fn request(&self, part: Placement) -> Result<Request, CheckError> {
        let machine = Machine { part, ..self.machine()? };
        let main = self.package.program(self.main).ok_or_else(|| self.broken(&"it was not emitted"))?;
        Ok(Request::new(self.name(), main.text.as_bytes(), machine))
    }

    fn programs(&self) -> Programs<'_> {
        Programs(self.package)
    }

    /// Runs the program with variables set before the start.
    fn run(&self, part: Placement, variables: Vec<(u32, f64)>) -> Result<Run, CheckError> {
        let mut request = self.request(part)?;
        request.variables = variables;
        let mut probe = HoleExtractor::new(&request.machine).with_surface(Some(self.surface()));
        run(&request, &mut self.programs(), &mut probe).map_err(|e| self.broken(&e))
    }

    /// Returns the reasons to reject a run, for a terminal: warnings, an alarm, or a limit.
    fn stop_messages(&self, run: &Run) -> Vec<String> {
        let sources = run.control.memory().sources();
        let findings = run.findings().filter(|finding| Severity::Warning <= finding.severity);
        findings.map(|finding| diagnostic::render(&finding, sources)).collect()
    }
}

/// Returns a variable after a run; a vacant one is NaN.
fn common_variable(run: &Run, number: u32) -> f64 {
    match run.control.variable(number) {
        Ok(Value::Number(value)) => value,
        Ok(Value::Vacant) | Err(_) => f64::NAN,
    }
}
