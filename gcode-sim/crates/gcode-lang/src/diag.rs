//! Findings and messages as plain data: code, severity, span, reason and remedy. Rendering is left to the
//! caller.
use std::borrow::Cow;

use crate::motion::Backtrace;
use crate::source::Span;

/// Grade of a finding, least serious first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// An observation; the check still passes.
    Note,
    /// A probable mistake; the check still passes.
    Warning,
    /// A fault; the check fails.
    Error,
    /// An alarm that stops the control.
    Alarm,
}

impl Severity {
    /// Returns the lower-case name used in JSON, tables and summaries.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
            Self::Alarm => "alarm",
        }
    }
}

/// Point on the part that a finding refers to, in the part's coordinate system, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Tool pass through the point, counted from 0; `None` if no pass applies.
    pub pass: Option<usize>,
    /// Coordinates x, y, z, mm.
    pub point: [f64; 3],
}

impl Site {
    /// Creates a site from a pass and a point.
    pub fn new(pass: Option<usize>, at: impl Into<[f64; 3]>) -> Self {
        Self { pass, point: at.into() }
    }
}

/// Kind of finding: one row with its code, highest severity, title and page. [`finding_kinds!`](crate::finding_kinds)
/// declares the rows.
#[derive(Debug)]
pub struct FindingKind {
    /// Stable identifier, such as `rapid-into-part` or the code of an alarm.
    pub code: &'static str,
    /// Highest severity; a single finding may have a lower one.
    pub severity: Severity,
    /// Meaning of the code in a few words.
    pub title: &'static str,
    /// Text that contains the page.
    pub document: Document,
}

/// Markdown that contains the page of a kind.
#[derive(Debug)]
pub enum Document {
    /// The page is the whole text.
    Page(&'static str),
    /// The page is the section whose heading starts with the code.
    Section(&'static str),
}

impl FindingKind {
    /// Returns the page: meaning, causes and remedy, as Markdown.
    pub fn page(&self) -> &'static str {
        match self.document {
            Document::Page(text) => text,
            Document::Section(text) => {
                let mut sections = text.split("\n## ").skip(1);
                sections.find(|section| section.starts_with(&format!("{}: ", self.code))).unwrap_or_default()
            }
        }
    }
}

impl PartialEq for FindingKind {
    fn eq(&self, other: &Self) -> bool {
        self.code == other.code
    }
}

impl Eq for FindingKind {}

impl std::fmt::Display for FindingKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.code)
    }
}

/// Declares a static [`FindingKind`](crate::diag::FindingKind) per line, and `ALL`. The folder of the pages comes first. The
/// first line of a page is compared with code and title at compile time.
#[macro_export]
macro_rules! finding_kinds {
    ($folder:literal; $($name:ident = $code:literal, $severity:ident, $title:literal;)+) => {
        $(
            #[doc = concat!("`", $code, "`: ", $title, ".")]
            pub static $name: $crate::diag::FindingKind = {
                const PAGE: &str = include_str!(concat!($folder, $code, ".md"));
                assert!($crate::diag::starts_with(PAGE, concat!("# ", $code, ": ", $title, "\n")));
                $crate::diag::FindingKind {
                    code: $code,
                    severity: $crate::diag::Severity::$severity,
                    title: $title,
                    document: $crate::diag::Document::Page(PAGE),
                }
            };
        )+

        /// All rows of this table.
        pub static ALL: &[&$crate::diag::FindingKind] = &[$(&$name),+];
    };
}

/// Returns true if a text starts with another, at compile time too.
#[doc(hidden)]
pub const fn starts_with(text: &str, start: &str) -> bool {
    match text.as_bytes().split_at_checked(start.len()) {
        Some((opening, _)) => is_equal(opening, start.as_bytes()),
        None => false,
    }
}

const fn is_equal(mut one: &[u8], mut other: &[u8]) -> bool {
    while let ([a, rest @ ..], [b, others @ ..]) = (one, other) {
        if *a != *b {
            return false;
        }
        (one, other) = (rest, others);
    }
    one.is_empty() && other.is_empty()
}

/// One finding: message, span and remedy.
///
/// The message is complete without the other fields, also on a narrow screen: it states the actual and the
/// nominal value with their units.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Kind of the finding, with its code and page.
    pub kind: &'static FindingKind,
    /// Number of an alarm that the program raises: replaces the number in the kind's code.
    pub raised: Option<u16>,
    /// Grade of the finding.
    pub severity: Severity,
    /// Statement of the fault, one sentence.
    pub message: String,
    /// Block of the finding and the calls that led to it.
    pub backtrace: Option<Backtrace>,
    /// Exact part of the block; `None` if the whole block is meant.
    pub span: Option<Span>,
    /// Points on the part, the worst first.
    pub sites: Vec<Site>,
    /// Secondary spans with their captions: "the loop starts here".
    pub labels: Vec<(Span, String)>,
    /// Additional facts, one sentence each.
    pub notes: Vec<String>,
    /// Remedy: one instruction.
    pub help: Option<String>,
    /// Number of findings of this kind and severity that a list leaves out behind this one.
    pub more: usize,
}

impl Diagnostic {
    /// Creates a finding of the kind's severity, without span, notes or help.
    pub fn new(kind: &'static FindingKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            raised: None,
            severity: kind.severity,
            message: message.into(),
            backtrace: None,
            span: None,
            sites: Vec::new(),
            labels: Vec::new(),
            notes: Vec::new(),
            help: None,
            more: 0,
        }
    }

    /// Returns the code: `hole-depth`, `PS0112`, `MC3021`.
    pub fn code(&self) -> Cow<'static, str> {
        match self.raised {
            None => self.kind.code.into(),
            Some(number) => format!("MC{number:04}").into(),
        }
    }

    /// Sets a severity, not higher than the kind's.
    #[must_use]
    pub fn with_severity(mut self, severity: Severity) -> Self {
        debug_assert!(severity <= self.kind.severity, "{}", self.kind);
        self.severity = severity;
        self
    }

    /// Sets the block and the calls that led to it.
    #[must_use]
    pub fn with_backtrace(mut self, backtrace: Backtrace) -> Self {
        self.backtrace = Some(backtrace);
        self
    }

    /// Sets the exact part of the block.
    #[must_use]
    pub fn with_span(mut self, span: Span) -> Self {
        self.span = Some(span);
        self
    }

    /// Appends a secondary span with its caption.
    #[must_use]
    pub fn label(mut self, span: Span, caption: impl Into<String>) -> Self {
        self.labels.push((span, caption.into()));
        self
    }

    /// Appends points on the part.
    #[must_use]
    pub fn with_sites(mut self, sites: impl IntoIterator<Item = Site>) -> Self {
        self.sites.extend(sites);
        self
    }

    /// Sets the remedy.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Appends a note.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}
