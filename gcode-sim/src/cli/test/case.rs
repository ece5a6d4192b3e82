//! One case of `gcode-sim test`: a folder with a program, its inputs, and its accepted result.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use super::claims;
use super::main_program::{self, MainProgram};
use crate::cli::conditions::RunConditions;
use crate::cli::project::Project;
use crate::cli::{UsageError, input, options};
use crate::report::test_report::{CaseAnswer, CaseReport, CaseVerdict, FirstFailure};
use gcode_control::Limits;
use gcode_inspect::verify::{self, denied_assumptions};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::Backtrace;
use gcode_part::{Assumption, NominalPart, Total};
use gcode_review::{BlockLocation, Change, Record, Revision, changes, unexecuted};
use gcode_session::files::PROGRAM_ENDINGS;
use gcode_session::{Criteria, Run};

/// Name of the file with the accepted result; behind the program's label and a point if the folder has several cases.
pub(super) const ACCEPTED: &str = "accepted.json";

/// Names of a case's reference, of which the first that is there counts.
pub(super) const REFERENCES: [&str; 3] = ["reference.json", "reference.csv", "job.toml"];

/// A folder with a program, or one of its main programs.
#[derive(Default)]
pub(super) struct Case {
    /// Path below the given folder, with `/` as separator.
    pub name: String,
    pub folder: PathBuf,
    /// The programs in the folder; empty if only an accepted result is left.
    pub programs: Vec<PathBuf>,
    /// Files that begin as programs and have another ending, if the folder has no program.
    pub others: Vec<PathBuf>,
    /// Label of the main program, if the folder has several cases: its files begin with it, `O0001.accepted.json`.
    pub label: Option<String>,
    /// The main program; `None` if the folder has none, for a reason that the run of the case states.
    pub main: Option<MainProgram>,
}

/// Terms on which all cases are run.
#[derive(Clone, Copy)]
pub(super) struct Terms<'a> {
    pub libraries: &'a [PathBuf],
    /// Tolerance for equality, mm or degrees.
    pub tolerance: f64,
    /// A case with an assumption fails.
    pub denies_assumptions: bool,
    /// Claims that are recorded as proved are proved again.
    pub proves_all: bool,
}

/// Result of a case.
pub(super) struct CaseResult {
    pub report: CaseReport,
    /// Record to be accepted; `None` if the case could not be run.
    pub record: Option<Record>,
    /// Lock file of the claims that are proved, with its text; `None` if it is as it should be.
    pub lock: Option<(PathBuf, String)>,
}

impl Case {
    /// Runs the case and compares it with its accepted result.
    pub(super) fn run(&self, terms: Terms<'_>) -> CaseResult {
        let main = self.lost().map_or_else(|| self.main_program(), Err);
        let unclear = || self.programs.first().cloned().unwrap_or_else(|| self.accepted());
        let file = main.as_ref().map_or_else(|_| unclear(), |main| main.file.clone());
        let file = Some(file.display().to_string());
        let tried = main.and_then(|program| self.evaluate(&program, terms));
        let mut result = tried.unwrap_or_else(|refusal| {
            let (answer, error) = (CaseAnswer::Refused, Some(refusal.to_string()));
            CaseResult {
                report: CaseReport { answer, error, ..CaseReport::default() },
                record: None,
                lock: None,
            }
        });
        result.report.name.clone_from(&self.name);
        result.report.file = file;
        result
    }

    fn main_program(&self) -> Result<MainProgram, UsageError> {
        match &self.main {
            Some(main) => Ok(main.clone()),
            None => Ok(main_program::of(&self.folder, &self.programs)?.remove(0)),
        }
    }

    /// Returns the path of a file of the case's own.
    fn own_file(&self, name: &str) -> PathBuf {
        match &self.label {
            Some(label) => self.folder.join(format!("{label}.{name}")),
            None => self.folder.join(name),
        }
    }

    /// Returns the path of the accepted result, or the folder's own path if the folder is gone.
    pub(super) fn accepted(&self) -> PathBuf {
        if self.folder.is_dir() { self.own_file(ACCEPTED) } else { self.folder.clone() }
    }

