//! Code actions: corrections of findings, and source actions that are offered with their proof.
use std::sync::Arc;

use gcode_control::Progress;
use gcode_ide::{FileEdit, FileId, FormatOptions, ProgramKey};
use lsp_types::{
    CodeAction, CodeActionDisabled, CodeActionKind, CodeActionOrCommand, CodeActionParams,
    CodeActionResponse, Diagnostic, NumberOrString, Range,
};

use crate::edits::{format_edits, renumber_edits, workspace_edit};
use crate::failure::Failure;
use crate::findings::{SOURCE, help_of};
use crate::offered_edit;
use crate::snapshot::Snapshot;

/// First sequence number and step of a renumbered program.
pub(crate) const NUMBERING: (u32, u32) = (10, 10);

/// Kind of the action that renumbers.
pub(crate) const RENUMBER: CodeActionKind = CodeActionKind::new("source.renumber");

/// Kind of the action that formats.
pub(crate) const FORMAT: CodeActionKind = CodeActionKind::new("source.format");

/// Returns the actions for a range. With `only`, those of the kinds and of the kinds below them.
pub(crate) fn code_actions(
    snapshot: &Snapshot,
    params: CodeActionParams,
    progress: &Arc<Progress>,
) -> Result<Option<CodeActionResponse>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let is_wanted = |kind: &CodeActionKind| {
        let Some(only) = &params.context.only else { return true };
        let is_in = |only: &CodeActionKind| {
            let rest = kind.as_str().strip_prefix(only.as_str());
            only.as_str().is_empty() || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        only.iter().any(is_in)
    };
    let mut actions = Vec::new();
    if is_wanted(&CodeActionKind::QUICKFIX) {
        let given = &params.context.diagnostics;
        let own = if given.is_empty() { snapshot.diagnostics(file) } else { Arc::default() };
        let here = own.iter().filter(|diagnostic| touches(diagnostic.range, params.range));
        for diagnostic in given.iter().chain(here) {
            quick_fixes(snapshot, file, diagnostic, &mut actions)?;
        }
    }
    let programs = if is_wanted(&RENUMBER) { programs_in(snapshot, file, params.range)? } else { Vec::new() };
    for program in programs {
        let title = format!("Renumber the blocks of {}", snapshot.project.label(program));
        let prove = || renumber_edits(snapshot, program, NUMBERING, progress);
        let edits = snapshot.runs.renumbering(program, progress, prove);
        actions.extend(source_action(snapshot, title, RENUMBER, edits)?);
    }
    if is_wanted(&FORMAT) {
        let edits = format_edits(snapshot, file, (None, FormatOptions::default()), progress);
        actions.extend(source_action(snapshot, "Format the file".to_owned(), FORMAT, edits)?);
    }
    let as_offered = |action| match snapshot.client.has_action_literals {
        true => Some(CodeActionOrCommand::CodeAction(action)),
        false => offered_edit::command(snapshot, action).map(CodeActionOrCommand::Command),
    };
    Ok(Some(actions.into_iter().filter_map(as_offered).collect()))
}

/// Returns the programs that a range touches; that of a file with one program, wherever the range is.
fn programs_in(snapshot: &Snapshot, file: FileId, range: Range) -> Result<Vec<ProgramKey>, Failure> {
    let (start, end) = snapshot.text_of(file)?.offsets(range);
    let range = gcode_ide::TextRange::new(start, end);
    let programs = snapshot.project.programs().filter(|(key, _)| key.file == file);
    let programs: Vec<_> = programs.map(|(key, outline)| (key, outline.range)).collect();
    let is_only = programs.len() == 1;
    let touched = programs.into_iter().filter(|(_, program)| {
        is_only || program.overlaps(range) || program.touches(start) && range.is_empty()
    });
    Ok(touched.map(|(key, _)| key).collect())
}

fn touches(one: Range, other: Range) -> bool {
    one.start <= other.end && other.start <= one.end
}

fn quick_fixes(
    snapshot: &Snapshot,
    file: FileId,
    diagnostic: &Diagnostic,
    actions: &mut Vec<CodeAction>,
) -> Result<(), Failure> {
    let Some(NumberOrString::String(code)) = &diagnostic.code else { return Ok(()) };
    if diagnostic.source.as_deref() != Some(SOURCE) {
        return Ok(());
    }
    let (start, end) = snapshot.text_of(file)?.offsets(diagnostic.range);
    let range = gcode_ide::TextRange::new(start, end);
    for fix in snapshot.project.quick_fixes(file, code, range, help_of(&diagnostic.message)) {
        let edits = fix.edits.into_iter().map(|edit| FileEdit { file, edit }).collect();
        actions.push(CodeAction {
            title: fix.title,
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(vec![diagnostic.clone()]),
            edit: Some(workspace_edit(snapshot, edits)?),
            is_preferred: fix.is_preferred.then_some(true),
            ..CodeAction::default()
        });
    }
    Ok(())
}

/// Returns an action with its edit; without one, disabled with the reason, for a client that shows it. No action if nothing
/// is to change.
fn source_action(
    snapshot: &Snapshot,
    title: String,
    kind: CodeActionKind,
    edits: Result<Vec<FileEdit>, String>,
) -> Result<Option<CodeAction>, Failure> {
    let action = CodeAction { title, kind: Some(kind), ..CodeAction::default() };
    match edits {
        Ok(edits) if edits.is_empty() => Ok(None),
        Ok(edits) => Ok(Some(CodeAction { edit: Some(workspace_edit(snapshot, edits)?), ..action })),
        Err(reason) => {
            let disabled = Some(CodeActionDisabled { reason });
            Ok(snapshot.client.has_disabled_actions.then_some(CodeAction { disabled, ..action }))
        }
    }
}
