//! House rules: the order of modules, opening sentences, no unfinished work.
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Every Rust file below `dir`.
fn sources(dir: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(dir).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|n| n != "target") {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn all_sources() -> Vec<PathBuf> {
    ["gcode-sim", "gcode-gen", "tests", "xtask"]
        .iter()
        .flat_map(|dir| sources(&workspace().join(dir)))
        .collect()
}

/// The modules of a crate in the order its `lib.rs` lists them.
fn order(lib: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(lib).unwrap();
    let names = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    names.map(str::to_owned).collect()
}

#[test]
fn a_module_uses_only_the_ones_listed_above_it() {
    for krate in ["gcode-sim", "gcode-gen"] {
        let src = workspace().join(krate).join("src");
        let order = order(&src.join("lib.rs"));
        for path in sources(&src) {
            let inside = path.strip_prefix(&src).unwrap();
            let first = inside.components().next().unwrap().as_os_str().to_str().unwrap();
            let module = first.trim_end_matches(".rs");
            let Some(place) = order.iter().position(|m| m == module) else { continue };
            let text = std::fs::read_to_string(&path).unwrap();
            for (number, line) in text.lines().enumerate() {
                for used in line.split("crate::").skip(1) {
                    let used: String =
                        used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                    if let Some(at) = order.iter().position(|m| *m == used) {
                        assert!(
                            at <= place,
                            "{}:{}: {module} uses {used}, which comes after it",
                            path.display(),
                            number + 1
                        );
                    }
                }
            }
        }
    }
}

/// What is wanted knows no NC code, and the text side knows no geometry.
#[test]
fn the_two_sides_stay_apart() {
    let rules: [(&str, &[&str]); 4] = [
        ("gcode-sim/src/part", &["syntax", "program", "exec", "motion", "machine", "holes"]),
        ("gcode-sim/src/exec", &["part", "machine", "job"]),
        ("gcode-sim/src/program", &["part", "machine", "job"]),
        ("gcode-sim/src/syntax", &["part", "machine", "job"]),
    ];
    for (dir, forbidden) in rules {
        for path in sources(&workspace().join(dir)) {
            let text = std::fs::read_to_string(&path).unwrap();
            for module in forbidden {
                assert!(!text.contains(&format!("crate::{module}")), "{} uses {module}", path.display());
            }
        }
    }
}

/// The verifier would agree with the generator's mistakes if they shared a formula.
#[test]
fn the_reference_shares_nothing_with_the_generator() {
    for path in sources(&workspace().join("gcode-gen/src/families")) {
        let text = std::fs::read_to_string(&path).unwrap();
        for module in ["part", "verify", "machine", "holes"] {
            assert!(
                !text.contains(&format!("gcode_sim::{module}")),
                "{} uses gcode_sim::{module}",
                path.display()
            );
        }
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
