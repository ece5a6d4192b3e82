//! Findings and messages as plain data: code, severity, place, reason and remedy. Rendering is left to the
//! caller.
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

/// One finding: message, place and remedy.
///
/// The message is complete without the other fields, also on a narrow screen: it states the actual and the
/// nominal value with their units.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// Stable identifier, such as `rapid-into-part` or the code of an alarm.
    pub code: String,
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
    /// Secondary places with their captions: "the loop starts here".
    pub labels: Vec<(Span, String)>,
    /// Additional facts, one sentence each.
    pub notes: Vec<String>,
    /// Remedy: one instruction.
    pub help: Option<String>,
}

impl Diagnostic {
    /// Creates a finding without place, notes or help.
    pub fn new(severity: Severity, code: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            code: code.into(),
            severity,
            message: message.into(),
            backtrace: None,
            span: None,
            sites: Vec::new(),
            labels: Vec::new(),
            notes: Vec::new(),
            help: None,
        }
    }

    /// Creates a finding of severity [`Severity::Error`].
    pub fn error(code: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, message)
    }

    /// Creates a finding of severity [`Severity::Warning`].
    pub fn warning(code: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, message)
    }

    /// Sets the block and the calls that led to it.
    #[must_use]
    pub fn with_backtrace(mut self, backtrace: Backtrace) -> Self {
        self.backtrace = Some(backtrace);
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
