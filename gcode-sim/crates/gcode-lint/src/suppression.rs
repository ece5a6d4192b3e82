//! Suppression comments: `(CHECK-OFF NAME)` turns a rule off for its block.
//!
//! In the head of a program, before the first block with an operation, it turns the rule off for the whole
//! program. A control treats it as a comment.
use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{OpIndex, OpKind};
use gcode_lang::source::Span;

use super::context::ProgramUnit;

/// First word of a suppression comment.
const KEYWORD: &str = "CHECK-OFF";

/// One name in a suppression comment.
#[derive(Debug)]
pub(super) struct Suppression {
    /// Name of the rule in upper case; empty if the comment has none.
    pub(super) name: String,
    /// Block of the comment.
    pub(super) block: OpIndex,
    /// Place of the comment.
    pub(super) comment: Span,
    /// Place of the block; `None` if the comment is in the head of the program.
    block_span: Option<Span>,
}

/// Returns the suppressions of a program.
pub(super) fn suppressions(unit: &ProgramUnit<'_>) -> Vec<Suppression> {
    let mut found = Vec::new();
    let mut is_in_head = true;
    for (block, (written, op)) in unit.blocks.iter().zip(unit.program.ops()).enumerate() {
        is_in_head &= matches!(op.kind(), OpKind::Empty) && op.number.is_none();
        for comment in &written.comments {
            let text = String::from_utf8_lossy(&comment.text).to_ascii_uppercase();
            let Some(names) = text.trim().strip_prefix(KEYWORD) else { continue };
            let mut names: Vec<_> = names.split([' ', ',', '\t']).filter(|name| !name.is_empty()).collect();
            if names.is_empty() {
                names.push("");
            }
            found.extend(names.into_iter().map(|name| Suppression {
                name: name.to_owned(),
                block,
                comment: comment.span,
                block_span: (!is_in_head).then_some(op.span),
            }));
        }
    }
    found
}

impl Suppression {
    /// Returns true if the comment turns the rule of a finding off at its block.
    pub(super) fn suppresses(&self, finding: &Diagnostic) -> bool {
        let block = finding.backtrace.as_ref().map(|place| place.block);
        (self.block_span.is_none() || self.block_span == block)
            && self.name.eq_ignore_ascii_case(finding.kind.code)
    }
}
