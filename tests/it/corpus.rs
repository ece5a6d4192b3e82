//! The fuzzers' corpus, and every program of the suite, examples and macros, replayed as an ordinary test.
use std::path::PathBuf;

use gcode_tests::{files_below, fuzz, fuzz_sessions, workspace};

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

/// One input in `every` of those of a target: a session takes longer than a run.
fn some_inputs(target: &str, every: usize) -> impl Iterator<Item = Vec<u8>> {
    let corpus = std::fs::read_dir(workspace().join("fuzz/corpus").join(target)).unwrap().count();
    let inputs = inputs(target).into_iter().enumerate();
    let chosen = inputs.filter(move |(index, _)| *index < corpus || index.is_multiple_of(every));
    chosen.map(|(_, path)| std::fs::read(path).unwrap())
}

#[test]
fn sessions_with_the_language_server_end_in_the_state_of_a_fresh_start() {
    some_inputs("language_server", 16).for_each(|input| fuzz_sessions::language_server(&input));
}

#[test]
fn sessions_with_the_debugger_restart_as_a_fresh_one() {
    some_inputs("debugger", 8).for_each(|input| fuzz_sessions::debugger(&input));
}
