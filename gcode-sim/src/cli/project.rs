//! The project of a program: `gcode.toml` in its folder or one above, and `machine.toml` beside it. Flags win over both.
use std::path::{Path, PathBuf};

use super::conditions::{ProgramArguments, RunConditions};
use super::disk_files::DiskFiles;
use super::{UsageError, input, output};
use gcode_part::job::project::PROJECT_FILE;
use gcode_session::files::{self, ProjectError};

/// The project's file that holds for a program on the disk.
#[derive(Debug)]
pub(super) struct Project(files::Project);

impl Project {
    /// Finds the project of a program, which is `-` for standard input: that of the current folder.
    ///
    /// # Errors
    /// A file that cannot be read, or with an unknown key or value.
    pub(super) fn of(program: &Path) -> Result<Self, UsageError> {
        Ok(Self(files::Project::of(program, &DiskFiles, shown)?))
    }

    /// Completes conditions by the project's file and by a machine file beside the program; says what it found.
    pub(super) fn complete(&self, program: &Path, given: &RunConditions) -> (RunConditions, Vec<String>) {
        let mut conditions = given.clone();
        let mut said = Vec::new();
        let mut say = |what: &str, found: &Path| said.push(format!("{what}: {}", found.display()));
        let paths = self.0.paths(program, &DiskFiles);
        if given.machine.is_none() {
            conditions.machine = paths.machine;
            conditions.machine.iter().for_each(|path| say("machine", path));
        }
        if given.control_file.is_none() {
            conditions.control_file = paths.control;
            conditions.control_file.iter().for_each(|path| say("control", path));
        }
        if given.dialect.is_none() {
            conditions.dialect = paths.dialect;
            conditions.dialect.iter().for_each(|name| say("dialect", Path::new(name)));
        }
        for library in paths.libraries {
            say("library", &library);
            conditions.libraries.push(library);
        }
        (conditions, said)
    }

    /// Returns the reference that the project's file gives the program; says if it gives one to a program that isn't there, but
    /// has this one's name in another folder or case.
    pub(super) fn reference(&self) -> Option<PathBuf> {
        if let Some((other, own)) = self.0.misnamed_reference(&DiskFiles) {
            output::print_message(&format!(
                "note: {PROJECT_FILE}: [references] names {}, which isn't there, and not this program: {}\n",
                other.display(),
                own.display()
            ));
        }
        self.0.reference()
    }

    /// Returns true if the project's file leaves out the findings of a rule in a file.
    pub(super) fn allows(&self, rule: &str, file: &Path) -> bool {
        self.0.allows(rule, file, &DiskFiles)
    }

    /// Refuses a name in `allow` that is not a rule of `check`.
    pub(super) fn check_rules(&self) -> Result<(), UsageError> {
        Ok(self.0.check_rules()?)
    }
}

impl From<ProjectError> for UsageError {
    fn from(error: ProjectError) -> Self {
        match &error {
            ProjectError::Contents { path, error } => Self::in_toml(path, error),
            ProjectError::Unreadable(_) | ProjectError::UnknownRule { .. } => Self::new(error.to_string()),
        }
    }
}

/// Returns the project's file that holds for the programs of a folder.
pub(super) fn file_for(folder: &Path) -> Option<PathBuf> {
    let folder = input::canonical(folder).ok()?;
    files::project_folder(&folder, &DiskFiles).map(|root| root.join(PROJECT_FILE))
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
