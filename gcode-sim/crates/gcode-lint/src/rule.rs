//! Rule: the kind of its finding, and the function that reports it.
use gcode_lang::diag::{Diagnostic, Document, FindingKind, Severity};
use gcode_lang::program::OpIndex;

use super::context::{CheckContext, ProgramUnit};

/// Reports the findings of a rule in one program.
type FindInProgram = fn(&CheckContext<'_>, &ProgramUnit<'_>) -> Vec<Diagnostic>;

/// Reports the findings of a rule about one reachable block.
type FindInBlock = fn(&CheckContext<'_>, &ProgramUnit<'_>, OpIndex) -> Vec<Diagnostic>;

/// Way in which a rule looks for its findings.
#[derive(Clone, Copy)]
pub(super) enum Find {
    InProgram(FindInProgram),
    /// Nothing but the block and the control decides: after an edit elsewhere its findings are the same.
    InBlock(FindInBlock),
}

/// Rule of the static check.
pub struct Rule {
    /// Kind of its findings. The code is also the name in `(CHECK-OFF NAME)`.
    pub kind: FindingKind,
    pub(super) find: Find,
}

impl Rule {
    /// Creates a rule; its page is a section of `docs/checks.md`.
    pub(super) const fn new(
        code: &'static str,
        severity: Severity,
        title: &'static str,
        find: FindInProgram,
    ) -> Self {
        Self::finding(code, severity, title, Find::InProgram(find))
    }

    /// Creates a rule about blocks, each of them alone.
    pub(super) const fn of_block(
        code: &'static str,
        severity: Severity,
        title: &'static str,
        find: FindInBlock,
    ) -> Self {
        Self::finding(code, severity, title, Find::InBlock(find))
    }

    const fn finding(code: &'static str, severity: Severity, title: &'static str, find: Find) -> Self {
        let document = Document::Section(include_str!("../../../../docs/checks.md"));
        Self { kind: FindingKind { code, severity, title, document }, find }
    }
}
