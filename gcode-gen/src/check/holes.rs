//! Runs the programs of a part with holes and verifies the holes against the job's geometry.
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, Tolerances, Verdict};
use gcode_lang::diag::Severity;
use gcode_part::Reference;
use gcode_part::job::Job;
use gcode_part::overlaps;
use gcode_session::{Request, Simulation, simulate};
use gcode_sim::report::verdict_table::{Layout, table};
use gcode_sim::report::{diagnostic, top};

use super::{CheckError, CheckedPackage, PackageVerdict, Programs, broken_package, main_program, warnings};
use crate::package::{Package, file_name, stem};

pub(super) fn check(
    job: &Job,
    package: &Package,
    reference: &Reference,
) -> Result<CheckedPackage, CheckError> {
    let machine = Machine::parse(&package.machine).map_err(|e| broken_package("machine.toml", &e))?;
    let main = main_program(package)?;
    let mut request = Request::new(file_name(main.number), main.text.as_bytes(), machine.clone());
    request.conduct = reference.process_limits.clone();
    let simulation = simulate(&request, &mut Programs(package), reference.surface)
        .map_err(|e| broken_package("the main program", &e))?;
    let tolerances = Tolerances::of(reference, None);
    let verdict = simulation.verify(reference, tolerances, &machine);
    let top = top::of_verdict(&file_name(main.number), &simulation, reference, &verdict, &machine);
    Ok(CheckedPackage {
        refusals: refusals(job, reference, &simulation, &verdict),
        warnings: warnings(&verdict.diagnostics, simulation.run.control.memory().sources()),
        seconds: simulation.run.control.seconds().0,
        report: table(&verdict, Layout::default()),
        pictures: vec![(stem(main.number), gcode_draw::main_view(&top))],
        verdict: PackageVerdict::Holes(verdict),
    })
}

/// Returns every error with its block, then the share of rounding in position errors.
fn refusals(job: &Job, reference: &Reference, simulation: &Simulation, verdict: &Verdict) -> Vec<String> {
    let sources = simulation.run.control.memory().sources();
    let failed = verdict.diagnostics.iter().filter(|finding| Severity::Error <= finding.severity);
    let mut refusals: Vec<_> = failed.map(|finding| diagnostic::render(finding, sources)).collect();
    // A pattern checks for overlaps before it computes any holes.
    if reference.pattern.is_none() {
        let cut = overlaps(&reference.holes);
        refusals.extend(cut.iter().map(|overlap| format!("error: {}\n", overlap.sentence(&reference.holes))));
    }
    let increment = job.control().increment;
    for hole in verdict.holes.iter().filter(|hole| hole.position_deviation > verdict.tolerance) {
        if hole.rounding > verdict.tolerance - (hole.position_deviation - hole.rounding).max(0.0) {
            refusals.push(format!(
                "hole {}: rounding to the least increment of {} mm and degrees alone can cause Φ{:.4} \
                 here, tolerance Φ{}; use a finer increment or a wider tolerance\n",
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
