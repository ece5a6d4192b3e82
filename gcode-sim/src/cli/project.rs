//! The project of a program: `gcode.toml` in its folder or one above, and `machine.toml` beside it. Flags win over both.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::path::{Path, PathBuf};

use super::conditions::{ProgramArguments, RunConditions};
use super::{UsageError, input, output};
use gcode_lint::rules;
use gcode_part::job::project::{PROJECT_FILE, ProjectFile};

/// Name of a machine file that counts beside a program, as the generator writes it.
pub(super) const MACHINE_FILE: &str = "machine.toml";

/// The project's file that holds for a program.
#[derive(Debug)]
pub(super) struct Project {
    /// The program's path below the folder of the file, as the file names it.
    program: PathBuf,
    found: Option<FoundFile>,
}

#[derive(Debug)]
struct FoundFile {
    /// The folder of the file, with links resolved.
    folder: PathBuf,
    /// The same folder as messages show it: from the current folder where one contains the other.
    shown: PathBuf,
    file: ProjectFile,
}

impl Project {
    /// Finds the project of a program, which is `-` for standard input: that of the current folder.
    ///
    /// # Errors
    /// A file that cannot be read, or with an unknown key or value.
    pub(super) fn of(program: &Path) -> Result<Self, UsageError> {
        let name = program.file_name().map(PathBuf::from).unwrap_or_default();
        let Ok(folder) = input::canonical(input::folder_of(program)) else {
            return Ok(Self { program: name, found: None });
        };
        let Some(root) = root(&folder) else { return Ok(Self { program: name, found: None }) };
        let below = folder.strip_prefix(root).unwrap_or(Path::new(""));
        let shown = shown(root);
        let path = shown.join(PROJECT_FILE);
        let file =
            ProjectFile::parse(&input::text(&path)?).map_err(|error| UsageError::in_toml(&path, &error))?;
        let found = FoundFile { folder: root.to_owned(), shown, file };
        Ok(Self { program: below.join(name), found: Some(found) })
    }

    /// Completes conditions by the project's file and by a machine file beside the program; says what it found.
    pub(super) fn complete(&self, program: &Path, given: &RunConditions) -> (RunConditions, Vec<String>) {
        let mut conditions = given.clone();
        let mut said = Vec::new();
        let mut say = |what: &str, found: &Path| said.push(format!("{what}: {}", found.display()));
        let entry = self.found.as_ref().map(|found| found.file.entry(&self.program)).unwrap_or_default();
        let beside = program.with_file_name(MACHINE_FILE);
        let beside = Some(beside).filter(|file| program != Path::new("-") && file.is_file());
        if given.machine.is_none() {
            conditions.machine = entry.machine.map(|path| self.shown(&path)).or(beside);
            conditions.machine.iter().for_each(|path| say("machine", path));
        }
        if given.control_file.is_none() {
            conditions.control_file = entry.control.map(|path| self.shown(&path));
            conditions.control_file.iter().for_each(|path| say("control", path));
        }
        if given.dialect.is_none() {
            conditions.dialect = entry.dialect;
            conditions.dialect.iter().for_each(|name| say("dialect", Path::new(name)));
        }
        for library in entry.libraries.iter().map(|path| self.shown(path)) {
            say("library", &library);
            conditions.libraries.push(library);
        }
        (conditions, said)
    }

    /// Returns the reference that the project's file gives the program.
    pub(super) fn reference(&self) -> Option<PathBuf> {
        let entry = self.found.as_ref()?.file.entry(&self.program);
        entry.reference.map(|path| self.shown(&path))
    }

    /// Returns true if the project's file leaves out the findings of a rule in a file.
    pub(super) fn allows(&self, rule: &str, file: &Path) -> bool {
        let Some(found) = &self.found else { return false };
        let Ok(folder) = input::canonical(input::folder_of(file)) else { return false };
        let below = folder.strip_prefix(&found.folder).ok();
        below.is_some_and(|below| found.file.allows(rule, &below.join(file.file_name().unwrap_or_default())))
    }

    /// Refuses a name in `allow` that is not a rule of `check`.
    pub(super) fn check_rules(&self) -> Result<(), UsageError> {
        let Some(found) = &self.found else { return Ok(()) };
        let is_rule = |name: &str| rules::ALL.iter().any(|rule| rule.kind.code.eq_ignore_ascii_case(name));
        match found.file.allowed_rules().find(|name| !is_rule(name)) {
            Some(name) => {
                let why = format!("key 'allow': '{name}' is not a rule of check: docs/checks.md lists them");
                Err(UsageError::in_file(&found.shown.join(PROJECT_FILE), why))
            }
            None => Ok(()),
        }
    }

    /// Returns a path of the project's file as messages show it.
    fn shown(&self, path: &Path) -> PathBuf {
        self.found.as_ref().map_or_else(|| path.to_owned(), |found| found.shown.join(path))
    }
}

/// Returns the nearest folder with a project's file, from a folder upwards.
fn root(folder: &Path) -> Option<&Path> {
    folder.ancestors().find(|folder| folder.join(PROJECT_FILE).is_file())
}

/// Returns the project's file that holds for the programs of a folder.
pub(super) fn file_for(folder: &Path) -> Option<PathBuf> {
    let folder = input::canonical(folder).ok()?;
    root(&folder).map(|root| root.join(PROJECT_FILE))
}

/// Returns a folder from the current one: below it or above it, otherwise as it is.
fn shown(folder: &Path) -> PathBuf {
    let Ok(current) = input::canonical(Path::new(".")) else { return folder.to_owned() };
    if let Ok(below) = folder.strip_prefix(&current) {
        return below.to_owned();
    }
    match current.strip_prefix(folder) {
        Ok(above) => above.components().map(|_| "..").collect(),
        Err(_) => folder.to_owned(),
    }
}

impl ProgramArguments {
    /// Completes the conditions by the project of the program, and says on standard error what it found.
    pub(super) fn completed(&self) -> Result<(Self, Project), UsageError> {
        let project = Project::of(&self.program)?;
        let (conditions, said) = project.complete(&self.program, &self.conditions);
        say(&said);
        Ok((Self { program: self.program.clone(), conditions }, project))
    }
}

/// Prints what a project gives, in one line.
pub(super) fn say(said: &[String]) {
    if !said.is_empty() {
        output::print_message(&format!("{}\n", said.join("; ")));
    }
}
