//! The server's loop: messages of the client and answers from the background, one after the other.
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use crossbeam_channel::{Receiver, select, tick, unbounded};
use gcode_control::Progress;
use lsp_server::{Connection, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{Exit, Notification as _};
use lsp_types::request::{ApplyWorkspaceEdit, Initialize, Request as _, ShowDocument, Shutdown};
use lsp_types::{ApplyWorkspaceEditParams, InitializeParams, ShowDocumentParams, Uri};
use serde::Deserialize;
use serde_json::Value;

use crate::capabilities::initialize_result;
use crate::client::Client;
use crate::commands::CommandResult;
use crate::document_uri;
use crate::failure::Failure;
use crate::host::Host;
use crate::notifications;
use crate::requests::{self, Handler, guarded};
use crate::state::{BackgroundAnswer, PendingRequest, ServerState};

/// Period of the server's clock: it ends long runs and looks for changes on the disk.
const TICK: Duration = Duration::from_millis(250);

/// Ticks from one look at the disk to the next.
const POLL: u64 = 4;

/// Ticks from one look at the editor's process to the next.
const EDITOR_POLL: u64 = 12;

/// How the client ended its session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionEnd {
    /// shutdown, then exit.
    Shutdown,
    /// exit alone, the end of its messages, or of the process that started the server.
    Exit,
}

/// Phase of a server's life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Starting,
    Running,
    ShutDown,
}

/// Serves a client until it ends the server.
pub fn serve(connection: &Connection, host: Arc<dyn Host>) -> SessionEnd {
    let (sender, background) = unbounded();
    let state = ServerState::new(host, connection.sender.clone(), sender);
    let mut server = Server { state, phase: Phase::Starting, editor: None };
    server.run(&connection.receiver, &background)
}

struct Server {
    state: ServerState,
    phase: Phase,
    /// Process of the editor: the server ends with it.
    editor: Option<u32>,
}

impl Server {
    fn run(&mut self, client: &Receiver<Message>, background: &Receiver<BackgroundAnswer>) -> SessionEnd {
        let clock = tick(TICK);
        let mut ticks = 0;
        loop {
            select! {
                recv(client) -> message => match message {
                    Ok(Message::Request(request)) => self.on_request(request),
                    Ok(Message::Response(response)) => self.on_response(response),
                    Ok(Message::Notification(notification)) if notification.method == Exit::METHOD => {
                        return if self.phase == Phase::ShutDown { SessionEnd::Shutdown } else { SessionEnd::Exit };
                    }
                    Ok(Message::Notification(notification)) => self.on_notification(notification),
                    Err(_) => return SessionEnd::Exit,
                },
                recv(background) -> answer => answer.into_iter().for_each(|answer| self.on_answer(answer)),
                recv(clock) -> _ => {
                    ticks += 1;
                    self.state.snapshot.runs.tick();
                    if ticks % POLL == 0 {
                        self.state.poll_disk();
                    }
                    if ticks % EDITOR_POLL == 0 && self.editor.is_some_and(|editor| !self.is_alive(editor)) {
                        return SessionEnd::Exit;
                    }
                }
            }
        }
    }

    fn is_alive(&self, process: u32) -> bool {
        self.state.snapshot.files.host().is_alive(process)
    }

    fn on_request(&mut self, request: Request) {
        let failure = match (self.phase, request.method.as_str()) {
            (Phase::Starting, Initialize::METHOD) => return self.initialize(request),
            (Phase::Starting, _) => Failure::not_initialized(),
            (Phase::Running, Initialize::METHOD) => Failure::not_now("the server is initialized already"),
            (Phase::Running, Shutdown::METHOD) => {
                self.phase = Phase::ShutDown;
                return self.state.send(Response::new_ok(request.id, Value::Null));
            }
            (Phase::Running, _) => return self.answer(request),
            (Phase::ShutDown, _) => Failure::not_now("the server is shut down"),
        };
        self.state.send(failure.response(request.id));
    }

    fn initialize(&mut self, request: Request) {
        let params = match InitializeParams::deserialize(&request.params) {
            Ok(params) => params,
            Err(error) => {
                let failure = Failure::params(format!("{}: {error}", Initialize::METHOD));
                return self.state.send(failure.response(request.id));
            }
        };
        let client = Client::new(&params);
        self.phase = Phase::Running;
        self.state.send(Response::new_ok(request.id, initialize_result(&client)));
        self.state.snapshot.client = Arc::new(client);
        // The id may be that of a process elsewhere, outside a container.
        self.editor = params.process_id.filter(|editor| self.is_alive(*editor));
        let folders = folders(&params);
        self.state.snapshot.folders = Arc::new(folders.iter().filter_map(document_uri::path).collect());
        if let Some(options) = &params.initialization_options {
            notifications::set_configuration(&mut self.state, options);
        }
    }

