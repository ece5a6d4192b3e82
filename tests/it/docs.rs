//! The sessions shown in README.md and docs/ are run and have the output shown.
use std::path::Path;

use gcode_tests::{copy_folder, files_below, programs, workspace};

/// A command of a ```` ```console ```` block and the lines under it; a line `...` stands for any lines.
struct ConsoleExample {
    command: String,
    output: Vec<String>,
}

fn sessions(text: &str) -> Vec<ConsoleExample> {
    let mut found: Vec<ConsoleExample> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        if line.starts_with("```") {
            inside = line == "```console";
        } else if let (true, Some(command)) = (inside, line.strip_prefix("$ ")) {
            found.push(ConsoleExample { command: command.to_owned(), output: Vec::new() });
        } else if inside {
            found.last_mut().expect("a console block begins with a command").output.push(line.to_owned());
        }
    }
    found
}

/// The program a line runs, as `cargo run` or by its own name; `None` for what no test may run (the tests themselves).
fn as_program(command: &str) -> Option<String> {
    for name in ["gcode-sim", "gcode-gen"] {
        if let Some(rest) = command.strip_prefix(&format!("cargo run --bin {name} -- ")) {
            return Some(format!("{name} {rest}"));
        }
        if command.starts_with(&format!("{name} ")) {
            return Some(command.to_owned());
        }
    }
    None
}

/// `shown` lines match `real` ones, `...` any number of them.
fn matches(shown: &[String], real: &[&str]) -> bool {
    match shown.split_first() {
        None => real.is_empty(),
        Some((line, rest)) if line == "..." => (0..=real.len()).any(|n| matches(rest, &real[n..])),
        Some((line, rest)) => real
            .split_first()
            .is_some_and(|(first, others)| line.trim_end() == first.trim_end() && matches(rest, others)),
    }
}

/// Runs a page's sessions in order in a copy of the folders that they may read.
fn check(page: &Path) {
    let shown = sessions(&std::fs::read_to_string(page).unwrap());
    if shown.is_empty() {
        return;
    }
    let place = tempfile::tempdir().unwrap();
    for folder in ["examples", "macros"] {
        copy_folder(&workspace().join(folder), &place.path().join(folder));
    }
    for shown in shown {
        let Some(line) = as_program(&shown.command) else {
            assert!(
                shown.command.starts_with("cargo "),
                "{}: '{}' is run by nothing",
                page.display(),
                shown.command
            );
            continue;
        };
        let done = programs::run_line(&line, place.path());
        let mut output = String::from_utf8_lossy(&done.stderr).into_owned();
        output.push_str(&String::from_utf8_lossy(&done.stdout));
        let real: Vec<_> = output.lines().collect();
        assert!(matches(&shown.output, &real), "{}: '{}' prints:\n{output}", page.display(), shown.command);
    }
}

#[test]
fn the_readme_shows_real_sessions() {
    check(&workspace().join("README.md"));
}

#[test]
fn the_pages_in_docs_show_real_sessions() {
    for folder in ["docs", "examples"] {
        files_below(&workspace().join(folder), "md").iter().for_each(|page| check(page));
    }
}

/// The book's index has every page once, and nothing else.
#[test]
fn the_summary_of_the_book_has_every_page_once() {
    let docs = workspace().join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let mut listed: Vec<String> = summary
        .lines()
        .filter_map(|line| line.rsplit_once("](")?.1.strip_suffix(')').map(str::to_owned))
        .collect();
    let mut pages: Vec<String> = files_below(&docs, "md")
        .iter()
        .map(|file| file.strip_prefix(&docs).unwrap().display().to_string().replace('\\', "/"))
        .filter(|page| page != "SUMMARY.md")
        .collect();
    listed.sort();
    pages.sort();
    assert_eq!(listed, pages);
}

/// The title of an explain page in the book's index is its heading.
#[test]
fn the_summary_of_the_book_has_the_headings_of_the_explain_pages() {
    let docs = workspace().join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let entries = summary.lines().filter_map(|line| line.split_once('[')?.1.rsplit_once("]("));
    let mut compared = 0;
    for (title, page) in entries.filter(|(_, page)| page.starts_with("explain/")) {
        let text = std::fs::read_to_string(docs.join(page.trim_end_matches(')'))).unwrap();
        assert_eq!(format!("# {}", title.replace('\\', "")), text.lines().next().unwrap(), "{page}");
        compared += 1;
    }
    assert!(200 < compared, "{compared} pages");
}
