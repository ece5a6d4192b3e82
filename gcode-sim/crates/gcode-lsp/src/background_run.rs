//! Runs of programs for an editor, with a limit: values of variables, deviations of holes.
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;
use std::sync::Arc;

use gcode_control::{Limits, Outcome, Progress};
use gcode_ide::{FileId, Project};
use gcode_inspect::verify::Verdict;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_part::{NominalPart, Reference};
use gcode_session::{Criteria, HoleJudgement, Request, Trace};

use crate::failure::Failure;
use crate::findings::calling_blocks;
use crate::overlay::Overlay;
use crate::program_setup::ProgramSetup;
use crate::run_facts::{HolesOfLine, RunFacts};
use crate::snapshot::Snapshot;

/// Largest number of blocks that are executed for an editor.
const MAX_BLOCKS: u64 = 300_000;

/// Largest text that is run while it is edited, bytes.
const MAX_TEXT: usize = 4 << 20;

/// Returns the facts of the run of a file's program, or of the one that calls it.
///
/// # Errors
/// An edit has made the run useless.
pub(crate) fn facts(snapshot: &Snapshot, file: FileId) -> Result<Arc<RunFacts>, Failure> {
    snapshot.runs.facts(file, |progress| run(snapshot, file, progress)).ok_or_else(Failure::outdated)
}

fn run(snapshot: &Snapshot, file: FileId, progress: &Arc<Progress>) -> RunFacts {
    let main = main_of(&snapshot.project, file);
    let Some(text) = snapshot.project.file(main).map(|index| index.text().clone()) else {
        return RunFacts::cut_off("the file is not open");
    };
    if MAX_TEXT < text.len() {
        return RunFacts::cut_off("the file is too long to be run while it is edited");
    }
    let setup = snapshot.setup(main);
    let request = request(&setup, text, progress);
    let mut library = setup.library(&snapshot.files);
    let mut trace = Trace::default();
    let nominal = reference(&setup, &snapshot.files, &request, &mut library);
    // The deviations of a hole are those of its own file.
    let criteria = nominal.as_ref().filter(|_| main == file).map(Criteria::of);
    let judged = gcode_session::simulate_judged(&request, &mut library, criteria, &mut (), &mut trace);
    let HoleJudgement { simulation, verdict } = match judged {
        Ok(judged) => judged,
        Err(error) => return RunFacts::cut_off(error.to_string()),
    };
    let run = &simulation.run;
    let memory = run.control.memory();
    let path = snapshot.path(file);
    let source = memory.sources().iter().find(|(_, source)| Path::new(&source.name) == path);
    let source = source.map(|(id, _)| id);
    let blocks = trace.blocks().filter(|executed| Some(executed.block.source) == source);
    let line_of = |drilled: usize| {
        let Backtrace { block, calls } = &simulation.extracted.holes.get(drilled)?.backtrace;
        let chain = std::iter::once(*block).chain(calling_blocks(calls));
        let outermost = chain.filter(|span| Some(span.source) == source).last()?;
        Some(memory.sources().get(outermost.source).line_column(outermost.start).line)
    };
    let holes = verdict.map(|verdict| holes_by_line(&verdict, line_of)).unwrap_or_default();
    RunFacts {
        blocks: blocks.cloned().collect(),
        commons: run.control.variables().filter(|(number, _)| 33 < *number).collect(),
        holes,
        stop: run.stop_finding().map(|finding| sentence(&finding)),
        is_cut_off: matches!(run.outcome, Outcome::Limit),
        main: memory.get(memory.main()).label(),
    }
}

/// Returns the holes of each line; `line_of` returns that of a drilled hole.
fn holes_by_line(verdict: &Verdict, line_of: impl Fn(usize) -> Option<u32>) -> BTreeMap<u32, HolesOfLine> {
    let mut lines: BTreeMap<u32, HolesOfLine> = BTreeMap::new();
    for hole in &verdict.holes {
        let Some(line) = line_of(hole.drilled_index) else { continue };
        let known = lines.entry(line).or_default();
        let phi = known.worst.map_or(hole.position_deviation, |(phi, _)| phi.max(hole.position_deviation));
        known.worst = Some((phi, verdict.tolerance));
        known.count += 1;
        let errors = hole.error_codes.iter().map(|code| code.trim_start_matches("hole-"));
        known.errors.extend(errors);
    }
    for line in verdict.extra.iter().filter_map(|extra| line_of(extra.drilled_index)) {
        lines.entry(line).or_default().extra += 1;
    }
    lines
}

/// Returns the message of a finding with its code in front, if it is an alarm's.
fn sentence(finding: &Diagnostic) -> String {
    format!("{}: {}", finding.code(), finding.message)
}

/// Returns the request of a run with the limits of an editor. The first M99 of the main program ends it.
pub(crate) fn request(setup: &ProgramSetup, text: Bytes, progress: &Arc<Progress>) -> Request {
    let mut request = setup.request(text);
    request.limits = Limits { blocks: MAX_BLOCKS };
    request.settings.main_program_cycles.get_or_insert(1);
    request.progress = Some(Arc::clone(progress));
    request
}

/// Returns the reference of a program that makes holes, if it has a usable one.
fn reference(
    setup: &ProgramSetup,
    files: &Overlay,
    request: &Request,
    library: &mut impl Library,
) -> Option<Reference> {
    let text = files.host().reference(setup.paths.reference.as_deref()?).ok()?;
    let mut reference = NominalPart::parse(&text).ok()?.into_holes()?;
    gcode_session::complete_depths(request, library, &mut reference).ok()?;
    Some(reference)
}

/// Returns the file with the main program that leads to a file. It is the file itself if nothing calls it.
pub(crate) fn main_of(project: &Project, file: FileId) -> FileId {
    mains_of(project, file).first().copied().unwrap_or(file)
}

/// Returns the files with all main programs that lead to a file, the nearest first.
pub(crate) fn mains_of(project: &Project, file: FileId) -> Vec<FileId> {
    let mut mains = Vec::new();
    let mut known = BTreeSet::from([file]);
    let mut waiting = VecDeque::from([file]);
    while let Some(current) = waiting.pop_front() {
        let callers = project.calling_files(current);
        if callers.is_empty() {
            mains.push(current);
        }
        waiting.extend(callers.into_iter().filter(|caller| known.insert(*caller)));
    }
    if mains.is_empty() { vec![file] } else { mains }
}
