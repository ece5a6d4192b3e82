//! Rule: the kind of its finding, and the function that reports it.
use gcode_lang::diag::{Diagnostic, Document, FindingKind, Severity};

use super::context::{CheckContext, ProgramUnit};

/// Reports the findings of a rule in one program.
type Find = fn(&CheckContext<'_>, &ProgramUnit<'_>) -> Vec<Diagnostic>;

/// Rule of the static check.
pub struct Rule {
    /// Kind of its findings. The code is also the name in `(CHECK-OFF NAME)`.
    pub kind: FindingKind,
    pub(super) find: Find,
}

impl Rule {
    /// Creates a rule; its page is a section of `docs/checks.md`.
    pub(super) const fn new(code: &'static str, severity: Severity, title: &'static str, find: Find) -> Self {
        let document = Document::Section(include_str!("../../../../docs/checks.md"));
        Self { kind: FindingKind { code, severity, title, document }, find }
    }
}
