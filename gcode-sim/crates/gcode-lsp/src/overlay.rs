//! Files as the editor sees them: open documents cover those on the disk. Files that were read are kept until they
//! change.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use gcode_lang::program::Library;
use gcode_lang::source::{Bytes, SourceId};
use gcode_lang::syntax::ast::ProgramName;
use gcode_lang::syntax::{FileItem, FileItems};
use gcode_session::files::{FileAccess, FolderLibrary};

use crate::host::Host;

/// Files of the host under the open documents.
#[derive(Clone)]
pub(crate) struct Overlay {
    host: Arc<dyn Host>,
    /// Open documents by their paths.
    open: Arc<BTreeMap<PathBuf, OpenText>>,
    /// Files read from the host.
    cache: Arc<Mutex<BTreeMap<PathBuf, CachedFile>>>,
    /// Folders of the host that were listed.
    listings: Arc<Mutex<BTreeMap<PathBuf, FolderListing>>>,
}

/// Text of an open document, with the names of its programs.
#[derive(Clone)]
struct OpenText {
    text: Bytes,
    programs: Arc<[ProgramName]>,
}

struct CachedFile {
    stamp: u64,
    content: Result<Bytes, String>,
    programs: Option<Arc<[ProgramName]>>,
}

/// Files of a folder, and the stamp of the folder then.
struct FolderListing {
    stamp: u64,
    files: Vec<PathBuf>,
}

impl Overlay {
    pub(crate) fn new(host: Arc<dyn Host>) -> Self {
        Self { host, open: Arc::default(), cache: Arc::default(), listings: Arc::default() }
    }

    pub(crate) fn host(&self) -> &dyn Host {
        &*self.host
    }

    /// Covers a file by an open text with these programs.
    pub(crate) fn open(&mut self, path: PathBuf, text: Bytes, programs: Arc<[ProgramName]>) {
        Arc::make_mut(&mut self.open).insert(path, OpenText { text, programs });
    }

    /// Uncovers a file.
    pub(crate) fn close(&mut self, path: &Path) {
        Arc::make_mut(&mut self.open).remove(path);
    }

    /// Returns true if an open document covers a file.
    pub(crate) fn is_open(&self, path: &Path) -> bool {
        self.open.contains_key(path)
    }

    /// Returns the programs that are found from a file's own folder and in `folders`.
    pub(crate) fn library(&self, folders: Vec<PathBuf>) -> impl Library + use<> {
        FolderLibrary::of_folders(self.clone(), folders)
    }

    /// Returns the files of a folder of the host.
    fn listing(&self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let Some(stamp) = self.host.stamp(folder) else { return self.host.files(folder) };
        let listings = || self.listings.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(listing) = listings().get(folder).filter(|listing| listing.stamp == stamp) {
            return Ok(listing.files.clone());
        }
        // A slow disk keeps no other thread waiting: no lock is held while it is read.
        let files = self.host.files(folder)?;
        listings().insert(folder.to_owned(), FolderListing { stamp, files: files.clone() });
        Ok(files)
    }

    /// Returns the stamp of a file from before it was read.
    pub(crate) fn read_stamp(&self, path: &Path) -> Option<u64> {
        // 0 is the stamp of a file that isn't there.
        let read = self.cache().get(path).map(|file| file.stamp).filter(|stamp| *stamp != 0);
        read.or_else(|| self.host.stamp(path))
    }

    fn cache(&self) -> MutexGuard<'_, BTreeMap<PathBuf, CachedFile>> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns what `value` takes of the current content of a file.
    fn cached<T>(&self, path: &Path, value: impl FnOnce(&mut CachedFile) -> T) -> T {
        let stamp = self.host.stamp(path).unwrap_or_default();
        if let Some(file) = self.cache().get_mut(path).filter(|file| file.stamp == stamp) {
            return value(file);
        }
        let mut file = CachedFile { stamp, content: self.host.program(path), programs: None };
        let result = value(&mut file);
        self.cache().insert(path.to_owned(), file);
        result
    }
}

impl FileAccess for Overlay {
    fn program(&self, path: &Path) -> Result<Bytes, String> {
        match self.open.get(path) {
            Some(open) => Ok(open.text.clone()),
            None => self.cached(path, |file| file.content.clone()),
        }
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        match self.open.get(path) {
            Some(open) => Ok(String::from_utf8_lossy(&open.text).into_owned()),
            None => self.host.text(path),
        }
    }

    fn files(&self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let mut files = self.listing(folder)?;
        let unsaved = self.open.keys().filter(|path| path.parent() == Some(folder));
        files.extend(unsaved.cloned());
        files.sort();
        files.dedup();
        Ok(files)
    }

    fn is_file(&self, path: &Path) -> bool {
        self.open.contains_key(path) || self.host.is_file(path)
    }

    fn canonical(&self, folder: &Path) -> Option<PathBuf> {
        self.host.canonical(folder)
    }

    fn programs(&self, path: &Path) -> Result<Arc<[ProgramName]>, String> {
        if let Some(open) = self.open.get(path) {
            return Ok(Arc::clone(&open.programs));
        }
        self.cached(path, |file| {
            let content = file.content.as_ref().map_err(Clone::clone)?;
            Ok(Arc::clone(file.programs.get_or_insert_with(|| programs_in(content))))
        })
    }
}

/// Returns the names of the programs of a text.
pub(crate) fn programs_in(text: &[u8]) -> Arc<[ProgramName]> {
    let items = FileItems::new(SourceId::default(), text);
    let names = items.filter_map(|item| match item {
        FileItem::Program { name, .. } => Some(name),
        _ => None,
    });
    names.collect()
}