    /// Returns the reason why there is nothing to run.
    fn lost(&self) -> Option<UsageError> {
        let folder = self.folder.display();
        if self.folder.is_symlink() && !self.folder.exists() {
            return Some(UsageError::new(format!("{folder} is a broken link")));
        }
        if let Some(other) = self.others.first().filter(|_| self.programs.is_empty()) {
            let endings = PROGRAM_ENDINGS.join(", .");
            let (other, right) = (other.display(), other.with_extension("nc"));
            let right = right.file_name().unwrap_or_default().to_string_lossy();
            return Some(UsageError::new(format!(
                "{other} begins as a program, and its ending is none of .{endings}: rename it to {right}"
            )));
        }
        self.programs.is_empty().then(|| {
            let remedy = "restore the program, or delete the folder if the part is no longer made";
            let accepted = self.own_file(ACCEPTED);
            let accepted = accepted.file_name().unwrap_or_default().to_string_lossy();
            UsageError::new(format!("{folder} has {accepted} and no program (.nc): {remedy}"))
        })
    }

    fn evaluate(
        &self,
        main: &MainProgram,
        Terms { libraries, tolerance, denies_assumptions, proves_all }: Terms<'_>,
    ) -> Result<CaseResult, UsageError> {
        // A broken link counts as present, so that reading it reports the error.
        let present = |path: PathBuf| Some(path).filter(|path| path.exists() || path.is_symlink());
        let there = |name: &str| present(self.folder.join(name));
        let own = |name: &str| present(self.own_file(name));
        let conditions = RunConditions {
            main_program: main.path.clone(),
            machine: there("machine.toml"),
            control_file: there("control.toml"),
            libraries: there("lib").into_iter().chain(libraries.iter().cloned()).collect(),
            max_blocks: Limits::default().blocks,
            ..RunConditions::default()
        };
        let project = Project::of(&main.file)?;
        let (conditions, _) = project.complete(&main.file, &conditions);
        let arguments = conditions.of(&main.file);
        let (mut request, mut folders) = options::request(&arguments)?;
        let libraries = &arguments.conditions.libraries;
        let claims = own(claims::CLAIMS)
            .map(|file| {
                let lock = self.own_file(claims::LOCK);
                let result = claims::check(&file, &lock, &request, (&main.file, libraries), proves_all)?;
                Ok::<_, UsageError>((lock, result))
            })
            .transpose()?;
        request.denies_assumptions = denies_assumptions;
        if let (Some(one), Some(other)) = (own("reference.json"), own("reference.csv")) {
            let both = format!("{} and {}", one.display(), other.display());
            return Err(UsageError::new(format!("{both}: both are references; delete one")));
        }
        // A reference of the folder would be that of none of its programs.
        if self.label.is_some()
            && let Some(unused) = ["reference.json", "reference.csv"].into_iter().find_map(there)
        {
            let name = unused.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let right = self.own_file(&name);
            let right = right.file_name().unwrap_or_default().to_string_lossy();
            return Err(UsageError::new(format!(
                "{}: the folder has several main programs, and this names none: call that of this one {right}",
                unused.display()
            )));
        }
        let reference = REFERENCES.into_iter().find_map(own);
        let reference = reference.or_else(|| project.reference());
        let nominal = options::nominal_or_motion(reference.as_deref(), &request, &mut folders)?;
        let criteria = match &nominal {
            Some(NominalPart::Holes(reference)) => Some(Criteria::of(reference)),
            Some(NominalPart::Flutes(_)) | None => None,
        };
        let mut revision = Revision::of(&request, &mut folders, criteria)?;
        revision.record.is_verified = reference.is_some();
        if revision.is_cut_off() {
            return Err(cut_off(&revision));
        }
        let run = &revision.simulation.run;
        let (against, verdict) = match (&nominal, &revision.verdict) {
            (Some(NominalPart::Flutes(flutes)), _) => {
                let (grinding, verdict) = gcode_session::judge_flutes(&request, &mut folders, flutes)?;
                let against = fails(verdict.verdict, &verdict.diagnostics, &grinding.run);
                let (summary, total) = (Some(verdict.conclusion().line()), Total::Flutes(verdict.passes));
                (against, CaseVerdict { summary, total, assumptions: verdict.assumptions })
            }
            (_, Some(verdict)) => {
                let against = fails(verdict.verdict, &verdict.diagnostics, run);
                let total = Total::Holes(verdict.holes.len() + verdict.extra.len());
                let (summary, assumptions) = (Some(verdict.conclusion().line()), verdict.assumptions.clone());
                (against, CaseVerdict { summary, total, assumptions })
            }
            (_, None) => {
                let found = revision.simulation.dependencies(&request);
                let (assumed, total) = (found.numbered(run), Total::Holes(found.count()));
                let denied = denied_assumptions(if denies_assumptions { &assumed } else { &[] }, total);
                let against = denied.first().map(|denied| failure(Some(denied), run));
                (against, CaseVerdict { summary: None, total, assumptions: without_places(assumed) })
            }
        };
        let mut not_compared = Vec::new();
        let (answer, changes) = match own(ACCEPTED) {
            None => (CaseAnswer::New, Vec::new()),
            Some(path) => {
                let accepted = Record::from_json(&input::text(&path)?).map_err(|error| {
                    let remedy = "delete it, run with --accept, and review what was accepted";
                    UsageError::new(format!("{}: {error}; {remedy}", path.display()))
                })?;
                not_compared = accepted.unrecorded_aspects(&revision.record);
                let mut found = changes(&accepted, &revision.record.reduced_to(&accepted), tolerance);
                let unexecuted = unexecuted(&accepted, &revision.record);
                found.extend(unexecuted.into_iter().map(Change::from));
                let has_lost_reference = accepted.is_verified && !revision.record.is_verified;
                found.extend(has_lost_reference.then(Change::lost_reference));
                let answer = match (found.is_empty(), not_compared.is_empty()) {
                    (false, _) => CaseAnswer::Changed,
                    (true, false) => CaseAnswer::Older,
                    (true, true) => CaseAnswer::Same,
                };
                (answer, found)
            }
        };
        let record = &revision.record;
        let (mut counts, mut lock, mut against) = (None, None, against);
        if let Some((path, result)) = claims {
            let is_recorded = path.exists() && input::text(&path)? == result.lock;
            lock = Some((path, result.lock)).filter(|_| !is_recorded);
            counts = Some(result.counts);
            against = against.or(result.failure);
        }
        let report = CaseReport {
            answer,
            files: files(&revision, &changes, against.as_ref()),
            changes,
            not_compared,
            against,
            claims: counts,
            verdict: Some(verdict),
            totals: Some(record.totals.clone()),
            ending: Some(record.words().to_owned()),
            ..CaseReport::default()
        };
        Ok(CaseResult { report, record: Some(revision.record), lock })
    }
}

