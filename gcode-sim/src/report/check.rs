//! The result of `check`: findings with their locations, and a line that counts them.
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::diagnostic;
use super::figures::count;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::source::{Sources, Span};
use gcode_lint::CheckResult;

/// The document of `check --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct CheckReport {
    /// Number of programs checked, called ones included.
    pub(crate) programs: usize,
    pub(crate) findings: Vec<FindingReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct FindingReport {
    /// The rule's name.
    pub(crate) code: String,
    pub(crate) severity: &'static str,
    pub(crate) message: String,
    pub(crate) program: Option<String>,
    pub(crate) file: Option<String>,
    pub(crate) line: Option<u32>,
    pub(crate) column: Option<u32>,
    /// The block's text.
    pub(crate) block: Option<String>,
    pub(crate) help: Option<String>,
    /// Secondary locations: the start of a loop, a call.
    pub(crate) labels: Vec<LabelReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct LabelReport {
    pub(crate) file: String,
    pub(crate) line: u32,
    pub(crate) text: String,
}

impl CheckReport {
    pub(crate) fn new(checked: &CheckResult) -> Self {
        let findings = checked.findings.iter().map(|finding| report(checked, finding)).collect();
        Self { programs: checked.programs, findings }
    }
}

fn report(checked: &CheckResult, finding: &Diagnostic) -> FindingReport {
    let sources = checked.memory.sources();
    let block = finding.backtrace.as_ref().map(|backtrace| backtrace.block);
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

/// Number of lines that a folded finding names.
const LINES_SHOWN: usize = 12;

/// Formats the findings and their count for a terminal; each kind once for each file, or with `shows_all` at each place.
pub(crate) fn text(checked: &CheckResult, shows_all: bool) -> String {
    let sources = checked.memory.sources();
    let folded;
    let findings = match shows_all {
        true => &checked.findings,
        false => {
            folded = fold(&checked.findings, sources);
            &folded
        }
    };
    let mut text: String =
        findings.iter().map(|finding| diagnostic::render(finding, sources) + "\n").collect();
    text.push_str(&summary(checked));
    text.push('\n');
    text
}

/// Rule each finding of which names another program.
const MISSING_PROGRAM: &str = "missing-program";

/// Returns the first finding of each kind and severity in each file, with the lines of the others in a note. Each error has
/// to be corrected, and each missing program to be found: those of one kind have one message and one remedy.
fn fold(findings: &[Diagnostic], sources: &Sources) -> Vec<Diagnostic> {
    let mut groups: BTreeMap<_, (usize, Vec<u32>)> = BTreeMap::new();
    let mut firsts = Vec::new();
    for finding in findings {
        let at = finding.span.or(finding.backtrace.as_ref().map(|backtrace| backtrace.block));
        let is_separate = finding.severity == Severity::Error || finding.kind.code == MISSING_PROGRAM;
        let error = is_separate.then(|| (finding.message.clone(), finding.help.clone()));
        let key = (finding.kind.code, finding.severity, at.map(|span| span.source), error);
        match groups.get_mut(&key) {
            Some((_, lines)) => lines.extend(at.map(|span| sources.line_column(span).line)),
            None => {
                groups.insert(key, (firsts.len(), Vec::new()));
                firsts.push(finding.clone());
            }
        }
    }
    for (first, mut lines) in groups.into_values().filter(|(_, lines)| !lines.is_empty()) {
        let more = count(lines.len(), "more finding");
        lines.dedup();
        let shown: Vec<_> = lines.iter().take(LINES_SHOWN).map(u32::to_string).collect();
        let rest = if lines.len() > LINES_SHOWN { " …" } else { "" };
        let line = if lines.len() == 1 { "line" } else { "lines" };
        let note = format!("{more} of this kind in {line} {}{rest} (--all: each)", shown.join(", "));
        firsts[first].notes.push(note);
    }
    firsts
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
