//! Checks in the background: the newest text of each document, the edited one first.
use std::collections::BTreeMap;

use crossbeam_channel::{Receiver, Sender, unbounded};
use gcode_ide::FileId;
use gcode_lint::{CheckResult, CheckedBlocks};
use lsp_types::Uri;

use crate::findings::{self, CheckedDocument};
use crate::requests::guarded;
use crate::snapshot::Snapshot;

/// A document to check.
pub(crate) struct CheckJob {
    pub snapshot: Snapshot,
    pub file: FileId,
    /// The document itself has changed, not a program that it calls.
    pub is_edited: bool,
    /// Number of changes that the snapshot has at least.
    pub changes: u64,
}

/// Result of a check.
pub(crate) struct CheckAnswer {
    pub file: FileId,
    pub uri: Uri,
    /// Version of the checked document; `None` for a file of the disk.
    pub version: Option<i32>,
    /// Number of changes of its job.
    pub changes: u64,
    pub checked: CheckedDocument,
}

/// Starts the thread that checks. It ends with the last sender of jobs.
pub(crate) fn start(answers: impl Fn(CheckAnswer) + Send + 'static) -> Sender<CheckJob> {
    let (sender, receiver) = unbounded();
    std::thread::spawn(move || work(&receiver, answers));
    sender
}

/// Largest number of blocks that are kept for the next check of a document, some tens of megabytes.
const MAX_KEPT_BLOCKS: usize = 100_000;

fn work(receiver: &Receiver<CheckJob>, answers: impl Fn(CheckAnswer)) {
    let mut jobs: BTreeMap<FileId, CheckJob> = BTreeMap::new();
    // Blocks of the document that was checked last: most often it is the next one too.
    let mut last: Option<(FileId, CheckedBlocks)> = None;
    loop {
        if jobs.is_empty() {
            let Ok(job) = receiver.recv() else { return };
            jobs.insert(job.file, job);
        }
        while let Ok(mut job) = receiver.try_recv() {
            let waits_as_edited = jobs.get(&job.file).is_some_and(|waiting| waiting.is_edited);
            job.is_edited |= waits_as_edited;
            jobs.insert(job.file, job);
        }
        let edited = jobs.values().find(|job| job.is_edited).or_else(|| jobs.values().next());
        let Some(file) = edited.map(|job| job.file) else { continue };
        let before = last.take().filter(|(checked, _)| *checked == file).map(|(_, blocks)| blocks);
        let answer = jobs.remove(&file).and_then(|job| check(&job, before.unwrap_or_default()));
        let Some((answer, CheckResult { memory, findings, blocks, .. })) = answer else { continue };
        answers(answer);
        // To release the operations of a long program takes as long as some rules: the next edit doesn't wait for it.
        std::thread::spawn(move || drop((memory, findings)));
        last = (blocks.count() <= MAX_KEPT_BLOCKS).then_some((file, blocks));
    }
}

fn check(job: &CheckJob, before: CheckedBlocks) -> Option<(CheckAnswer, CheckResult)> {
    let CheckJob { snapshot, file, changes, .. } = job;
    let (text, uri) = (snapshot.text(*file)?, snapshot.uri(*file)?);
    let check = || {
        // What is read behind its stamp is that state of the file or a later one, which the next look at the disk finds.
        let stamps = findings::stamps(&snapshot.setup(*file), &snapshot.files);
        let setup = snapshot.setup(*file);
        Ok(findings::check(uri, &text, before, (&setup, stamps), &snapshot.files, &snapshot.client))
    };
    let (checked, rest) = guarded("check", check).ok()?;
    let version = snapshot.documents.get(file).map(|document| document.version);
    Some((CheckAnswer { file: *file, uri: uri.clone(), version, changes: *changes, checked }, rest))
}
