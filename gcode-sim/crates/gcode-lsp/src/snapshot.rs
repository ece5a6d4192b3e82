//! What the server knows at one moment: open documents, the project's index, files and settings. Copies are cheap, so that a
//! long request works on its own.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gcode_ide::{FileId, FileIndex, Project, TextEdit, TextRange};
use gcode_lang::source::Bytes;
use gcode_lang::syntax::ast::ProgramName;
use gcode_lint::CheckedBlocks;
use lsp_types::{
    Diagnostic, Location, TextDocumentContentChangeEvent, TextDocumentIdentifier, TextDocumentPositionParams,
    Uri,
};

use crate::client::Client;
use crate::configuration::EditorSettings;
use crate::document_uri;
use crate::failure::Failure;
use crate::findings;
use crate::overlay::Overlay;
use crate::program_setup::ProgramSetup;
use crate::runs::Runs;
use crate::text_document::TextDocument;

/// A document that the client has opened.
#[derive(Clone, Debug)]
pub(crate) struct OpenDocument {
    pub uri: Uri,
    pub version: i32,
    pub text: Arc<TextDocument>,
}

/// Version of a document, `None` for a file of the disk, and the diagnostics of that text.
type VersionedDiagnostics = (Option<i32>, Arc<Vec<Diagnostic>>);

/// State of documents, files and settings.
#[derive(Clone)]
pub(crate) struct Snapshot {
    pub client: Arc<Client>,
    pub files: Overlay,
    pub editor: Arc<EditorSettings>,
    /// Folders of the workspace.
    pub folders: Arc<Vec<PathBuf>>,
    pub project: Arc<Project>,
    pub documents: Arc<BTreeMap<FileId, OpenDocument>>,
    /// Diagnostics last published.
    pub published: Arc<BTreeMap<FileId, VersionedDiagnostics>>,
    /// Runs of this state of the texts.
    pub runs: Arc<Runs>,
    addresses: Arc<Addresses>,
}

/// Files by their numbers.
#[derive(Clone, Debug, Default)]
struct Addresses {
    uris: Vec<Uri>,
    /// Numbers by path, or by URI for what has no path.
    numbers: BTreeMap<PathBuf, FileId>,
}

impl Snapshot {
    /// Returns the diagnostics of a document: those published if they are of its present text, else those of a check.
    pub(crate) fn diagnostics(&self, file: FileId) -> Arc<Vec<Diagnostic>> {
        let version = self.documents.get(&file).map(|document| document.version);
        let published = self.published.get(&file).filter(|(published, _)| *published == version);
        let checked = || {
            if document_uri::is_other_text(&self.path(file)) {
                return None;
            }
            let (text, uri, setup) = (self.text(file)?, self.uri(file)?, self.setup(file));
            let conditions = (&setup, BTreeMap::new());
            let checked =
                findings::check(uri, &text, CheckedBlocks::default(), conditions, &self.files, &self.client);
            Some(Arc::new(checked.0.diagnostics))
        };
        published.map(|(_, diagnostics)| Arc::clone(diagnostics)).or_else(checked).unwrap_or_default()
    }

    pub(crate) fn new(files: Overlay) -> Self {
        Self {
            client: Arc::default(),
            files,
            editor: Arc::default(),
            folders: Arc::default(),
            project: Arc::default(),
            documents: Arc::default(),
            published: Arc::default(),
            runs: Arc::default(),
            addresses: Arc::default(),
        }
    }

    /// Returns the number of a document, a new one for a new document.
    pub(crate) fn number(&mut self, uri: &Uri) -> FileId {
        let key = key(uri);
        if let Some(known) = self.addresses.numbers.get(&key) {
            return *known;
        }
        let addresses = Arc::make_mut(&mut self.addresses);
        let id = FileId(addresses.uris.len() as u32);
        addresses.uris.push(uri.clone());
        addresses.numbers.insert(key, id);
        id
    }

