//! Suppression comments: `(CHECK-OFF NAME)` turns a rule off for its block.
//!
//! In the head of a program, before the first block with an operation, it turns the rule off for the whole
//! program. A control treats it as a comment.
use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{Op, OpIndex, OpKind};
use gcode_lang::source::Span;

use super::context::ProgramUnit;

/// First word of a suppression comment.
const KEYWORD: &str = "CHECK-OFF";

/// One name in a suppression comment.
#[derive(Debug)]
pub(super) struct Suppression {
    /// Name of the rule in upper case; empty if the comment has none.
    pub(super) name: String,
    pub(super) block: OpIndex,
    pub(super) comment: Span,
    /// Place of the block; `None` if the comment is in the head of the program.
    block_span: Option<Span>,
}

pub(super) fn suppressions(unit: &ProgramUnit<'_>) -> Vec<Suppression> {
    let mut found = Vec::new();
    let ops = unit.program.ops();
    let is_head = |op: &Op| matches!(op.kind(), OpKind::Empty) && op.number.is_none();
    let is_begun_before = unit.piece.as_ref().is_some_and(|piece| !piece.is_first);
    let head = ops.iter().position(|op| is_begun_before || !is_head(op)).unwrap_or(ops.len());
    for (block, written) in unit.blocks.iter().enumerate() {
        let is_in_head = block < head;
        for comment in &written.comments {
            let begins = comment.text.trim_ascii_start().get(..KEYWORD.len());
            if begins.is_none_or(|begins| !begins.eq_ignore_ascii_case(KEYWORD.as_bytes())) {
                continue;
            }
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
                block_span: (!is_in_head).then_some(ops[block].span),
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
