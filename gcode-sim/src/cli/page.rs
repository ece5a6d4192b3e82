//! Writes the review page, with all inputs of the result named on it.
use std::path::Path;

use super::conditions::RunConditions;
use super::library::Folders;
use super::{UsageError, input, output, progress};
use crate::report::page::{Document, ObservedProgram, Page};
use gcode_part::Reference;
use gcode_review::Revision;
use gcode_session::{Criteria, Request, Simulation, Trace};

/// Runs and judges a program, and records the trace that the page shows.
pub(super) fn judge_traced(
    request: &mut Request,
    folders: &mut Folders,
    criteria: Option<Criteria<'_>>,
) -> Result<(Revision, Trace), UsageError> {
    let mut trace = Trace::default();
    let revision = progress::of_run(request, |request| {
        Revision::observed(request, folders, criteria, &mut (), &mut trace)
    })?;
    // The page is then not complete, and the result is.
    super::findings(&revision.truncation, &revision.simulation.run);
    Ok((revision, trace))
}

/// Writes the page of one program, with its verdict if there is a reference.
pub(super) fn write_alone(
    request: &Request,
    traced: &(Revision, Trace),
    reference: Option<(Option<&Path>, &Reference)>,
    conditions: &RunConditions,
    path: &Path,
) -> Result<(), UsageError> {
    output::write(path, alone(request, traced, reference, conditions)?.as_bytes())
}

/// Returns the page of one program as HTML.
pub(super) fn alone(
    request: &Request,
    (revision, trace): &(Revision, Trace),
    reference: Option<(Option<&Path>, &Reference)>,
    conditions: &RunConditions,
) -> Result<String, UsageError> {
    let page = Page {
        old: None,
        new: ObservedProgram::of(request, revision, trace),
        machine: &request.machine,
        reference: reference.map(|(_, reference)| reference),
        conditions: &flags(conditions, reference.and_then(|(path, _)| path)),
        documents: &documents(conditions, reference.and_then(|(path, _)| path))?,
    };
    html(&page)
}

/// Refuses a program without a move, whose page or sheet would be empty; a run that stops has its alarm to show.
pub(super) fn check_has_moves(what: &str, simulation: &Simulation) -> Result<(), UsageError> {
    let run = &simulation.run;
    if run.control.moves() == 0 && run.stop_finding().is_none() {
        return Err(UsageError::new(format!("no {what} is written: the program makes no move")));
    }
    Ok(())
}

/// Refuses a file name with another extension than .html or .htm: it could be that of a program.
pub(super) fn check_is_html(path: &Path) -> Result<(), UsageError> {
    let is_other = |extension: &std::ffi::OsStr| {
        !["html", "htm"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    };
    if path.extension().is_some_and(is_other) {
        let (path, html) = (path.display(), path.with_extension("html"));
        return Err(UsageError::new(format!("{path}: a page is an HTML file: name it {}", html.display())));
    }
    Ok(())
}

/// Writes a page to its file.
pub(super) fn write(page: &Page<'_>, path: &Path) -> Result<(), UsageError> {
    output::write(path, html(page)?.as_bytes())
}

fn html(page: &Page<'_>) -> Result<String, UsageError> {
    page.html().map_err(|error| UsageError::new(format!("the page cannot be written: {error}")))
}

/// Reads the input files besides the programs.
pub(super) fn documents(
    conditions: &RunConditions,
    reference: Option<&Path>,
) -> Result<Vec<Document>, UsageError> {
    let RunConditions { machine, control_file, part, .. } = conditions;
    let files = [
        ("machine file", machine.as_deref()),
        ("control settings", control_file.as_deref()),
        ("part for probing", part.as_deref()),
        ("reference", reference),
    ];
    let given = files.into_iter().filter_map(|(role, path)| Some((role, path?)));
    let document = |(role, path): (_, &Path)| {
        Ok(Document { role, name: path.display().to_string(), bytes: input::bytes(path)? })
    };
    given.map(document).collect()
}

/// Returns the flags that the run and its verdict depend on.
pub(super) fn flags(conditions: &RunConditions, reference: Option<&Path>) -> Vec<String> {
    let RunConditions {
        main_program,
        libraries,
        set,
        start,
        dialect,
        max_blocks,
        control,
        control_file,
        input,
        machine,
        code,
        skip,
        part,
        cycles,
    } = conditions;
    let path = |path: &Path| path.display().to_string();
    let mut flags: Vec<String> = Vec::new();
    let mut add = |flag: &str, value: &str| flags.push(format!("{flag} {value}"));
    main_program.iter().for_each(|program| add("--program", program));
    machine.iter().for_each(|file| add("--machine", &path(file)));
    reference.iter().for_each(|file| add("--reference", &path(file)));
    libraries.iter().for_each(|folder| add("--lib", &path(folder)));
    dialect.iter().for_each(|name| add("--dialect", name));
    control_file.iter().for_each(|file| add("--control-file", &path(file)));
    control.iter().for_each(|setting| add("--control", setting));
    code.iter().for_each(|call| add("--code", call));
    set.iter().for_each(|variable| add("--set", variable));
    start.iter().for_each(|position| add("--start", position));
    input.iter().for_each(|signal| add("--input", signal));
    skip.iter().for_each(|part| add("--skip", &part.to_string()));
    part.iter().for_each(|file| add("--part", &path(file)));
    cycles.iter().for_each(|count| add("--cycles", &count.to_string()));
    add("--max-blocks", &max_blocks.to_string());
    flags
}