    /// Returns the number of a known document.
    pub(crate) fn known(&self, uri: &Uri) -> Option<FileId> {
        self.addresses.numbers.get(&key(uri)).copied()
    }

    /// Returns the number of a document that a request names.
    pub(crate) fn file(&self, document: &TextDocumentIdentifier) -> Result<FileId, Failure> {
        let known = self.known(&document.uri).filter(|file| self.project.file(*file).is_some());
        known.ok_or_else(|| Failure::params(format!("{} is not open", document.uri.as_str())))
    }

    /// Returns the document and the offset of a position that a request names.
    pub(crate) fn place(&self, at: &TextDocumentPositionParams) -> Result<(FileId, u32), Failure> {
        let file = self.file(&at.text_document)?;
        Ok((file, self.text_of(file)?.offset(at.position)))
    }

    /// Returns the text of a file that a request names.
    pub(crate) fn text_of(&self, file: FileId) -> Result<Arc<TextDocument>, Failure> {
        self.text(file).ok_or_else(|| Failure::params("the document is not open"))
    }

    /// Returns the URI of a file: that of the client for an open document.
    pub(crate) fn uri(&self, file: FileId) -> Option<&Uri> {
        let open = self.documents.get(&file).map(|document| &document.uri);
        open.or_else(|| self.addresses.uris.get(file.0 as usize))
    }

    /// Returns the path of a file; for a document without one a path in the first folder of the workspace.
    pub(crate) fn path(&self, file: FileId) -> PathBuf {
        let path = self.uri(file).map(|uri| (uri, document_uri::path(uri)));
        match path {
            Some((_, Some(path))) => path,
            Some((uri, None)) => {
                let name = uri.as_str().rsplit([':', '/']).next().unwrap_or("untitled");
                self.folders.first().map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
            }
            None => PathBuf::new(),
        }
    }

    /// Returns the text of a file with its lines.
    pub(crate) fn text(&self, file: FileId) -> Option<Arc<TextDocument>> {
        if let Some(open) = self.documents.get(&file) {
            return Some(Arc::clone(&open.text));
        }
        let text = self.project.file(file)?.text().clone();
        Some(Arc::new(TextDocument::new(text, self.client.encoding)))
    }

    /// Returns the conditions of a program.
    pub(crate) fn setup(&self, file: FileId) -> ProgramSetup {
        ProgramSetup::new(&self.path(file), &self.files, &self.editor)
    }

    /// Returns a place of the index as the protocol has it.
    pub(crate) fn location(&self, place: gcode_ide::Location) -> Option<Location> {
        let range = self.text(place.file)?.range(place.range.start, place.range.end);
        Some(Location { uri: self.uri(place.file)?.clone(), range })
    }

    /// Opens a document.
    pub(crate) fn open(&mut self, uri: Uri, version: i32, text: String) -> FileId {
        let file = self.number(&uri);
        self.set_text(file, text.into_bytes().into());
        let index = self.project.file(file).map(|index| index.text().clone());
        let text =
            Arc::new(TextDocument::new(index.unwrap_or_else(|| Vec::new().into()), self.client.encoding));
        self.cover(file, &uri, &text);
        Arc::make_mut(&mut self.documents).insert(file, OpenDocument { uri, version, text });
        file
    }

    /// Replaces the text of a file in the index.
    pub(crate) fn set_text(&mut self, file: FileId, text: Bytes) {
        let name = self.path(file).display().to_string();
        Arc::make_mut(&mut self.project).set_file(file, name, text);
    }

    /// Covers the file of a document by its text.
    fn cover(&mut self, file: FileId, uri: &Uri, text: &TextDocument) {
        if let Some(path) = document_uri::path(uri) {
            let programs = self.project.file(file).map(FileIndex::programs).unwrap_or_default();
            let names = programs.iter().map(|program| program.name.clone());
            let named = names.filter(|name| *name != ProgramName::Unnamed).collect();
            self.files.open(path, text.bytes().clone(), named);
        }
    }

