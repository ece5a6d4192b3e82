//! One case of `gcode-sim test`: a folder with a program, what it needs, and what was accepted of it.
use std::path::{Path, PathBuf};

use crate::changes::{Change, Record, Revision, changes};
use crate::cli::args::RunConditions;
use crate::cli::{Refusal, input, options};
use crate::diag::{Diagnostic, Severity};
use crate::exec::Limits;
use crate::part::wanted::Wanted;
use crate::session::{self, SessionError};
use crate::verify::{Answer, Tolerances};

/// The file that holds what was accepted.
pub(super) const ACCEPTED: &str = "accepted.json";

/// A folder with a program.
pub(super) struct Case {
    /// Its path below the folder that was asked for, `/` between the parts.
    pub name: String,
    pub folder: PathBuf,
    program: PathBuf,
}

/// What came of a case.
pub(super) struct Tried {
    pub name: String,
    pub answer: Tested,
    /// What the reference says against the holes, in one line.
    pub against: Option<String>,
    /// To be accepted; `None` where nothing could be run.
    pub record: Option<Record>,
}

pub(super) enum Tested {
    /// As accepted.
    Same,
    Changed(Vec<Change>),
    /// Nothing accepted yet.
    New,
    /// The case can't be used.
    Refused(String),
}

impl Tried {
    pub(super) fn is_good(&self) -> bool {
        matches!(self.answer, Tested::Same) && self.against.is_none()
    }
}

/// The cases in a folder and below it, by name. A folder with programs is a case: its main program is `main.nc` or the
/// only `.nc` there is; folders below it are its own business.
pub(super) fn find(root: &Path) -> Result<Vec<Case>, Refusal> {
    let mut cases = Vec::new();
    let mut folders = vec![(root.to_owned(), String::new())];
    while let Some((folder, name)) = folders.pop() {
        let entries = input::folder(&folder)?;
        let programs: Vec<&PathBuf> =
            entries.iter().filter(|path| path.is_file() && is_program(path)).collect();
        let main = programs.iter().find(|path| path.file_stem().is_some_and(|stem| stem == "main"));
        match (main, &programs[..]) {
            (Some(program), _) | (None, [program]) => {
                let name = if name.is_empty() { ".".to_owned() } else { name };
                cases.push(Case { name, folder, program: (*program).clone() });
            }
            (None, []) => {
                for below in entries.iter().filter(|path| path.is_dir()) {
                    let own = below.file_name().unwrap_or_default().to_string_lossy();
                    let path = if name.is_empty() { own.into_owned() } else { format!("{name}/{own}") };
                    folders.push((below.clone(), path));
                }
            }
            (None, _) => {
                let message = "holds several programs: name the one to run main.nc";
                return Err(Refusal::new(format!("{} {message}", folder.display())));
            }
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
        let refused = |refusal: Refusal| Tried {
            name: self.name.clone(),
            answer: Tested::Refused(refusal.to_string()),
            against: None,
            record: None,
        };
        self.tried(libraries, tolerance).unwrap_or_else(refused)
    }

    fn tried(&self, libraries: &[PathBuf], tolerance: f64) -> Result<Tried, Refusal> {
        let there = |name: &str| Some(self.folder.join(name)).filter(|path| path.exists());
        let conditions = RunConditions {
            machine: there("machine.toml"),
            control_file: there("control.toml"),
            libraries: there("lib").into_iter().chain(libraries.iter().cloned()).collect(),
            max_blocks: Limits::default().blocks,
            ..RunConditions::default()
        };
        let (request, mut folders) = options::request(&conditions.of(&self.program))?;
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
                fails(verdict.verdict, &verdict.diagnostics)
            }
            Some(Wanted::Flutes(flutes)) => {
                let verdict = session::grind(&request, &mut folders, flutes);
                let verdict = verdict.map_err(|error| Refusal::new(error.to_string()))?.verify();
                fails(verdict.verdict, &verdict.diagnostics)
            }
        };
        let answer = match there(ACCEPTED) {
            None => Tested::New,
            Some(path) => {
                let unusable = |error| Refusal::new(format!("{}: {error}", path.display()));
                let accepted = Record::from_json(&input::text(&path)?).map_err(|error| {
                    unusable(format!("{error}; delete it, run with --accept, and look at what was accepted"))
                })?;
                let found = changes(&accepted, &revision.record, tolerance);
                if found.is_empty() { Tested::Same } else { Tested::Changed(found) }
            }
        };
        Ok(Tried { name: self.name.clone(), answer, against, record: Some(revision.record) })
    }
}

/// The first thing that a failed verdict has against the program.
fn fails(answer: Answer, findings: &[Diagnostic]) -> Option<String> {
    let first = findings.iter().find(|finding| Severity::Error <= finding.severity);
    let words =
        || first.map_or_else(|| "not what it wants".to_owned(), |f| format!("{}: {}", f.code, f.message));
    (answer == Answer::Fail).then(words)
}
