//! Runs an emitted package as the control would and holds its holes against the job's geometry. What doesn't pass
//! here is not written.
use gcode_sim::diag::Severity;
use gcode_sim::job::Job;
use gcode_sim::machine::Machine;
use gcode_sim::part::reference::Reference;
use gcode_sim::picture::TopView;
use gcode_sim::program::Library;
use gcode_sim::report::{diagnostic, top};
use gcode_sim::session::{Request, Simulation, simulate};
use gcode_sim::verify::{Answer, Tolerances, Verdict};

use crate::package::{Package, file_name};

/// Why the check can't be made at all: the package or the job contradicts itself.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct CheckError(String);

/// A package that was run.
#[derive(Debug)]
pub struct Checked {
    pub verdict: Verdict,
    /// Why it may not be written: findings with their lines, as text for a terminal. Empty where all is well.
    pub refusals: Vec<String>,
    /// Predicted running time, operator stops left out.
    pub seconds: f64,
    /// The holes on the part, for a picture.
    pub top: TopView,
}

/// The package's programs as the control's program memory.
struct Programs<'p>(&'p Package);

impl Library for Programs<'_> {
    fn program(&mut self, number: u32) -> Option<(String, Vec<u8>)> {
        let program = self.0.program(number)?;
        Some((file_name(number), program.text.as_bytes().to_vec()))
    }
}

/// Simulates the main program on the machine of the package's own machine file.
pub fn check(job: &Job, package: &Package) -> Result<Checked, CheckError> {
    let told = |what: &str, error: &dyn std::fmt::Display| CheckError(format!("{what}: {error}"));
    let machine = Machine::parse(&package.machine).map_err(|e| told("machine.toml", &e))?;
    let reference = Reference::of_job(job).map_err(|e| told("the job's reference", &e))?;
    let main = package
        .program(package.main)
        .ok_or_else(|| CheckError(format!("the main program O{} was not emitted", package.main)))?;
    let request = Request::new(file_name(main.number), main.text.as_bytes(), machine.clone());
    let simulation = simulate(&request, &mut Programs(package), reference.surface)
        .map_err(|e| told("the main program", &e))?;
    let tolerances = Tolerances::of(&reference, None);
    let verdict = simulation.verify(&reference, tolerances, &machine);
    let refusals = refusals(job, &simulation, &verdict);
    let top = top::of_verdict(&file_name(main.number), &simulation, &reference, &verdict, &machine);
    Ok(Checked { refusals, seconds: simulation.run.control.seconds().0, top, verdict })
}

/// Every reason with its block; then what rounding has to do with it.
fn refusals(job: &Job, simulation: &Simulation, verdict: &Verdict) -> Vec<String> {
    let sources = simulation.run.control.memory().sources();
    let failed = verdict.diagnostics.iter().filter(|finding| Severity::Error <= finding.severity);
    let mut refusals: Vec<_> = failed.map(|finding| diagnostic::render(finding, sources)).collect();
    let increment = job.control().increment;
    for hole in verdict.holes.iter().filter(|hole| hole.phi > verdict.tolerance) {
        if hole.rounding > verdict.tolerance - (hole.phi - hole.rounding).max(0.0) {
            refusals.push(format!(
                "hole {}: rounding to the least increment of {} mm and degrees alone can make Φ{:.4} here, {} is allowed; \
                 a finer increment or a wider tolerance is needed\n",
                hole.id,
                increment.size(),
                hole.rounding,
                verdict.tolerance
            ));
        }
    }
    if refusals.is_empty() && verdict.verdict == Answer::Fail {
        refusals.push("the programs fail the job's reference\n".to_owned());
    }
    refusals
}
