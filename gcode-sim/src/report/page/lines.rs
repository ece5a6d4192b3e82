//! The texts of one run by line, and the anchors of lines.
use std::collections::{BTreeMap, BTreeSet};

use super::words::shown;
use gcode_lang::program::{Program, ProgramId};
use gcode_lang::source::{SourceId, Span};
use gcode_lint::reachable_programs;
use gcode_review::BlockLocation;
use gcode_session::Run;

/// One file of programs.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub source: SourceId,
    pub name: String,
    /// Labels of the programs in it that the run can reach.
    pub programs: Vec<String>,
    pub lines: Vec<String>,
    /// First lines of its programs, counted from 0, with what they are to the run.
    pub parts: Vec<(usize, Part)>,
}

/// What a program is to a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    Main,
    /// Calls can reach it.
    Called,
    Unreached,
}

impl Text {
    /// Returns what the program of a line is to the run; lines above the first program belong to it.
    pub(super) fn part(&self, line: usize) -> Part {
        let next = self.parts.partition_point(|(first, _)| *first <= line);
        self.parts.get(next.saturating_sub(1)).map_or(Part::Main, |(_, part)| *part)
    }
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
        let reached = reachable_programs(&mut memory.reload(), run.control.settings());
        let part = |id: ProgramId| match reached.contains(&id) {
            _ if id == memory.main() => Part::Main,
            true => Part::Called,
            false => Part::Unreached,
        };
        let texts = memory.sources().iter().map(|(source, text)| {
            let all = memory.ids().map(|id| (part(id), memory.get(id)));
            let own: Vec<_> = all.filter(|(_, program)| program.span.source == source).collect();
            let label = |(part, program): &(Part, &Program)| {
                (*part != Part::Unreached).then(|| shown(&program.label()))
            };
            let first_line = |program: &Program| text.line_column(program.span.start).line as usize - 1;
            Text {
                source,
                name: shown(&text.name),
                programs: own.iter().filter_map(label).collect(),
                lines: text.lines().map(|line| shown(&line)).collect(),
                parts: own.iter().map(|(part, program)| (first_line(program), *part)).collect(),
            }
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
