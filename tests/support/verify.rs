//! Cases of kind `verify`: a program held against a reference, as the inspector's table and the findings say it.
//!
//! `case.nc` is the program (programs it calls stand in the same file), `reference.toml`, `.csv` or `.json` what is
//! wanted (holes, or a burr's flutes), `machine.toml`, where there is one, the machine. Where there is no reference the holes are shown.
use std::fmt::Write as _;

use gcode_inspect::machine::Machine;
use gcode_inspect::verify::Tolerances;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Call;
use gcode_lang::program::NoLibrary;
use gcode_part::NominalPart;
use gcode_session::{Request, Run, Simulation, grind, simulate};
use gcode_sim::report::flute_table;
use gcode_sim::report::verdict_table::{Layout, table};

use crate::Case;

pub(crate) fn run(case: &Case) {
    let machine =
        case.optional("machine.toml").map_or_else(Machine::default, |text| Machine::parse(&text).unwrap());
    let mut request = Request::new("case.nc", case.bytes("case.nc"), machine.clone());
    let files = ["reference.toml", "reference.csv", "reference.json"];
    let wanted =
        files.iter().find_map(|name| case.optional(name)).map(|text| NominalPart::parse(&text).unwrap());
    if let Some(NominalPart::Flutes(flutes)) = &wanted {
        let grinding = grind(&request, &mut NoLibrary, flutes).unwrap();
        let verdict = grinding.verify();
        let shown = flute_table::table(&verdict);
        return case.snapshot("verdict", &with_findings(shown, &verdict.diagnostics, &grinding.run));
    }
    let reference = wanted.and_then(NominalPart::into_holes);
    let surface = reference.as_ref().and_then(|reference| reference.surface);
    request.conduct = reference.as_ref().map(|reference| reference.conduct.clone()).unwrap_or_default();
    let simulation = simulate(&request, &mut NoLibrary, surface).unwrap();
    let (shown, findings) = match &reference {
        Some(reference) => {
            let verdict = simulation.verify(reference, Tolerances::of(reference, None), &machine);
            (table(&verdict, Layout::default()), verdict.diagnostics)
        }
        None => (holes(&simulation), simulation.extracted.findings.clone()),
    };
    case.snapshot("verdict", &with_findings(shown, &findings, &simulation.run));
}

/// The table and what was found, with its places.
fn with_findings(mut shown: String, findings: &[Diagnostic], run: &Run) -> String {
    for finding in findings {
        let severity = finding.severity.name();
        write!(shown, "\n{severity} {}: {}\n", finding.code, finding.message).unwrap();
        if let Some(place) = &finding.place {
            writeln!(shown, "  at {}", at(run, place.block)).unwrap();
            let mut next: Option<&Call> = place.calls.as_deref();
            while let Some(call) = next {
                writeln!(shown, "  called from {}", at(run, call.from)).unwrap();
                next = call.outer.as_deref();
            }
        }
        finding.notes.iter().for_each(|note| writeln!(shown, "  {note}").unwrap());
        finding.help.iter().for_each(|help| writeln!(shown, "  help: {help}").unwrap());
    }
    shown
}

fn at(run: &Run, block: gcode_lang::source::Span) -> String {
    let (program, line) = run.locate(block);
    let text = run.control.memory().sources().text(block);
    format!("{program} line {line}: {}", text.trim())
}

fn holes(simulation: &Simulation) -> String {
    let mut text = String::new();
    for hole in simulation.list().holes {
        let [x, y, z] = hole.entry.map(|v| format!("{:.3}", v + 0.0));
        let [i, j, k] = hole.axis.map(|v| format!("{:.4}", v + 0.0));
        let from = hole.from.unwrap();
        let tool = from.tool.map_or(String::new(), |tool| format!(", T{tool}"));
        let depth = hole.depth;
        let line = format!(
            "hole from {x} {y} {z}, axis {i} {j} {k}, {depth:.3} deep: {} line {}{tool}",
            from.program, from.line
        );
        writeln!(text, "{}", line.replace("-0.000 ", "0.000 ").replace("-0.0000", "0.0000")).unwrap();
    }
    text
}