/// Returns the error of a run ended by a limit, with its last block.
fn cut_off(revision: &Revision) -> UsageError {
    let backtrace = revision.stopped().find_map(|finding| finding.backtrace.as_ref());
    let location = backtrace.map(|backtrace| BlockLocation::of(&revision.simulation.run, backtrace));
    let text =
        location.map(|BlockLocation { program, line, block, .. }| format!(" at {program}:{line} {block}"));
    let text = text.unwrap_or_default();
    UsageError::new(format!("the run was cut off by a limit{text}: the rest cannot be compared"))
}

/// Returns the first error of a failed verdict.
fn fails(answer: verify::Answer, findings: &[Diagnostic], run: &Run) -> Option<FirstFailure> {
    if answer != verify::Answer::Fail {
        return None;
    }
    Some(failure(findings.iter().find(|finding| Severity::Error <= finding.severity), run))
}

/// Returns the assumptions without their blocks.
fn without_places(assumed: Vec<(Assumption, Backtrace)>) -> Vec<Assumption> {
    assumed.into_iter().map(|(assumption, _)| assumption).collect()
}

/// Returns an error as the failure of a case.
fn failure(first: Option<&Diagnostic>, run: &Run) -> FirstFailure {
    let location = first.and_then(|first| Some(BlockLocation::of(run, first.backtrace.as_ref()?)));
    let (code, message) = match first {
        Some(first) => (first.code(), first.message.clone()),
        None => ("verdict".into(), "verification failed".to_owned()),
    };
    FirstFailure { code: code.into_owned(), message, location }
}

/// Returns the files of the programs that the changes and the failure name.
fn files(
    revision: &Revision,
    changes: &[Change],
    against: Option<&FirstFailure>,
) -> BTreeMap<String, String> {
    let locations = changes.iter().filter_map(|change| change.new.as_ref().or(change.anchor.as_ref()));
    let locations = locations
        .chain(changes.iter().flat_map(|change| &change.also).filter_map(|effect| effect.new.as_ref()));
    let locations = locations.chain(against.and_then(|against| against.location.as_ref()));
    let named: BTreeSet<&str> = locations
        .flat_map(|location| std::iter::once(location).chain(&location.calls))
        .map(|location| location.program.as_str())
        .collect();
    revision.files().into_iter().filter(|(program, _)| named.contains(program.as_str())).collect()
}
