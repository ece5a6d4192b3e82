//! Edits that prove that nothing changes: rename, format, renumber.
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gcode_control::Progress;
use gcode_ide::{FileEdit, FileId, FormatOptions, ProgramKey, Symbol, TextRange};
use lsp_types::{
    DocumentChanges, DocumentFormattingParams, DocumentRangeFormattingParams, FormattingOptions, OneOf,
    OptionalVersionedTextDocumentIdentifier, PrepareRenameResponse, RenameParams, TextDocumentEdit,
    TextDocumentPositionParams, TextEdit, WorkspaceEdit,
};

use crate::failure::Failure;
use crate::proof::{RenamedVariables, prove};
use crate::snapshot::Snapshot;
use crate::text_document::TextDocument;

/// Returns edits of files as the client takes them: with the versions of its documents, if it can.
#[expect(clippy::mutable_key_type, reason = "the protocol's type has URIs as keys")]
pub(crate) fn workspace_edit(snapshot: &Snapshot, edits: Vec<FileEdit>) -> Result<WorkspaceEdit, Failure> {
    let mut by_file: BTreeMap<FileId, Vec<TextEdit>> = BTreeMap::new();
    let mut last = None;
    for FileEdit { file, edit } in edits {
        let text = match &last {
            Some((known, text)) if *known == file => Arc::clone(text),
            _ => editable_text(snapshot, file)?,
        };
        let range = text.range(edit.range.start, edit.range.end);
        by_file.entry(file).or_default().push(TextEdit { range, new_text: edit.text });
        last = Some((file, text));
    }
    let files =
        by_file.into_iter().filter_map(|(file, edits)| Some((file, snapshot.uri(file)?.clone(), edits)));
    // The order in which files were opened decides nothing.
    let mut files: Vec<_> = files.collect();
    files.sort_by(|(_, one, _), (_, other, _)| one.as_str().cmp(other.as_str()));
    let files = files.into_iter();
    if !snapshot.client.has_document_changes {
        let changes = files.map(|(_, uri, edits)| (uri, edits)).collect();
        return Ok(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() });
    }
    let changes = files.map(|(file, uri, edits)| TextDocumentEdit {
        text_document: OptionalVersionedTextDocumentIdentifier {
            uri,
            version: snapshot.documents.get(&file).map(|document| document.version),
        },
        edits: edits.into_iter().map(OneOf::Left).collect(),
    });
    let document_changes = Some(DocumentChanges::Edits(changes.collect()));
    Ok(WorkspaceEdit { document_changes, ..WorkspaceEdit::default() })
}

/// Returns a text whose columns are those that an editor counts: the text that it has open, or a file in UTF-8.
fn editable_text(snapshot: &Snapshot, file: FileId) -> Result<Arc<TextDocument>, Failure> {
    let text = snapshot.text_of(file)?;
    if snapshot.documents.contains_key(&file) || text.bytes().file_content() == &**text.bytes() {
        return Ok(text);
    }
    let name = snapshot.path(file);
    Err(Failure::refused(format!(
        "{} is not in UTF-8, so an editor may count its columns otherwise: open it first",
        name.display()
    )))
}

pub(crate) fn prepare_rename(
    snapshot: &Snapshot,
    params: TextDocumentPositionParams,
) -> Result<Option<PrepareRenameResponse>, Failure> {
    let (file, offset) = snapshot.place(&params)?;
    if snapshot.project.symbol_at(file, offset).is_none() {
        return Ok(None);
    }
    let target = snapshot.project.prepare_rename(file, offset);
    let target = target.map_err(|refusal| Failure::refused(refusal.reason))?;
    let range = snapshot.text_of(file)?.range(target.range.start, target.range.end);
    Ok(Some(PrepareRenameResponse::RangeWithPlaceholder { range, placeholder: target.placeholder }))
}

