//! What is checked in is what the generator writes: the resident macros and the examples' programs.
use std::path::{Path, PathBuf};

use gcode_gen::families::pin_holes::macros::Resident;
use gcode_sim::control::{Dialect, Increment};
use gcode_sim::job::{HeadKind, Job};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The file must hold `text`, byte for byte; `cargo xtask bless` writes it.
fn holds(path: &Path, text: &str) {
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

const FILES: [(u32, &str); 2] = [(8101, "O8101_pin_hole.nc"), (8102, "O8102_head_angle.nc")];

#[test]
fn the_resident_macros_are_what_the_defaults_emit() {
    let resident = Resident {
        dialect: Dialect::default(),
        increment: Increment::default(),
        rotary: 'B',
        head: HeadKind::Manual,
        common: 140,
    };
    let folder = workspace().join("macros");
    let programs = resident.programs();
    assert_eq!(programs.len(), FILES.len());
    for (program, (number, name)) in programs.iter().zip(FILES) {
        assert_eq!(program.number, number);
        holds(&folder.join(name), &program.text);
    }
}

#[test]
fn every_resident_macro_has_its_row_and_every_alarm_its_remedy() {
    let readme = std::fs::read_to_string(workspace().join("macros/README.md")).unwrap();
    let mut files: Vec<_> = std::fs::read_dir(workspace().join("macros"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".nc"))
        .collect();
    files.sort();
    assert_eq!(files, FILES.map(|(_, name)| name.to_owned()));
    for (number, _) in FILES {
        assert!(readme.contains(&format!("| O{number} |")), "O{number} has no row");
    }
}

#[test]
fn the_examples_hold_what_emit_writes() {
    let mut examples = 0;
    let mut folders: Vec<_> =
        std::fs::read_dir(workspace().join("examples")).unwrap().map(|e| e.unwrap().path()).collect();
    folders.sort();
    for folder in folders.iter().filter(|path| path.join("job.toml").is_file()) {
        let job = Job::parse(&std::fs::read_to_string(folder.join("job.toml")).unwrap())
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for (name, text) in gcode_gen::families::emit(&job).files() {
            holds(&folder.join(name), text);
        }
        examples += 1;
    }
    assert!(examples >= 3, "examples are gone");
}
