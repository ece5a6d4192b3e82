//! Findings of `check` as diagnostics of the protocol.
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use gcode_lang::diag::{Diagnostic as Finding, Severity};
use gcode_lang::motion::{Backtrace, CallChain};
use gcode_lang::source::{SourceId, Sources, Span};
use gcode_lint::{CONTROL_ASSUMED, CheckResult, CheckedBlocks, FindingLimit};
use lsp_types::{
    CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location,
    NumberOrString, Range, Uri,
};

use crate::client::Client;
use crate::document_uri;
use crate::host::Host;
use crate::overlay::Overlay;
use crate::program_setup::ProgramSetup;
use crate::text_document::TextDocument;

/// Source of all diagnostics.
pub(crate) const SOURCE: &str = "gcode-sim";

/// Largest number of diagnostics of a document.
const MAX_DIAGNOSTICS: usize = 1000;

/// Result of a check of one document.
#[derive(Debug)]
pub(crate) struct CheckedDocument {
    pub diagnostics: Vec<Diagnostic>,
    /// Files of the called programs.
    pub called: BTreeSet<PathBuf>,
    /// Files of the configuration, existing or not, and folders of called programs.
    pub surroundings: BTreeSet<PathBuf>,
    /// Stamps of all these files, from before they were read.
    pub stamps: BTreeMap<PathBuf, Option<u64>>,
    /// Faults of the configuration.
    pub faults: Vec<String>,
    /// The document belongs to the project of a gcode.toml.
    pub is_in_project: bool,
}

/// Returns the stamps of the files on which the conditions of a program rest.
pub(crate) fn stamps(setup: &ProgramSetup, files: &Overlay) -> BTreeMap<PathBuf, Option<u64>> {
    let paths = setup.dependencies().chain(setup.folders());
    paths.map(|path| (path.clone(), files.host().stamp(&path))).collect()
}

/// Checks a document with the programs that it calls; `before` are the blocks of an earlier state of its text. The second part
/// of the result is to be dropped once the first is used: that takes as long as some rules.
pub(crate) fn check(
    uri: &Uri,
    document: &TextDocument,
    before: CheckedBlocks,
    (setup, mut stamps): (&ProgramSetup, BTreeMap<PathBuf, Option<u64>>),
    files: &Overlay,
    client: &Client,
) -> (CheckedDocument, CheckResult) {
    let surroundings: BTreeSet<_> = setup.dependencies().chain(setup.folders()).collect();
    let mut library = setup.library(files);
    let text = (setup.path.display().to_string(), document.bytes().clone());
    let control = (&setup.settings, setup.knowledge);
    let is_of_document = |finding: &Finding| place(finding).is_none_or(|span| span.source == SourceId(0));
    let is_allowed = |finding: &Finding| setup.project.allows(finding.kind.code, &setup.path, files);
    // A note without a remedy states a limit of the simulator, no fault of the program; but the run stops at an alarm that
    // an option of the control would take away.
    let is_optional = |finding: &Finding| finding.notes.iter().any(|note| note == CONTROL_ASSUMED);
    let is_fault = |finding: &Finding| {
        Severity::Note < finding.severity || finding.help.is_some() || is_optional(finding)
    };
    let is_shown = |finding: &Finding| is_of_document(finding) && is_fault(finding) && !is_allowed(finding);
    let limit = FindingLimit { of_kind: MAX_DIAGNOSTICS, is_shown: &is_shown };
    let checked = gcode_lint::check_edited(text, before, control, limit, &mut library);
    let sources = checked.memory.sources();
    let context =
        FindingContext { uri, document, sources, client, host: files.host(), pages: RefCell::default() };
    let shown: Vec<_> = checked.findings.iter().filter(|finding| is_shown(finding)).collect();
    let mut diagnostics: Vec<_> =
        shown.iter().take(MAX_DIAGNOSTICS).map(|finding| context.diagnostic(finding)).collect();
    let more = (shown.len() + checked.left_over).saturating_sub(MAX_DIAGNOSTICS);
    if 0 < more {
        let message = format!("{more} more findings are not shown: gcode-sim check lists them");
        let source = Some(SOURCE.to_owned());
        diagnostics.push(Diagnostic { message, source, ..Diagnostic::default() });
    }
    let called = sources.iter().skip(1).map(|(_, source)| PathBuf::from(&source.name));
    let called: BTreeSet<_> = called.collect();
    stamps.extend(called.iter().map(|path| (path.clone(), files.read_stamp(path))));
    let document = CheckedDocument {
        diagnostics,
        called,
        stamps,
        surroundings,
        faults: setup.faults.iter().chain(&setup.job_fault).cloned().collect(),
        is_in_project: setup.project.folder().is_some(),
    };
    (document, checked)
}

/// Returns the exact place of a finding. One between two characters, where an editor marks nothing, has its block. One in another
/// file that a call of the document decides has that call: it is found in no check of the other file.
fn place(finding: &Finding) -> Option<Span> {
    let own = own_place(finding);
    let is_here = own.is_none_or(|span| span.source == SourceId(0));
    let call = || finding.labels.iter().map(|(span, _)| *span).find(|span| span.source == SourceId(0));
    own.filter(|_| is_here).or_else(call).or(own)
}

fn own_place(finding: &Finding) -> Option<Span> {
    let block = finding.backtrace.as_ref().map(|backtrace| backtrace.block);
    finding.span.filter(|span| span.start < span.end).or(block).or(finding.span)
}

