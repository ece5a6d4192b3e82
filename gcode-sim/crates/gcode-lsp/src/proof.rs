//! Proof that an edit changes nothing: the programs run before and after, and everything that they do is compared.
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use gcode_control::{Control, Limits, Observer, OperatorStop, Outcome, Progress};
use gcode_ide::{FileEdit, FileId, ProgramKey, ProgramOutline, TextEdit, TextRange, apply_edits};
use gcode_lang::alarm::AlarmCode;
use gcode_lang::motion::{Event, EventKind, EventSink};
use gcode_lang::program::{Memory, ProgramId};
use gcode_lang::source::{Bytes, Span};
use gcode_lang::syntax::ast::{ProgramName, ProgramPath};
use gcode_session::{Request, Run};

use crate::background_run::mains_of;
use crate::overlay::programs_in;
use crate::snapshot::Snapshot;

/// Largest number of blocks of a proof.
const MAX_BLOCKS: u64 = 5_000_000;

/// Number of events that go from one run to the other at once.
const BATCH: usize = 1024;

/// Number of batches on their way.
const BATCHES: usize = 8;

/// What an edit may change: values of variables that it renames.
pub(crate) type RenamedVariables = BTreeSet<u32>;

/// Runs the programs that an edit concerns, with and without it.
///
/// # Errors
/// The reason why the edit is not proved to change nothing.
pub(crate) fn prove(
    snapshot: &Snapshot,
    edits: &[FileEdit],
    renamed: &RenamedVariables,
    progress: &Arc<Progress>,
) -> Result<(), String> {
    let texts = edited_texts(snapshot, edits);
    let mut edited = snapshot.clone();
    for (file, text) in &texts {
        let path = edited.path(*file);
        edited.files.open(path, text.clone(), programs_in(text));
    }
    let states = ProvedStates { old: snapshot, new: &edited, texts: &texts, renamed, progress };
    // An edit that no run has executed proves nothing by equal runs.
    let mut unreached = edited_programs(snapshot, edits);
    let mains: BTreeSet<FileId> = texts.keys().flat_map(|file| mains_of(&snapshot.project, *file)).collect();
    for main in mains {
        for program in main_programs(snapshot, main) {
            let reached = states.compare_runs(main, program)?;
            unreached.retain(|program| !program.is_among(&reached));
        }
    }
    // A subprogram that nothing calls, or whose callers end before, runs alone, with vacant arguments.
    for program in unreached {
        let compared = states.compare_runs(program.file, program.name.clone());
        let reached = compared
            .map_err(|why| format!("no run of a main program reaches {}; alone, {why}", program.label))?;
        if !program.is_among(&reached) {
            return Err(format!("no run reaches {}, so that nothing is proved of it", program.label));
        }
    }
    Ok(())
}

/// Program that an edit changes.
struct EditedProgram {
    file: FileId,
    path: PathBuf,
    range: TextRange,
    /// `None` for a program without a name.
    name: Option<ProgramPath>,
    label: String,
}

/// Executed program: its file and its range there.
type ReachedProgram = (PathBuf, TextRange);

impl EditedProgram {
    fn is_among(&self, reached: &[ReachedProgram]) -> bool {
        reached.iter().any(|(path, range)| {
            *path == self.path && range.start < self.range.end && self.range.start < range.end
        })
    }
}

/// Returns the programs whose texts edits change.
fn edited_programs(snapshot: &Snapshot, edits: &[FileEdit]) -> Vec<EditedProgram> {
    let project = &snapshot.project;
    let is_edited = |file: FileId, range: TextRange| {
        edits.iter().any(|edit| {
            let place = edit.edit.range;
            edit.file == file && place.start < range.end && range.start <= place.start.max(place.end)
        })
    };
    let edited = project.programs().filter(|(key, outline)| is_edited(key.file, outline.range));
    let program = |(key, outline): (ProgramKey, &ProgramOutline)| EditedProgram {
        file: key.file,
        path: snapshot.path(key.file),
        range: outline.range,
        name: program_path(outline),
        label: project.label(key),
    };
    edited.map(program).collect()
}

fn program_path(outline: &ProgramOutline) -> Option<ProgramPath> {
    let is_named = outline.name != ProgramName::Unnamed;
    is_named.then(|| ProgramPath { folder: outline.folder.clone(), name: outline.name.clone() })
}

