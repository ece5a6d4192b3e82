//! Location of a block: program, line, text, and the calls that led to it.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use gcode_lang::motion::Backtrace;
use gcode_session::Run;

/// A block by program and line, and the calls that led to it, innermost first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockLocation {
    /// Name of the program.
    pub program: String,
    /// Line in its file, from 1.
    pub line: u32,
    /// Text of the block.
    pub block: String,
    /// Calls that led to the block, innermost first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calls: Vec<Self>,
}

impl BlockLocation {
    /// Locates a block of a run and the calls that led to it.
    pub fn of(run: &Run, backtrace: &Backtrace) -> Self {
        let sources = run.control.memory().sources();
        let at = |span| {
            let (program, line) = run.locate(span);
            Self { program, line, block: sources.text(span).trim().to_owned(), calls: Vec::new() }
        };
        let chain = std::iter::successors(backtrace.calls.as_deref(), |call| call.outer_calls.as_deref());
        let calls = chain.map(|call| at(call.calling_block)).collect();
        Self { calls, ..at(backtrace.block) }
    }

    /// Iterates over the calls that led to a block, the outermost first, and the block itself.
    pub(super) fn outermost_first(&self) -> impl Iterator<Item = &Self> {
        self.calls.iter().rev().chain([self])
    }
}

/// A block of an executed program that no step names.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OtherBlock {
    pub program: String,
    /// Line in its file, from 1.
    pub line: u32,
    pub block: String,
    /// Number of steps before its first execution; absent if it was not executed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<usize>,
    /// True if a condition or a block skip kept it from being executed as a whole.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub in_part: bool,
}
