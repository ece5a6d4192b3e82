//! One case of `gcode-sim test`: a folder with a program, what it needs, and what was accepted of it.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::main_program;
use crate::changes::{Change, Record, Revision, Where, changes};
use crate::cli::args::RunConditions;
use crate::cli::{Refusal, input, options};
use crate::diag::{Diagnostic, Severity};
use crate::exec::Limits;
use crate::part::wanted::Wanted;
use crate::report::tested::{Against, Answer, CaseReport};
use crate::session::{self, Run, SessionError};
use crate::verify::{self, Tolerances};

/// The file that holds what was accepted.
pub(super) const ACCEPTED: &str = "accepted.json";

/// A folder with a program.
pub(super) struct Case {
    /// Its path below the folder that was asked for, `/` between the parts.
    pub name: String,
    pub folder: PathBuf,
    programs: Vec<PathBuf>,
}

/// What came of a case.
pub(super) struct Tried {
    pub report: CaseReport,
    /// To be accepted; `None` where nothing could be run.
    pub record: Option<Record>,
}

/// The cases in a folder and below it, by name. A folder with programs is a case; folders below it are its own business.
pub(super) fn find(root: &Path) -> Result<Vec<Case>, Refusal> {
    let mut cases = Vec::new();
    let mut folders = vec![(root.to_owned(), String::new())];
    while let Some((folder, name)) = folders.pop() {
        let entries = input::folder(&folder)?;
        let (programs, others): (Vec<_>, Vec<_>) =
            entries.into_iter().partition(|path| is_program(path) && path.is_file());
        if programs.is_empty() {
            for below in others.into_iter().filter(|path| path.is_dir()) {
                let own = below.file_name().unwrap_or_default().to_string_lossy();
                let path = if name.is_empty() { own.into_owned() } else { format!("{name}/{own}") };
                folders.push((below, path));
            }
        } else {
            let name = if name.is_empty() { ".".to_owned() } else { name };
            cases.push(Case { name, folder, programs });
        }
    }
    cases.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(cases)
}

fn is_program(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("nc"))
}

impl Case {
    /// Runs the case and holds it against what was accepted.
    pub(super) fn run(&self, libraries: &[PathBuf], tolerance: f64) -> Tried {
        let main = main_program::of(&self.folder, &self.programs);
        let file = main.as_ref().ok().map(|path| path.display().to_string());
        let empty = |answer| CaseReport::new(self.name.clone(), file.clone(), answer);
        let tried = main.and_then(|program| self.tried(&program, libraries, tolerance, empty));
        tried.unwrap_or_else(|refusal| {
            let error = Some(refusal.to_string());
            Tried { report: CaseReport { error, ..empty(Answer::Refused) }, record: None }
        })
    }

    fn tried(
        &self,
        program: &Path,
        libraries: &[PathBuf],
        tolerance: f64,
        empty: impl Fn(Answer) -> CaseReport,
    ) -> Result<Tried, Refusal> {
        let there = |name: &str| Some(self.folder.join(name)).filter(|path| path.exists());
        let conditions = RunConditions {
            machine: there("machine.toml"),
            control_file: there("control.toml"),
            libraries: there("lib").into_iter().chain(libraries.iter().cloned()).collect(),
            max_blocks: Limits::default().blocks,
            ..RunConditions::default()
        };
        let (request, mut folders) = options::request(&conditions.of(program))?;
        let reference = ["reference.json", "reference.csv", "job.toml"].into_iter().find_map(there);
        let wanted = reference.as_deref().map(options::wanted).transpose()?;
        let surface = match &wanted {
            Some(Wanted::Holes(reference)) => reference.surface,
            Some(Wanted::Flutes(_)) | None => None,
        };
        let refused = |error: SessionError| Refusal::new(error.to_string());
        let revision = Revision::of(&request, &mut folders, surface).map_err(refused)?;
        if revision.is_cut_off() {
            let message = "the run was cut off by a limit: what lies behind it can't be compared";
            return Err(Refusal::new(message));
        }
        let against = match &wanted {
            None => None,
            Some(Wanted::Holes(reference)) => {
                let tolerances = Tolerances::of(reference, None);
                let verdict = revision.simulation.verify(reference, tolerances, &request.machine);
                fails(verdict.verdict, &verdict.diagnostics, &revision.simulation.run)
            }
            Some(Wanted::Flutes(flutes)) => {
                let grinding = session::grind(&request, &mut folders, flutes);
                let grinding = grinding.map_err(|error| Refusal::new(error.to_string()))?;
                let verdict = grinding.verify();
                fails(verdict.verdict, &verdict.diagnostics, &grinding.run)
            }
        };
        let (answer, changes) = match there(ACCEPTED) {
            None => (Answer::New, Vec::new()),
            Some(path) => {
                let unusable = |error| Refusal::new(format!("{}: {error}", path.display()));
                let accepted = Record::from_json(&input::text(&path)?).map_err(|error| {
                    unusable(format!("{error}; delete it, run with --accept, and look at what was accepted"))
                })?;
                let found = changes(&accepted, &revision.record, tolerance);
                (if found.is_empty() { Answer::Same } else { Answer::Changed }, found)
            }
        };
        let record = &revision.record;
        let report = CaseReport {
            files: files(&revision, &changes, against.as_ref()),
            changes,
            against,
            totals: Some(record.totals.clone()),
            ending: Some(record.words().to_owned()),
            ..empty(answer)
        };
        Ok(Tried { report, record: Some(revision.record) })
    }
}

/// The first thing that a failed verdict has against the program.
fn fails(answer: verify::Answer, findings: &[Diagnostic], run: &Run) -> Option<Against> {
    if answer != verify::Answer::Fail {
        return None;
    }
    let first = findings.iter().find(|finding| Severity::Error <= finding.severity);
    let place = first.and_then(|first| Some(Where::of(run, first.place.as_ref()?)));
    let (code, message) =
        first.map_or(("verdict", "not what it wants"), |first| (first.code.as_str(), first.message.as_str()));
    Some(Against { code: code.to_owned(), message: message.to_owned(), place })
}

/// The files of the programs that are named by what is told.
fn files(revision: &Revision, changes: &[Change], against: Option<&Against>) -> BTreeMap<String, String> {
    let places = changes.iter().filter_map(|change| change.new.as_ref());
    let places = places.chain(against.and_then(|against| against.place.as_ref()));
    let named: BTreeSet<&str> = places
        .flat_map(|place| std::iter::once(place).chain(&place.calls))
        .map(|place| place.program.as_str())
        .collect();
    if named.is_empty() {
        return BTreeMap::new();
    }
    revision.files().into_iter().filter(|(program, _)| named.contains(program.as_str())).collect()
}