struct FindingContext<'a> {
    uri: &'a Uri,
    document: &'a TextDocument,
    sources: &'a Sources,
    client: &'a Client,
    host: &'a dyn Host,
    /// Pages of the codes so far.
    pages: RefCell<BTreeMap<String, Option<Uri>>>,
}

impl FindingContext<'_> {
    fn diagnostic(&self, finding: &Finding) -> Diagnostic {
        let mut message = finding.message.clone();
        let notes = finding.notes.iter().map(|note| format!("note: {note}"));
        let help = finding.help.iter().map(|help| format!("{HELP}{help}"));
        for line in notes.chain(help) {
            message.push('\n');
            message.push_str(&line);
        }
        let related = self.client.has_related_information.then(|| self.related(finding));
        let tags = self.client.has_diagnostic_tags.then(|| tags(finding.kind.code)).flatten();
        Diagnostic {
            range: place(finding).map_or_else(Range::default, |span| self.range(span)),
            severity: Some(match finding.severity {
                Severity::Note => DiagnosticSeverity::INFORMATION,
                Severity::Warning => DiagnosticSeverity::WARNING,
                Severity::Error | Severity::Alarm => DiagnosticSeverity::ERROR,
            }),
            code: Some(NumberOrString::String(finding.code().into_owned())),
            code_description: self
                .client
                .has_code_description
                .then(|| self.page_of(&finding.code()))
                .flatten(),
            source: Some(SOURCE.to_owned()),
            message,
            related_information: related.filter(|related| !related.is_empty()),
            tags,
            ..Diagnostic::default()
        }
    }

    /// Returns the link to the page that explains a code.
    fn page_of(&self, code: &str) -> Option<CodeDescription> {
        let known = self.pages.borrow().get(code).cloned();
        let href = known.unwrap_or_else(|| {
            let page = self.host.explanation(code).and_then(|path| document_uri::of_path(&path));
            self.pages.borrow_mut().insert(code.to_owned(), page.clone());
            page
        });
        Some(CodeDescription { href: href? })
    }

    /// Returns a range of the document, without the end of its line.
    fn range(&self, span: Span) -> Range {
        let text = &self.document.bytes()[span.start as usize..span.end as usize];
        let end = span.start + text.trim_ascii_end().len() as u32;
        self.document.range(span.start, end)
    }

    fn related(&self, finding: &Finding) -> Vec<DiagnosticRelatedInformation> {
        let elsewhere = own_place(finding).filter(|span| span.source != SourceId(0));
        let elsewhere = elsewhere.map(|span| (span, "in this block of the called program".to_owned()));
        let labels = finding.labels.iter().map(|(span, caption)| (*span, caption.clone())).chain(elsewhere);
        let calls = finding.backtrace.iter().flat_map(|Backtrace { calls, .. }| calling_blocks(calls));
        let calls = calls.map(|span| (span, "called from here".to_owned()));
        let related = labels.chain(calls).filter_map(|(span, message)| {
            Some(DiagnosticRelatedInformation { location: self.location(span)?, message })
        });
        related.collect()
    }

    fn location(&self, span: Span) -> Option<Location> {
        if span.source == SourceId(0) {
            return Some(Location { uri: self.uri.clone(), range: self.range(span) });
        }
        let source = self.sources.get(span.source);
        let uri = document_uri::of_path(Path::new(&source.name))?;
        let document = TextDocument::new(source.bytes.clone(), self.client.encoding);
        Some(Location { uri, range: document.range(span.start, span.end) })
    }
}

/// Iterates over the blocks that called, the innermost first.
pub(crate) fn calling_blocks(calls: &CallChain) -> impl Iterator<Item = Span> {
    std::iter::successors(calls.as_deref(), |call| call.outer_calls.as_deref()).map(|call| call.calling_block)
}

/// Begins the line of a message that states the remedy.
const HELP: &str = "help: ";

/// Returns the remedy that the message of a diagnostic ends with.
pub(crate) fn help_of(message: &str) -> Option<&str> {
    message.lines().last().and_then(|line| line.strip_prefix(HELP))
}

/// Returns the tags of a rule: blocks that no path reaches are faded.
fn tags(code: &str) -> Option<Vec<DiagnosticTag>> {
    (code == "unreachable").then(|| vec![DiagnosticTag::UNNECESSARY])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::opened;

    fn shown(count: usize) -> Vec<Diagnostic> {
        let text = format!("O1\nG0\n{}M30\n", "X25 Y1.\n".repeat(count));
        let (snapshot, files) = opened(&[("O1.nc", text.as_str())]);
        let (uri, setup) = (snapshot.uri(files[0]).unwrap(), snapshot.setup(files[0]));
        let text = snapshot.text(files[0]).unwrap();
        let conditions = (&setup, BTreeMap::new());
        check(uri, &text, CheckedBlocks::default(), conditions, &snapshot.files, &snapshot.client)
            .0
            .diagnostics
    }

    #[test]
    fn more_findings_than_an_editor_shows_are_counted() {
        assert!(shown(1000).iter().all(|finding| finding.code.is_some()));
        let all = shown(1003);
        assert_eq!(all.len(), 1001);
        assert!(all[1000].message.starts_with("3 more findings are not shown"), "{}", all[1000].message);
    }
}
