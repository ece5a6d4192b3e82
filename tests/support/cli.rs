//! Cases of kind `cli`: the lines of `commands.txt` run in a copy of the folder; the session is the snapshot.
use std::fmt::Write;
use std::path::Path;

use crate::{Case, copy_folder, programs};

/// Runs the commands and compares the whole session, exit codes and new files included, with `session.snap`.
pub(crate) fn run(case: &Case) {
    let place = tempfile::tempdir().unwrap();
    copy_folder(&case.dir, place.path());
    let before = files(place.path());
    let mut session = String::new();
    for line in case.text("commands.txt").lines().filter(|line| !line.trim().is_empty()) {
        if let Some(comment) = line.strip_prefix('#') {
            let _ = writeln!(session, "#{comment}");
            continue;
        }
        let done = programs::run_line(line, place.path());
        let _ = writeln!(session, "$ {line}");
        session.push_str(&String::from_utf8_lossy(&done.stdout));
        for line in String::from_utf8_lossy(&done.stderr).lines() {
            let _ = writeln!(session, "! {line}");
        }
        let _ = writeln!(session, "[exit {}]", done.status.code().unwrap());
    }
    let new: Vec<_> = files(place.path()).into_iter().filter(|name| !before.contains(name)).collect();
    if !new.is_empty() {
        let _ = writeln!(session, "new files: {}", new.join(", "));
    }
    case.snapshot("session", &session);
}

/// The names of all files below `dir`, sorted.
fn files(dir: &Path) -> Vec<String> {
    fn walk(root: &Path, dir: &Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(root, &path, found);
            } else {
                found.push(path.strip_prefix(root).unwrap().display().to_string());
            }
        }
    }
    let mut found = Vec::new();
    walk(dir, dir, &mut found);
    found.sort();
    found
}