/// The texts before and after the edits.
struct ProvedStates<'a> {
    old: &'a Snapshot,
    new: &'a Snapshot,
    /// Texts of the edited files.
    texts: &'a BTreeMap<FileId, Bytes>,
    renamed: &'a RenamedVariables,
    progress: &'a Arc<Progress>,
}

impl ProvedStates<'_> {
    /// Runs a main program in both states, and returns the programs that the old one executes.
    fn compare_runs(
        &self,
        main: FileId,
        program: Option<ProgramPath>,
    ) -> Result<Vec<ReachedProgram>, String> {
        let Some(old) = self.old.project.file(main).map(|index| index.text().clone()) else {
            return Ok(Vec::new());
        };
        let new = self.texts.get(&main).unwrap_or(&old);
        let renamed = program.clone().map(|program| name_after(&old, new, program));
        let request = |state: &Snapshot, (text, program): (&Bytes, Option<ProgramPath>)| {
            let mut request = state.setup(main).request(text.clone());
            request.main = program;
            request.limits = Limits { blocks: MAX_BLOCKS };
            request.settings.main_program_cycles.get_or_insert(1);
            request.progress = Some(Arc::clone(self.progress));
            request
        };
        let old = Side { snapshot: self.old, file: main, request: request(self.old, (&old, program)) };
        let new = Side { snapshot: self.new, file: main, request: request(self.new, (new, renamed)) };
        compare(&old, &new, self.renamed)
    }
}

/// Returns the name that a program of a text has after an edit: programs keep their order.
fn name_after(old: &[u8], new: &[u8], program: ProgramPath) -> ProgramPath {
    let (before, after) = (programs_in(old), programs_in(new));
    let place = before.iter().position(|name| *name == program.name);
    match place.and_then(|place| after.get(place)).filter(|_| before.len() == after.len()) {
        Some(name) => ProgramPath { name: name.clone(), ..program },
        None => program,
    }
}

/// Records which programs a run executes.
#[derive(Default)]
struct ReachObserver {
    programs: BTreeSet<ProgramId>,
    last: Option<ProgramId>,
}

impl Observer for ReachObserver {
    fn before_block(&mut self, control: &mut Control) {
        let program = control.program_at_work();
        if self.last.replace(program) != Some(program) {
            self.programs.insert(program);
        }
    }

    fn after_block(&mut self, _: &Control) {}
}

impl ReachObserver {
    /// Returns the executed programs.
    fn reached(&self, memory: &Memory) -> Vec<ReachedProgram> {
        let place = |id: &ProgramId| {
            let span = memory.get(*id).span;
            let source = memory.sources().get(span.source);
            (PathBuf::from(&source.name), TextRange::new(span.start, span.end))
        };
        self.programs.iter().map(place).collect()
    }
}

/// Returns the texts of the edited files.
pub(crate) fn edited_texts(snapshot: &Snapshot, edits: &[FileEdit]) -> BTreeMap<FileId, Bytes> {
    let mut by_file: BTreeMap<FileId, Vec<TextEdit>> = BTreeMap::new();
    for FileEdit { file, edit } in edits {
        by_file.entry(*file).or_default().push(edit.clone());
    }
    let text = |(file, mut edits): (FileId, Vec<TextEdit>)| {
        edits.sort();
        let text = snapshot.project.file(file)?.text();
        Some((file, apply_edits(text, &edits).into()))
    };
    by_file.into_iter().filter_map(text).collect()
}

/// Returns the main programs of a file: those that no program of the file calls, all if there is none.
fn main_programs(snapshot: &Snapshot, file: FileId) -> Vec<Option<ProgramPath>> {
    let project = &snapshot.project;
    let own: Vec<_> = project.programs().filter(|(key, _)| key.file == file).collect();
    let is_called = |key| project.incoming_calls(key).iter().any(|group| group.item.key != key);
    let mains: Vec<_> = own.iter().filter(|(key, _)| !is_called(*key)).collect();
    if own.len() < 2 || mains.is_empty() {
        return vec![None];
    }
    mains.iter().map(|(_, outline)| program_path(outline)).collect()
}

/// One side of a comparison.
struct Side<'a> {
    snapshot: &'a Snapshot,
    file: FileId,
    request: Request,
}

