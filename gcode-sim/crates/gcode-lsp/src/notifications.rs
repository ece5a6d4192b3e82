//! Notifications of the client by method.
use std::path::PathBuf;
use std::sync::Arc;

use lsp_server::{Notification, RequestId};
use lsp_types::notification::{
    Cancel, DidChangeConfiguration, DidChangeTextDocument, DidChangeWatchedFiles, DidChangeWorkspaceFolders,
    DidCloseTextDocument, DidOpenTextDocument, DidSaveTextDocument, Initialized, LogMessage,
    Notification as Kind,
};
use lsp_types::request::{RegisterCapability, WorkspaceConfiguration};
use lsp_types::{
    ConfigurationItem, ConfigurationParams, DidChangeWatchedFilesRegistrationOptions, FileSystemWatcher,
    GlobPattern, LogMessageParams, MessageType, NumberOrString, Registration, RegistrationParams,
};
use serde_json::Value;

use crate::configuration::{EditorSettings, SECTION};
use crate::document_uri;
use crate::state::ServerState;
use crate::workspace_scan::ENDINGS;

/// Takes a notification; one that is unknown or malformed changes nothing.
pub(crate) fn take(state: &mut ServerState, notification: Notification) {
    let Notification { method, params } = notification;
    let taken = match method.as_str() {
        Initialized::METHOD => {
            initialized(state);
            Ok(())
        }
        DidOpenTextDocument::METHOD => decode::<DidOpenTextDocument>(params).map(|params| {
            let document = params.text_document;
            state.open(document.uri, document.version, document.text);
        }),
        DidChangeTextDocument::METHOD => decode::<DidChangeTextDocument>(params).map(|params| {
            let document = params.text_document;
            state.change(&document.uri, document.version, params.content_changes);
        }),
        DidCloseTextDocument::METHOD => {
            decode::<DidCloseTextDocument>(params).map(|params| state.close(&params.text_document.uri))
        }
        DidSaveTextDocument::METHOD => decode::<DidSaveTextDocument>(params).map(|_| state.poll_disk()),
        DidChangeWatchedFiles::METHOD => decode::<DidChangeWatchedFiles>(params).map(|params| {
            let paths: Vec<_> =
                params.changes.iter().filter_map(|change| document_uri::path(&change.uri)).collect();
            state.changed_on_disk(&paths);
        }),
        DidChangeWorkspaceFolders::METHOD => decode::<DidChangeWorkspaceFolders>(params).map(|params| {
            let removed: Vec<_> =
                params.event.removed.iter().filter_map(|folder| document_uri::path(&folder.uri)).collect();
            let added = params.event.added.iter().filter_map(|folder| document_uri::path(&folder.uri));
            let folders = Arc::make_mut(&mut state.snapshot.folders);
            folders.retain(|folder| !removed.contains(folder));
            folders.extend(added);
            state.forget_folders(&removed);
            state.start_scan();
        }),
        DidChangeConfiguration::METHOD => decode::<DidChangeConfiguration>(params).map(|params| {
            if state.snapshot.client.has_configuration {
                ask_configuration(state);
            } else if !params.settings.is_null() {
                set_configuration(state, &params.settings);
            }
        }),
        Cancel::METHOD => decode::<Cancel>(params).map(|params| {
            let id = match params.id {
                NumberOrString::Number(number) => RequestId::from(number),
                NumberOrString::String(text) => RequestId::from(text),
            };
            state.cancel(&id);
        }),
        _ => Ok(()),
    };
    if let Err(error) = taken {
        let message = format!("{method}: {error}");
        state.notify::<LogMessage>(LogMessageParams { typ: MessageType::ERROR, message });
    }
}

fn decode<N: Kind>(params: Value) -> Result<N::Params, serde_json::Error> {
    serde_json::from_value(params)
}

fn initialized(state: &mut ServerState) {
    if state.snapshot.client.can_register_watchers {
        let endings = ENDINGS.map(|ending| format!("{ending},{}", ending.to_ascii_uppercase())).join(",");
        let globs = [format!("**/*.{{{endings},txt,toml,json,csv}}"), "**/[Oo][0-9]*".to_owned()];
        let watchers =
            globs.map(|glob| FileSystemWatcher { glob_pattern: GlobPattern::String(glob), kind: None });
        let options = DidChangeWatchedFilesRegistrationOptions { watchers: watchers.to_vec() };
        let registration = Registration {
            id: "gcode-sim files".to_owned(),
            method: DidChangeWatchedFiles::METHOD.to_owned(),
            register_options: serde_json::to_value(options).ok(),
        };
        state.ask::<RegisterCapability>(RegistrationParams { registrations: vec![registration] });
    }
    if state.snapshot.client.has_configuration {
        ask_configuration(state);
    }
    state.start_scan();
}

fn ask_configuration(state: &mut ServerState) {
    let items = vec![ConfigurationItem { scope_uri: None, section: Some(SECTION.to_owned()) }];
    let id = state.ask::<WorkspaceConfiguration>(ConfigurationParams { items });
    state.configuration_requests.insert(id);
}

/// Takes over settings of the editor.
pub(crate) fn set_configuration(state: &mut ServerState, value: &Value) {
    let folder: Option<PathBuf> = state.snapshot.folders.first().cloned();
    match EditorSettings::parse(value) {
        Ok(settings) => {
            let settings = settings.below(folder.as_deref());
            if settings != *state.snapshot.editor {
                state.snapshot.editor = Arc::new(settings);
                state.settings_changed();
            }
        }
        Err(fault) => state.show_message(MessageType::WARNING, fault),
    }
}
