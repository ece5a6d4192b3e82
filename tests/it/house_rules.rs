//! House rules: the order of modules, opening sentences, no unfinished work.
use std::path::{Path, PathBuf};

use gcode_tests::{files_below, workspace};

fn all_sources() -> Vec<PathBuf> {
    ["gcode-sim", "gcode-gen", "tests", "xtask"]
        .iter()
        .flat_map(|dir| files_below(&workspace().join(dir), "rs"))
        .collect()
}

/// The modules that a line names behind `root`, as `crate::` or `gcode_sim::`, one by one or in braces.
fn named(line: &str, root: &str) -> Vec<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut found = Vec::new();
    for path in line.split(root).skip(1) {
        match path.strip_prefix('{') {
            None => found.push(word(path)),
            Some(list) => {
                let mut depth = 0;
                let outer = |c: char| {
                    depth += i32::from(c == '{') - i32::from(c == '}');
                    depth == 0 && c == ','
                };
                found.extend(list.split(outer).map(|path| word(path.trim())));
            }
        }
    }
    found.retain(|name| !name.is_empty());
    found
}

/// Fails where a file below `dir` names another module behind `root` than the ones it may.
fn uses_only(dir: &str, root: &str, may: &[&str]) {
    let files = files_below(&workspace().join(dir), "rs");
    assert!(!files.is_empty(), "{dir} has no sources");
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            for module in named(line, root) {
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

#[test]
fn every_module_of_a_line_is_seen() {
    let seen =
        named("use gcode_sim::{job::{Burr, Nose}, part, verify::checks}; gcode_sim::holes::X", "gcode_sim::");
    assert_eq!(seen, ["job", "part", "verify", "holes"]);
    assert_eq!(named("use crate::units::Deg;", "crate::"), ["units"]);
}

/// The crates that a crate of gcode-sim depends on, as its Cargo.toml lists them.
fn dependencies(name: &str) -> Vec<String> {
    let path = workspace().join("gcode-sim/crates").join(name).join("Cargo.toml");
    let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    file["dependencies"].as_table().unwrap().keys().cloned().collect()
}

/// The text side knows no geometry, no command line, no picture and no page.
#[test]
fn the_language_side_depends_on_no_geometry_and_no_output() {
    let barred =
        ["clap", "gcode-draw", "gcode-inspect", "gcode-part", "image", "maud", "nalgebra", "tiny-skia"];
    for name in ["gcode-lang", "gcode-control", "gcode-lint"] {
        let found: Vec<_> = dependencies(name).into_iter().filter(|d| barred.contains(&&**d)).collect();
        assert!(found.is_empty(), "{name} depends on {}", found.join(", "));
    }
}

/// The nominal part is independent of NC code: its crate uses units and the names of controls alone.
#[test]
fn the_nominal_part_knows_no_program() {
    uses_only("gcode-sim/crates/gcode-part/src", "gcode_lang::", &["control", "units"]);
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
fn every_file_opens_with_what_it_is() {
    for path in all_sources() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("//! "), "{} must open with a sentence", path.display());
    }
}

#[test]
fn nothing_is_left_unfinished() {
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

/// What merges and snapshots leave behind.
#[test]
fn no_file_is_left_over() {
    let left = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        [".orig", ".rej", ".snap.new", ".bak"].iter().any(|end| name.ends_with(end))
    };
    fn look(dir: &Path, left: &dyn Fn(&Path) -> bool) {
        for entry in std::fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            let hidden =
                path.file_name().is_some_and(|n| n == "target" || n.to_string_lossy().starts_with('.'));
            if path.is_dir() && !hidden {
                look(&path, left);
            }
            assert!(!left(&path), "{} is left over", path.display());
        }
    }
    look(&workspace(), &left);
}

/// A file has one subject; beyond this it has several.
#[test]
fn no_file_is_too_long() {
    for path in all_sources() {
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 500, "{} has {lines} lines", path.display());
    }
}