impl Side<'_> {
    fn run(&self, sink: &mut impl EventSink, observer: &mut impl Observer) -> Result<Run, String> {
        let mut library = self.snapshot.setup(self.file).library(&self.snapshot.files);
        let run = gcode_session::run_observed(&self.request, &mut library, sink, observer)
            .map_err(|error| error.to_string())?;
        match (&run.outcome, run.control.is_cancelled()) {
            (Outcome::Limit, true) => Err("the run takes too long: it was ended before its end".to_owned()),
            (Outcome::Limit, false) => {
                let why = run.stop_finding().map(|finding| finding.message).unwrap_or_default();
                Err(format!("the run does not end: {why}"))
            }
            _ => Ok(run),
        }
    }
}

/// Event without its place.
type Action = (EventKind, u64);

/// Compares two runs event by event, while both go on, and returns the programs that the old one executes.
fn compare(
    old: &Side<'_>,
    new: &Side<'_>,
    renamed: &RenamedVariables,
) -> Result<Vec<ReachedProgram>, String> {
    let (sender, receiver) = sync_channel(BATCHES);
    let (old_run, new_run, first) = std::thread::scope(|scope| {
        let old_run = scope.spawn(move || {
            let mut recorder = ActionSender { sender: Some(sender), batch: Vec::new() };
            let mut reach = ReachObserver::default();
            let run = old.run(&mut recorder, &mut reach);
            recorder.flush();
            run.map(|run| (reach.reached(run.control.memory()), run))
        });
        let comparer = RefCell::new(ActionComparer { receiver, batch: Vec::new().into_iter(), first: None });
        let new_run = new.run(&mut SharedComparer(&comparer), &mut ());
        let mut comparer = comparer.into_inner();
        let is_longer = comparer.first.is_none() && new_run.is_ok() && comparer.next().is_some();
        let first = comparer.first.take();
        // A sender that waits goes on.
        drop(comparer);
        let old_run = old_run.join().unwrap_or_else(|_| Err("the run failed".to_owned()));
        (old_run, new_run, if is_longer { Some(None) } else { first.map(Some) })
    });
    let ((reached, old_run), new_run) = (old_run?, new_run?);
    let line = |span: Span| new_run.locate(span);
    match first {
        Some(Some(span)) => {
            let (program, line) = line(span);
            return Err(format!("the machine would do something else from line {line} of {program} on"));
        }
        Some(None) => return Err("the machine would do less".to_owned()),
        None => {}
    }
    let ends = [&old_run, &new_run].map(EndState::new);
    let [old, new] = ends.map(|mut end| {
        end.variables.retain(|(number, _)| !renamed.contains(number));
        end
    });
    if old.alarm != new.alarm {
        return Err("the run would end otherwise".to_owned());
    }
    if old.variables != new.variables {
        let changed = old.variables.iter().chain(&new.variables);
        let changed = changed.filter(|entry| old.variables.contains(entry) != new.variables.contains(entry));
        let number = changed.map(|(number, _)| *number).min().unwrap_or_default();
        return Err(format!("#{number} would have another value at the end"));
    }
    let is_same = old.output == new.output && old.stops == new.stops;
    if is_same { Ok(reached) } else { Err("the output of the program would change".to_owned()) }
}

/// End of a run, as far as it does not name places.
struct EndState<'a> {
    alarm: Option<AlarmCode>,
    variables: Vec<(u32, u64)>,
    output: &'a [Vec<u8>],
    stops: &'a [OperatorStop],
}

impl<'a> EndState<'a> {
    fn new(run: &'a Run) -> Self {
        let alarm = match &run.outcome {
            Outcome::Alarm(stopped) => Some(stopped.alarm.row().code),
            Outcome::End | Outcome::Limit => None,
        };
        let variables = run.control.variables().map(|(number, value)| (number, value.to_bits())).collect();
        Self { alarm, variables, output: run.control.output(), stops: run.control.stops() }
    }
}

/// Sends the events of the old run.
struct ActionSender {
    /// `None` once nothing receives them.
    sender: Option<SyncSender<Vec<Action>>>,
    batch: Vec<Action>,
}

impl ActionSender {
    fn flush(&mut self) {
        let batch = std::mem::take(&mut self.batch);
        if let Some(sender) = &self.sender
            && sender.send(batch).is_err()
        {
            self.sender = None;
        }
    }
}

impl EventSink for ActionSender {
    fn event(&mut self, event: &Event<'_>) {
        self.batch.push((event.kind.clone(), event.seconds.0.to_bits()));
        if self.batch.len() == BATCH {
            self.flush();
        }
    }
}

/// Compares the events of the new run with those of the old one.
struct ActionComparer {
    receiver: Receiver<Vec<Action>>,
    batch: std::vec::IntoIter<Action>,
    /// Block of the first event that differs.
    first: Option<Span>,
}

