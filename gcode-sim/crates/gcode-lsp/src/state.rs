//! State of the server: the snapshot of all texts, the work in the background, and the published diagnostics.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam_channel::Sender;
use gcode_control::Progress;
use gcode_ide::FileId;
use gcode_lang::control::Settings;
use lsp_server::{Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{Notification as _, PublishDiagnostics, ShowMessage};
use lsp_types::request::{InlayHintRefreshRequest, SemanticTokensRefresh};
use lsp_types::{Diagnostic, MessageType, PublishDiagnosticsParams, ShowMessageParams, Uri};

use crate::check_basis::CheckBasis;
use crate::checker::{self, CheckAnswer, CheckJob};
use crate::commands::CommandResult;
use crate::document_uri;
use crate::failure::Failure;
use crate::findings::CheckedDocument;
use crate::hint_refresh::HintRefresh;
use crate::host::Host;
use crate::overlay::Overlay;
use crate::proof;
use crate::runs::Runs;
use crate::snapshot::Snapshot;
use crate::workspace_scan;

/// Largest size of the programs that are read with one that is opened, or of a workspace, bytes.
const MAX_NEIGHBOURS: usize = 64 << 20;

/// Result of work in the background.
pub(crate) enum BackgroundAnswer {
    Checked(CheckAnswer),
    Answered(Response),
    Executed(RequestId, Result<CommandResult, Failure>),
    /// Program files of the workspace; the last one is empty.
    Scanned(Vec<PathBuf>),
}

/// Request that is answered in the background.
pub(crate) struct PendingRequest {
    pub progress: Arc<Progress>,
    /// An edit makes the answer useless.
    pub ends_with_edit: bool,
}

/// State of the server.
pub(crate) struct ServerState {
    pub snapshot: Snapshot,
    /// Requests in the background.
    pub pending: BTreeMap<RequestId, PendingRequest>,
    /// Requests that wait for the scan of the workspace.
    pub waiting: Vec<Request>,
    pub is_scanning: bool,
    /// Requests to the client whose answer matters: configuration.
    pub configuration_requests: BTreeSet<RequestId>,
    pub background: Sender<BackgroundAnswer>,
    out: Sender<Message>,
    checks: Sender<CheckJob>,
    next_request: i32,
    /// Request to the client to ask for hints again, until it answers.
    hint_refresh: HintRefresh,
    /// Control of each document.
    settings: BTreeMap<FileId, Settings>,
    /// On what the diagnostics of each document rest.
    checked: BTreeMap<FileId, CheckBasis>,
    /// Number of changes of all documents.
    changes: u64,
    /// Last change of each document, and the last one with other programs.
    last_changes: BTreeMap<FileId, (u64, u64)>,
    /// Number of changes at the last job of each document.
    jobs: BTreeMap<FileId, u64>,
    /// Faults of the configuration that were shown.
    shown_faults: BTreeSet<String>,
    /// Length of all programs that were read and no document has opened.
    read_bytes: usize,
}

impl ServerState {
    pub(crate) fn new(
        host: Arc<dyn Host>,
        out: Sender<Message>,
        background: Sender<BackgroundAnswer>,
    ) -> Self {
        let answers = background.clone();
        let checks = checker::start(move |answer| _ = answers.send(BackgroundAnswer::Checked(answer)));
        Self {
            snapshot: Snapshot::new(Overlay::new(host)),
            pending: BTreeMap::new(),
            waiting: Vec::new(),
            is_scanning: false,
            configuration_requests: BTreeSet::new(),
            background,
            out,
            checks,
            next_request: 0,
            hint_refresh: HintRefresh::default(),
            settings: BTreeMap::new(),
            checked: BTreeMap::new(),
            changes: 0,
            last_changes: BTreeMap::new(),
            jobs: BTreeMap::new(),
            shown_faults: BTreeSet::new(),
            read_bytes: 0,
        }
    }

    /// Sends a message. A client that is gone reads none, and the end of its messages ends the server.
    pub(crate) fn send(&self, message: impl Into<Message>) {
        _ = self.out.send(message.into());
    }

    pub(crate) fn notify<N: lsp_types::notification::Notification>(&self, params: N::Params) {
        self.send(Notification::new(N::METHOD.to_owned(), params));
    }

    /// Sends a request to the client and returns its id.
    pub(crate) fn ask<R: lsp_types::request::Request>(&mut self, params: R::Params) -> RequestId {
        let id = RequestId::from(format!("gcode-sim {}", self.next_request));
        self.next_request += 1;
        self.send(Request::new(id.clone(), R::METHOD.to_owned(), params));
        id
    }

    pub(crate) fn show_message(&self, typ: MessageType, message: String) {
        self.send(Notification::new(ShowMessage::METHOD.to_owned(), ShowMessageParams { typ, message }));
    }

    /// Ends the runs of the texts before a change.
    fn outdate_runs(&mut self) {
        let old = std::mem::replace(&mut self.snapshot.runs, Arc::new(Runs::default()));
        old.outdate();
    }

    /// Schedules the check of a document.
    fn check(&mut self, file: FileId, is_edited: bool) {
        if document_uri::is_other_text(&self.snapshot.path(file)) {
            return;
        }
        let changes = self.changes;
        self.jobs.insert(file, changes);
        _ = self.checks.send(CheckJob { snapshot: self.snapshot.clone(), file, is_edited, changes });
    }

    /// Takes over an opened document.
    pub(crate) fn open(&mut self, uri: Uri, version: i32, text: String) {
        let file = self.snapshot.number(&uri);
        self.take_settings(file);
        self.use_settings(file);
        let file = self.snapshot.open(uri, version, text);
        // Its versions begin anew.
        Arc::make_mut(&mut self.snapshot.published).remove(&file);
        self.read_neighbours(file);
        self.changed(file, true);
    }

    /// Reads the programs of the folders in which the programs that a document calls are found.
    fn read_neighbours(&mut self, file: FileId) {
        use gcode_session::files::FileAccess;
        if document_uri::path(&self.snapshot.documents[&file].uri).is_none()
            && self.snapshot.folders.is_empty()
        {
            return;
        }
        for folder in self.snapshot.setup(file).folders() {
            for path in self.snapshot.files.files(&folder).unwrap_or_default() {
                let is_known = document_uri::of_path(&path).is_some_and(|uri| {
                    self.snapshot.known(&uri).is_some_and(|file| self.snapshot.project.file(file).is_some())
                });
                if is_known || !workspace_scan::is_program(&path, &self.snapshot.files) {
                    continue;
                }
                self.read_within_budget(&path);
            }
        }
    }

    /// Reads a program that no document has opened, as long as all of them are not too long.
    pub(crate) fn read_within_budget(&mut self, path: &Path) {
        use gcode_session::files::FileAccess;
        let length = self.snapshot.files.program(path).map_or(0, |text| text.len());
        // A program that was read before counts once.
        let index = document_uri::of_path(path).and_then(|uri| self.snapshot.known(&uri));
        let known =
            index.and_then(|file| self.snapshot.project.file(file)).map_or(0, |file| file.text().len());
        self.read_bytes = self.read_bytes.saturating_sub(known);
        if self.read_bytes + length <= MAX_NEIGHBOURS {
            self.read_bytes += length;
            self.snapshot.read(path);
        }
    }

    /// Takes over the changes of a document.
    pub(crate) fn change(
        &mut self,
        uri: &Uri,
        version: i32,
        changes: Vec<lsp_types::TextDocumentContentChangeEvent>,
    ) {
        let Some(file) = self.snapshot.known(uri).filter(|file| self.snapshot.documents.contains_key(file))
        else {
            return;
        };
        self.end_requests_of_text();
        self.use_settings(file);
        let names = |state: &Self| {
            let programs = state.snapshot.project.file(file).map(|index| index.programs().to_vec());
            programs.unwrap_or_default().into_iter().map(|program| program.name).collect::<Vec<_>>()
        };
        let before = names(self);
        self.snapshot.change(file, version, changes);
        let has_other_programs = before != names(self);
        self.changed(file, has_other_programs);
    }

    /// Ends the requests whose answers an edit makes useless.
    fn end_requests_of_text(&mut self) {
        let ended: Vec<_> = self
            .pending
            .iter()
            .filter(|(_, request)| request.ends_with_edit)
            .map(|(id, _)| id.clone())
            .collect();
        for id in ended {
            self.end_request(&id, Failure::outdated());
        }
        // A place that waits for the scan is one of the text before the edit.
        let names_text = |request: &Request| request.params.get("textDocument").is_some();
        let waiting = std::mem::take(&mut self.waiting).into_iter();
        let (outdated, waiting): (Vec<_>, Vec<_>) = waiting.partition(names_text);
        self.waiting = waiting;
        for request in outdated {
            self.send(Failure::outdated().response(request.id));
        }
    }

    /// Ends a request in the background and answers it with an error.
    fn end_request(&mut self, id: &RequestId, failure: Failure) {
        if let Some(request) = self.pending.remove(id) {
            proof::cancel(&request.progress);
            self.send(failure.response(id.clone()));
        }
    }

    /// Closes a document. Its diagnostics stay if it belongs to a project, those of the file on the disk.
    pub(crate) fn close(&mut self, uri: &Uri) {
        let Some(file) = self.snapshot.known(uri) else { return };
        let is_in_project = self.checked.get(&file).is_some_and(|basis| basis.is_in_project);
        if self.snapshot.close(uri).is_none() {
            return;
        }
        if is_in_project && self.snapshot.project.file(file).is_some() {
            self.changed(file, true);
        } else {
            self.checked.remove(&file);
            Arc::make_mut(&mut self.snapshot.published).remove(&file);
            self.publish(uri.clone(), None, Vec::new());
            self.changed_beside(file, true);
            self.outdate_runs();
        }
    }

    /// Has everything computed anew that rests on a text.
    fn changed(&mut self, file: FileId, has_other_programs: bool) {
        let path = self.snapshot.path(file);
        if document_uri::is_other_text(&path) {
            return self.changed_on_disk(&[path]);
        }
        self.outdate_runs();
        self.check(file, true);
        self.changed_beside(file, has_other_programs);
    }

    /// Checks the documents that call programs of a file, and with other programs those that might.
    fn changed_beside(&mut self, file: FileId, has_other_programs: bool) {
        self.changes += 1;
        let last = self.last_changes.entry(file).or_default();
        last.0 = self.changes;
        if has_other_programs {
            last.1 = self.changes;
        }
        let path = self.snapshot.path(file);
        let others = self.checked.iter().filter(|(other, _)| **other != file);
        let others = others.filter(|(_, basis)| basis.rests_on(&path, has_other_programs));
        let others: Vec<_> = others.map(|(other, _)| *other).collect();
        let calls_open_document = self.checked.get(&file).is_some_and(|basis| {
            let mut called = basis.called.iter().filter(|called| **called != path);
            called.any(|called| self.snapshot.files.is_open(called))
        });
        if calls_open_document || others.iter().any(|other| self.snapshot.documents.contains_key(other)) {
            self.refresh_hints();
        }
        for other in others {
            self.check(other, false);
        }
    }

    /// Has the client ask again for hints: those of open documents may rest on a text that another document changed. It does so
    /// for all documents: changes until it answers have one more request together.
    fn refresh_hints(&mut self) {
        if self.snapshot.client.can_refresh_hints && self.hint_refresh.is_needed() {
            let id = self.ask::<InlayHintRefreshRequest>(());
            self.hint_refresh.asked = Some(id);
        }
    }

    /// Takes the client's answer to a request to ask for hints.
    pub(crate) fn hints_refreshed(&mut self, id: &RequestId) {
        if self.hint_refresh.is_answered_late(id) {
            self.refresh_hints();
        }
    }

    /// Returns true if a called program, or the choice of one, has changed since the job of a check, and no later job waits.
    fn is_outdated(&self, file: FileId, changes: u64) -> bool {
        let is_last = self.jobs.get(&file).is_none_or(|last| *last <= changes);
        let Some(basis) = self.checked.get(&file).filter(|_| is_last) else { return false };
        self.last_changes.iter().any(|(other, (any, programs))| {
            *other != file
                && changes < *any
                && basis.rests_on(&self.snapshot.path(*other), changes < *programs)
        })
    }

    /// Reads changed files of the disk and checks what rests on them.
    pub(crate) fn changed_on_disk(&mut self, paths: &[PathBuf]) {
        for path in paths {
            if workspace_scan::is_program(path, &self.snapshot.files) || self.is_indexed(path) {
                self.snapshot.read(path);
            }
        }
        self.outdate_runs();
        if !self.snapshot.documents.is_empty() {
            self.refresh_hints();
        }
        let files: Vec<_> = self.snapshot.documents.keys().chain(self.checked.keys()).copied().collect();
        let files: BTreeSet<_> = files.into_iter().collect();
        let mut has_other_settings = false;
        for file in files {
            has_other_settings |= self.take_settings(file);
            if self.snapshot.documents.contains_key(&file) || self.checked.contains_key(&file) {
                self.check(file, false);
            }
        }
        // The dialect tells the kinds of codes and variables.
        if has_other_settings && self.snapshot.client.can_refresh_tokens {
            self.ask::<SemanticTokensRefresh>(());
        }
    }

    fn is_indexed(&self, path: &Path) -> bool {
        document_uri::of_path(path).is_some_and(|uri| self.snapshot.known(&uri).is_some())
    }

    /// Looks for changes on the disk, also where the client reports none.
    pub(crate) fn poll_disk(&mut self) {
        let host = self.snapshot.files.host();
        let stamps = self.checked.values().flat_map(|basis| &basis.stamps);
        let changed =
            stamps.filter(|(path, stamp)| host.stamp(path) != **stamp).map(|(path, _)| path.clone());
        let changed: BTreeSet<_> = changed.filter(|path| !self.snapshot.files.is_open(path)).collect();
        if changed.is_empty() {
            return;
        }
        for basis in self.checked.values_mut() {
            basis.stamps.retain(|path, _| !changed.contains(path));
        }
        let in_folders = changed.iter().flat_map(|path| {
            use gcode_session::files::FileAccess;
            self.snapshot.files.files(path).unwrap_or_default()
        });
        let new = in_folders.filter(|path| !self.is_indexed(path)).collect::<Vec<_>>();
        let all: Vec<_> = changed.into_iter().chain(new).collect();
        self.changed_on_disk(&all);
    }

    /// Takes the control of a document over; returns true if it had another one.
    fn take_settings(&mut self, file: FileId) -> bool {
        let settings = self.snapshot.setup(file).settings;
        let before = self.settings.insert(file, settings);
        before.is_some_and(|before| self.settings.get(&file) != Some(&before))
    }

    /// Has the index read for the control of a document.
    pub(crate) fn use_settings(&mut self, file: FileId) {
        if let Some(settings) =
            self.settings.get(&file).filter(|settings| *settings != self.snapshot.project.settings())
        {
            Arc::make_mut(&mut self.snapshot.project).set_settings(settings.clone());
        }
    }

    /// Has all documents checked with other settings of the editor.
    pub(crate) fn settings_changed(&mut self) {
        self.changed_on_disk(&[]);
    }

    /// Publishes the result of a check, unless the document has changed since.
    pub(crate) fn publish_check(&mut self, answer: CheckAnswer) {
        let CheckAnswer { file, uri, version, changes, checked } = answer;
        let open = self.snapshot.documents.get(&file).map(|document| document.version);
        if open != version {
            return;
        }
        for fault in checked.faults {
            if self.shown_faults.insert(fault.clone()) {
                self.show_message(MessageType::WARNING, fault);
            }
        }
        let CheckedDocument { called, surroundings, is_in_project, stamps, .. } = checked;
        self.checked.insert(file, CheckBasis { called, surroundings, is_in_project, stamps });
        let published = (version, Arc::new(checked.diagnostics.clone()));
        Arc::make_mut(&mut self.snapshot.published).insert(file, published);
        self.publish(uri, version, checked.diagnostics);
        if self.is_outdated(file, changes) {
            self.check(file, false);
        }
    }

    fn publish(&self, uri: Uri, version: Option<i32>, diagnostics: Vec<Diagnostic>) {
        let params = PublishDiagnosticsParams { uri, diagnostics, version };
        self.send(Notification::new(PublishDiagnostics::METHOD.to_owned(), params));
    }

    /// Starts to read the programs of the workspace's folders.
    pub(crate) fn start_scan(&mut self) {
        if self.snapshot.folders.is_empty() {
            return;
        }
        self.is_scanning = true;
        let (files, folders) = (self.snapshot.files.clone(), Arc::clone(&self.snapshot.folders));
        let answers = self.background.clone();
        std::thread::spawn(move || {
            // Requests wait for the end of the scan, which a panic in it must not take away.
            let _end = ScanEnd(answers.clone());
            let mut batch = Vec::new();
            workspace_scan::scan(&files, &folders, |path| {
                batch.push(path);
                if batch.len() == 16 {
                    _ = answers.send(BackgroundAnswer::Scanned(std::mem::take(&mut batch)));
                }
            });
            if !batch.is_empty() {
                _ = answers.send(BackgroundAnswer::Scanned(batch));
            }
        });
    }

    /// Forgets the programs in folders that left the workspace, but for those that an open document needs.
    pub(crate) fn forget_folders(&mut self, removed: &[PathBuf]) {
        let is_left = |path: &Path| {
            let is_below = |folders: &[PathBuf]| folders.iter().any(|folder| path.starts_with(folder));
            is_below(removed) && !is_below(&self.snapshot.folders)
        };
        let files = self.snapshot.project.files().map(|(file, index)| (file, index.text().len()));
        let closed = files.filter(|(file, _)| !self.snapshot.documents.contains_key(file));
        let left: Vec<_> = closed.filter(|(file, _)| is_left(&self.snapshot.path(*file))).collect();
        for (file, length) in left {
            self.read_bytes = self.read_bytes.saturating_sub(length);
            Arc::make_mut(&mut self.snapshot.project).remove_file(file);
            if self.checked.remove(&file).is_some()
                && let Some(uri) = self.snapshot.uri(file).cloned()
            {
                self.publish(uri, None, Vec::new());
            }
        }
        for file in self.snapshot.documents.keys().copied().collect::<Vec<_>>() {
            self.read_neighbours(file);
        }
        self.outdate_runs();
    }

    /// Answers a request as cancelled, if it has no answer yet.
    pub(crate) fn cancel(&mut self, id: &RequestId) {
        if self.waiting.iter().any(|request| request.id == *id) {
            self.waiting.retain(|request| request.id != *id);
            self.send(Failure::cancelled().response(id.clone()));
        }
        self.end_request(id, Failure::cancelled());
    }
}

/// Announces the end of the scan of the workspace when it is dropped.
struct ScanEnd(Sender<BackgroundAnswer>);

impl Drop for ScanEnd {
    fn drop(&mut self) {
        _ = self.0.send(BackgroundAnswer::Scanned(Vec::new()));
    }
}
