//! The resident macros and the examples' programs in the repository are those that the generator writes.
use std::path::Path;

use gcode_gen::families;
use gcode_gen::package::Program;
use gcode_part::job::Job;
use gcode_tests::workspace;

/// The file must hold `text`, byte for byte; `cargo xtask bless` writes it.
fn assert_file_matches(path: &Path, text: &str) {
    if std::env::var("BLESS").is_ok() {
        std::fs::write(path, text).unwrap();
    }
    let found = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert!(
        found == text.as_bytes(),
        "{} is not what gcode-gen emits; run cargo xtask bless",
        path.display()
    );
}

/// The resident macros of all families in the order of their file names.
fn resident() -> Vec<(&'static str, Program)> {
    let of_family = |family: &families::Family| {
        let package = families::emit(&Job::parse(family.new_job).unwrap());
        let macros = family.macros.iter().flat_map(|of_main| *of_main);
        macros.map(|one| (one.file, package.program(one.number).unwrap().clone())).collect::<Vec<_>>()
    };
    let mut all: Vec<_> = families::ALL.iter().flat_map(of_family).collect();
    all.sort_by_key(|(name, _)| *name);
    all
}

#[test]
fn the_resident_macros_are_what_the_defaults_emit() {
    for (name, program) in resident() {
        assert!(name.starts_with(&format!("O{}_", program.number)), "{name}");
        assert_file_matches(&workspace().join("macros").join(name), &program.text);
    }
}

#[test]
fn every_resident_macro_has_its_row() {
    let readme = std::fs::read_to_string(workspace().join("macros/README.md")).unwrap();
    let mut files: Vec<_> = std::fs::read_dir(workspace().join("macros"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".nc"))
        .collect();
    files.sort();
    assert_eq!(files, resident().iter().map(|(name, _)| *name).collect::<Vec<_>>());
    for number in resident().iter().map(|(_, program)| program.number) {
        assert!(readme.contains(&format!("| O{number} |")), "O{number} has no row");
    }
}

/// The numbers of a row's first cell: `3001–3006`, `3133, 3154`.
fn numbers(row: &str) -> Vec<u32> {
    let cell = row.trim_start_matches('|').split('|').next().unwrap();
    let range = |part: &str| {
        let (from, to) = part.split_once('–').unwrap_or((part, part));
        Some(from.trim().parse().ok()?..=to.trim().parse::<u32>().ok()?)
    };
    cell.split(',').filter_map(range).flatten().collect()
}

#[test]
fn every_alarm_of_a_program_has_its_remedy() {
    let readme = std::fs::read_to_string(workspace().join("macros/README.md")).unwrap();
    let known: Vec<u32> = readme.lines().filter(|line| line.starts_with("| 3")).flat_map(numbers).collect();
    for program in
        families::ALL.iter().flat_map(|one| families::emit(&Job::parse(one.new_job).unwrap()).programs)
    {
        for alarm in program.text.split("#3000=").skip(1) {
            let number = 3000 + alarm.split('(').next().unwrap().parse::<u32>().unwrap();
            let name = program.number;
            assert!(
                known.contains(&number),
                "macros/README.md doesn't say what to do at {number} of O{name}"
            );
        }
    }
}

#[test]
fn the_examples_have_the_files_that_emit_writes() {
    let mut examples = 0;
    let mut folders: Vec<_> =
        std::fs::read_dir(workspace().join("examples")).unwrap().map(|e| e.unwrap().path()).collect();
    folders.sort();
    for folder in folders.iter().filter(|path| path.join("job.toml").is_file()) {
        let job = Job::parse(&std::fs::read_to_string(folder.join("job.toml")).unwrap())
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for (name, text) in families::emit(&job).files() {
            assert_file_matches(&folder.join(name), text);
        }
        examples += 1;
    }
    assert!(examples >= 3, "examples are gone");
}