pub(crate) fn rename(
    snapshot: &Snapshot,
    params: RenameParams,
    progress: &Arc<Progress>,
) -> Result<Option<WorkspaceEdit>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position)?;
    let edits = snapshot.project.rename(file, offset, &params.new_name);
    let edits = edits.map_err(|refusal| Failure::refused(refusal.reason))?;
    let symbol = snapshot.project.symbol_at(file, offset).map(|(symbol, _)| symbol);
    let proved = prove(snapshot, &edits, &renamed_variables(symbol, &params.new_name), progress);
    proved.map_err(|why| Failure::refused(format!("not renamed: {why}")))?;
    workspace_edit(snapshot, edits).map(Some)
}

/// Returns the variables whose values a rename exchanges.
fn renamed_variables(symbol: Option<Symbol>, new_name: &str) -> RenamedVariables {
    let old = match symbol {
        Some(Symbol::Variable { number, .. }) => number,
        Some(Symbol::Argument { local, .. }) => local,
        _ => return BTreeSet::new(),
    };
    let new = new_name.trim().trim_start_matches('#').parse().ok();
    std::iter::once(old).chain(new).collect()
}

pub(crate) fn format(
    snapshot: &Snapshot,
    params: DocumentFormattingParams,
    progress: &Arc<Progress>,
) -> Result<Option<Vec<TextEdit>>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    formatted(snapshot, file, (None, options(&params.options)), progress).map(Some)
}

pub(crate) fn format_range(
    snapshot: &Snapshot,
    params: DocumentRangeFormattingParams,
    progress: &Arc<Progress>,
) -> Result<Option<Vec<TextEdit>>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let (start, end) = snapshot.text_of(file)?.offsets(params.range);
    let range = Some(TextRange::new(start, end));
    formatted(snapshot, file, (range, options(&params.options)), progress).map(Some)
}

/// Returns those of the client's options that mean something in a program.
fn options(given: &FormattingOptions) -> FormatOptions {
    FormatOptions {
        trims_trailing_spaces: given.trim_trailing_whitespace.unwrap_or_default(),
        inserts_final_newline: given.insert_final_newline.unwrap_or_default(),
        trims_final_newlines: given.trim_final_newlines.unwrap_or_default(),
    }
}

fn formatted(
    snapshot: &Snapshot,
    file: FileId,
    what: (Option<TextRange>, FormatOptions),
    progress: &Arc<Progress>,
) -> Result<Vec<TextEdit>, Failure> {
    let edits = format_edits(snapshot, file, what, progress).map_err(Failure::refused)?;
    let text = snapshot.text_of(file)?;
    let edit = |edit: FileEdit| {
        let range = text.range(edit.edit.range.start, edit.edit.range.end);
        TextEdit { range, new_text: edit.edit.text }
    };
    Ok(edits.into_iter().map(edit).collect())
}

/// Returns the edits that format a file, or the lines of a range.
///
/// # Errors
/// The reason why they are not proved to change nothing.
pub(crate) fn format_edits(
    snapshot: &Snapshot,
    file: FileId,
    (range, options): (Option<TextRange>, FormatOptions),
    progress: &Arc<Progress>,
) -> Result<Vec<FileEdit>, String> {
    let edits = snapshot.project.format(file, range, options).into_iter().map(|edit| FileEdit { file, edit });
    let edits: Vec<_> = edits.collect();
    let proved = prove(snapshot, &edits, &BTreeSet::new(), progress);
    proved.map_err(|why| format!("not formatted: {why}"))?;
    Ok(edits)
}

/// Returns the edits that renumber the blocks of a program.
///
/// # Errors
/// The reason why a jump cannot be followed, or why the edits are not proved to change nothing.
pub(crate) fn renumber_edits(
    snapshot: &Snapshot,
    program: ProgramKey,
    (from, step): (u32, u32),
    progress: &Arc<Progress>,
) -> Result<Vec<FileEdit>, String> {
    let edits = snapshot.project.renumber(program, None, from, step);
    let edits = edits.map_err(|refusal| refusal.reason)?;
    let proved = prove(snapshot, &edits, &BTreeSet::new(), progress);
    proved.map_err(|why| format!("not renumbered: {why}"))?;
    Ok(edits)
}
