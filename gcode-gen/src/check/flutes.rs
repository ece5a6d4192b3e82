//! Runs the programs of a burr and verifies the flutes against the job's geometry.
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::Answer;
use gcode_lang::diag::Severity;
use gcode_part::Flutes;
use gcode_session::{Request, grind};
use gcode_sim::report::{diagnostic, flute_table, flute_view};

use super::{CheckError, CheckedPackage, PackageVerdict, Programs, broken_package, main_program, warnings};
use crate::package::{Package, file_name, stem};

pub(super) fn check(package: &Package, wanted: &Flutes) -> Result<CheckedPackage, CheckError> {
    let machine = Machine::parse(&package.machine).map_err(|e| broken_package("machine.toml", &e))?;
    let main = main_program(package)?;
    let request = Request::new(file_name(main.number), main.text.as_bytes(), machine);
    let grinding = grind(&request, &mut Programs(package), wanted)
        .map_err(|e| broken_package("the main program", &e))?;
    let verdict = grinding.verify();
    let sources = grinding.run.control.memory().sources();
    let failed = verdict.diagnostics.iter().filter(|finding| Severity::Error <= finding.severity);
    let mut refusals: Vec<_> = failed.map(|finding| diagnostic::render(finding, sources)).collect();
    if refusals.is_empty() && verdict.verdict == Answer::Fail {
        refusals.push("the programs fail the job's reference\n".to_owned());
    }
    let view = flute_view::of(&file_name(main.number), &grinding, &verdict);
    Ok(CheckedPackage {
        refusals,
        warnings: warnings(&verdict.diagnostics, sources),
        seconds: grinding.run.control.seconds().0,
        report: flute_table::table(&verdict),
        pictures: vec![
            (stem(main.number), gcode_draw::side_view(&view)),
            (format!("{}-tip", stem(main.number)), gcode_draw::tip_view(&view)),
            (format!("{}-helix", stem(main.number)), gcode_draw::helix_graph(&view)),
        ],
        verdict: PackageVerdict::Flutes(verdict),
    })
}
