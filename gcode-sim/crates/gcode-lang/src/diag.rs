//! Findings and messages as plain data: what, where, why and what to do. Drawing them is `report`'s business.
use crate::motion::Backtrace;
use crate::source::Span;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; the answer stays yes.
    Note,
    /// Likely a slip; the answer stays yes.
    Warning,
    /// The answer is no.
    Error,
    /// The control stops.
    Alarm,
}

impl Severity {
    /// As JSON, tables and summaries write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
            Self::Alarm => "alarm",
        }
    }
}

/// A place on the part, and which pass of the tool it is on, counted from 0; mm, in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    pub pass: Option<usize>,
    pub point: [f64; 3],
}

impl Site {
    pub fn new(pass: Option<usize>, at: impl Into<[f64; 3]>) -> Self {
        Self { pass, point: at.into() }
    }
}

/// One thing to tell. The message alone makes sense on a narrow screen: both numbers with units, wanted and found.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// A stable name such as `rapid-into-part` or an alarm's code.
    pub code: String,
    pub severity: Severity,
    pub message: String,
    /// The block it is about, and the calls that led to it.
    pub backtrace: Option<Backtrace>,
    /// The exact part of the block, where known.
    pub span: Option<Span>,
    /// Where that is on the part, the worst first.
    pub sites: Vec<Site>,
    /// Second places: "the loop starts here".
    pub labels: Vec<(Span, String)>,
    pub notes: Vec<String>,
    /// One thing to do.
    pub help: Option<String>,
}

impl Diagnostic {
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

    pub fn error(code: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, message)
    }

    pub fn warning(code: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, message)
    }

    #[must_use]
    pub fn with_backtrace(mut self, backtrace: Backtrace) -> Self {
        self.backtrace = Some(backtrace);
        self
    }

    #[must_use]
    pub fn with_sites(mut self, sites: impl IntoIterator<Item = Site>) -> Self {
        self.sites.extend(sites);
        self
    }

    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}
