//! House rules: dependencies, opening sentences, no unfinished work, paths that exist.
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gcode_tests::{files_below, workspace};

use crate::module_circles::paths_behind;

fn all_sources() -> Vec<PathBuf> {
    ["gcode-sim", "gcode-gen", "tests", "xtask"]
        .iter()
        .flat_map(|dir| files_below(&workspace().join(dir), "rs"))
        .collect()
}

/// Fails if a file below `dir` names another module behind `root`, as `crate::` or `gcode_sim::`, than it may.
fn uses_only(dir: &str, root: &str, may: &[&str]) {
    let files = files_below(&workspace().join(dir), "rs");
    assert!(!files.is_empty(), "{dir} has no sources");
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            for module in paths_behind(line, root).into_iter().map(|mut path| path.swap_remove(0)) {
                assert!(
                    may.contains(&module.as_str()),
                    "{}:{}: uses {root}{module}, and may use {} only",
                    path.display(),
                    number + 1,
                    may.join(", ")
                );
            }
        }
    }
}

/// Returns the folder of a crate.
fn crate_folder(name: &str) -> PathBuf {
    let program = workspace().join(name);
    if program.is_dir() { program } else { workspace().join("gcode-sim/crates").join(name) }
}

/// Returns the crates that a Cargo.toml lists in one of its sections.
fn listed_dependencies(folder: &Path, section: &str) -> Vec<String> {
    let path = folder.join("Cargo.toml");
    let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let listed = file.get(section).and_then(toml::Value::as_table);
    listed.into_iter().flat_map(toml::Table::keys).cloned().collect()
}

fn dependencies(name: &str) -> Vec<String> {
    listed_dependencies(&crate_folder(name), "dependencies")
}

/// Returns the crates in the order of the table in ARCHITECTURE.md.
fn crates_of_the_table() -> Vec<String> {
    let text = std::fs::read_to_string(workspace().join("ARCHITECTURE.md")).unwrap();
    let (_, section) = text.split_once("\n## Crates\n").unwrap();
    let table = section.split("\n## ").next().unwrap();
    let names = table.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    names.map(|(name, _)| name.to_owned()).collect()
}

#[test]
fn a_crate_depends_only_on_crates_above_it_in_the_table() {
    let table = crates_of_the_table();
    let mut crates = BTreeSet::from(["gcode-gen".to_owned(), "gcode-sim".to_owned()]);
    for entry in std::fs::read_dir(workspace().join("gcode-sim/crates")).unwrap() {
        crates.insert(entry.unwrap().file_name().into_string().unwrap());
    }
    assert_eq!(BTreeSet::from_iter(table.iter().cloned()), crates, "the table of crates in ARCHITECTURE.md");
    for (index, name) in table.iter().enumerate() {
        for section in ["dependencies", "dev-dependencies", "build-dependencies"] {
            for other in listed_dependencies(&crate_folder(name), section) {
                assert!(
                    !crates.contains(&other) || table[..index].contains(&other),
                    "{name} depends on {other}, which is not above it in the table of ARCHITECTURE.md"
                );
            }
        }
    }
}

#[test]
fn every_dependency_is_used() {
    let crates = crates_of_the_table();
    let folders = crates.iter().map(|name| crate_folder(name)).chain([workspace().join("tests")]);
    for folder in folders {
        let inner_crates = folder.join("crates");
        let files = files_below(&folder, "rs").into_iter().filter(|path| !path.starts_with(&inner_crates));
        let sources: String = files.map(|path| std::fs::read_to_string(path).unwrap()).collect();
        for section in ["dependencies", "dev-dependencies"] {
            for name in listed_dependencies(&folder, section) {
                let path = name.replace('-', "_") + "::";
                assert!(sources.contains(&path), "{}: {name} is not used", folder.display());
            }
        }
    }
}

/// The text side has no geometry, no command line, no picture and no page.
#[test]
fn the_language_side_depends_on_no_geometry_and_no_output() {
    let barred =
        ["clap", "gcode-draw", "gcode-inspect", "gcode-part", "image", "maud", "nalgebra", "tiny-skia"];
    for name in ["gcode-lang", "gcode-control", "gcode-lint", "gcode-ide"] {
        let found: Vec<_> = dependencies(name).into_iter().filter(|d| barred.contains(&&**d)).collect();
        assert!(found.is_empty(), "{name} depends on {}", found.join(", "));
    }
}

