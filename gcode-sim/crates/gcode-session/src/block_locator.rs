//! Locations of many blocks; the label of each program is formatted once.
use std::cell::RefCell;
use std::collections::BTreeMap;

use super::Run;
use gcode_lang::source::{SourceId, Span};

/// Converts spans to program and line.
#[derive(Debug)]
pub(super) struct BlockLocator<'r> {
    run: &'r Run,
    /// Labels by the start of the program.
    names: RefCell<BTreeMap<(SourceId, u32), String>>,
}

impl<'r> BlockLocator<'r> {
    pub(super) fn of(run: &'r Run) -> Self {
        Self { run, names: RefCell::default() }
    }

    pub(super) fn locate(&self, span: Span) -> (String, u32) {
        let memory = self.run.control.memory();
        let line = memory.sources().line_column(span).line;
        let Some(program) = memory.program_at(span) else {
            return (memory.sources().get(span.source).name.clone(), line);
        };
        let mut names = self.names.borrow_mut();
        let name = names.entry((program.span.source, program.span.start)).or_insert_with(|| program.label());
        (name.clone(), line)
    }
}