impl ActionComparer {
    fn next(&mut self) -> Option<Action> {
        loop {
            if let Some(action) = self.batch.next() {
                return Some(action);
            }
            self.batch = self.receiver.recv().ok()?.into_iter();
        }
    }
}

struct SharedComparer<'a>(&'a RefCell<ActionComparer>);

impl EventSink for SharedComparer<'_> {
    fn event(&mut self, event: &Event<'_>) {
        let mut comparer = self.0.borrow_mut();
        if comparer.first.is_some() {
            return;
        }
        let old = comparer.next();
        if old.is_none_or(|(kind, seconds)| kind != *event.kind || seconds != event.seconds.0.to_bits()) {
            comparer.first = Some(event.block);
        }
    }
}

/// Ends the runs of a proof.
pub(crate) fn cancel(progress: &Progress) {
    progress.cancel.store(true, Ordering::Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::opened;

    /// Proves the replacement of one part of O0001 by another, among documents.
    fn replaced(documents: &[(&str, &str)], old: &str, new: &str) -> Result<(), String> {
        let (snapshot, files) = opened(documents);
        let (index, start) = documents
            .iter()
            .enumerate()
            .find_map(|(index, (_, text))| Some((index, text.find(old)?)))
            .unwrap();
        let range = TextRange::new(start as u32, (start + old.len()) as u32);
        let edit = FileEdit { file: files[index], edit: TextEdit { range, text: new.to_owned() } };
        prove(&snapshot, &[edit], &BTreeSet::new(), &Arc::default())
    }

    const MAIN: &str = "O0001\nG90G54\nG00X1.\nG65P9001A2.\n#100=3\nN7 M30\n";

    #[test]
    fn an_edit_that_changes_no_action_is_proved() {
        assert_eq!(replaced(&[("O0001.nc", MAIN)], "N7 ", "N90   "), Ok(()));
        let documents = [("O0001.nc", MAIN), ("O9001.nc", "O9001\nG00Z#1\nM99\n")];
        assert_eq!(replaced(&documents, "G00X1.", "G00  X1.0"), Ok(()));
        assert_eq!(replaced(&documents, "Z#1", "Z[#1]"), Ok(()), "in the macro, run by its caller");
    }

    #[test]
    fn an_edit_that_changes_an_action_is_refused_with_the_place() {
        let documents = [("O0001.nc", MAIN), ("O9001.nc", "O9001\nG00Z#1\nM99\n")];
        for (old, new, why) in [
            ("X1.", "X2.", "the machine would do something else from line 3 of O0001 on"),
            ("Z#1", "Z-#1", "the machine would do something else from line 2 of O9001 on"),
            ("G65P9001A2.", "", "the machine would do less"),
            ("#100=3", "#100=4", "#100 would have another value at the end"),
            ("N7 M30", "N7 #3000=1(X)", "the run would end otherwise"),
            ("N7 M30", "N8 GOTO 8", "the run does not end: the program never ends"),
        ] {
            let found = replaced(&documents, old, new).unwrap_err();
            assert!(found.starts_with(why), "{old}: {found}");
        }
    }

    #[test]
    fn a_program_that_no_main_program_reaches_runs_alone() {
        // The alarm of the main program ends its run before the call.
        let text = "O0001\n#3000=1(STOP)\nM98P2\nM30\nO0002\n#100=3\nG00X1.\nM99\n";
        assert_eq!(replaced(&[("O0001.nc", text)], "G00X1.", "G00 X1."), Ok(()));
        let why = replaced(&[("O0001.nc", text)], "X1.", "X2.").unwrap_err();
        let expected =
            "no run of a main program reaches O0002; alone, the machine would do something else from line";
        assert!(why.starts_with(expected), "{why}");
    }

    #[test]
    fn a_cancelled_proof_is_none() {
        let (snapshot, files) =
            opened(&[("O0001.nc", "O0001\n#1=0\nWHILE[#1LT300000]DO1\n#1=#1+1\nEND1\nM30\n")]);
        let edit = TextEdit { range: TextRange::new(5, 6), text: "\n\n".to_owned() };
        let progress = Arc::new(Progress::default());
        cancel(&progress);
        let edits = [FileEdit { file: files[0], edit }];
        let found = prove(&snapshot, &edits, &BTreeSet::new(), &progress);
        assert_eq!(found, Err("the run takes too long: it was ended before its end".to_owned()));
    }
}
