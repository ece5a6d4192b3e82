//! The result of `check`: findings with their places, and a line that counts them.
use schemars::JsonSchema;
use serde::Serialize;

use super::diagnostic;
use super::figures::count;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::source::Span;
use gcode_lint::CheckResult;

/// The document of `check --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CheckReport {
    /// Number of programs checked, called ones included.
    pub programs: usize,
    pub findings: Vec<FindingReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub struct FindingReport {
    /// The rule's name.
    pub code: String,
    pub severity: &'static str,
    pub message: String,
    pub program: Option<String>,
    pub file: Option<String>,
    pub line: Option<u32>,
    pub column: Option<u32>,
    /// The block's text.
    pub block: Option<String>,
    pub help: Option<String>,
    /// Secondary locations: the start of a loop, a call.
    pub labels: Vec<LabelReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub struct LabelReport {
    pub file: String,
    pub line: u32,
    pub text: String,
}

impl CheckReport {
    pub fn new(checked: &CheckResult) -> Self {
        let findings = checked.findings.iter().map(|finding| report(checked, finding)).collect();
        Self { programs: checked.programs, findings }
    }
}

fn report(checked: &CheckResult, finding: &Diagnostic) -> FindingReport {
    let sources = checked.memory.sources();
    let block = finding.backtrace.as_ref().map(|place| place.block);
    let at = finding.span.or(block);
    let file = |span: Span| sources.get(span.source).name.clone();
    FindingReport {
        code: finding.code().into_owned(),
        severity: finding.severity.name(),
        message: finding.message.clone(),
        program: block.and_then(|span| checked.program(span)).map(|program| program.label()),
        file: at.map(file),
        line: at.map(|span| sources.line_column(span).line),
        column: at.map(|span| sources.line_column(span).column),
        block: block.map(|span| sources.text(span).trim().to_owned()),
        help: finding.help.clone(),
        labels: finding
            .labels
            .iter()
            .map(|(span, text)| LabelReport {
                file: file(*span),
                line: sources.line_column(*span).line,
                text: text.clone(),
            })
            .collect(),
    }
}

/// Formats the findings and their count for a terminal.
pub fn text(checked: &CheckResult) -> String {
    let sources = checked.memory.sources();
    let mut text: String =
        checked.findings.iter().map(|finding| diagnostic::render(finding, sources) + "\n").collect();
    text.push_str(&summary(checked));
    text.push('\n');
    text
}

/// Returns `2 programs checked: 1 error, 2 warnings`.
fn summary(checked: &CheckResult) -> String {
    let counts = [Severity::Error, Severity::Warning, Severity::Note].map(|s| (checked.count(s), s.name()));
    let counts: Vec<_> = counts
        .into_iter()
        .filter(|(number, _)| 0 < *number)
        .map(|(number, name)| count(number, name))
        .collect();
    let found = if counts.is_empty() { "no findings".to_owned() } else { counts.join(", ") };
    format!("{} checked: {found}", count(checked.programs, "program"))
}
