//! House rules: dependencies, opening sentences, no unfinished work.
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

/// The crates that a crate of gcode-sim depends on, as its Cargo.toml lists them.
fn dependencies(name: &str) -> Vec<String> {
    let path = workspace().join("gcode-sim/crates").join(name).join("Cargo.toml");
    let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    file["dependencies"].as_table().unwrap().keys().cloned().collect()
}

/// The text side has no geometry, no command line, no picture and no page.
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
fn the_nominal_part_uses_no_program() {
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
