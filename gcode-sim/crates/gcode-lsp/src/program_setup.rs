//! Conditions of a program in the editor: machine, control, libraries and reference, as the commands have them.
use std::path::{Path, PathBuf};

use gcode_inspect::machine::Machine;
use gcode_lang::control::Settings;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_lint::ControlKnowledge;
use gcode_part::job::{Job, control_file};
use gcode_session::Request;
use gcode_session::files::{FileAccess, Project, ProjectPaths, folder_of};

use crate::configuration::EditorSettings;
use crate::overlay::Overlay;

/// Name of a job file that counts beside a program.
const JOB_FILE: &str = "job.toml";

/// Conditions of one program.
pub(crate) struct ProgramSetup {
    /// Path of the program; for a document without a file, a path in the first folder of the workspace.
    pub path: PathBuf,
    pub project: Project,
    /// Files that the project, the editor's settings and the program's folder give.
    pub paths: ProjectPaths,
    pub machine: Machine,
    pub settings: Settings,
    pub knowledge: ControlKnowledge,
    /// Faults of the files, one sentence each; what they state is left out.
    pub faults: Vec<String>,
    /// Fault of the job beside the program, which a run does without.
    pub job_fault: Option<String>,
}

impl ProgramSetup {
    pub(crate) fn new(path: &Path, files: &Overlay, editor: &EditorSettings) -> Self {
        let mut faults = Vec::new();
        let mut note = |fault: String| faults.push(fault);
        let project = Project::of(path, files, Path::to_owned).unwrap_or_else(|error| {
            note(error.to_string());
            Project::default()
        });
        project.check_rules().unwrap_or_else(|error| note(error.to_string()));
        let of_project = project.paths(path, files);
        let beside = Some(path.with_file_name(JOB_FILE)).filter(|file| files.is_file(file));
        let paths = ProjectPaths {
            machine: editor.machine.clone().or(of_project.machine),
            control: editor.control.clone().or(of_project.control),
            dialect: editor.dialect.clone().or(of_project.dialect),
            libraries: editor.libraries.iter().cloned().chain(of_project.libraries).collect(),
            reference: of_project.reference.or_else(|| editor.reference.clone()).or(beside.clone()),
        };
        let in_file = |path: &Path, error: &dyn std::fmt::Display| format!("{}, {error}", path.display());
        let mut machine = Machine::default();
        if let Some(path) = &paths.machine {
            let parse = |text: String| Machine::parse(&text).map_err(|error| in_file(path, &error));
            match files.text(path).and_then(parse) {
                Ok(stated) => machine = stated,
                Err(fault) => note(fault),
            }
        }
        let mut settings = Request::new("", Vec::new(), machine.clone()).settings;
        let parse = |path: PathBuf| {
            let parse = |text: String| Job::parse(&text).map_err(|error| in_file(&path, &error));
            files.text(&path).and_then(parse)
        };
        let job = beside.map(parse);
        if let (Some(Ok(job)), None) = (&job, &paths.machine) {
            settings.apply_dialect(job.control().dialect);
            settings.increment = job.control().increment;
        }
        if let Some(name) = &paths.dialect
            && let Err(error) = settings.set("DIALECT", name)
        {
            note(format!("dialect: {error}"));
        }
        if let Some(path) = &paths.control {
            let mut changed = settings.clone();
            let apply = |text: String| {
                control_file::apply(&text, &mut changed, paths.dialect.is_none())
                    .map_err(|error| in_file(path, &error))
            };
            match files.text(path).and_then(apply) {
                Ok(()) => settings = changed,
                Err(fault) => note(fault),
            }
        }
        let is_stated = paths.machine.is_some() || paths.control.is_some();
        let knowledge = if is_stated { ControlKnowledge::Stated } else { ControlKnowledge::Assumed };
        let job_fault = job.and_then(Result::err);
        Self { path: path.to_owned(), project, paths, machine, settings, knowledge, faults, job_fault }
    }

    /// Returns the folders in which called programs are found, in this order.
    pub(crate) fn folders(&self) -> Vec<PathBuf> {
        std::iter::once(folder_of(&self.path).to_owned())
            .chain(self.paths.libraries.iter().cloned())
            .collect()
    }

    /// Returns the called programs.
    pub(crate) fn library(&self, files: &Overlay) -> impl Library + use<> {
        files.library(self.folders())
    }

    /// Returns the request of a run of this program.
    pub(crate) fn request(&self, text: Bytes) -> Request {
        let mut request = Request::new(self.path.display().to_string(), text, self.machine.clone());
        request.settings = self.settings.clone();
        request
    }

    /// Returns the files on which the conditions rest, existing or not.
    pub(crate) fn dependencies(&self) -> impl Iterator<Item = PathBuf> {
        let beside = ["gcode.toml", "machine.toml", JOB_FILE].map(|name| self.path.with_file_name(name));
        let project = self.project.folder().map(|folder| folder.join("gcode.toml"));
        let ProjectPaths { machine, control, reference, .. } = &self.paths;
        let named = [machine, control, reference].into_iter().flatten().cloned();
        beside.into_iter().chain(project).chain(named)
    }
}
