//! Findings as SARIF 2.1.0 for code reviews, each with its rule, its location and the rule's page.
use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Serialize;

use super::explain;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::source::{Sources, Span};

/// One finding of any command, with its location in a file.
#[derive(Clone, Debug)]
pub(crate) struct Finding {
    /// Name of its rule: a code that `explain` knows.
    pub(crate) code: Cow<'static, str>,
    pub(crate) severity: Severity,
    pub(crate) message: String,
    pub(crate) at: Option<FileLocation>,
    /// Further locations, each with its text.
    pub(crate) related: Vec<(FileLocation, String)>,
}

/// A location in a file; lines and columns count from 1.
#[derive(Clone, Debug)]
pub(crate) struct FileLocation {
    /// The file's name as the user gave it.
    pub(crate) file: String,
    pub(crate) line: Option<u32>,
    pub(crate) column: Option<u32>,
}

impl Finding {
    /// Converts a diagnostic, with its labels and calls as further locations.
    pub(crate) fn of(diagnostic: &Diagnostic, sources: &Sources) -> Self {
        let at = |span: Span| {
            let position = sources.line_column(span);
            let file = sources.get(span.source).name.clone();
            FileLocation { file, line: Some(position.line), column: Some(position.column) }
        };
        let backtrace = diagnostic.backtrace.as_ref();
        let chain =
            std::iter::successors(backtrace.and_then(|backtrace| backtrace.calls.as_deref()), |call| {
                call.outer_calls.as_deref()
            });
        let calls = chain.map(|call| (at(call.calling_block), "called from here".to_owned()));
        let labels = diagnostic.labels.iter().map(|(span, text)| (at(*span), text.clone()));
        let help = diagnostic.help.as_ref().map(|help| format!("; {help}")).unwrap_or_default();
        Self {
            code: diagnostic.code(),
            severity: diagnostic.severity,
            message: format!("{}{help}", diagnostic.message),
            at: diagnostic.span.or(backtrace.map(|backtrace| backtrace.block)).map(at),
            related: labels.chain(calls).collect(),
        }
    }
}

/// A SARIF log with one run.
#[derive(Debug, Serialize)]
pub(crate) struct Log {
    #[serde(rename = "$schema")]
    schema: &'static str,
    version: &'static str,
    runs: [Run; 1],
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Run {
    tool: Tool,
    column_kind: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    invocations: Vec<Invocation>,
    results: Vec<Outcome>,
}

/// The run of the tool: its exit code, and what it means.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Invocation {
    execution_successful: bool,
    exit_code: u8,
    exit_code_description: String,
}

impl Invocation {
    pub(crate) fn new(exit_code: u8, exit_code_description: String) -> Self {
        Self { execution_successful: true, exit_code, exit_code_description }
    }
}

#[derive(Debug, Serialize)]
struct Tool {
    driver: Driver,
}