    fn answer(&mut self, request: Request) {
        let Some(handler) = requests::handler(&request.method) else {
            return self.state.send(Failure::unknown_method(&request.method).response(request.id));
        };
        if self.state.is_scanning && requests::OF_WORKSPACE.contains(&request.method.as_str()) {
            return self.state.waiting.push(request);
        }
        let Request { id, method, params } = request;
        let uri = params.pointer("/textDocument/uri").and_then(|uri| Uri::deserialize(uri).ok());
        if let Some(file) = uri.and_then(|uri| self.state.snapshot.known(&uri)) {
            self.state.use_settings(file);
        }
        match handler {
            Handler::Now(handler) => {
                let result = guarded(&method, || handler(&self.state.snapshot, params));
                self.state.send(response(id, result));
            }
            Handler::Aside(handler) => self.in_background(id, false, move |snapshot, id, _| {
                let result = guarded(&method, || handler(&snapshot, params));
                BackgroundAnswer::Answered(response(id, result))
            }),
            Handler::Later(handler) => self.in_background(id, true, move |snapshot, id, progress| {
                let result = guarded(&method, || handler(&snapshot, params, progress));
                BackgroundAnswer::Answered(response(id, result))
            }),
            Handler::Command(handler) => self.in_background(id, false, move |snapshot, id, progress| {
                let result = guarded(&method, || handler(&snapshot, params, progress));
                BackgroundAnswer::Executed(id, result)
            }),
        }
    }

    fn in_background(
        &mut self,
        id: RequestId,
        ends_with_edit: bool,
        work: impl FnOnce(crate::snapshot::Snapshot, RequestId, &Arc<Progress>) -> BackgroundAnswer
        + Send
        + 'static,
    ) {
        let progress = Arc::new(Progress::default());
        let request = PendingRequest { progress: Arc::clone(&progress), ends_with_edit };
        self.state.pending.insert(id.clone(), request);
        let (snapshot, answers) = (self.state.snapshot.clone(), self.state.background.clone());
        std::thread::spawn(move || _ = answers.send(work(snapshot, id, &progress)));
    }

    fn on_notification(&mut self, notification: Notification) {
        if self.phase == Phase::Running {
            notifications::take(&mut self.state, notification);
        }
    }

    fn on_response(&mut self, response: Response) {
        self.state.hints_refreshed(&response.id);
        if self.state.configuration_requests.remove(&response.id) {
            let result = response.result.unwrap_or_default();
            // A client without such settings answers null: those of initialize stay.
            if let Some(settings) = result.get(0).filter(|settings| !settings.is_null()) {
                notifications::set_configuration(&mut self.state, settings);
            }
        }
    }

    fn on_answer(&mut self, answer: BackgroundAnswer) {
        match answer {
            BackgroundAnswer::Checked(answer) => self.state.publish_check(answer),
            BackgroundAnswer::Answered(response) => {
                // A cancelled request has its answer.
                if self.state.pending.remove(&response.id).is_some() {
                    self.state.send(response);
                }
            }
            BackgroundAnswer::Executed(id, result) => self.on_executed(id, result),
            BackgroundAnswer::Scanned(paths) if paths.is_empty() => {
                self.state.is_scanning = false;
                for request in std::mem::take(&mut self.state.waiting) {
                    self.answer(request);
                }
            }
            BackgroundAnswer::Scanned(paths) => {
                // A folder may have left the workspace since.
                let folders = Arc::clone(&self.state.snapshot.folders);
                let is_in = |path: &&PathBuf| folders.iter().any(|folder| path.starts_with(folder));
                paths.iter().filter(is_in).for_each(|path| self.state.read_within_budget(path));
            }
        }
    }

    fn on_executed(&mut self, id: RequestId, result: Result<CommandResult, Failure>) {
        if self.state.pending.remove(&id).is_none() {
            return;
        }
        let result = result.map(|result| {
            let CommandResult { value, message, shown, applied } = result;
            if let Some((kind, message)) = message {
                self.state.show_message(kind, message);
            }
            if let Some(uri) = shown.filter(|_| self.state.snapshot.client.has_show_document) {
                let external = Some(true);
                self.state.ask::<ShowDocument>(ShowDocumentParams {
                    uri,
                    external,
                    take_focus: None,
                    selection: None,
                });
            }
            if let Some((label, edit)) = applied {
                self.state.ask::<ApplyWorkspaceEdit>(ApplyWorkspaceEditParams { label: Some(label), edit });
            }
            value
        });
        self.state.send(response(id, result));
    }
}

fn response(id: RequestId, result: Result<Value, Failure>) -> Response {
    result.map_or_else(|failure| failure.response(id.clone()), |value| Response::new_ok(id.clone(), value))
}

#[expect(deprecated, reason = "old clients have one folder")]
fn folders(params: &InitializeParams) -> Vec<Uri> {
    match &params.workspace_folders {
        Some(folders) if !folders.is_empty() => folders.iter().map(|folder| folder.uri.clone()).collect(),
        _ => {
            let path = || document_uri::of_path(Path::new(params.root_path.as_deref()?));
            params.root_uri.clone().or_else(path).into_iter().collect()
        }
    }
}
