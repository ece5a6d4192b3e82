//! `gcode-sim lsp`: gives the language server its files, reports, pages, standard input and output.
#![expect(clippy::disallowed_methods, reason = "the command line finds files and reads standard input")]

use std::io::Read;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant, UNIX_EPOCH};

use clap::Args;
use serde_json::Value;
use tempfile::TempDir;

use super::conditions::RunConditions;
use super::disk_files::DiskFiles;
use super::project::Project;
use super::rerun::Rerun;
use super::test::reference_beside;
use super::{ExitStatus, UsageError, framing, input, options, output, page};
use crate::report::explain::ExplainReport;
use crate::report::proof::ProofReport;
use crate::report::run::{RunReport, StopRecorder};
use gcode_control::Control;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_lsp::{Host, LibrarySource, SessionEnd, serve};
use gcode_part::{NominalPart, Total};
use gcode_prove::{Ask, Setup, Watch, prove};
use gcode_review::Revision;
use gcode_session::files::FileAccess;
use gcode_session::{Criteria, Request, Trace};

/// Exit code of a server that a signal ends.
const SIGNALLED: i32 = 1;

/// Time of a proof for an editor.
const PROOF_TIME: Duration = Duration::from_secs(10);

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Accepted for editors that name the transport: standard input and output is the only one
    #[arg(long)]
    stdio: bool,
}

pub(super) fn run(_: &Arguments) -> Result<ExitStatus, UsageError> {
    let host = Arc::new(EditorHost::default());
    let at_signal = Arc::clone(&host);
    // Work in the background may hold the host: the folder of pages is removed by its name.
    _ = ctrlc::set_handler(move || {
        at_signal.remove_pages();
        std::process::exit(SIGNALLED);
    });
    let (connection, writer) = framing::stdio();
    let ending = serve(&connection, Arc::clone(&host) as Arc<dyn Host>);
    // The writer ends with the last sender of its messages; work in the background may hold one.
    drop(connection);
    writer.finish();
    host.remove_pages();
    Ok(match ending {
        SessionEnd::Shutdown => ExitStatus::Passed,
        SessionEnd::Exit => ExitStatus::Failed,
    })
}

/// The disk, the reports and the pages of this program.
#[derive(Debug, Default)]
pub struct EditorHost {
    /// Folder of the pages that were shown; none before the first page.
    pages: Mutex<Option<TempDir>>,
}

impl EditorHost {
    /// Returns the folder of pages, created with the first page.
    fn page_folder(&self) -> Result<PathBuf, String> {
        let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = match pages.take() {
            Some(folder) => folder,
            None => tempfile::Builder::new()
                .prefix("gcode-sim-")
                .tempdir()
                .map_err(|error| format!("no folder for pages: {error}"))?,
        };
        Ok(pages.insert(folder).path().to_owned())
    }