/// The nominal part is independent of NC code: its crate uses units and the names of controls alone.
#[test]
fn the_nominal_part_uses_no_program() {
    uses_only("gcode-sim/crates/gcode-part/src", "gcode_lang::", &["control", "shares", "similar", "units"]);
}

/// The verifier would agree with the generator's mistakes if they shared a formula: a family may use the job file, the
/// names of controls and the units, and nothing else.
#[test]
fn the_reference_shares_nothing_with_the_generator() {
    let families = "gcode-gen/src/families";
    uses_only(families, "gcode_lang::", &["control", "units"]);
    uses_only(families, "gcode_part::", &["gauge", "job"]);
    for root in ["gcode_control::", "gcode_inspect::", "gcode_session::", "gcode_sim::"] {
        uses_only(families, root, &[]);
    }
}

#[test]
fn every_file_opens_with_a_sentence() {
    for path in all_sources() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("//! "), "{} must open with a sentence", path.display());
    }
}

#[test]
fn no_work_is_unfinished() {
    let words = [
        ["TO", "DO"].concat(),
        ["FIX", "ME"].concat(),
        ["#[ign", "ore"].concat(),
        ["unimple", "mented!"].concat(),
    ];
    for path in all_sources() {
        let text = std::fs::read_to_string(&path).unwrap();
        for word in &words {
            assert!(!text.contains(word.as_str()), "{} contains {word}", path.display());
        }
    }
}

/// Files that merges and snapshots leave behind.
#[test]
fn no_file_is_left_over() {
    fn check(dir: &Path) {
        for entry in std::fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let is_left = [".orig", ".rej", ".snap.new", ".bak"].iter().any(|end| name.ends_with(end));
            assert!(!is_left, "{} is left over", path.display());
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                check(&path);
            }
        }
    }
    check(&workspace());
}

/// A file has one subject; beyond this it has several.
#[test]
fn no_file_is_too_long() {
    for path in all_sources() {
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 500, "{} has {lines} lines", path.display());
    }
}

/// Returns the paths between backticks in a page: text with a `/`, or the name of a file.
fn named_paths(page: &str) -> Vec<&str> {
    let is_path = |text: &&str| {
        let may_stand = |c: char| c.is_ascii_alphanumeric() || "_./-".contains(c);
        let is_file =
            [".rs", ".md", ".toml", ".nc", ".txt", ".mjs", ".sh"].iter().any(|end| text.ends_with(end));
        text.chars().all(may_stand) && (text.contains('/') || is_file)
    };
    // Code stands between an odd backtick and the next one.
    page.lines().flat_map(|line| line.split('`').skip(1).step_by(2)).filter(is_path).collect()
}

/// Adds the paths of all files and folders below a folder; build results and what npm and Git keep are left out.
fn add_entries(folder: &Path, known: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if matches!(name, "target" | "node_modules" | ".git") {
            continue;
        }
        known.insert(path.strip_prefix(workspace()).unwrap().to_str().unwrap().to_owned());
        if path.is_dir() {
            add_entries(&path, known);
        }
    }
}

#[test]
fn every_path_in_the_pages_for_contributors_exists() {
    assert_eq!(named_paths("see `a/b.rs`, `x.rs` and `<name>.rs`, not `word`"), ["a/b.rs", "x.rs"]);
    let mut known = BTreeSet::new();
    add_entries(&workspace(), &mut known);
    // Each path counts with any number of folders left out before it.
    let is_known =
        |path: &str| known.iter().any(|known| known == path || known.ends_with(&format!("/{path}")));
    for page in ["CONTRIBUTING.md", "ARCHITECTURE.md"] {
        let text = std::fs::read_to_string(workspace().join(page)).unwrap();
        let paths = named_paths(&text);
        assert!(10 < paths.len(), "{page} names paths");
        for path in paths {
            assert!(is_known(path.trim_end_matches('/')), "{page}: {path} does not exist");
        }
    }
}
