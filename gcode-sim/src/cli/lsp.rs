//! `gcode-sim lsp`: gives the language server its files, reports, pages, standard input and output.
#![expect(clippy::disallowed_methods, reason = "the command line finds files and reads standard input")]

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use clap::Args;
use serde_json::Value;
use tempfile::TempDir;

use super::conditions::RunConditions;
use super::disk_files::DiskFiles;
use super::project::Project;
use super::{ExitStatus, UsageError, framing, input, options, output, page};
use crate::report::run::RunReport;
use gcode_inspect::verify::Tolerances;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_lsp::{Ending, Host, serve};
use gcode_part::{NominalPart, Total};
use gcode_review::Revision;
use gcode_session::files::FileAccess;
use gcode_session::{Request, Trace};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Accepted for editors that name the transport: standard input and output is the only one
    #[arg(long)]
    stdio: bool,
}

pub(super) fn run(_: &Arguments) -> Result<ExitStatus, UsageError> {
    let host = Arc::new(EditorHost::new()?);
    let (connection, writer) = framing::stdio();
    let ending = serve(&connection, host);
    // The writer ends with the last sender of its messages; work in the background may hold one.
    drop(connection);
    writer.finish();
    Ok(match ending {
        Ending::Shutdown => ExitStatus::Passed,
        Ending::Exit => ExitStatus::Failed,
    })
}

/// The disk, the reports and the pages of this program.
#[derive(Debug)]
pub struct EditorHost {
    /// Folder of the pages that were shown.
    pages: TempDir,
}

impl EditorHost {
    /// Creates the host with a folder for pages, which goes with it.
    pub fn new() -> Result<Self, UsageError> {
        let unusable = |error| UsageError::new(format!("no folder for pages: {error}"));
        Ok(Self { pages: tempfile::Builder::new().prefix("gcode-sim-").tempdir().map_err(unusable)? })
    }
}

impl FileAccess for EditorHost {
    fn program(&self, path: &Path) -> Result<Bytes, String> {
        DiskFiles.program(path)
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        DiskFiles.text(path)
    }

    fn files(&self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        DiskFiles.files(folder)
    }

    fn is_file(&self, path: &Path) -> bool {
        DiskFiles.is_file(path)
    }

    fn canonical(&self, folder: &Path) -> Option<PathBuf> {
        DiskFiles.canonical(folder)
    }
}

impl Host for EditorHost {
    fn stamp(&self, path: &Path) -> Option<u64> {
        let about = path.metadata().ok()?;
        let since = about.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        Some((since.as_nanos() as u64).wrapping_mul(31).wrapping_add(about.len()))
    }

    fn is_text(&self, path: &Path) -> bool {
        let mut beginning = Vec::new();
        let read = std::fs::File::open(path).and_then(|file| file.take(512).read_to_end(&mut beginning));
        let is_wide = beginning.starts_with(b"\xff\xfe") || beginning.starts_with(b"\xfe\xff");
        read.is_ok() && (is_wide || !beginning.contains(&0))
    }

    fn folders(&self, path: &Path) -> Vec<PathBuf> {
        let mut entries = input::folder(path).unwrap_or_default();
        entries.retain(|entry| entry.is_dir() && !entry.is_symlink());
        entries
    }

    fn reference(&self, path: &Path) -> Result<String, String> {
        sentence(input::table(path))
    }

    fn run_report(&self, request: &Request, mut library: &mut dyn Library) -> Result<Value, String> {
        let run = sentence(gcode_session::run(request, &mut library, &mut ()))?;
        let found = run.dependencies(request);
        let assumptions = found.numbered(&run).into_iter().map(|(assumption, _)| assumption).collect();
        let assumptions = (assumptions, Total::Holes(found.count()));
        json(&RunReport::new(&run, &request.machine, None, Vec::new(), assumptions))
    }

    fn verdict_report(
        &self,
        request: &Request,
        mut library: &mut dyn Library,
        reference: &Path,
    ) -> Result<Value, String> {
        match sentence(options::read_nominal(reference, request, &mut library))? {
            NominalPart::Holes(nominal) => {
                let request = Request { process_limits: nominal.process_limits.clone(), ..request.clone() };
                let metal = request.metal(&nominal);
                let simulation = sentence(gcode_session::simulate(&request, &mut library, metal))?;
                json(&simulation.verify(&nominal, Tolerances::of(&nominal, None), &request))
            }
            NominalPart::Flutes(nominal) => {
                let grinding = sentence(gcode_session::grind(request, &mut library, &nominal))?;
                json(&grinding.verify(request))
            }
        }
    }

    fn write_page(
        &self,
        request: &Request,
        library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<PathBuf, String> {
        let html = self.page(request, library, reference)?;
        let stem = Path::new(&request.name).file_stem().unwrap_or_default().to_string_lossy();
        let path = self.pages.path().join(format!("{stem}.html"));
        sentence(output::write(&path, html.as_bytes()))?;
        Ok(path)
    }

    fn page(
        &self,
        request: &Request,
        mut library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<String, String> {
        let nominal = reference.map(|path| options::read_nominal(path, request, &mut library)).transpose();
        let nominal = sentence(nominal)?.and_then(NominalPart::into_holes);
        let metal = nominal.as_ref().map(|nominal| request.metal(nominal)).unwrap_or_default();
        let limits = nominal.as_ref().map(|nominal| nominal.process_limits.clone()).unwrap_or_default();
        let request = Request { process_limits: limits, ..request.clone() };
        let mut trace = Trace::default();
        let revision = sentence(Revision::observed(&request, &mut library, metal, &mut trace))?;
        let verdict = nominal
            .as_ref()
            .map(|nominal| revision.simulation.verify(nominal, Tolerances::of(nominal, None), &request));
        let judged = reference.zip(nominal.as_ref()).zip(verdict.as_ref());
        let judged = judged.map(|((path, nominal), verdict)| (path, nominal, verdict));
        let program = Path::new(&request.name);
        let given = RunConditions {
            main_program: request.main.as_ref().map(|main| main.name.label()),
            max_blocks: request.limits.blocks,
            ..RunConditions::default()
        };
        let (conditions, _) = sentence(Project::of(program))?.complete(program, &given);
        sentence(page::alone(&request, &(revision, trace), judged, &conditions))
    }
}

/// Returns a result whose error is a sentence.
fn sentence<T, E: std::fmt::Display>(result: Result<T, E>) -> Result<T, String> {
    result.map_err(|error| error.to_string())
}

fn json(report: &impl serde::Serialize) -> Result<Value, String> {
    sentence(serde_json::to_value(report))
}
