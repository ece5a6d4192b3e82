//! The fuzzers' corpus, and every program of the suite, examples and macros, replayed as an ordinary test.
use std::path::{Path, PathBuf};

use gcode_tests::fuzz;

/// Every file below `dir` that `wanted` takes, in the order of their names.
fn files(dir: &Path, wanted: fn(&Path) -> bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, wanted));
        } else if wanted(&path) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn programs() -> Vec<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let is_program = |path: &Path| path.extension().is_some_and(|e| e == "nc");
    let folders = ["tests/suite", "examples", "macros"];
    folders.iter().flat_map(|folder| files(&workspace.join(folder), is_program)).collect()
}

fn corpus(target: &str) -> Vec<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let found = files(&workspace.join("fuzz/corpus").join(target), |_| true);
    assert!(!found.is_empty(), "fuzz/corpus/{target} is empty");
    found
}

#[test]
fn what_the_fuzzer_found_is_read() {
    for path in corpus("reader").iter().chain(&programs()) {
        fuzz::reader(&std::fs::read(path).unwrap());
    }
}

#[test]
fn what_the_fuzzer_found_runs_to_an_end() {
    for path in corpus("run").iter().chain(&programs()) {
        fuzz::run(&std::fs::read(path).unwrap());
    }
}
