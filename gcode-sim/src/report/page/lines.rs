//! The texts of one run by line, and the anchors of lines.
use std::collections::{BTreeMap, BTreeSet};

use super::words::shown;
use gcode_lang::source::{SourceId, Span};
use gcode_review::BlockLocation;
use gcode_session::Run;

/// One file of programs.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub source: SourceId,
    pub name: String,
    /// Labels of the programs in it.
    pub programs: Vec<String>,
    pub lines: Vec<String>,
}

/// The files of one side.
#[derive(Debug)]
pub(super) struct Lines {
    word: &'static str,
    pub texts: Vec<Text>,
    by_program: BTreeMap<String, BTreeSet<SourceId>>,
}

impl Lines {
    pub(super) fn new(word: &'static str, run: &Run) -> Self {
        let memory = run.control.memory();
        let mut by_program: BTreeMap<String, BTreeSet<SourceId>> = BTreeMap::new();
        for program in memory.programs() {
            by_program.entry(program.label()).or_default().insert(program.span.source);
        }
        let texts = memory.sources().iter().map(|(source, text)| Text {
            source,
            name: shown(&text.name),
            programs: memory
                .programs()
                .iter()
                .filter(|program| program.span.source == source)
                .map(|program| shown(&program.label()))
                .collect(),
            lines: text.lines().map(|line| shown(&line)).collect(),
        });
        Self { word, texts: texts.collect(), by_program }
    }

    /// Returns the anchor of a line: `new-1-51`. Lines count from 1.
    pub(super) fn anchor(&self, source: SourceId, line: u32) -> String {
        format!("{}-{}-{line}", self.word, source.0)
    }

    pub(super) fn of_span(&self, run: &Run, span: Span) -> String {
        self.anchor(span.source, run.control.memory().sources().line_column(span).line)
    }

    /// Returns the line of a location whose text contains the block: two files without an O number are both
    /// `MAIN`.
    pub(super) fn of_location(&self, location: &BlockLocation) -> Option<(SourceId, u32)> {
        let block = shown(&location.block);
        let holds = |source: &&SourceId| {
            let text = self.texts.iter().find(|text| text.source == **source);
            let written = text.and_then(|text| text.lines.get(location.line.checked_sub(1)? as usize));
            written.is_some_and(|written| written.contains(&block))
        };
        self.by_program.get(&location.program)?.iter().find(holds).map(|source| (*source, location.line))
    }
}