    /// Removes the folder of pages.
    fn remove_pages(&self) {
        _ = self.pages.lock().unwrap_or_else(PoisonError::into_inner).take().map(TempDir::close);
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

    #[cfg(unix)]
    fn is_alive(&self, process: u32) -> bool {
        use rustix::process::{Pid, test_kill_process};
        let id = i32::try_from(process).ok().and_then(Pid::from_raw);
        // A process of another user refuses the signal.
        id.is_none_or(|id| test_kill_process(id) != Err(rustix::io::Errno::SRCH))
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
        json(&RunReport::new(
            &run,
            &request.machine,
            (&StopRecorder::default(), None),
            Vec::new(),
            assumptions,
        ))
    }

    fn verdict_report(
        &self,
        request: &Request,
        mut library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<Option<Value>, String> {
        let main = request.main.as_ref().map(|main| main.name.label());
        let beside = || reference_beside(Path::new(&request.name), main.as_deref());
        let reference = reference.map(Path::to_owned).or_else(beside);
        let nominal = sentence(options::nominal_to_verify(reference.as_deref(), request, &mut library))?;
        let report = |nominal| match nominal {
            NominalPart::Holes(nominal) => {
                let criteria = Criteria::of(&nominal);
                let judged = gcode_session::judge_holes(request, &mut library, criteria, &mut (), &mut ());
                json(&sentence(judged)?.1)
            }
            NominalPart::Flutes(nominal) => {
                json(&sentence(gcode_session::judge_flutes(request, &mut library, &nominal))?.1)
            }
        };
        nominal.map(report).transpose()
    }

    fn proof_report(
        &self,
        request: &Request,
        libraries: LibrarySource<'_>,
        (ranges, claims): (&[String], &[String]),
    ) -> Result<Value, String> {
        let ask = Ask {
            ranges: ranges.to_vec(),
            claims: claims.to_vec(),
            max_blocks: request.limits.blocks,
            threads: std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN),
            ..Ask::default()
        };
        let start = Instant::now();
        let clock = || start.elapsed();
        let controls = EditedProgram { request, libraries };
        let answer = sentence(prove(&controls, &ask, &Watch::new(&clock, PROOF_TIME)))?;
        // JSON has the values of a counterexample and not the command.
        let rerun = Rerun::new(Path::new(&request.name), &RunConditions::default(), None);
        json(&ProofReport::new(&answer, start.elapsed().as_secs_f64(), rerun))
    }

    fn explanation(&self, code: &str) -> Option<PathBuf> {
        // All servers of a version link the same page, also after a restart of the editor.
        let folder = std::env::temp_dir().join(concat!("gcode-sim-pages-", env!("CARGO_PKG_VERSION")));
        let path = folder.join(format!("{code}.md"));
        let text = ExplainReport::of(code)?.markdown();
        if std::fs::read(&path).is_ok_and(|known| known == text.as_bytes()) {
            return Some(path);
        }
        std::fs::create_dir_all(&folder).ok()?;
        output::write(&path, text.as_bytes()).ok()?;
        Some(path)
    }

    fn write_page(
        &self,
        request: &Request,
        library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<PathBuf, String> {
        let html = self.page(request, library, reference)?;
        let stem = Path::new(&request.name).file_stem().unwrap_or_default().to_string_lossy();
        let path = self.page_folder()?.join(format!("{stem}.html"));
        sentence(output::write(&path, html.as_bytes()))?;
        Ok(path)
    }

    fn page(
        &self,
        request: &Request,
        mut library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<String, String> {
        let nominal = sentence(options::nominal_or_motion(reference, request, &mut library))?;
        let nominal = nominal.and_then(NominalPart::into_holes);
        let mut trace = Trace::default();
        let criteria = nominal.as_ref().map(Criteria::of);
        let revision = sentence(Revision::observed(request, &mut library, criteria, &mut (), &mut trace))?;
        let judged = nominal.as_ref().map(|nominal| (reference, nominal));
        let program = Path::new(&request.name);
        let given = RunConditions {
            main_program: request.main.as_ref().map(|main| main.name.label()),
            max_blocks: request.limits.blocks,
            ..RunConditions::default()
        };
        let (conditions, _) = sentence(Project::of(program))?.complete(program, &given);
        sentence(page::alone(request, &(revision, trace), judged, &conditions))
    }
}

/// Source of the controls of a proof: a program as the editor has it.
struct EditedProgram<'a> {
    request: &'a Request,
    libraries: LibrarySource<'a>,
}

impl Setup for EditedProgram<'_> {
    type Library = EditedPrograms;

    fn control(&self, settings: &[(String, String)]) -> Result<Control, String> {
        let request = sentence(self.request.with_settings(settings))?;
        sentence(gcode_session::set_up(&request, None))
    }

    fn library(&self) -> Self::Library {
        EditedPrograms((self.libraries)())
    }
}

/// Called programs as the editor has them.
struct EditedPrograms(Box<dyn Library>);

impl Library for EditedPrograms {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        self.0.program(number)
    }

    fn named(&mut self, name: &str) -> Option<(String, Bytes)> {
        self.0.named(name)
    }

    fn read_error(&self) -> Option<String> {
        self.0.read_error()
    }
}

/// Returns a result whose error is a sentence.
fn sentence<T, E: std::fmt::Display>(result: Result<T, E>) -> Result<T, String> {
    result.map_err(|error| error.to_string())
}

fn json(report: &impl serde::Serialize) -> Result<Value, String> {
    sentence(serde_json::to_value(report))
}
