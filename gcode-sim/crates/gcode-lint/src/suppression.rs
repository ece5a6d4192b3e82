//! Suppression comments: `(CHECK-OFF NAME)` turns a rule off for its block.
//!
//! In the head of a program, before the first block with an operation, it turns the rule off for the whole
//! program. A control treats it as a comment.
use gcode_lang::program::OpKind;
use gcode_lang::source::Span;

use super::context::{ProgramUnit, RuleFinding};

/// First word of a suppression comment.
const KEYWORD: &str = "CHECK-OFF";

/// Suppressions of a program.
#[derive(Debug)]
pub(super) struct Suppressions {
    /// Index of the block, `None` for the whole program; name of the rule in upper case; place of the
    /// comment.
    entries: Vec<(Option<usize>, String, Span)>,
}

impl Suppressions {
    pub(super) fn new(unit: &ProgramUnit<'_>) -> Self {
        let mut off = Vec::new();
        let mut is_in_head = true;
        for (index, (block, op)) in unit.blocks.iter().zip(unit.program.ops()).enumerate() {
            is_in_head &= matches!(op.kind(), OpKind::Empty) && op.number.is_none();
            for comment in &block.comments {
                let text = String::from_utf8_lossy(&comment.text).to_ascii_uppercase();
                let Some(names) = text.trim().strip_prefix(KEYWORD) else { continue };
                let place = (!is_in_head).then_some(index);
                let mut names: Vec<&str> =
                    names.split([' ', ',', '\t']).filter(|name| !name.is_empty()).collect();
                if names.is_empty() {
                    names.push("");
                }
                off.extend(names.into_iter().map(|name| (place, name.to_owned(), comment.span)));
            }
        }
        Self { entries: off }
    }

    pub(super) fn suppresses(&self, finding: &RuleFinding) -> bool {
        self.entries.iter().any(|(place, name, _)| {
            place.is_none_or(|block| block == finding.block)
                && name.eq_ignore_ascii_case(finding.diagnostic.kind.code)
        })
    }

    /// Iterates over the suppressed names in upper case with the places of their comments.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, Span)> {
        self.entries.iter().map(|(_, name, span)| (name.as_str(), *span))
    }
}
