//! The fuzzers' corpus, and every program of the suite, examples and macros, replayed as an ordinary test.
use std::path::PathBuf;

use gcode_tests::{files_below, fuzz, workspace};

/// The corpus of a target, and every program of the suite, the examples and the macros.
fn inputs(target: &str) -> Vec<PathBuf> {
    let corpus = std::fs::read_dir(workspace().join("fuzz/corpus").join(target)).unwrap();
    let corpus: Vec<_> = corpus.map(|entry| entry.unwrap().path()).collect();
    assert!(!corpus.is_empty(), "fuzz/corpus/{target} is empty");
    let folders = ["tests/suite", "examples", "macros"];
    let programs = folders.into_iter().flat_map(|folder| files_below(&workspace().join(folder), "nc"));
    corpus.into_iter().chain(programs).collect()
}

#[test]
fn the_fuzzers_corpus_is_read_and_printed() {
    for path in inputs("reader") {
        fuzz::reader(&std::fs::read(path).unwrap());
    }
}

#[test]
fn the_fuzzers_corpus_runs_to_an_end() {
    for path in inputs("run") {
        fuzz::run(&std::fs::read(path).unwrap());
    }
}
