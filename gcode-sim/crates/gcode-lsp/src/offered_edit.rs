//! The edit of a code action as a command, for a client that takes no code actions but commands.
use std::collections::BTreeMap;

use lsp_types::{
    CodeAction, Command, DocumentChangeOperation, DocumentChanges, ExecuteCommandParams, Uri, WorkspaceEdit,
};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::failure::Failure;
use crate::snapshot::Snapshot;

/// Name of the command.
pub(crate) const APPLY: &str = "gcode-sim.apply";

/// Argument of the command.
#[derive(Debug, Serialize, Deserialize)]
struct OfferedEdit {
    title: String,
    edit: WorkspaceEdit,
    /// Versions of the open documents that the edit is made for, by their URIs.
    versions: BTreeMap<String, i32>,
}

/// Returns the command that applies the edit of an action; `None` without an edit, or for a client that can't apply one.
pub(crate) fn command(snapshot: &Snapshot, action: CodeAction) -> Option<Command> {
    let edit = action.edit.filter(|_| snapshot.client.has_apply_edit)?;
    let versions = documents(&edit).into_iter().filter_map(|uri| {
        let version = version(snapshot, uri.as_str())?;
        Some((uri.as_str().to_owned(), version))
    });
    let versions = versions.collect();
    let offered = OfferedEdit { title: action.title.clone(), edit, versions };
    Some(Command { title: action.title, command: APPLY.to_owned(), arguments: Some(vec![json!(offered)]) })
}

/// Returns the title and the edit that the command has the client apply, if the texts are still those that it is made for.
pub(crate) fn of_command(
    snapshot: &Snapshot,
    params: &ExecuteCommandParams,
) -> Result<(String, WorkspaceEdit), Failure> {
    let argument = params.arguments.first().cloned().unwrap_or_default();
    let offered = OfferedEdit::deserialize(argument)
        .map_err(|error| Failure::params(format!("{APPLY}: give the argument of a code action: {error}")))?;
    let changed = offered.versions.iter().find(|(uri, made_for)| version(snapshot, uri) != Some(**made_for));
    if changed.is_some() {
        return Err(Failure::outdated());
    }
    if !snapshot.client.has_apply_edit {
        return Err(Failure::refused(format!("{APPLY}: the client has no workspace/applyEdit")));
    }
    Ok((offered.title, offered.edit))
}

/// Returns the version of an open document.
fn version(snapshot: &Snapshot, uri: &str) -> Option<i32> {
    snapshot.documents.values().find(|document| document.uri.as_str() == uri).map(|document| document.version)
}

/// Returns the documents that an edit changes.
fn documents(edit: &WorkspaceEdit) -> Vec<&Uri> {
    let mut uris: Vec<&Uri> = edit.changes.iter().flat_map(|changes| changes.keys()).collect();
    match &edit.document_changes {
        Some(DocumentChanges::Edits(edits)) => uris.extend(edits.iter().map(|edit| &edit.text_document.uri)),
        Some(DocumentChanges::Operations(operations)) => {
            uris.extend(operations.iter().filter_map(|operation| match operation {
                DocumentChangeOperation::Edit(edit) => Some(&edit.text_document.uri),
                DocumentChangeOperation::Op(_) => None,
            }));
        }
        None => {}
    }
    uris
}