    /// Applies the changes of one notification, each to the text that the one before leaves.
    ///
    /// Changes that go upwards, as of several cursors or of a replacement of all places, are made at once.
    pub(crate) fn change(
        &mut self,
        file: FileId,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
    ) {
        let Some(open) = self.documents.get(&file).cloned() else { return };
        let mut text = open.text;
        // A whole text makes the changes before it void.
        let first = changes.iter().rposition(|change| change.range.is_none()).unwrap_or_default();
        let mut changes = &changes[first..];
        while let Some(change) = changes.first() {
            if change.range.is_none() {
                self.set_text(file, change.text.clone().into_bytes().into());
                let Some(index) = self.project.file(file) else { return };
                text = Arc::new(TextDocument::new(index.text().clone(), self.client.encoding));
                changes = &changes[1..];
                continue;
            }
            let upwards = upward_edits(&text, changes);
            changes = &changes[upwards.len()..];
            let Some(edit) = hull(text.bytes(), &upwards) else { return };
            Arc::make_mut(&mut self.project).edit_file(file, &edit);
            let Some(index) = self.project.file(file) else { return };
            Arc::make_mut(&mut text).replace(
                (edit.range.start as usize, edit.range.end as usize),
                edit.text.len(),
                index.text().clone(),
            );
        }
        self.cover(file, &open.uri, &text);
        Arc::make_mut(&mut self.documents).insert(file, OpenDocument { uri: open.uri, version, text });
    }

    /// Closes a document; the file on the disk counts again.
    pub(crate) fn close(&mut self, uri: &Uri) -> Option<FileId> {
        let file = self.known(uri)?;
        Arc::make_mut(&mut self.documents).remove(&file)?;
        match document_uri::path(uri) {
            Some(path) => {
                self.files.close(&path);
                self.read(&path);
            }
            None => Arc::make_mut(&mut self.project).remove_file(file),
        }
        Some(file)
    }

    /// Reads a file of the disk into the index, or removes it. An open document covers it.
    pub(crate) fn read(&mut self, path: &Path) {
        use gcode_session::files::FileAccess;
        if self.files.is_open(path) {
            return;
        }
        let Some(uri) = document_uri::of_path(path) else { return };
        match self.files.program(path) {
            Ok(text) => {
                let file = self.number(&uri);
                self.set_text(file, text);
            }
            Err(_) => {
                if let Some(file) = self.known(&uri) {
                    Arc::make_mut(&mut self.project).remove_file(file);
                }
            }
        }
    }
}

/// Returns the first changes of which each lies in lines above the one before: their places are those of the text before all.
fn upward_edits(text: &TextDocument, changes: &[TextDocumentContentChangeEvent]) -> Vec<TextEdit> {
    let mut edits = Vec::new();
    let mut lowest = u32::MAX;
    for change in changes {
        let Some(range) = change.range.filter(|range| range.start.line.max(range.end.line) < lowest) else {
            break;
        };
        let (start, end) = text.offsets(range);
        // A place behind the text lies in its last line.
        lowest = text.position(start).line;
        edits.push(TextEdit { range: TextRange::new(start, end), text: change.text.clone() });
    }
    edits
}

/// Returns the edit that has the effect of some edits that go upwards; `None` without any.
fn hull(text: &[u8], upwards: &[TextEdit]) -> Option<TextEdit> {
    let (last, first) = (upwards.first()?, upwards.last()?);
    let mut new = String::new();
    let mut from = first.range.start;
    for edit in upwards.iter().rev() {
        new.push_str(&String::from_utf8_lossy(&text[from as usize..edit.range.start as usize]));
        new.push_str(&edit.text);
        from = edit.range.end;
    }
    Some(TextEdit { range: TextRange::new(first.range.start, last.range.end), text: new })
}

/// Returns the key of a document: its path, however the URI escapes it.
fn key(uri: &Uri) -> PathBuf {
    document_uri::path(uri).unwrap_or_else(|| PathBuf::from(uri.as_str()))
}
