//! Cases of kind `check`: what is found in `case.nc` without running it, each finding with its block and its remedy.
//!
//! Programs it calls stand in the same file. A comment `(@KEY=VALUE)` is a setting of the control.
use std::fmt::Write as _;

use gcode_lang::program::NoLibrary;
use gcode_lang::source::Span;
use gcode_lint::{CheckResult, check};

use crate::{Case, expect};

pub(crate) fn run(case: &Case) {
    let program = case.bytes("case.nc");
    let settings = expect::settings(&program);
    let checked = check("case.nc", program, &settings, &mut NoLibrary);
    let mut shown = String::new();
    for finding in &checked.findings {
        let severity = finding.severity.name();
        if let Some(place) = &finding.backtrace {
            writeln!(shown, "{}", at(&checked, place.block)).unwrap();
        }
        writeln!(shown, "  {severity} {}: {}", finding.code(), finding.message).unwrap();
        for (span, text) in &finding.labels {
            writeln!(shown, "  {text}: {}", at(&checked, *span)).unwrap();
        }
        finding.help.iter().for_each(|help| writeln!(shown, "  help: {help}").unwrap());
    }
    if checked.findings.is_empty() {
        shown.push_str("no findings\n");
    }
    case.snapshot("findings", &shown);
}

fn at(checked: &CheckResult, block: Span) -> String {
    let sources = checked.memory.sources();
    let program = checked.program(block).map_or_else(String::new, |program| program.label());
    format!("{program} line {}: {}", sources.line_column(block).line, sources.text(block).trim())
}