#[derive(Debug, Serialize)]
struct Driver {
    name: &'static str,
    version: &'static str,
    rules: Vec<Rule>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Rule {
    id: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    short_description: Option<Text>,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<Help>,
}

#[derive(Debug, Serialize)]
struct Text {
    text: String,
}

#[derive(Debug, Serialize)]
struct Help {
    text: String,
    markdown: String,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Outcome {
    rule_id: String,
    rule_index: usize,
    level: &'static str,
    message: Text,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    locations: Vec<Location>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    related_locations: Vec<Location>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Location {
    physical_location: Physical,
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<Text>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Physical {
    artifact_location: Artifact,
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Region>,
}

#[derive(Debug, Serialize)]
struct Artifact {
    uri: String,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    start_column: Option<u32>,
}

/// Builds the log of all findings, of a verdict with its conclusion. Files below `root`, the working directory, have
/// relative names.
pub(crate) fn log(findings: &[Finding], conclusion: Option<Invocation>, root: &str) -> Log {
    let mut indices: BTreeMap<&str, usize> = findings.iter().map(|finding| (&*finding.code, 0)).collect();
    indices.values_mut().enumerate().for_each(|(number, index)| *index = number);
    let rules = indices.keys().map(|code| rule(code)).collect();
    let outcome = |finding: &Finding| Outcome {
        rule_id: finding.code.to_string(),
        rule_index: indices[&*finding.code],
        level: match finding.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error | Severity::Alarm => "error",
        },
        message: Text { text: finding.message.clone() },
        locations: finding.at.iter().map(|at| location(at, None, root)).collect(),
        related_locations: finding.related.iter().map(|(at, text)| location(at, Some(text), root)).collect(),
    };
    let driver = Driver { name: "gcode-sim", version: env!("CARGO_PKG_VERSION"), rules };
    let run = Run {
        tool: Tool { driver },
        column_kind: "unicodeCodePoints",
        invocations: conclusion.into_iter().collect(),
        results: findings.iter().map(outcome).collect(),
    };
    Log { schema: "https://json.schemastore.org/sarif-2.1.0.json", version: "2.1.0", runs: [run] }
}

fn rule(code: &str) -> Rule {
    let pages: Vec<explain::Page> = explain::pages(code).collect();
    let joined = |text: fn(&str) -> String| {
        pages.iter().map(|page| text(page.text).trim_end().to_owned()).collect::<Vec<_>>().join("\n\n")
    };
    Rule {
        id: code.to_owned(),
        short_description: pages.first().map(|page| Text { text: page.title.to_owned() }),
        help: (!pages.is_empty())
            .then(|| Help { text: joined(explain::plain_text), markdown: joined(str::to_owned) }),
    }
}

fn location(at: &FileLocation, text: Option<&String>, root: &str) -> Location {
    let region = at.line.map(|line| Region { start_line: line, start_column: at.column });
    Location {
        physical_location: Physical { artifact_location: Artifact { uri: uri(&at.file, root) }, region },
        message: text.map(|text| Text { text: text.clone() }),
    }
}

/// Returns a file's name as a URI: relative if it lies below `root`, else absolute with its scheme.
fn uri(file: &str, root: &str) -> String {
    let (file, root) = (file.replace('\\', "/"), root.replace('\\', "/"));
    let below = file.strip_prefix(root.trim_end_matches('/')).and_then(|rest| rest.strip_prefix('/'));
    let mut path = below.filter(|_| !root.is_empty()).unwrap_or(&file);
    while let Some(rest) = path.strip_prefix("./") {
        path = rest;
    }
    let mut uri = match path.as_bytes() {
        [b'/', ..] => "file://".to_owned(),
        // A drive letter would be read as a scheme.
        [_, b':', ..] => "file:///".to_owned(),
        _ => String::new(),
    };
    let is_drive = uri.len() == "file:///".len();
    for (number, byte) in path.bytes().enumerate() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(char::from(byte));
            }
            b':' if is_drive && number == 1 => uri.push(':'),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_are_relative_to_the_working_directory() {
        for (file, expected) in [
            ("parts/O1.nc", "parts/O1.nc"),
            ("./parts/O1.nc", "parts/O1.nc"),
            ("/shop/nc/parts/O1.nc", "parts/O1.nc"),
            ("/shop/ncs/O1.nc", "file:///shop/ncs/O1.nc"),
            ("parts\\O1.nc", "parts/O1.nc"),
            ("C:\\shop\\O1.nc", "file:///C:/shop/O1.nc"),
            ("flange 6\u{b0}.nc", "flange%206%C2%B0.nc"),
            ("plate:2.nc", "plate%3A2.nc"),
            ("standard input", "standard%20input"),
        ] {
            assert_eq!(uri(file, "/shop/nc"), expected, "{file}");
        }
        assert_eq!(uri("/O1.nc", ""), "file:///O1.nc");
        assert_eq!(uri("/O1.nc", "/"), "O1.nc");
    }
}
