//! `gcode-sim diff`: compares two revisions of a program by their effect.
use std::path::{Path, PathBuf};

use clap::Args;

use super::conditions::RunConditions;
use super::format::FindingFormat;
use super::options::EqualityArguments;
use super::picture_file::PictureFile;
use super::project::{self, Project};
use super::{ExitStatus, UsageError, options, output, page, progress, render, unused_machine};
use crate::report::changed_view;
use crate::report::changes::{ChangesReport, change_found};
use crate::report::page::{Difference, ObservedProgram, Page};
use crate::report::sarif::{FileLocation, Finding};
use gcode_inspect::tool_path::{PathRecorder, ToolPath};
use gcode_review::{Revision, RevisionDiff, unexecuted};
use gcode_session::{Criteria, Trace};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The revision on the machine
    #[arg(value_name = "OLD.nc")]
    old: PathBuf,

    /// The revision to review
    #[arg(value_name = "NEW.nc")]
    new: PathBuf,

    /// A folder that holds the programs OLD.nc calls, instead of --lib (repeatable)
    #[arg(long = "old-lib", value_name = "DIR")]
    old_libraries: Vec<PathBuf>,

    #[command(flatten)]
    equality: EqualityArguments,

    /// Also draw the new holes over the old ones to this file
    #[arg(long, value_name = "OUT.png", value_parser = PictureFile::parser())]
    picture: Option<PictureFile>,

    /// Also write a review page to this file: both programs side by side, their holes, paths, blocks and variables;
    /// opens in any browser
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,

    /// The reference for the page: a hole list (JSON or CSV) or a job file (TOML)
    #[arg(long, value_name = "REF", requires = "page")]
    reference: Option<PathBuf>,

    /// Output format
    #[arg(long, value_enum, default_value_t = FindingFormat::Text)]
    format: FindingFormat,

    #[command(flatten)]
    run: RunConditions,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let tolerance = arguments.equality.tolerance()?;
    let programs = [arguments.old.as_path(), arguments.new.as_path()];
    let files: Vec<&Path> =
        programs.into_iter().chain(arguments.run.files()).chain(arguments.reference.as_deref()).collect();
    options::check_files(
        &files,
        arguments.picture.as_ref().map(PictureFile::path),
        arguments.page.as_deref(),
    )?;
    let mut before = arguments.run.clone();
    if !arguments.old_libraries.is_empty() {
        before.libraries.clone_from(&arguments.old_libraries);
    }
    // One machine for both revisions: the differences are those of the programs.
    let of_project = if arguments.new == Path::new("-") { &arguments.old } else { &arguments.new };
    let project = Project::of(of_project)?;
    let (before, _) = project.complete(of_project, &before);
    let (after, said) = project.complete(of_project, &arguments.run);
    project::say(&said);
    let (mut old_request, mut old_folders) = options::request(&before.of(&arguments.old))?;
    let (mut new_request, mut new_folders) = options::request(&after.of(&arguments.new))?;
    unused_machine::warn_unused_machine(&after.of(&arguments.new), &new_request);
    let path = arguments.reference.as_deref();
    let named = path.unwrap_or(Path::new("")).display();
    let refusal =
        format!("--reference {named}: a page verifies holes, and this is a burr: omit the reference");
    let reference = options::read_holes(path, &new_request, &mut new_folders, &refusal)?;
    let criteria = reference.as_ref().map(Criteria::of);
    let trace = || arguments.page.as_ref().map(|_| Trace::default());
    let (mut old_trace, mut new_trace) = (trace(), trace());
    let machines = [&old_request, &new_request].map(|request| request.machine.clone());
    let [mut old_path, mut new_path] =
        machines.each_ref().map(|machine| arguments.picture.as_ref().map(|_| PathRecorder::new(machine)));
    let [old, new] = progress::of_two_runs(
        [&mut old_request, &mut new_request],
        |request| Revision::observed(request, &mut old_folders, criteria, &mut old_path, &mut old_trace),
        |request| Revision::observed(request, &mut new_folders, criteria, &mut new_path, &mut new_trace),
    );
    let (old, new) = (old?, new?);
    let compared = RevisionDiff::new(&old.record, &new.record, tolerance);
    let unexecuted = unexecuted(&old.record, &new.record);
    let report = ChangesReport::new(
        (&old_request.name, &old.record),
        (&new_request.name, &new.record),
        &compared.changes,
        unexecuted.clone(),
        tolerance,
    );
    match arguments.format {
        FindingFormat::Json => output::json(&report)?,
        FindingFormat::Text => {
            output::print(&report.text())?;
            if new.simulation.run.control.is_inch() && !compared.changes.is_empty() {
                output::print("the programs are in inches; above, lengths and Q are in mm, F in mm/min\n")?;
            }
        }
        FindingFormat::Sarif => output::sarif(findings(&compared, &new, &new_request.name), None)?,
    }
    if let Some(file) = &arguments.picture {
        let names = [&new_request, &old_request].map(render::name);
        // Equal names are distinguished by their folders.
        let [is, was] = if names[0] == names[1] {
            [&new_request, &old_request].map(|request| request.name.clone())
        } else {
            names
        };
        let name = format!("{is} against {was}");
        let (machine, reference) = (&new_request.machine, reference.as_ref());
        let paths =
            [old_path, new_path].map(|path| path.map_or_else(ToolPath::default, PathRecorder::finish));
        let drawn = (reference, &paths);
        let view = changed_view::of_changes(&name, (&old, &new), machine, (&compared, tolerance), drawn);
        let picture = gcode_draw::top_view(&view);
        file.draw(&picture, gcode_draw::Size::default())?;
        output::written("picture", file.path(), arguments.format == FindingFormat::Text)?;
    }
    if let (Some(path), Some(old_trace), Some(new_trace)) = (&arguments.page, &old_trace, &new_trace) {
        let difference = Difference { compared: &compared, unexecuted: &unexecuted, tolerance };
        let of_old = arguments.old_libraries.iter().map(|folder| format!("--old-lib {}", folder.display()));
        let flags: Vec<String> =
            page::flags(&after, arguments.reference.as_deref()).into_iter().chain(of_old).collect();
        let review = Page {
            old: Some((ObservedProgram::of(&old_request, &old, old_trace), difference)),
            new: ObservedProgram::of(&new_request, &new, new_trace),
            machine: &new_request.machine,
            reference: reference.as_ref(),
            conditions: &flags,
            documents: &page::documents(&after, arguments.reference.as_deref())?,
        };
        page::write(&review, path)?;
        output::written("page", path, arguments.format == FindingFormat::Text)?;
    }
    let mut status = if compared.changes.is_empty() { ExitStatus::Passed } else { ExitStatus::Failed };
    for revision in [&old, &new] {
        status = status.max(super::findings(revision.stopped(), &revision.simulation.run));
    }
    Ok(status)
}

/// Returns the findings for a code review: the changes at their locations in the new revision, and its alarm or
/// limit.
fn findings(compared: &RevisionDiff, new: &Revision, file: &str) -> Vec<Finding> {
    let (files, sources) = (new.files(), new.simulation.run.control.memory().sources());
    // Code-review tools reject a result without a location.
    let first = FileLocation { file: file.to_owned(), line: Some(1), column: None };
    let found = |change| {
        let found = change_found(change, "", &files);
        Finding { at: found.at.or_else(|| Some(first.clone())), ..found }
    };
    let changes = compared.changes.iter().map(found);
    changes.chain(new.stopped().map(|stopped| Finding::of(stopped, sources))).collect()
}
